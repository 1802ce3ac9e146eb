//! The screen: where it lies by the touches, on a block, and what had to make room on it.

use std::fs;
use std::time::Duration;

use plumbline_model::touch_plan::{Pattern, PlanOptions};
use plumbline_model::{Pixel, Session};

use super::folder;
use crate::ground::step::StepState;
use crate::robot::view::MotionState;
use crate::robot::{RobotControl, TouchRun};
use crate::touch::command::TouchCommand;
use crate::touch::testing::{Desk, area, grid, only_session, rig};
use crate::touch::view::TouchPhase;
use crate::twin::command::TwinCommand;

#[test]
fn a_raised_screen_and_a_weight_are_waited_for() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let options = PlanOptions {
        patterns: vec![Pattern::Grid { columns: 2, rows: 1 }],
        screen_heights_m: vec![0.0, 0.02],
        payloads_kg: vec![0.0, 0.25],
        ..grid(2, 1)
    };
    desk.start(options);
    let mut asked = vec![];
    loop {
        desk.touch_all();
        let TouchPhase::Waiting { what, prepare } = desk.view().phase else { break };
        let (screen_height_m, payload_kg) = prepare.expect("what is to be prepared");
        // Something else does not do.
        desk.apply(TouchCommand::Prepared { screen_height_m: 0.5, payload_kg });
        assert!(desk.order().is_none() && matches!(desk.view().phase, TouchPhase::Waiting { .. }));
        asked.push((screen_height_m, payload_kg));
        assert!(what.contains("block") || what.contains("weight") || what.contains("table"), "{what}");
        desk.apply(TouchCommand::Prepared { screen_height_m, payload_kg });
        if screen_height_m > 0.0 {
            let raised = desk.workflow.screen().expect("on its block").clone();
            assert!(rig().touchscreen.raised(screen_height_m) == raised, "everyone is told");
        }
    }
    assert_eq!(asked, [(0.0, 0.25), (0.02, 0.25), (0.02, 0.0), (0.0, 0.0)], "at last as it lay");
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert!(desk.workflow.screen().is_none(), "back where it lay");
    let read = Session::read(&only_session(folder.path())).expect("readable").touches.expect("touches");
    let heights: Vec<f64> = read.rows().filter_map(|row| row.screen_height_m).collect();
    assert_eq!(heights.iter().filter(|height| **height == 0.02).count(), 4);
    for row in read.rows() {
        let (height_m, sent) = (row.screen_height_m.expect("written"), row.target.expect("written"));
        let above_m = rig().touchscreen.height_above_m(sent);
        assert!((above_m - height_m).abs() < 1e-9, "{above_m} on a block of {height_m}");
    }
}

#[test]
fn corners_give_a_place_of_the_screen_that_is_used_after_it_was_accepted() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let options = PlanOptions { repeats: 1, ..PlanOptions::place_screen(area()) };
    desk.start(options.clone());
    desk.touch_all();
    assert!(only_session(folder.path()).to_string_lossy().ends_with("_corners"));
    let proposal = desk.view().placement_proposal.expect("a proposal");
    // The fingertip lands 8 px and −5 px beside: the screen lies that much the other way.
    let [u_m, v_m] = rig().touchscreen.pitch_m();
    let axes = (rig().touchscreen.u_axis.vector(), rig().touchscreen.v_axis.vector());
    let expected = axes.0 * (-8.0 * u_m) + axes.1 * (5.0 * v_m);
    let moved = nalgebra::Vector3::from(proposal.moved_m);
    assert!((moved - expected).norm() < 1.5e-3, "{moved:?} {expected:?}");
    assert!(desk.workflow.screen().is_none() && desk.view().placement.is_none(), "only a proposal");

    desk.apply(TouchCommand::AcceptPlacement);
    assert!(desk.view().placement_proposal.is_none());
    assert_eq!(desk.workflow.screen(), Some(&proposal.screen));
    // It is still there after a restart, and new plans use it.
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::Plan(grid(2, 1)));
    let view = desk.view();
    assert_eq!(view.screen.as_ref(), Some(&proposal.screen));
    for touch in view.touches.iter() {
        assert!(proposal.screen.point_at(touch.target).distance_m(&touch.sent) < 1e-12);
    }
    desk.apply(TouchCommand::UseNominalPlacement);
    assert!(desk.workflow.screen().is_none() && !folder.path().join("screen.toml").exists());
    for touch in desk.view().touches.iter() {
        assert!(rig().touchscreen.point_at(touch.target).distance_m(&touch.sent) < 1e-12, "planned anew");
    }
}

#[test]
fn touches_are_stale_when_the_screen_is_placed_anew_but_not_by_themselves() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    desk.touch_all();
    assert!(desk.view().placement_proposal.is_some(), "a run for training places the screen, too");
    desk.apply(TouchCommand::AcceptPlacement);
    assert_eq!(desk.view().step, StepState::Done);
    assert_eq!(Desk::new(folder.path()).view().step, StepState::Done, "after a restart, too");
    desk.apply(TouchCommand::UseNominalPlacement);
    assert_eq!(desk.view().step, StepState::Done, "where it was when they were made");
    desk.bias_px = (40.0, 0.0);
    desk.start(PlanOptions { repeats: 1, ..PlanOptions::place_screen(area()) });
    desk.touch_all();
    desk.apply(TouchCommand::AcceptPlacement);
    assert!(matches!(desk.view().step, StepState::Stale { .. }));
}

