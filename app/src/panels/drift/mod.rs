//! Whether places stay where they are: curves over time, and arrows over the table.

mod chart;
mod course;
mod explain;
mod grid;
mod grid_map;
mod inspector;
mod table;

pub use course::show as show_course;
pub use grid::show as show_grid;
pub use inspector::show as show_inspector;
pub use table::show as show_table;

use std::time::{Duration, Instant};

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;

/// A look is expected at least so often; what is older is said to be.
const OLD: Duration = Duration::from_secs(30);

/// How long ago it looked.
fn age(view: &View) -> Option<Duration> {
    let [looked, _] = view.drift.looks_at?;
    Some(Instant::now().saturating_duration_since(looked))
}

/// That the last look is of long ago, and why; `None`: it is not.
fn old(view: &View) -> Option<String> {
    let age = age(view).filter(|age| *age > OLD)?;
    let [_, due] = view.drift.looks_at?;
    let next = due.saturating_duration_since(Instant::now());
    let why = match &view.drift.waits_because {
        Some(why) => why.clone(),
        None if next > Duration::ZERO => {
            format!("This computer is busy, so it looks seldom: again in {} s.", next.as_secs() + 1)
        }
        None => "The next look is under way.".to_owned(),
    };
    Some(format!("The last look was {}. {why}", format::age(age)))
}

/// What stands where there is no course to draw.
fn nothing_yet(ui: &mut Ui, view: &View) {
    let drift = &view.drift;
    match (&drift.failed, drift.is_watching) {
        (Some(why), true) => EmptyState::failed(Message::new("Nothing could be made of the pairs", why)).show(ui),
        (None, true) => {
            let why = drift.waits_because.as_deref().unwrap_or("Looks for the first time.");
            EmptyState::loading(why).show(ui)
        }
        (_, false) => EmptyState::empty(Message::new(
            "Not watched yet",
            "Start watching, at the bottom: now and then a pair is looked at, and these curves say how far places wander.",
        ))
        .show(ui),
    };
}
