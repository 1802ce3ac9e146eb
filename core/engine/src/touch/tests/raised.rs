//! A screen that is put on blocks: nobody reaches under a finger, and at the end it lies where it lay.

use plumbline_model::robot::Posture;
use plumbline_model::touch_plan::{Pattern, PlanOptions};

use super::{folder, paused};
use crate::ground::notice::NoticeLevel;
use crate::robot::view::{Connection, MotionState};
use crate::robot::{RobotControl, TouchOrder, TouchRun, WithdrawOrder};
use crate::touch::command::TouchCommand;
use crate::touch::testing::{Desk, grid, only_session, rig};
use crate::touch::view::{TouchOutcome, TouchPhase};

const BLOCK_M: f64 = 0.06;

/// Two touches as the screen lies, then two on a block.
fn on_a_block() -> PlanOptions {
    let patterns = vec![Pattern::Grid { columns: 2, rows: 1 }];
    PlanOptions { patterns, screen_heights_m: vec![0.0, BLOCK_M], ..grid(2, 1) }
}

/// The first block is touched, and the finger hovers where it went up; its last way down.
fn touched_as_it_lies(desk: &mut Desk) -> Vec<Posture> {
    desk.start(on_a_block());
    let mut lower = vec![];
    for _ in 0..2 {
        let order = desk.order().expect("as the screen lies no arm has to go away");
        desk.robot.measured = order.lower.first().cloned();
        desk.touch(&order);
        lower = order.lower;
    }
    lower
}

/// The first block is touched, the arm is away, and the block is asked for.
fn asked_for_the_block(desk: &mut Desk) {
    touched_as_it_lies(desk);
    let away = desk.withdrawal().expect("away");
    desk.withdraw(&away);
    assert_eq!(waits_for(desk), Some((BLOCK_M, 0.0)));
}

/// The block is there, the first touch on it is made, and the arm hovers above the last one: both.
fn both_on_the_block(desk: &mut Desk) -> [TouchOrder; 2] {
    asked_for_the_block(desk);
    desk.apply(done(BLOCK_M));
    let first = desk.order().expect("on the block");
    desk.touch(&first);
    let last = desk.order().expect("the last one");
    desk.robot.measured = last.lower.first().cloned();
    [first, last]
}

fn waits_for(desk: &Desk) -> Option<(f64, f64)> {
    match desk.view().phase {
        TouchPhase::Waiting { prepare, .. } => prepare,
        _ => None,
    }
}

/// What somebody is asked to do.
fn asked(desk: &Desk) -> String {
    match desk.view().phase {
        TouchPhase::Waiting { what, .. } => what,
        other => panic!("it waits for nobody: {other:?}"),
    }
}

/// Height of the fingertip above the glass where it lies on the table, m.
fn above_glass_m(posture: &Posture) -> f64 {
    let tip = rig().chain("right_index_tip").map(|chain| chain.robot_from_tip_in(posture).translation_m());
    rig().touchscreen.height_above_m(nalgebra::Point3::from(tip.expect("NICO's finger")).into())
}

fn done(screen_height_m: f64) -> TouchCommand {
    TouchCommand::Prepared { screen_height_m, payload_kg: 0.0 }
}

