//! The whole life of a run, with a robot that does what it is told when the test says so.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use plumbline_correction::{Method, TouchData, TrainOptions, train};
use plumbline_model::session::names;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, TouchArea};
use plumbline_model::{Pixel, Session, Unattended};

use super::command::{ContactWith, Correction, ScreenContact, ScreenWindow, TouchCommand};
use super::store::{PLAN, PROGRESS, REJECTED};
use super::testing::{Desk, area, grid, only_session, rig};
use super::view::{ContactSource, TouchOutcome, TouchPhase};
use crate::ground::step::StepState;
use crate::robot::view::{Connection, MotionState};
use crate::robot::{RobotControl, TouchOrder, TouchRun, TouchStage};
use crate::twin::command::TwinCommand;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn rows(session: &Path) -> usize {
    Session::read(session).expect("readable").touches.map_or(0, |table| table.row_count())
}

fn paused(desk: &Desk) -> String {
    match desk.view().phase {
        TouchPhase::Paused { why } => why.unwrap_or_default(),
        other => panic!("not paused: {other:?}"),
    }
}

#[test]
fn a_run_from_the_plan_to_a_session_that_is_read_again() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    let view = desk.view();
    let plan = view.plan.clone().expect("a plan");
    assert_eq!((view.phase.clone(), plan.reachable, view.counts.planned), (TouchPhase::Planned, 4 + 4, 8));
    assert!(plan.duration.as_secs() > 8 && plan.score.is_some() && plan.refusals.is_empty());
    assert!(!folder.path().join("sessions").exists(), "planning writes nothing");

    desk.apply(TouchCommand::Start);
    let mut done = 0;
    while let Some(order) = desk.order() {
        assert!(desk.order().is_none(), "one touch at a time");
        // Every touch before this one is on disk.
        let session = only_session(folder.path());
        assert_eq!(if done == 0 { 0 } else { rows(&session) }, done);
        assert!(matches!(desk.view().phase, TouchPhase::Running { number, .. } if number == order.number));
        assert!(!order.lower.is_empty() && order.lower.len() == order.lower_tip.len());
        desk.touch(&order);
        done += 1;
    }
    let view = desk.view();
    assert_eq!((done, view.phase, view.counts.touched), (8, TouchPhase::Finished, 8));
    assert_eq!(view.step, StepState::Done);

    let session = only_session(folder.path());
    assert!(session.to_string_lossy().ends_with("_touch"));
    let read = Session::read(&session).expect("readable");
    let table = read.touches.expect("touches");
    assert_eq!(read.manifest.touchscreen.as_ref(), Some(&rig().touchscreen));
    assert_eq!(table.joints().len(), 6);
    for (row, touch) in table.rows().zip(view.touches.iter()) {
        assert_eq!((row.touch, row.target), (touch.touched, Some(touch.sent)));
        assert_eq!((row.group.as_ref(), row.set.as_ref()), (Some(&touch.group), Some(&touch.set)));
        assert_eq!(row.approach.as_deref(), Some("plus"), "every joint arrived moving so");
        assert_eq!((row.screen_height_m, row.payload_kg, row.move_secs), (Some(0.0), Some(0.0), Some(1.25)));
        assert!(row.t_secs.is_some());
    }
    for name in ["planned", "target_u_px", "target_v_px", "later_r_elbow_y_rad", "dir_r_elbow_y"] {
        let column = table.extra_numbers(name).unwrap_or_else(|| panic!("{name}"));
        assert!(column.iter().all(Option::is_some), "{name}");
    }
    // The bias of the made-up robot is what the figures say.
    let figures = view.figures.expect("eight touches");
    let [u_m, v_m] = rig().touchscreen.pitch_m();
    assert!((figures.bias_m[0] - 8.0 * u_m).abs() < 1e-6 && (figures.bias_m[1] + 5.0 * v_m).abs() < 1e-6);
    assert!(figures.noise_m.expect("repeats") < 1e-6);
}

