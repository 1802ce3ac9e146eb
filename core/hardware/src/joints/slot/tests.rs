//! When a servo counts as silent, and when this computer is to blame.

use plumbline_model::robot::Rig;

use super::*;

/// The servo that turns the head, not read for so long and asked in vain so often since.
fn neck(not_read_for: Duration, missed: u32) -> Slot {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let servo = rig.servo_of(rig.eyes.pan).expect("the head has a servo");
    let mut slot = Slot::new(ServoUnit::new(servo).expect("a model that is known"));
    slot.reading.angle_rad = Some(0.1);
    slot.reading.read_at = Instant::now().checked_sub(not_read_for);
    (slot.silent, slot.missed) = (false, missed);
    slot
}

#[test]
fn a_servo_is_not_blamed_for_a_program_that_stood_still() {
    let stalled = KNOWN_FOR + Duration::from_millis(200);
    for missed in [0, 1, 12] {
        let slot = neck(stalled, missed);
        assert!(!slot.is_known());
        assert_eq!(slot.unheard(), Unheard::TooBusy, "missed {missed} times");
    }
    let mut silent = neck(stalled, 25);
    silent.fall_silent();
    assert_eq!(silent.unheard(), Unheard::Silent, "it was left out for its silence");
    silent.note_late(1);
    assert_eq!(silent.unheard(), Unheard::TooBusy, "an answer came that nobody waited for any more");
    silent.late_at = Instant::now().checked_sub(Duration::from_millis(900));
    assert_eq!(silent.unheard(), Unheard::TooBusy, "it is asked but twice a second");
    silent.late_at = Instant::now().checked_sub(LOAD_COUNTS_FOR);
    silent.in_vain = LOAD_COUNTS_TIMES;
    assert_eq!(silent.unheard(), Unheard::Silent, "nothing has come since");
}

/// Cycles of a tenth of a second: whoever was left out has its turn every three seconds.
#[test]
fn where_cycles_are_long_it_counts_how_often_it_was_asked_in_vain() {
    let mut slot = neck(Duration::from_secs(20), 25);
    slot.fall_silent();
    slot.note_late(1);
    for asked in 0..LOAD_COUNTS_TIMES {
        slot.late_at = Instant::now().checked_sub(Duration::from_secs(3 * u64::from(asked)));
        assert_eq!(slot.unheard(), Unheard::TooBusy, "asked {asked} times since");
        slot.in_vain += 1;
    }
    slot.late_at = Instant::now().checked_sub(Duration::from_secs(12));
    assert_eq!(slot.unheard(), Unheard::Silent);
    // Another answer that is late, and all is as it was.
    slot.note_late(2);
    assert_eq!((slot.unheard(), slot.in_vain), (Unheard::TooBusy, 0));
}

/// One that is asked once a second is not left out between two of its late answers, but is after three questions in vain.
#[test]
fn one_that_is_asked_seldom_and_answers_late_is_not_left_out() {
    let mut slot = neck(Duration::from_millis(800), 10);
    slot.note_late(1);
    slot.late_at = Instant::now().checked_sub(Duration::from_millis(900));
    for _ in 0..LATE_COUNTS_TIMES {
        assert!(slot.answers_late());
        slot.miss();
    }
    assert!(!slot.answers_late());
    let never = neck(Duration::from_millis(800), 10);
    assert!(!never.answers_late(), "a silent one is not spared");
}

#[test]
fn a_question_that_was_missed_a_moment_ago_leaves_the_angle_known() {
    assert!(neck(Duration::from_millis(300), 4).is_known());
}

/// A busy machine misses the first answer after the bus was looked through: what holds then was found so.
#[test]
fn a_servo_that_was_found_holding_is_in_hand_when_it_is_first_read() {
    let first_read = |silent: bool, holds: bool| {
        let mut slot = neck(Duration::from_millis(10), 0);
        (slot.in_hand, slot.found_at_start, slot.silent) = (false, true, false);
        slot.miss();
        if silent {
            slot.fall_silent();
        }
        slot.take_torque(holds);
        (slot.in_hand, slot.holds_unasked())
    };
    assert_eq!(first_read(false, true), (true, false));
    assert_eq!(first_read(false, false), (false, false), "limp is limp");
    assert_eq!(first_read(true, true), (false, true), "and that nobody has taken hold of it is said");
}

/// What was in hand and is heard again is still in hand where this machine alone was late; else it is taken hold of anew.
#[test]
fn a_servo_that_only_this_machine_missed_is_still_in_hand() {
    let heard_again = |late_answers: u64, holds: bool, goal: u16| {
        let mut slot = neck(Duration::from_millis(800), 25);
        (slot.in_hand, slot.goal, slot.in_vain) = (true, Some(Ticks(2048)), 25);
        slot.fall_silent();
        assert!(slot.let_go && !slot.in_hand);
        slot.note_late(late_answers);
        slot.goal = Some(Ticks(goal));
        slot.keep_hold(holds);
        (slot.in_hand, slot.let_go)
    };
    assert_eq!(heard_again(1, true, 2048), (true, false));
    assert_eq!(heard_again(0, true, 2048), (false, true), "no answer came late: its cable may have been out");
    assert_eq!(heard_again(1, false, 2048), (false, true), "it has lost its torque");
    assert_eq!(heard_again(1, true, 2100), (false, true), "somebody else has sent it elsewhere");
    // Long ago, and asked in vain since: that says nothing of now.
    let mut slot = neck(Duration::from_millis(800), 25);
    (slot.in_hand, slot.goal) = (true, Some(Ticks(2048)));
    slot.fall_silent();
    slot.note_late(1);
    (slot.late_at, slot.in_vain) = (Instant::now().checked_sub(LOAD_COUNTS_FOR), LOAD_COUNTS_TIMES);
    slot.goal = Some(Ticks(2048));
    slot.keep_hold(true);
    assert!(slot.let_go && !slot.in_hand);
    // Never taken hold of: it is not in hand for having been heard late.
    let mut slot = neck(Duration::from_millis(800), 25);
    slot.goal = Some(Ticks(2048));
    slot.fall_silent();
    slot.note_late(1);
    slot.goal = Some(Ticks(2048));
    slot.keep_hold(true);
    assert!(!slot.in_hand);
}
