//! Judging that nobody has asked for: when it rests, when it gives way, and what it counts.

use std::sync::Arc;
use std::time::Duration;

use super::{Desk, accepted, dark, frame};
use crate::eyes::command::EyesCommand;
use crate::eyes::view::HealthState;
use crate::ground::Workflow as _;
use crate::ground::jobs::JobId;

#[test]
fn it_rests_after_nothing_came_of_it_as_after_an_answer() {
    let end: [fn(&mut Desk, JobId); 3] = [
        |desk, _| desk.wait(Duration::from_secs(11)),
        |desk, id| desk.with(|room, around, context| room.work_ended(id, Some("broken"), around, context)),
        |desk, id| desk.with(|room, around, context| room.work_ended(id, None, around, context)),
    ];
    for (case, end) in end.into_iter().enumerate() {
        let mut desk = Desk::new(0.0);
        desk.until_judging();
        let (id, _) = desk.started.pop().expect("it is judged");
        end(&mut desk, id);
        assert!(!desk.room.may_give_way() && desk.said().is_empty(), "case {case}: {:?}", desk.said());
        (0..100).for_each(|_| desk.see(dark()));
        assert!(desk.started.is_empty() && !desk.room.wants_pairs(), "case {case}");
    }
}

#[test]
fn judging_that_nobody_asked_for_ends_when_the_arm_begins_to_move() {
    let mut desk = Desk::new(0.0);
    desk.until_judging();
    desk.started.clear();
    assert!(desk.room.may_give_way());
    desk.around.arm_moves = true;
    desk.see(dark());
    assert!(!desk.room.may_give_way());
    desk.around.arm_moves = false;
    (0..100).for_each(|_| desk.see(dark()));
    assert!(desk.started.is_empty(), "it rests");
    // A proposal is looked at as soon as the arm rests: somebody waits for what is said of it.
    desk.propose(0.6);
    desk.until_judging();
    desk.started.clear();
    desk.around.arm_moves = true;
    desk.see(dark());
    desk.around.arm_moves = false;
    (0..12).for_each(|_| desk.see(dark()));
    assert_eq!(desk.started.len(), 1);
    // Who asks has an answer.
    desk.around.newest = Some(frame(dark(), desk.time));
    desk.ask(EyesCommand::JudgeHealth);
    desk.around.arm_moves = true;
    (0..4).for_each(|_| desk.see(dark()));
    assert_eq!(desk.view().health.state, HealthState::Judging);
}

#[test]
fn how_another_calibration_looked_is_not_counted() {
    let mut desk = Desk::new(0.0);
    desk.until_judging();
    desk.looks_bad();
    desk.room.in_use = Some(Arc::new(accepted(0.0)));
    desk.until_judging();
    desk.looks_bad();
    assert_eq!(desk.said(), Vec::<String>::new(), "this one looked bad once");
    desk.until_judging();
    desk.looks_bad();
    assert_eq!(desk.said().len(), 1);
}

#[test]
fn cold_eyes_are_not_judged_by_itself_and_nothing_bad_is_said_of_their_calibration() {
    let mut desk = Desk::new(0.6);
    desk.calibrated_after(25.0);
    desk.room.clock.say(Some(2.0), desk.time);
    (0..300).for_each(|_| desk.see(dark()));
    assert!(desk.started.is_empty(), "they are left alone");
    assert_eq!(desk.view().health.colder_wait_min, Some(5.0), "after five of twelve minutes");
    // The twin's eyes say themselves for how long they have been on.
    desk.around.twin_on_s = Some(1200.0);
    assert_eq!(desk.view().health.colder_wait_min, None);
    desk.around.twin_on_s = None;
    // Whoever asks is answered, with the time to wait; the calibration is not said to be bad.
    desk.ask(EyesCommand::JudgeHealth);
    desk.until_judging();
    desk.looks_bad();
    assert_eq!(desk.said(), Vec::<String>::new());
    // Warm, it is judged as ever, and what looks bad twice is told.
    (0..3000).for_each(|_| {
        if desk.started.is_empty() {
            desk.see(dark());
        }
    });
    assert_eq!(desk.view().health.colder_wait_min, None);
    desk.looks_bad();
    assert_eq!(desk.said().len(), 0, "a hand before an eye is no turned eye");
    desk.until_judging();
    desk.looks_bad();
    assert_eq!(desk.said().len(), 1);
}