#[test]
fn a_killed_run_goes_on_exactly_where_it_was() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let mut numbers = vec![];
    for _ in 0..3 {
        let order = desk.order().expect("an order");
        numbers.push(order.number);
        desk.touch(&order);
    }
    let under_way = desk.order().expect("the fourth is under way").number;
    let before = desk.view().touches.clone();
    let session = only_session(folder.path());
    let csv = fs::read(session.join(names::TOUCHES)).expect("written");
    drop(desk);
    // Killed while a file was being written: a half file lies about, and the table is older.
    fs::write(session.join(".1-1.part-touches.csv"), "group,appr").expect("written");
    fs::remove_file(session.join(names::TOUCHES)).expect("removed");

    let mut desk = Desk::new(folder.path());
    let view = desk.view();
    assert_eq!(view.unfinished.len(), 1);
    assert_eq!((view.unfinished[0].touched, view.unfinished[0].planned), (3, 8));
    desk.apply(TouchCommand::Open { session: view.unfinished[0].session.clone() });
    assert_eq!(paused(&desk), "");
    assert!(desk.view().unfinished.is_empty() && desk.order().is_none(), "nothing moves by itself");
    assert_eq!(fs::read(session.join(names::TOUCHES)).expect("written again"), csv);
    for (now, then) in desk.view().touches.iter().zip(before.iter()) {
        assert_eq!((now.touched, now.sent, now.target), (then.touched, then.sent, then.target));
    }
    desk.apply(TouchCommand::Resume);
    let order = desk.order().expect("it goes on");
    assert_eq!(order.number, under_way, "with the touch that was under way");
    desk.touch(&order);
    desk.touch_all();
    assert_eq!((desk.view().phase, rows(&session)), (TouchPhase::Finished, 8));
    assert!(Desk::new(folder.path()).view().unfinished.is_empty());
}

#[test]
fn without_room_on_disk_nothing_moves_until_it_is_written() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let order = desk.order().expect("an order");
    let session = only_session(folder.path());
    // A folder in its place: the table cannot be written.
    fs::create_dir_all(session.join(names::TOUCHES).join("in the way")).expect("made");
    desk.touch(&order);
    assert!(desk.order().is_none(), "the next touch waits for the disk");
    let TouchPhase::Waiting { what, prepare: None } = desk.view().phase else { panic!("waits") };
    assert!(what.contains(names::TOUCHES) && what.contains("go on"), "{what}");
    assert_eq!(desk.view().touches[0].outcome, TouchOutcome::UnderWay, "touched means on disk");
    desk.apply(TouchCommand::Resume);
    assert!(desk.order().is_none() && matches!(desk.view().phase, TouchPhase::Waiting { .. }));
    desk.apply(TouchCommand::Close);
    assert!(desk.said().contains("not on disk yet") && desk.view().session.is_some());
    fs::remove_dir_all(session.join(names::TOUCHES)).expect("removed");
    desk.apply(TouchCommand::Resume);
    assert_eq!((rows(&session), desk.order().map(|order| order.number)), (1, Some(2)));
}