#[test]
fn the_arm_goes_home_before_the_screen_is_raised_under_it() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let hovers = touched_as_it_lies(&mut desk)[0].clone();
    assert!(above_glass_m(&hovers) < 0.10, "{} m", above_glass_m(&hovers));
    let away: WithdrawOrder = desk.withdrawal().expect("first it goes away");
    assert!(desk.order().is_none(), "and does nothing else");
    match desk.view().phase {
        TouchPhase::Running { doing, .. } => assert!(doing.contains("away from the screen"), "{doing}"),
        other => panic!("nobody is asked for a block while a finger is there: {other:?}"),
    }
    // Every place of the way is at least as high as it hovers, and the last one is home.
    assert!(away.way.iter().all(|posture| above_glass_m(posture) > above_glass_m(&hovers) - 0.02));
    let (home, end) = (rig().home(), away.way.last().expect("a way"));
    let arm = rig().arm("right").cloned().expect("NICO's arm");
    assert_eq!(end.of(&arm.joints), home.of(&arm.joints));
    desk.withdraw(&away);
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)));
    desk.apply(done(BLOCK_M));
    let order = desk.order().unwrap_or_else(|| panic!("it does not go on: {}", desk.said()));
    let lowest = order.lower.last().expect("a way down");
    assert!(above_glass_m(lowest) > BLOCK_M - 0.02, "as high as the block");
    desk.touch(&order);
    let order = desk.order().expect("the last one");
    desk.robot.measured = order.lower.first().cloned();
    desk.touch(&order);

    // It lies as it lay before the run is over: from then on it is taken to.
    let away = desk.withdrawal().expect("away once more");
    assert_eq!(away.number, None, "no touch waits for it");
    desk.withdraw(&away);
    assert_eq!(waits_for(&desk), Some((0.0, 0.0)));
    assert!(desk.view().next.contains("back on the table"), "{}", desk.view().next);
    desk.apply(done(0.0));
    let view = desk.view();
    assert_eq!((view.phase, view.counts.touched), (TouchPhase::Finished, 4));
    assert!(desk.workflow.screen().is_none());
}

#[test]
fn no_block_is_believed_while_a_hand_is_over_the_screen() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let hovers = touched_as_it_lies(&mut desk)[0].clone();
    let away = desk.withdrawal().expect("away");
    desk.withdraw(&away);
    let home = desk.robot.measured.replace(hovers);
    desk.apply(done(BLOCK_M));
    assert!(desk.said().contains("Right arm: the hand is over the screen"), "{}", desk.said());
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)), "it still waits");
    assert!(desk.order().is_none() && desk.workflow.screen().is_none());
    desk.robot.measured = home;
    desk.apply(done(BLOCK_M));
    assert!(desk.order().is_some());
}

#[test]
fn an_arm_that_is_away_already_is_not_moved() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.robot.measured = Some(rig().home());
    desk.start(PlanOptions { screen_heights_m: vec![BLOCK_M], ..on_a_block() });
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)));
    assert!(desk.withdrawal().is_none());
}

#[test]
fn a_way_home_that_is_interrupted_is_gone_when_the_run_goes_on() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    touched_as_it_lies(&mut desk);
    let away = desk.withdrawal().expect("away");
    desk.say_away(&away, TouchRun::Interrupted("STOP was pressed.".to_owned()));
    assert!(paused(&desk).starts_with("STOP was pressed."), "{}", paused(&desk));
    desk.apply(TouchCommand::Resume);
    let again = desk.withdrawal().expect("once more");
    assert!(again.order > away.order);
    // The touch that waits for it can be left out meanwhile, and the next one waits for it, too.
    desk.apply(TouchCommand::Skip);
    desk.say_away(&again, TouchRun::Missed("stopped".to_owned()));
    assert_eq!(desk.view().touches[2].outcome, TouchOutcome::Skipped);
    let third = desk.withdrawal().expect("the other one needs the block as well");
    desk.withdraw(&third);
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)));
}

#[test]
fn a_run_that_is_ended_early_asks_for_the_screen_back_and_no_more_than_once() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    asked_for_the_block(&mut desk);
    desk.apply(done(BLOCK_M));
    let order: TouchOrder = desk.order().expect("on the block");
    desk.robot.measured = order.lower.first().cloned();
    desk.apply(TouchCommand::Finish);
    desk.say(&order, TouchRun::Missed("broken off".to_owned()));
    let away = desk.withdrawal().expect("it goes away");
    desk.withdraw(&away);
    assert_eq!(waits_for(&desk), Some((0.0, 0.0)));
    assert!(asked(&desk).contains("nothing moves any more"), "{}", asked(&desk));
    // Whoever cannot put it back now is told what follows from that.
    desk.apply(TouchCommand::Finish);
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    let warned = desk.notices.view().iter().any(|notice| {
        notice.level == NoticeLevel::Warning && notice.text.contains("put the screen back on the table")
    });
    assert!(warned);
    // From then on it is taken to lie as it lay: touched once more on the block, it has to be put there again.
    desk.apply(TouchCommand::Redo { number: 3 });
    desk.apply(TouchCommand::Resume);
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)));
}

