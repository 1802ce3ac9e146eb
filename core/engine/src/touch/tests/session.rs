//! What stands on disk: the session of a run, after a kill, without room, and with a file that is damaged.

use std::fs;

use plumbline_correction::TouchData;
use plumbline_model::Session;
use plumbline_model::session::names;
use plumbline_model::touch_plan::{Pattern, PlanOptions};

use super::{folder, paused, rows};
use crate::ground::step::StepState;
use crate::robot::TouchRun;
use crate::touch::command::TouchCommand;
use crate::touch::plan::TIP;
use crate::touch::store::{PLAN, PROGRESS};
use crate::touch::testing::{Desk, grid, only_session, rig};
use crate::touch::view::{TouchOutcome, TouchPhase};

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
        assert!(
            matches!(desk.view().phase, TouchPhase::Running { number, .. } if number == Some(order.number))
        );
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
    // For how long the robot was on by the second connection nobody knows: no time goes back.
    let text = fs::read_to_string(session.join(names::TOUCHES)).expect("written");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = lines.next().and_then(|names| names.iter().position(|name| *name == "t_secs"));
    let column = column.expect("a column of times");
    let told: Vec<bool> = lines.map(|line| !line[column].is_empty()).collect();
    assert_eq!(told, [true, true, true, false, false, false, false, false]);
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
        let chain = rig().chain(TIP).expect("the tip");
        assert_eq!(TouchData::of_session(&read, &chain).expect("can be learned from").len(), 5);
    }
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
    let data = TouchData::of_session(&session, &rig().chain(TIP).expect("the tip"));
    assert_eq!(data.expect("can be learned from").len(), 7, "that touch is left out");
}