#[test]
fn touches_are_skipped_rejected_counted_again_and_redone() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { patterns: vec![Pattern::Grid { columns: 2, rows: 2 }], ..grid(2, 2) });
    let order = desk.order().expect("first");
    desk.touch(&order);
    let order = desk.order().expect("second");
    desk.apply(TouchCommand::Skip);
    assert!(matches!(desk.controls.pop_front(), Some(RobotControl::AbandonTouch)));
    assert!(desk.order().is_none(), "the arm has to be up again first");
    desk.say(&order, TouchRun::Missed("The touch was broken off.".to_owned()));
    assert_eq!(desk.view().touches[1].outcome, TouchOutcome::Skipped);
    let order = desk.order().expect("third");
    desk.touch(&order);
    let order = desk.order().expect("fourth");
    desk.apply(TouchCommand::Reject { number: 1 });
    desk.touch(&order);
    desk.touch_all();
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    let session = only_session(folder.path());
    let numbers = |name: &str| {
        let joints = Session::read(&session).expect("readable").manifest.chain.expect("chain").joints;
        let table = plumbline_model::session::TouchTable::read(&session.join(name), &joints);
        table.map_or(vec![], |table| table.extra_numbers("planned").expect("a column"))
    };
    assert_eq!(numbers(REJECTED), [Some(1.0)]);
    assert!(!numbers(names::TOUCHES).contains(&Some(1.0)));
    desk.apply(TouchCommand::Restore { number: 1 });
    assert_eq!(desk.view().touches[0].outcome, TouchOutcome::Touched);
    assert!(!session.join(REJECTED).exists() && numbers(names::TOUCHES)[0] == Some(1.0));

    desk.apply(TouchCommand::Redo { number: 1 });
    assert!(paused(&desk).contains("once more"));
    assert!(desk.order().is_none(), "nothing moves before it is told to go on");
    desk.bias_px = (0.0, 0.0);
    desk.apply(TouchCommand::Resume);
    let order = desk.order().expect("once more");
    assert_eq!(order.number, 1);
    desk.touch(&order);
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert_eq!((numbers(REJECTED), numbers(names::TOUCHES).len()), (vec![Some(1.0)], rows(&session)));
    let [u, v] = desk.view().touches[0].error_m.expect("touched");
    assert!(u.abs() < 1e-9 && v.abs() < 1e-9, "the newer touch counts");
    desk.apply(TouchCommand::Redo { number: 99 });
    assert!(desk.said().contains("no target 99"));
}

#[test]
fn a_pause_is_after_the_touch_and_stop_tries_it_again() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let order = desk.order().expect("first");
    desk.apply(TouchCommand::Pause);
    assert!(matches!(desk.view().phase, TouchPhase::Running { .. }), "the arm still moves");
    desk.touch(&order);
    assert_eq!((paused(&desk), desk.order().is_none()), (String::new(), true));
    desk.apply(TouchCommand::Resume);
    let order = desk.order().expect("second");
    desk.say(&order, TouchRun::Interrupted("STOP was pressed.".to_owned()));
    desk.robot.stopped = true;
    desk.step();
    assert!(paused(&desk).starts_with("STOP was pressed."));
    desk.apply(TouchCommand::Resume);
    assert!(desk.order().is_none() && desk.said().contains("Release it"), "{}", desk.said());
    desk.robot.stopped = false;
    desk.apply(TouchCommand::Resume);
    let again = desk.order().expect("the same once more");
    assert_eq!(again.number, order.number);
    // What is said of the old order is not taken for the new one.
    desk.say(&order, TouchRun::Missed("late".to_owned()));
    assert!(matches!(desk.view().phase, TouchPhase::Running { .. }));

    desk.robot.connection = Connection::Lost { to: "test".to_owned(), reason: "gone".to_owned() };
    desk.step();
    assert!(paused(&desk).contains("Connect again"));
    desk.robot.connection = Connection::Connected { to: "test".to_owned(), twin: true };
    desk.apply(TouchCommand::Resume);
    assert_eq!(desk.order().map(|order| order.number), Some(again.number));
}

#[test]
fn many_misses_in_a_row_pause_with_advice() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { patterns: vec![Pattern::Grid { columns: 3, rows: 3 }], ..grid(3, 3) });
    for _ in 0..super::run::MISSES {
        let order = desk.order().expect("goes on after a miss");
        desk.say(&order, TouchRun::Doing(TouchStage::Lowering));
        desk.say(&order, TouchRun::Missed("The lowest place was reached.".to_owned()));
    }
    assert!(paused(&desk).contains("touch window"));
    assert_eq!((desk.view().counts.missed, desk.order().is_none()), (5, true));
    desk.apply(TouchCommand::Resume);
    desk.touch_all();
    desk.apply(TouchCommand::Redo { number: 1 });
    desk.apply(TouchCommand::Resume);
    desk.touch_all();
    assert_eq!((desk.view().counts.missed, desk.view().counts.touched), (4, 5));
}

