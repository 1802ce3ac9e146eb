//! From one step of the work to the next: what was accepted is behind, and the button leads on.

use plumbline_engine::View;
use plumbline_engine::view::StepState;

use super::sentence::{Guidance, say};
use crate::operator::{Action, Screen};

/// After the eyes, where there is a robot whose head they sit in.
pub(super) fn after_the_eyes(view: &View, said: &str) -> Option<Guidance> {
    let is_next = view.robot.connection.is_connected()
        && view.eyes.in_use.is_some()
        && view.mount.step != StepState::Done;
    is_next.then(|| {
        say(format!("{said} Next: measure how the eyes sit in the head (step 2)."))
            .then("Go to Mount", Action::Go(Screen::Mount))
    })
}

/// After the mount, as long as nobody measured where the screen lies.
pub(super) fn after_the_mount(view: &View, said: &str) -> Option<Guidance> {
    let is_next = view.mount.step == StepState::Done && view.touch.placement.is_none();
    is_next.then(|| {
        say(format!("{said} Next: touch the screen (step 3).")).then("Go to Touch", Action::Go(Screen::Touch))
    })
}

/// To grasping, where the eyes that lead there are still good.
pub(super) fn to_grasping(view: &View, said: &str) -> Guidance {
    match &view.eyes.health.does_not_hold {
        Some(_) => say(format!(
            "{said} Before grasping: the eyes see places elsewhere by now, calibrate them again."
        ))
        .warn()
        .then("Calibrate the eyes again", Action::Go(Screen::Collect)),
        None => say(format!("{said} Next: grasp.")).then("Go to Grasp", Action::Go(Screen::Grasp)),
    }
}
