//! What the panes of this folder share.

use plumbline_engine::view::{TouchPhase, TouchState, TouchView};
use plumbline_model::robot::Posture;

use crate::operator::Screen;
use crate::operator::guidance::waiting_touch;
use crate::panels::PanelContext;

/// The posture at the contact of the chosen touch, or of the next one, to be drawn as a ghost, the head as it is: no
/// touch turns it. `None` while the arm moves by itself.
pub fn ghost(cx: &PanelContext<'_>) -> Option<Posture> {
    let touch = &cx.view.touch;
    let moves = matches!(touch.phase, TouchPhase::Running { .. } | TouchPhase::Planning);
    if cx.screen != Screen::Touch || moves {
        return None;
    }
    let number = cx.state.touch.chosen.or_else(|| next_touch(touch))?;
    let planned = touch.plan.as_ref()?.postures.get(number.checked_sub(1)?)?.as_ref()?;
    let Some((rig, measured)) = cx.view.robot.rig.as_ref().zip(cx.view.robot.measured.as_ref()) else {
        return Some(planned.clone());
    };
    let head = [rig.eyes.pan, rig.eyes.tilt];
    (measured.len() == planned.len()).then(|| planned.with(&head, &measured.of(&head)))
}

/// The touch that is under way, else the next one, by number.
pub fn next_touch(touch: &TouchView) -> Option<usize> {
    if let TouchPhase::Running { number, .. } = touch.phase {
        return number;
    }
    // What was not made when the run ended is not next.
    waiting_touch(touch).filter(|_| touch.phase != TouchPhase::Finished)
}

/// A planned touch by its number.
pub fn touch_number(touch: &TouchView, number: usize) -> Option<&TouchState> {
    touch.touches.iter().find(|one| one.number == number)
}

/// Distance between target and touch in the glass, m.
pub fn error_length_m(touch: &TouchState) -> Option<f64> {
    touch.error_m.map(|[u, v]| u.hypot(v))
}