/// An arm that stands higher than its encoders say ends in the air.
#[test]
fn where_nothing_is_met_the_same_place_is_looked_for_deeper_and_so_are_the_next_ones() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let ends_m = |order: &TouchOrder| {
        [order.lower_tip.first(), order.lower_tip.last()].map(|tip| tip.expect("a way down").coords.z)
    };
    let first = desk.order().expect("first");
    assert_eq!((first.beside_m.norm(), first.deeper_m), (0.0, 0.0));
    desk.say(&first, TouchRun::MetNothing);
    assert!(desk.said().contains("12 mm deeper"), "{}", desk.said());
    let deeper = desk.order().expect("once more");
    assert_eq!((deeper.number, deeper.deeper_m, desk.view().counts.missed), (first.number, 0.012, 0));
    let ([above_m, low_m], [as_high_m, deep_m]) = (ends_m(&first), ends_m(&deeper));
    assert!((above_m - as_high_m).abs() < 1e-6, "from as high as always");
    assert!((low_m - deep_m - 0.012).abs() < 0.0021, "{low_m} {deep_m}");
    desk.touch(&deeper);
    let second = desk.order().expect("the next one");
    assert_eq!(second.deeper_m, 0.012, "as deep as where the glass was met");
    desk.say(&second, TouchRun::MetNothing);
    let deepest = desk.order().expect("deeper still");
    assert_eq!((deepest.number, deepest.deeper_m, desk.view().counts.missed), (second.number, 0.024, 0));
    desk.say(&deepest, TouchRun::MetNothing);
    assert_eq!(desk.view().counts.missed, 1, "it was looked for everywhere");
    let third = desk.order().expect("it goes on");
    assert_eq!(third.deeper_m, 0.012, "as deep as where the glass was met last");
    // What pushes is not looked for deeper.
    desk.say(&third, TouchRun::Missed("It pushes.".to_owned()));
    assert_eq!(desk.view().counts.missed, 2);
    let fourth = desk.order().expect("it goes on");
    assert!(fourth.number != third.number);
}

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
    assert_eq!(asked, [(0.0, 0.25), (0.02, 0.25), (0.02, 0.0)]);
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
fn the_left_finger_touches_what_it_reaches_and_its_session_says_so() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let [Some(right), Some(left)] = desk.view().reach else { panic!("both fingers reach a part") };
    assert!(left.u_px[0] < right.u_px[0] || left.u_px[1] < right.u_px[1], "{left:?} {right:?}");
    let inner = |range: [f64; 2]| [0.8 * range[0] + 0.2 * range[1], 0.2 * range[0] + 0.8 * range[1]];
    let area = TouchArea { u_px: inner(left.u_px), v_px: inner(left.v_px) };
    let options = PlanOptions { finger: Finger::Left, area, ..PlanOptions::quick(area) };
    desk.start(options.clone());
    assert!(desk.view().plan.is_some_and(|plan| plan.reachable > 12), "{:?}", desk.view().plan);
    desk.touch_all();
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert!(desk.view().placement_proposal.is_none(), "the right finger places the screen");
    let session = Session::read(&only_session(folder.path())).expect("readable");
    let chain = session.manifest.chain.clone().expect("a chain");
    assert_eq!(chain.tip, "left_index_tip");
    assert!(chain.joints.iter().all(|joint| joint.starts_with("l_")), "{:?}", chain.joints);

    // What was learned of the right arm says nothing of the left one.
    let data = TouchData::of_session(&session, &rig().chain(&chain.tip).expect("the tip")).expect("touches");
    let model = train(&data, Method::M1, &TrainOptions::default(), &Unattended, &mut |_| {});
    desk.models = vec![Arc::new(model.expect("trained"))];
    desk.controls.clear();
    desk.apply(TouchCommand::Close);
    let ends = |control: &RobotControl| matches!(control, RobotControl::Twin(TwinCommand::EndTouch));
    assert!(desk.controls.iter().any(ends), "toys that made room come back: {:?}", desk.controls);
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    desk.apply(TouchCommand::Plan(options));
    assert!(desk.said().contains("right index finger"), "{}", desk.said());
    assert!(desk.view().plan.is_none());
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
    assert_eq!(ends(&mut desk), 1, "nobody has to ask again");
    desk.step();
    assert_eq!(ends(&mut desk), 0, "once");
}