#[test]
fn what_made_room_on_the_screen_comes_back_when_no_hand_is_there_any_more() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 1));
    let order = desk.order().expect("an order");
    let away = desk.robot.measured.clone();
    let ends = |desk: &mut Desk| {
        let controls = desk.controls.drain(..);
        controls.filter(|one| matches!(one, RobotControl::Twin(TwinCommand::EndTouch))).count()
    };
    desk.robot.measured = order.lower.last().cloned();
    desk.robot.motion = MotionState::Moving { what: "up".to_owned(), fraction: None, remaining: None };
    desk.apply(TouchCommand::Close);
    desk.step();
    assert_eq!(ends(&mut desk), 0, "nothing is put beside an arm that moves");
    desk.robot.motion = MotionState::Holding { why: None };
    desk.step();
    assert_eq!(ends(&mut desk), 0, "the finger is on the glass");
    desk.robot.measured = order.lower.first().cloned();
    desk.step();
    assert_eq!(ends(&mut desk), 0, "what is put under a finger that hovers meets it");
    desk.robot.measured = away;
    desk.step();
    assert_eq!(ends(&mut desk), 0, "it may only pause between two ways");
    desk.wait(Duration::from_secs(2));
    assert_eq!(ends(&mut desk), 1, "nobody has to ask again");
    desk.step();
    assert_eq!(ends(&mut desk), 0, "once");
}

#[test]
fn what_made_room_comes_back_once_a_run_is_over_and_goes_again_when_it_is_taken_up() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let ends = |control: &RobotControl| matches!(control, RobotControl::Twin(TwinCommand::EndTouch));
    let begins =
        |control: &RobotControl| matches!(control, RobotControl::Twin(TwinCommand::PrepareTouch { .. }));
    // Orders stay for the arm.
    let count = |desk: &Desk| {
        let of = |is: &dyn Fn(&RobotControl) -> bool| desk.controls.iter().filter(|one| is(one)).count();
        [of(&begins), of(&ends)]
    };
    desk.start(grid(2, 1));
    desk.step();
    assert_eq!(count(&desk), [1, 0], "toys stay away as long as it is touched");
    desk.touch_all();
    desk.step();
    desk.wait(Duration::from_secs(2));
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert_eq!(count(&desk), [0, 1], "nobody has to close the run");
    desk.controls.clear();
    desk.apply(TouchCommand::Redo { number: 1 });
    desk.apply(TouchCommand::Resume);
    desk.step();
    assert_eq!(count(&desk), [1, 0], "and goes before the finger comes again");
    desk.touch_all();
    desk.step();
    desk.wait(Duration::from_secs(2));
    assert_eq!(count(&desk), [0, 1]);
}

#[test]
fn a_place_of_another_robot_is_not_used() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { repeats: 1, ..PlanOptions::place_screen(area()) });
    desk.touch_all();
    desk.apply(TouchCommand::AcceptPlacement);
    let file = folder.path().join("screen.toml");
    let text = fs::read_to_string(&file).expect("written").replace("\"nico\"", "\"other\"");
    fs::write(&file, text).expect("written");
    let mut desk = Desk::new(folder.path());
    assert!(desk.view().placement.is_none());
    assert!(desk.said().contains("other") && desk.said().contains("described place"), "{}", desk.said());
}

#[test]
fn a_touch_beside_the_image_does_not_spoil_the_place_of_the_screen() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { repeats: 2, ..PlanOptions::place_screen(area()) });
    let order = desk.order().expect("first");
    let mut measured = desk.measure(&order);
    measured.pixel = Pixel::new(-40.0, 500.0);
    desk.say(&order, TouchRun::Touched(Box::new(measured)));
    desk.touch_all();
    let proposal = desk.view().placement_proposal.expect("from the others");
    assert_eq!(proposal.touches, 7);
}

#[test]
fn a_place_that_older_touches_give_is_offered_with_a_warning() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let first = desk.order().expect("an order");
    desk.touch(&first);
    desk.apply(TouchCommand::Pause);
    let second = desk.order().expect("the next one is under way");
    desk.touch(&second);
    let older = only_session(folder.path());
    desk.apply(TouchCommand::Close);
    desk.start(PlanOptions { repeats: 1, ..PlanOptions::place_screen(area()) });
    desk.touch_all();
    let corners = desk.view();
    assert!(!corners.proposal_is_older, "of the run that is shown");
    let warns = |remarks: &[String]| remarks.iter().any(|remark| remark.contains("older than the place"));
    assert!(!warns(&corners.placement_proposal.expect("corners place it").remarks));
    desk.apply(TouchCommand::AcceptPlacement);
    desk.apply(TouchCommand::Close);

    desk.apply(TouchCommand::Open { session: older });
    desk.apply(TouchCommand::Resume);
    desk.touch_all();
    let offered = desk.view().placement_proposal.expect("touches for training place it, too");
    assert!(warns(&offered.remarks[..1]), "{:?}", offered.remarks);
    // While another run is shown it is said that it comes of an earlier one.
    desk.apply(TouchCommand::Close);
    desk.start(grid(2, 1));
    assert!(desk.view().proposal_is_older);
}
