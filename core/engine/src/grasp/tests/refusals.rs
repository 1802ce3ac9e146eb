//! What cannot be done is said, and nothing is asked of the arm.

use plumbline_grasp::{HandChoice, Method};

use crate::command::{Command, GraspCommand, GraspTarget, HandStep};
use crate::grasp::view::{GateState, Need};
use crate::robot::RobotControl;
use crate::state::{Action, State};

/// What the state says to a command, and whether the arm is led.
fn said(state: &mut State, command: GraspCommand) -> (String, bool) {
    state.take_actions();
    state.apply(Command::Grasp(command));
    let led =
        state.take_actions().iter().any(|action| matches!(action, Action::Robot(RobotControl::Lead(_))));
    let view = state.view(crate::Skipped::default(), 0, std::time::Instant::now());
    (view.notices.last().map(|notice| notice.text.clone()).unwrap_or_default(), led)
}

#[test]
fn without_a_robot_nothing_is_led() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut state = State::new(folder.path());
    for command in [GraspCommand::Plan, GraspCommand::Grasp, GraspCommand::Hand(HandStep::Home)] {
        let (text, led) = said(&mut state, command);
        assert!(text.contains("No robot is connected"), "{text}");
        assert!(!led);
    }
}

#[test]
fn what_is_not_there_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut state = State::new(folder.path());
    let target = GraspTarget { class: Some("Anvil".to_owned()), near_m: None };
    for (command, words) in [
        (GraspCommand::Target(target), "a thing called Anvil"),
        (GraspCommand::Pause, "Nothing is under way"),
        (GraspCommand::End, "Nothing is under way"),
        (GraspCommand::Judge { attempt: "yesterday".to_owned(), held: true }, "no attempt called yesterday"),
    ] {
        let (text, led) = said(&mut state, command);
        assert!(text.contains(words), "{text}");
        assert!(!led);
    }
}

#[test]
fn a_published_method_with_the_left_hand_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut state = State::new(folder.path());
    let gate = |state: &mut State| {
        let view = state.view(crate::Skipped::default(), 0, std::time::Instant::now());
        assert_eq!((view.grasp.hands.len(), view.grasp.hand), (3, HandChoice::Left));
        view.grasp.gates.iter().find(|gate| gate.of == Need::Method).expect("it is looked at").clone()
    };
    state.apply(Command::Grasp(GraspCommand::Arm(HandChoice::Left)));
    let allowed = gate(&mut state);
    assert!(!allowed.text.contains("right hand only"));
    // It goes by named effects, of which there are none.
    assert_eq!(allowed.state, GateState::Doubtful);
    assert!(allowed.text.contains("No effect is in use"), "{}", allowed.text);
    state.apply(Command::Grasp(GraspCommand::Method(Method::M4)));
    let refused = gate(&mut state);
    assert_eq!(refused.state, GateState::Shut);
    assert!(refused.text.contains("M4 knows the right hand only"), "{}", refused.text);
}

#[test]
fn a_method_that_lacks_a_model_can_be_chosen_and_says_what_it_lacks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut state = State::new(folder.path());
    state.apply(Command::Grasp(GraspCommand::Method(Method::M3)));
    let view = state.view(crate::Skipped::default(), 0, std::time::Instant::now());
    let gate = view.grasp.gates.iter().find(|gate| gate.of == Need::Method).expect("it is looked at");
    assert!(gate.text.contains("M3 needs M3 trained from touches"), "{}", gate.text);
}