#[test]
fn a_run_is_finished_when_the_disk_says_so() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 1));
    while let Some(order) = desk.order() {
        desk.held = (order.number == desk.view().counts.planned).then_some("Write the touches");
        desk.touch(&order);
    }
    assert!(matches!(desk.view().phase, TouchPhase::Running { .. }), "{:?}", desk.view().phase);
    assert!(desk.workflow.run_standing().is_some_and(|run| !run.is_finished));
    desk.release();
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert!(desk.workflow.run_standing().is_some_and(|run| run.is_finished && run.touched == run.contacts));
}

#[test]
fn a_check_with_a_model_lands_nearer() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    assert!(desk.said().contains("no model M1"), "{}", desk.said());
    desk.start(grid(3, 3));
    desk.touch_all();
    let before = desk.view().figures.expect("touches");
    let session = Session::read(&only_session(folder.path())).expect("readable");
    let data = TouchData::of_session(&session, &rig().chain(super::plan::TIP).expect("the tip"));
    let data = data.expect("can be learned from");
    let model = train(&data, Method::M1, &TrainOptions::default(), &Unattended, &mut |_| {});
    desk.models = vec![Arc::new(model.expect("trained"))];
    desk.apply(TouchCommand::Close);
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    desk.start(PlanOptions { seed: 3, ..PlanOptions::check_reach(area(), 6, 3) });
    desk.touch_all();
    let view = desk.view();
    assert_eq!((view.phase, view.correct_with), (TouchPhase::Finished, Some(Method::M1.into())));
    assert!(view.touches.iter().all(|touch| touch.sent.distance_m(&touch.target_place) > 1e-3));
    let after = view.figures.expect("touches");
    assert!(after.mean_m < 0.3 * before.mean_m, "{} {}", after.mean_m, before.mean_m);
    assert!(view.session.expect("a session").to_string_lossy().ends_with("_check"));
    assert!(view.placement_proposal.is_some(), "that of the run before is still there");
}

#[test]
fn what_corrects_targets_is_the_same_after_a_restart() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::CorrectWith(Some(Correction::Effects)));
    drop(desk);
    let mut desk = Desk::new(folder.path());
    assert_eq!(desk.view().correct_with, Some(Correction::Effects));
    desk.apply(TouchCommand::CorrectWith(None));
    drop(desk);
    let mut desk = Desk::new(folder.path());
    assert_eq!((desk.view().correct_with, desk.said().as_str()), (None, ""));

    fs::write(folder.path().join("touch_correction.json"), "{\"correct_with\": \"m9\"}").expect("written");
    let mut desk = Desk::new(folder.path());
    assert!(desk.said().contains("choose it anew in Touch"), "{}", desk.said());
    assert_eq!(desk.view().correct_with, None);
}

#[test]
fn one_touch_is_a_session_too() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { patterns: vec![Pattern::Grid { columns: 1, rows: 1 }], ..grid(1, 1) });
    let order = desk.order().expect("one");
    desk.touch(&order);
    assert_eq!((desk.view().phase, desk.view().figures), (TouchPhase::Finished, None));
    assert!(desk.view().placement_proposal.is_none(), "one touch does not place a screen");
    assert_eq!(rows(&only_session(folder.path())), 1);
}

