//! What stands in place of an image, and how old the one that is shown is.

use std::time::{Duration, Instant};

use plumbline_engine::View;
use plumbline_engine::view::SourceStatus;
use plumbline_model::Eye;
use plumbline_widgets::empty::Message;
use plumbline_widgets::format;
use plumbline_widgets::image_view::Content;

use crate::operator::{Action, Outbox, RobotAction};

/// From this age on, the picture of a camera is called old.
const OLD: Duration = Duration::from_millis(1500);

/// What a view shows while there is no image. Only the left eye's view offers to do something
/// about it: the same button twice side by side helps nobody.
pub fn without_image(view: &View, eye: Eye) -> Content<'_> {
    match without_image_of_left(view) {
        Content::Empty(message) if eye == Eye::Right => Content::Empty(Message { button: None, ..message }),
        Content::Failed(message) if eye == Eye::Right => Content::Failed(Message { button: None, ..message }),
        content => content,
    }
}

fn without_image_of_left(view: &View) -> Content<'_> {
    match &view.source.status {
        SourceStatus::None if view.twin.running => Content::Empty(
            Message::new("No images yet", "The twin runs; its eyes are closed.")
                .button("Look through the twin's eyes"),
        ),
        SourceStatus::None => Content::Empty(
            Message::new(
                "No images yet",
                "Open a folder of pairs, two videos or two cameras; or drop files here.",
            )
            .button("Open a folder of pairs…"),
        ),
        SourceStatus::Lost { reason, .. } => {
            Content::Failed(Message::new("The source is lost", reason).button("Try again"))
        }
        SourceStatus::Ended => {
            Content::Empty(Message::new("The recording has ended", "Step back or seek to see a pair."))
        }
        SourceStatus::Opening | SourceStatus::Running | SourceStatus::Paused => {
            Content::Loading("Waiting for the first pair")
        }
    }
}

/// What the button of [`without_image`] asks for.
pub fn button_clicked(view: &View, outbox: &mut Outbox) {
    outbox.act(match view.source.status {
        SourceStatus::Lost { .. } => Action::RetrySource,
        SourceStatus::None if view.twin.running => Action::Robot(RobotAction::TwinEyes),
        _ => Action::OpenFolder,
    });
}

/// Age of the newest pair; `None` where it has none (photographs, a recording held still).
pub fn source_age(view: &View) -> Option<Duration> {
    let held =
        view.source.photographs || matches!(view.source.status, SourceStatus::Paused | SourceStatus::Ended);
    let newest_at = view.live.statistics.source.newest_at?;
    (!held).then(|| Instant::now().saturating_duration_since(newest_at))
}

/// Says that the shown picture is old, and why.
pub fn stale_sentence(view: &View) -> Option<String> {
    match &view.source.status {
        SourceStatus::Lost { since, reason, .. } => {
            let age = Instant::now().saturating_duration_since(*since);
            Some(format!("Last picture, {}: {reason}", format::age(age)))
        }
        SourceStatus::Running => {
            let age = source_age(view).filter(|age| *age > OLD)?;
            Some(format!("Last picture, {}: no new one comes.", format::age(age)))
        }
        _ => None,
    }
}
