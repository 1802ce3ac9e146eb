//! What is looked at before anything moves.

use plumbline_grasp::{Hand, HandChoice, Method};

use super::around::HandEyeAround;
use crate::grasp::gates::{full_hand, gates as gates_of_grasp, may_hold};
use crate::grasp::view::{Gate, GateState, Need};

/// All gates, in the order in which they are passed. Both arms move.
pub fn gates(around: &HandEyeAround) -> Vec<Gate> {
    let described = &around.grasp.described;
    let hands = Hand::BOTH.into_iter().filter(|hand| described.arm(hand.name()).is_some());
    let mut gates: Vec<Gate> = vec![];
    for gate in hands.flat_map(|hand| gates_of_grasp(&around.grasp, HandChoice::from(hand), Method::M5)) {
        // Of both arms, the one that lets pass less is told.
        match gates.iter_mut().find(|known| known.of == gate.of) {
            Some(known) if rank(gate.state) > rank(known.state) => *known = gate,
            Some(_) => {}
            None => gates.push(gate),
        }
    }
    gates.retain(|gate| ![Need::Places, Need::Method].contains(&gate.of));
    gates.push(calibrated(around));
    gates.push(touched(around));
    gates.extend(around.held.as_ref().map(full_hand).or_else(|| around.waits.and_then(may_hold)));
    gates
}

fn rank(state: GateState) -> usize {
    match state {
        GateState::Open => 0,
        GateState::Doubtful => 1,
        GateState::Shut => 2,
    }
}

fn gate(of: Need, is_open: bool, [open, shut]: [&str; 2]) -> Gate {
    let (state, text) = if is_open { (GateState::Open, open) } else { (GateState::Shut, shut) };
    Gate { of, state, text: text.to_owned() }
}

fn calibrated(around: &HandEyeAround) -> Gate {
    let grasp = &around.grasp;
    let is_open = grasp.calibration.is_some() && grasp.has_mount && grasp.has_screen;
    if let Some(why) = grasp.in_doubt.as_ref().filter(|_| is_open) {
        return Gate { of: Need::Places, state: GateState::Doubtful, text: why.clone() };
    }
    let shut = match (grasp.calibration.is_some(), grasp.has_mount) {
        (false, _) => "The lenses are not calibrated: calibrate the eyes first.",
        (true, false) => "How the eyes sit in the head was not measured: calibrate the mount first.",
        (true, true) => "Where the screen lies was not measured: place the screen first, in Touch.",
    };
    gate(Need::Places, is_open, ["Lenses, mount and screen were calibrated.", shut])
}

fn touched(around: &HandEyeAround) -> Gate {
    let none = || {
        format!(
            "No touches to learn from were found in {}: touch the screen, and find what makes the arm miss, in Gap.",
            around.sessions.display()
        )
    };
    let unread =
        "The model in use is not read yet, or its file cannot be used: wait a moment, else see the log.";
    let shut = if around.touches.is_some() { unread.to_owned() } else { none() };
    let is_open = around.touches.is_some() && around.added.is_some();
    gate(Need::Touches, is_open, ["What the arm was learned from is there.", &shut])
}