#[test]
fn a_run_is_finished_early_with_what_there_is() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let order = desk.order().expect("first");
    desk.touch(&order);
    let order = desk.order().expect("second");
    desk.apply(TouchCommand::Finish);
    desk.say(&order, TouchRun::Missed("broken off".to_owned()));
    assert_eq!((desk.view().phase, desk.order().is_none()), (TouchPhase::Finished, true));
    assert_eq!(desk.view().touches[1].outcome, TouchOutcome::Waiting);
    assert_eq!(rows(&only_session(folder.path())), 1);
    desk.apply(TouchCommand::Finish);
    desk.apply(TouchCommand::Skip);
    assert_eq!(desk.view().counts.skipped, 0, "nothing is under way");
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
    assert!(desk.said().contains("other") && desk.said().contains("nominal"), "{}", desk.said());
}

#[test]
fn a_damaged_plan_is_told_and_its_touches_can_still_be_used() {
    for name in [PLAN, PROGRESS] {
        let folder = folder();
        let mut desk = Desk::new(folder.path());
        desk.start(grid(2, 2));
        for _ in 0..5 {
            let order = desk.order().expect("an order");
            desk.touch(&order);
        }
        let session = only_session(folder.path());
        fs::write(session.join(name), "{ \"format\": 1, ").expect("written");
        let mut desk = Desk::new(folder.path());
        desk.apply(TouchCommand::Open { session: session.clone() });
        let said = desk.said();
        assert!(said.contains(name) && said.contains("Models"), "{said}");
        assert_eq!((desk.view().phase, rows(&session)), (TouchPhase::Idle, 5));
        let read = Session::read(&session).expect("readable");
        let chain = rig().chain(super::plan::TIP).expect("the tip");
        assert_eq!(TouchData::of_session(&read, &chain).expect("can be learned from").len(), 5);
    }
}

#[test]
fn contacts_go_to_the_robot_and_the_window_is_needed_for_a_real_one() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let contact =
        |with| TouchCommand::Contact(ScreenContact { u_px: 10.0, v_px: 20.0, age_s: 0.01, with, down: true });
    assert_eq!(desk.view().source, ContactSource::Twin);
    desk.apply(contact(ContactWith::Mouse));
    assert!(desk.controls.is_empty(), "the twin has a glass of its own");
    assert_eq!(desk.view().last_contact.map(|contact| contact.pixel), Some(Pixel::new(10.0, 20.0)));
    desk.robot.connection = Connection::Connected { to: "port".to_owned(), twin: false };
    desk.apply(contact(ContactWith::Mouse));
    assert!(matches!(desk.controls.pop_front(), Some(RobotControl::Contact(touch)) if touch.is_down));

    desk.apply(TouchCommand::Plan(grid(2, 2)));
    desk.apply(TouchCommand::Start);
    assert!(desk.said().contains("touch window"), "{}", desk.said());
    let window = ScreenWindow { width_px: 1280, height_px: 720, full_screen: true };
    desk.apply(TouchCommand::Window(Some(window)));
    assert!(desk.view().next.contains("1280×720"), "{}", desk.view().next);
    desk.apply(TouchCommand::Start);
    let order = desk.order().expect("with a window it begins");
    desk.apply(TouchCommand::Window(None));
    assert!(matches!(desk.controls.pop_front(), Some(RobotControl::AbandonTouch)));
    desk.say(&order, TouchRun::Missed("broken off".to_owned()));
    assert!(paused(&desk).contains("monitor"));
    desk.apply(TouchCommand::Resume);
    assert!(desk.order().is_none());
    let window = ScreenWindow { width_px: 1920, height_px: 1080, full_screen: true };
    desk.apply(TouchCommand::Window(Some(window)));
    desk.apply(TouchCommand::Resume);
    assert_eq!(desk.order().map(|again| again.number), Some(order.number), "made again");
}

#[test]
fn a_pause_while_the_way_is_looked_for_holds_before_the_arm_moves() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    desk.held = Some("way to target");
    desk.apply(TouchCommand::Start);
    assert!(matches!(desk.view().phase, TouchPhase::Running { .. }));
    desk.apply(TouchCommand::Pause);
    desk.release();
    assert_eq!((paused(&desk), desk.order().is_none()), (String::new(), true));
    desk.apply(TouchCommand::Resume);
    assert_eq!(desk.order().map(|order| order.number), Some(1));
    desk.apply(TouchCommand::Close);
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    assert_eq!(desk.view().unfinished.len(), 1, "a closed run can be opened again");
}