#[test]
fn whoever_closes_a_run_on_a_block_is_told_that_the_screen_still_stands_there() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    asked_for_the_block(&mut desk);
    let in_the_way = |desk: &Desk| desk.workflow.in_the_way().unwrap_or_default();
    assert!(in_the_way(&desk).contains("say that it is done"), "{}", in_the_way(&desk));
    desk.apply(TouchCommand::Close);
    assert_eq!(in_the_way(&desk), "");
    assert!(!desk.said().contains("higher"), "as it lay: {}", desk.said());
    let session = desk.view().unfinished[0].session.clone();
    desk.apply(TouchCommand::Open { session: session.clone() });
    desk.apply(TouchCommand::Resume);
    desk.apply(done(BLOCK_M));
    assert!(desk.order().is_some());
    desk.apply(TouchCommand::Close);
    assert!(desk.said().contains("stands 60 mm higher"), "{}", desk.said());
    // Opened again nobody knows whether it still stands there, and the arm waits until somebody has looked.
    desk.apply(TouchCommand::Open { session });
    assert!(in_the_way(&desk).contains("stands on a block"), "{}", in_the_way(&desk));
    desk.apply(TouchCommand::Resume);
    assert!(desk.order().is_none());
    let said = asked(&desk);
    assert!(
        said.contains("See that the screen stands on its block of 60 mm") && said.contains("goes on"),
        "{said}"
    );
    desk.apply(done(BLOCK_M));
    let order = desk.order().expect("nothing has to be prepared");
    assert!(above_glass_m(order.lower.last().expect("a way down")) > BLOCK_M - 0.02);
}

#[test]
fn where_no_way_leads_home_it_is_said_what_to_do() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    touched_as_it_lies(&mut desk);
    let away = desk.withdrawal().expect("away");
    desk.say_away(&away, TouchRun::Interrupted("Something else moved the arm.".to_owned()));
    // An arm of which nobody knows where it is is not taken to be away.
    let stands = desk.robot.measured.clone().expect("it hovers");
    desk.robot.measured = Some(Posture::new(vec![f64::NAN; stands.len()]));
    desk.apply(TouchCommand::Resume);
    assert!(desk.withdrawal().is_none());
    let why = paused(&desk);
    assert!(why.contains("not a number") && why.contains("Bring it home"), "{why}");
}

#[test]
fn a_run_that_is_stopped_at_its_end_on_a_block_pauses_and_is_not_over() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let [_, order] = both_on_the_block(&mut desk);
    desk.robot.stopped = true;
    desk.touch(&order);
    assert!(paused(&desk).contains("STOP"), "{}", paused(&desk));
    let raised = desk.workflow.screen().expect("it still stands on its block");
    assert!(*raised == rig().touchscreen.raised(BLOCK_M));
    desk.robot.stopped = false;
    desk.apply(TouchCommand::Resume);
    assert_eq!(desk.withdrawal().expect("then it goes away").number, None);
}

#[test]
fn a_touch_that_is_to_be_made_again_is_made_before_a_run_that_was_to_end() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let [order, second] = both_on_the_block(&mut desk);
    desk.apply(TouchCommand::Finish);
    desk.say(&second, TouchRun::Missed("broken off".to_owned()));
    let away = desk.withdrawal().expect("away");
    desk.withdraw(&away);
    desk.apply(TouchCommand::Redo { number: order.number });
    desk.apply(TouchCommand::Resume);
    desk.touch_all();
    if waits_for(&desk).is_some() {
        desk.apply(done(0.0));
    }
    assert_eq!(desk.view().touches[order.number - 1].outcome, TouchOutcome::Touched);
}

