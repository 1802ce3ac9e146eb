//! What became of touches, in words.

use plumbline_engine::view::{TouchOutcome, TouchState};
use plumbline_model::touch_plan::{Purpose, Side};
use plumbline_widgets::format;

use super::parts::error_length_m;

/// "12.3 mm off", "out of reach: …".
pub fn outcome(touch: &TouchState) -> String {
    match &touch.outcome {
        TouchOutcome::Waiting => "to come".to_owned(),
        TouchOutcome::Unreachable(why) => format!("out of reach: {why}"),
        TouchOutcome::UnderWay => "under way".to_owned(),
        TouchOutcome::Touched => {
            error_length_m(touch).map_or("touched".to_owned(), |off| format!("{} off", format::mm(off)))
        }
        TouchOutcome::Missed(why) => format!("no contact: {why}"),
        TouchOutcome::Skipped => "left out".to_owned(),
        TouchOutcome::Rejected => "does not count".to_owned(),
    }
}

/// From where the finger comes.
pub fn side(side: Side) -> &'static str {
    match side {
        Side::Above => "above",
        Side::Left => "the robot's left",
        Side::Right => "the robot's right",
    }
}

/// What a run is for.
pub fn purpose(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::PlaceScreen => "Place screen",
        Purpose::Train => "Train",
        Purpose::Check => "Check",
    }
}

/// "1 touch", "80 touches".
pub fn touches(count: usize) -> String {
    format::count(count, "touch")
}
