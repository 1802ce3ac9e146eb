//! From one step of the work to the next: what was accepted is behind, and the button leads on.

use plumbline_engine::View;
use plumbline_engine::view::{Gate, GateState, Need, StepState};

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

/// After the mount: to the first step that is left.
pub(super) fn after_the_mount(view: &View, said: &str) -> Option<Guidance> {
    if view.mount.step != StepState::Done {
        return None;
    }
    let (next, label, screen) = if view.touch.placement.is_none() {
        ("touch the screen (step 3)", "Go to Touch", Screen::Touch)
    } else if view.touch.step != StepState::Done {
        ("touch targets to learn from (step 3)", "Go to Touch", Screen::Touch)
    } else if [&view.models.step, &view.gap.step].iter().all(|step| **step == StepState::NotDone) {
        ("learn from the touches (step 4 or 5)", "Go to Models", Screen::Models)
    } else {
        ("grasp (step 7)", "Go to Grasp", Screen::Grasp)
    };
    Some(say(format!("{said} Next: {next}.")).then(label, Action::Go(screen)))
}

/// After a search that leaves nothing to add: to what is left.
pub(super) fn after_the_gap(view: &View, guidance: Guidance) -> Guidance {
    if !view.robot.connection.is_connected() {
        return guidance;
    }
    match view.handeye.step == StepState::Done {
        true => guidance.then("Go to Grasp", Action::Go(Screen::Grasp)),
        false => guidance.then("Go to Hand-eye", Action::Go(Screen::HandEye)),
    }
}

/// Where what a gate lacks, or has in doubt, is made: "Calibrate the eyes", and the screen.
pub fn way_to(gate: &Gate, view: &View) -> Option<(&'static str, Screen)> {
    if gate.state == GateState::Open || gate.of != Need::Places {
        return None;
    }
    if view.eyes.in_use.is_none() || view.eyes.health.does_not_hold.is_some() {
        return Some(("Calibrate the eyes", Screen::Collect));
    }
    if view.mount.step != StepState::Done {
        return Some(("Go to Mount", Screen::Mount));
    }
    Some(("Go to Touch", Screen::Touch))
}

/// To grasping, where the eyes that lead there are still good.
pub(super) fn to_grasping(view: &View, said: &str) -> Guidance {
    if view.eyes.health.does_not_hold.is_some() {
        let first = "Before grasping: the eyes see places elsewhere by now, calibrate them again.";
        return say(format!("{said} {first}"))
            .warn()
            .then("Calibrate the eyes again", Action::Go(Screen::Collect));
    }
    if let StepState::Stale { why } = &view.mount.step {
        return say(format!("{said} Before grasping: {why}"))
            .warn()
            .then("Go to Mount", Action::Go(Screen::Mount));
    }
    say(format!("{said} Next: grasp.")).then("Go to Grasp", Action::Go(Screen::Grasp))
}
