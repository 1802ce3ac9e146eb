//! Touching the screen: planning, the map of touches, the run, the place of the screen.

mod draft;
mod inspector;
mod map;
mod options;
mod place;
mod plan;
mod run;
mod score;
mod words;

pub use inspector::show as show_inspector;
pub use map::show as show_map;
pub use place::show as show_place;
pub use plan::show as show_plan;
pub use run::show as show_run;

use plumbline_engine::view::{TouchOutcome, TouchPhase, TouchState, TouchView};
use plumbline_model::robot::Posture;

use super::PanelContext;
use crate::operator::{Monitor, Screen};
use draft::Draft;

/// How touching is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct TouchPanels {
    /// The plan as it is being changed.
    draft: Draft,
    /// The touch that the inspector speaks of, by number.
    chosen: Option<usize>,
    /// The map shows the table rather than the screen.
    on_table: bool,
    /// The operator was asked whether to finish early.
    finishing: bool,
    /// Monitors of this machine.
    pub monitors: Vec<Monitor>,
    /// The monitor that the touch window opens on, by its place among them; `None`: a window.
    pub monitor: Option<usize>,
    /// Whether the monitor was chosen by the operator.
    pub monitor_chosen: bool,
    /// Whether the touch window is open.
    pub window_open: bool,
}

/// The posture at the contact of the chosen touch, or of the next one, to be drawn as a ghost;
/// `None` while the arm moves by itself.
pub fn ghost<'a>(cx: &'a PanelContext<'_>) -> Option<&'a Posture> {
    let touch = &cx.view.touch;
    let moves = matches!(touch.phase, TouchPhase::Running { .. } | TouchPhase::Planning);
    if cx.screen != Screen::Touch || moves {
        return None;
    }
    let number = cx.state.touch.chosen.or_else(|| next_touch(touch))?;
    touch.plan.as_ref()?.postures.get(number.checked_sub(1)?)?.as_ref()
}

/// The touch that is under way, else the next one, by number.
pub fn next_touch(touch: &TouchView) -> Option<usize> {
    if let TouchPhase::Running { number, .. } = touch.phase {
        return Some(number);
    }
    touch.touches.iter().find(|one| one.outcome == TouchOutcome::Waiting).map(|one| one.number)
}

/// A planned touch by its number.
fn touch_number(touch: &TouchView, number: usize) -> Option<&TouchState> {
    touch.touches.iter().find(|one| one.number == number)
}

/// Distance between target and touch in the glass, m.
fn error_length_m(touch: &TouchState) -> Option<f64> {
    touch.error_m.map(|[u, v]| u.hypot(v))
}
