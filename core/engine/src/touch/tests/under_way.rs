//! What happens while a run is under way: what the operator asks for, what is missed, and what the glass tells.

use std::time::Duration;

use plumbline_model::session::{TouchTable, names};
use plumbline_model::touch_plan::{Pattern, PlanOptions};
use plumbline_model::{Pixel, Session};

use super::{folder, paused, rows};
use crate::robot::view::Connection;
use crate::robot::{RobotControl, TouchOrder, TouchRun, TouchStage};
use crate::touch::command::{ContactWith, ScreenContact, ScreenWindow, TouchCommand};
use crate::touch::refusal::Held;
use crate::touch::run::MISSES;
use crate::touch::store::REJECTED;
use crate::touch::testing::{Desk, grid, only_session};
use crate::touch::view::{ContactSource, TouchOutcome, TouchPhase};

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
        let table = TouchTable::read(&session.join(name), &joints);
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
fn nothing_is_touched_with_a_full_hand() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.in_hand = Some(Held { hand: "right", object: "Tomato".to_owned() });
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    desk.apply(TouchCommand::Start);
    assert!(desk.order().is_none() && !folder.path().join("sessions").exists());
    let said = desk.said();
    assert!(said.contains("The right hand holds the tomato. Put it down first"), "{said}");
    desk.in_hand = None;
    desk.apply(TouchCommand::Start);
    let order = desk.order().expect("the hand is empty");
    desk.apply(TouchCommand::Pause);
    desk.touch(&order);
    desk.in_hand = Some(Held { hand: "right", object: "Tomato".to_owned() });
    desk.apply(TouchCommand::Resume);
    assert!(desk.order().is_none() && desk.said().contains("holds the tomato"));
}

#[test]
fn many_misses_in_a_row_pause_with_advice() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.start(PlanOptions { patterns: vec![Pattern::Grid { columns: 3, rows: 3 }], ..grid(3, 3) });
    for _ in 0..MISSES {
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
    let next = |desk: &mut Desk, holds_s: u64| {
        desk.wait(Duration::from_secs(holds_s));
        let order = desk.order().expect("an order");
        desk.touch(&order);
        desk.view().remaining.map(|left| left.as_secs())
    };
    // A short hold belongs to the pace: 9, 9 and 18 s. An hour's pause does not.
    assert_eq!(next(&mut desk, 9), Some(4 * 12));
    assert_eq!(next(&mut desk, 3600), Some(3 * 12));
    // It runs while a touch is made, and stands still with one that takes much longer.
    desk.wait(Duration::from_secs(5));
    assert_eq!(desk.view().remaining.map(|left| left.as_secs()), Some(3 * 12 - 5));
    desk.wait(Duration::from_secs(3600));
    let left = desk.view().remaining.expect("touches are left");
    assert!((24.0..26.0).contains(&left.as_secs_f64()), "{left:?}");
    // Not while nothing moves: the touch under way is made again.
    let order = desk.order().expect("an order");
    desk.say(&order, TouchRun::Interrupted("STOP was pressed.".to_owned()));
    for _ in 0..2 {
        assert_eq!(desk.view().remaining.map(|left| left.as_secs()), Some(3 * 12));
        desk.wait(Duration::from_secs(7));
    }
}