#[test]
fn an_arm_that_was_moved_back_while_it_waited_goes_away_again() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let hovers = touched_as_it_lies(&mut desk)[0].clone();
    let away = desk.withdrawal().expect("away");
    desk.withdraw(&away);
    desk.robot.measured = Some(hovers);
    desk.apply(TouchCommand::Skip);
    assert!(desk.withdrawal().is_some(), "the next touch needs the block, too");
}

#[test]
fn nobody_is_believed_while_an_arm_moves_or_is_not_known() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    asked_for_the_block(&mut desk);
    desk.robot.motion = MotionState::Moving { what: "jogged".to_owned(), fraction: None, remaining: None };
    desk.apply(done(BLOCK_M));
    assert!(desk.said().contains("arm moves"), "{}", desk.said());
    desk.robot.motion = MotionState::Holding { why: None };
    desk.robot.unknown = [rig().arm("right").expect("NICO's arm").joints[0]].into();
    desk.apply(done(BLOCK_M));
    assert!(desk.said().contains("not known where the arm is"), "{}", desk.said());
    assert_eq!(waits_for(&desk), Some((BLOCK_M, 0.0)));
}

/// A run whose touches all lie as the screen lies, until it hovers over the glass after the last one.
fn hovers_after_the_last(desk: &mut Desk) -> WithdrawOrder {
    let patterns = vec![Pattern::Grid { columns: 2, rows: 1 }];
    desk.start(PlanOptions { patterns, ..grid(2, 1) });
    for _ in 0..2 {
        let order = desk.order().expect("a touch");
        desk.robot.measured = order.lower.first().cloned();
        desk.touch(&order);
    }
    desk.withdrawal().unwrap_or_else(|| panic!("home at the end: {}", desk.said()))
}

#[test]
fn a_run_that_is_done_leaves_no_hand_over_the_glass() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let away = hovers_after_the_last(&mut desk);
    assert_eq!(away.number, None);
    assert!(matches!(desk.view().phase, TouchPhase::Running { .. }), "it is not over while the arm moves");
    desk.withdraw(&away);
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert!(desk.controls.iter().all(|control| !matches!(control, RobotControl::Withdraw(_))), "once");
}

#[test]
fn a_run_is_over_although_the_arm_cannot_go_home() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let away = hovers_after_the_last(&mut desk);
    desk.say_away(&away, TouchRun::Interrupted("STOP is pressed.".to_owned()));
    assert_eq!(desk.view().phase, TouchPhase::Finished, "no touch is left");
    let said =
        |desk: &mut Desk| desk.notices.view().iter().filter(|one| one.text.contains("stays near")).count();
    assert_eq!(said(&mut desk), 1);
    assert!(desk.withdrawal().is_none());

    // Or with the robot gone on the way.
    let mut desk = Desk::new(self::folder().path());
    hovers_after_the_last(&mut desk);
    desk.robot.connection = Connection::None;
    desk.step();
    assert_eq!((desk.view().phase, said(&mut desk)), (TouchPhase::Finished, 1));
}

#[test]
fn a_pause_on_the_way_home_leaves_nothing_to_go_on_with() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let away = hovers_after_the_last(&mut desk);
    assert!(matches!(desk.view().phase, TouchPhase::Running { number: None, .. }));
    assert_eq!(desk.view().remaining, None);
    desk.apply(TouchCommand::Pause);
    desk.withdraw(&away);
    assert_eq!(desk.view().phase, TouchPhase::Finished);
}

#[test]
fn a_run_that_ended_on_the_way_home_is_over_when_it_is_opened_again() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    hovers_after_the_last(&mut desk);
    let mut again = Desk::new(folder.path());
    again.apply(TouchCommand::Open { session: only_session(folder.path()) });
    assert_eq!(again.view().phase, TouchPhase::Finished, "{}", again.said());
    assert!(again.withdrawal().is_none(), "nothing moves for it");
}