#[test]
fn a_plan_that_cannot_be_made_is_told_and_so_are_targets_out_of_reach() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::Plan(PlanOptions { patterns: vec![], ..grid(1, 1) }));
    assert!(desk.said().contains("no pattern") || desk.said().contains("No pattern"), "{}", desk.said());
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    desk.apply(TouchCommand::Start);
    assert!(desk.said().contains("Plan touches first"));
    let mut far = area();
    (far.u_px, far.v_px) = ([20.0, 60.0], [20.0, 60.0]);
    let options = PlanOptions { area: far, purpose: Purpose::Train, ..grid(2, 2) };
    desk.apply(TouchCommand::Plan(options));
    let view = desk.view();
    let plan = view.plan.expect("a plan");
    assert_eq!((plan.reachable, view.counts.unreachable), (0, view.counts.planned));
    assert!(!plan.refusals.is_empty() && plan.score.is_none());
    desk.apply(TouchCommand::Start);
    assert!(desk.said().contains("reaches none"), "{}", desk.said());
}

/// Asks to stop at the n-th checkpoint.
struct StopsAt(std::sync::atomic::AtomicUsize);

impl plumbline_model::JobContext for StopsAt {
    fn checkpoint(&self) -> Result<(), plumbline_model::Cancelled> {
        match self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) {
            1 => Err(plumbline_model::Cancelled),
            _ => Ok(()),
        }
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}

#[test]
fn planning_stops_when_asked_to() {
    let request = super::plan::PlanRequest {
        rig: rig(),
        place: crate::motion::ScreenPlace::Nominal,
        options: grid(2, 2),
        corrector: super::plan::Corrector::None,
    };
    let cancelled = super::plan::make(&request, &StopsAt(3.into()));
    assert!(matches!(cancelled, Err(crate::ground::jobs::JobError::Cancelled(_))));
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.held = Some("Plan touches");
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    assert_eq!(desk.view().phase, TouchPhase::Planning);
    desk.cancel();
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    // A plan in place of one that is being made: only the newer one counts, without a word.
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    desk.apply(TouchCommand::Plan(grid(3, 2)));
    desk.release();
    assert_eq!((desk.view().phase, desk.view().counts.planned), (TouchPhase::Planned, 10));
    assert!(desk.said().is_empty(), "{}", desk.said());
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
fn the_time_left_follows_the_pace() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let estimated = desk.view().plan.expect("a plan").duration;
    let left = desk.view().remaining.expect("estimated");
    assert!((left.as_secs_f64() - estimated.as_secs_f64()).abs() < 0.1, "{left:?} {estimated:?}");
    for _ in 0..3 {
        let order = desk.order().expect("an order");
        desk.touch(&order);
    }
    // The made-up robot takes nine seconds for each.
    assert_eq!(desk.view().remaining.map(|left| left.as_secs()), Some(5 * 9));
}

#[test]
fn a_touch_of_which_the_commanded_angles_are_not_known_claims_no_point_that_was_sent() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(grid(2, 2));
    let order = desk.order().expect("first");
    let mut measured = desk.measure(&order);
    measured.commanded_tip = None;
    for list in [&mut measured.commanded_rad, &mut measured.encoder_rad] {
        list.iter_mut().for_each(|angle| *angle = None);
    }
    desk.say(&order, TouchRun::Touched(Box::new(measured)));
    desk.touch_all();
    let session = Session::read(&only_session(folder.path())).expect("readable");
    let row = session.touches.as_ref().and_then(|table| table.row(0)).expect("a row");
    assert_eq!((row.target, row.commanded_rad[0], row.touch.is_some()), (None, None, true));
    let data = TouchData::of_session(&session, &rig().chain(super::plan::TIP).expect("the tip"));
    assert_eq!(data.expect("can be learned from").len(), 7, "that touch is left out");
}
