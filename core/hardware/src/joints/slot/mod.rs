//! What is known of one servo, and whether anything may be written to it.
//!
//! A servo is *in hand* from the moment the operator takes hold of it (or the program finds it
//! holding when it connects) until it is relaxed, loses its torque, or falls silent. Only a servo in
//! hand is ever sent a goal: in protocol 1.0 a goal switches torque on, and a servo whose power was
//! cut may have sunk far from where it was.

#[cfg(test)]
mod tests;

use std::time::{Duration, Instant};

use super::reading::JointReading;
use super::refusal::Unheard;
use super::servo_unit::{ServoUnit, unwrapped};
use crate::dynamixel::{FoundServo, Status, Ticks};

/// Where a joint was this long ago tells which side of the seam it is on: the fastest servo needs
/// more than 0.4 s for half a turn.
const NEAR: Duration = Duration::from_millis(300);
/// An angle read longer ago than this says no more where the joint is.
const KNOWN_FOR: Duration = Duration::from_secs(1);
/// An answer that came too late is a sign of life for this long: without it the servo is silent.
const LATE_COUNTS_FOR: Duration = Duration::from_millis(500);
/// One that was left out is asked twice a second where the machine gets around to it: an answer of it that came too late
/// tells for this long that its power and cable are there …
const LOAD_COUNTS_FOR: Duration = Duration::from_secs(2);
/// … and, where cycles are long, until it was asked in vain so often: time alone says nothing of who was hardly asked.
const LOAD_COUNTS_TIMES: u32 = 4;
/// The same of one that is in use, before it is left out.
const LATE_COUNTS_TIMES: u32 = 3;
/// Less force than this share of the stall torque is none.
const NO_FORCE: f64 = 0.02;

/// Who a servo is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Identity {
    /// Not asked since it was silent.
    Unknown,
    /// Who the rig says.
    Right,
    /// Somebody else: nothing is ever written to it.
    Barred(Bar),
}

/// Why a servo is never used.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Bar {
    /// Another model than the rig says.
    WrongModel(FoundServo),
    /// Two servos have its id.
    Doubled,
}

/// What a servo's limit of torque is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Force {
    /// This share of its stall torque.
    Limited(f64),
    /// What its own memory says.
    Own,
}

/// So far a servo gives below a usual load. One that stands further from its goal pushes against something, which taking
/// hold of it anew ends, rad.
const GIVES_RAD: f64 = 0.035;

/// A servo, what is known of it, and how it answers.
#[derive(Clone, Debug)]
pub(super) struct Slot {
    pub unit: ServoUnit,
    pub reading: JointReading,
    pub identity: Identity,
    /// Taken hold of by the operator, and not silent or limp since.
    pub in_hand: bool,
    /// When first read it is in hand if it holds: so it was found when the bus was opened, and has not fallen silent since.
    pub found_at_start: bool,
    /// Cycles in a row in which it was asked for itself and did not answer rightly.
    pub missed: u32,
    /// When an answer of it came that was not waited for any more: it has power and a cable.
    pub late_at: Option<Instant>,
    /// Such answers so far.
    pub late_answers: u64,
    /// Questions to it alone since the last answer, in time or not, that it has not answered.
    pub in_vain: u32,
    /// Left out for its silence; asked again now and then.
    pub silent: bool,
    /// It was in hand when it fell silent.
    pub let_go: bool,
    /// The goal that its register held then.
    pub held_goal: Option<Ticks>,
    /// It missed a question: who it is is asked before anything is written.
    pub verify: bool,
    /// What it complained about last.
    pub complaint: Option<String>,
    /// Whether it raises an alarm (overload, overheating).
    pub alarm: bool,
    /// Whether its torque was on and is off without our doing.
    pub torque_lost: bool,
    /// Count of the position, over the seam of the turn where it was pushed there.
    pub ticks: Option<i32>,
    /// The goal that its register holds.
    pub goal: Option<Ticks>,
    /// It is to be held where it is read next.
    pub hold_pending: bool,
    /// Its goal is written though its register holds it already.
    pub insist: bool,
    /// What its limit of torque is to be; `None`: as it is.
    pub force: Option<Force>,
    /// Of a limit, this share is left since the servos of its hand got warm; 1: all of it.
    pub eased: f64,
    /// How often it was told its limit.
    pub force_tries: u32,
    /// Wait before its answers, s, when it is longer than it needs to be.
    pub slow_answers_s: Option<f64>,
    pub reads_singly: bool,
    pub no_bulk: u32,
    /// Cycle of the last reading.
    pub read_in: u64,
    /// Cycle in which it was asked for itself last.
    pub asked_in: u64,
}

impl Slot {
    pub fn new(unit: ServoUnit) -> Self {
        let reading = JointReading::new(unit.servo.joint, unit.id());
        let reads_singly = !unit.table.bulk_read;
        Self {
            unit,
            reading,
            identity: Identity::Unknown,
            in_hand: false,
            found_at_start: false,
            missed: 0,
            late_at: None,
            late_answers: 0,
            in_vain: 0,
            silent: true,
            let_go: false,
            held_goal: None,
            verify: false,
            complaint: None,
            alarm: false,
            torque_lost: false,
            ticks: None,
            goal: None,
            hold_pending: false,
            insist: false,
            force: None,
            eased: 1.0,
            force_tries: 0,
            slow_answers_s: None,
            reads_singly,
            no_bulk: 0,
            read_in: 0,
            asked_in: 0,
        }
    }

    /// Whether it takes part in every cycle.
    pub fn in_use(&self) -> bool {
        !self.silent && !self.is_barred()
    }

    pub fn is_barred(&self) -> bool {
        matches!(self.identity, Identity::Barred(_))
    }

    /// Whether its angle is known: read a moment ago, and not silent since.
    pub fn is_known(&self) -> bool {
        self.in_use() && self.reading.angle_rad.is_some() && !self.is_overdue()
    }

    /// Whether it was not read for so long that nothing rests on its angle, though it is not known to
    /// be silent: the line, or this machine, does not get around to it.
    pub fn is_overdue(&self) -> bool {
        self.silence() >= KNOWN_FOR
    }

    /// Time since the last answer; long before the first.
    pub fn silence(&self) -> Duration {
        self.reading.read_at.map_or(Duration::MAX, |at| at.elapsed())
    }

    /// Takes how many of its answers came too late so far.
    pub fn note_late(&mut self, late_answers: u64) {
        if late_answers > self.late_answers {
            self.late_at = Some(Instant::now());
            self.in_vain = 0;
        }
        self.late_answers = late_answers;
    }

    /// Whether it answers, but later than this machine or the line can wait.
    pub fn answers_late(&self) -> bool {
        self.was_late(LATE_COUNTS_FOR, LATE_COUNTS_TIMES)
    }

    /// Whether an answer came too late, and no longer ago, or not asked in vain more often since.
    fn was_late(&self, at_most: Duration, times: u32) -> bool {
        self.late_at.is_some_and(|at| at.elapsed() < at_most || self.in_vain < times)
    }

    /// Why it is not heard: one that was heard lately, and was asked too seldom since to be left out for its silence, is
    /// no more to blame than one that answers late. A program that runs would have left it out by now.
    pub fn unheard(&self) -> Unheard {
        // Nobody asks one that is barred: what came of it once says nothing of now.
        if !self.is_barred() && (self.in_use() || self.was_late(LOAD_COUNTS_FOR, LOAD_COUNTS_TIMES)) {
            Unheard::TooBusy
        } else {
            Unheard::Silent
        }
    }

    /// Whether its torque is on and it is ours to command.
    pub fn holds_torque(&self) -> bool {
        self.in_hand && self.reading.torque_on == Some(true)
    }

    /// Whether it holds and nobody has taken hold of it here.
    pub fn holds_unasked(&self) -> bool {
        !self.in_hand && self.reading.torque_on == Some(true)
    }

    /// Whether it holds where it was sent, was heard in the last cycle and has nothing to say: there is nothing to take
    /// hold of.
    pub fn holds_well(&self) -> bool {
        let off_rad = self.reading.angle_rad.zip(self.reading.goal_rad).map(|(at, goal)| (at - goal).abs());
        let is_there = off_rad.is_some_and(|off_rad| off_rad < GIVES_RAD);
        let is_heard = self.identity == Identity::Right && self.missed == 0 && !self.verify && !self.silent;
        is_there
            && is_heard
            && self.holds_torque()
            && !self.alarm
            && !self.hold_pending
            && self.force.is_none()
    }

    /// Whether it has torque on and no force: it shut down after an overload.
    pub fn has_no_force(&self) -> bool {
        self.reading.force.is_some_and(|share| share < NO_FORCE)
    }

    /// Whether a goal may be written: who it is, where it is and that it holds were read no longer
    /// than `window` ago.
    pub fn may_be_written(&self, window: Duration) -> bool {
        self.identity == Identity::Right
            && self.in_use()
            && self.holds_torque()
            && !self.verify
            && !self.has_no_force()
            && self.silence() <= window
    }

    /// Takes what a cycle read.
    pub fn take(&mut self, status: &Status, cycle: u64) {
        let measured = self.unit.measured(&status.data);
        self.complaint = (!status.error.is_none()).then(|| status.error.to_string());
        self.alarm = status.error.is_alarm();
        let Some(ticks) = measured.ticks else {
            self.missed = self.missed.saturating_add(1);
            self.in_vain = self.in_vain.saturating_add(1);
            self.complaint = Some("its position is out of range: take it out of multi-turn mode".to_owned());
            return;
        };
        let holds = measured.torque_on == Some(true);
        let goal = measured.goal.map(|goal| i32::from(goal.0));
        let near = self.ticks.filter(|_| self.silence() < NEAR).or(goal.filter(|_| holds));
        let ticks = unwrapped(ticks, near);
        self.ticks = Some(ticks);
        self.goal = measured.goal;
        let reading = &mut self.reading;
        reading.angle_rad = self.unit.joint_rad(ticks);
        reading.speed_rad_s = measured.speed_rad_s;
        reading.load = measured.load;
        reading.voltage_v = measured.voltage_v;
        reading.temperature_c = measured.temperature_c;
        reading.force = measured.torque_limit;
        reading.read_at = Some(Instant::now());
        self.keep_hold(holds);
        (self.missed, self.in_vain, self.silent, self.read_in) = (0, 0, false, cycle);
        self.take_torque(holds);
    }

    /// One that was in hand, fell silent, and is heard again: where it answered too late meanwhile and nothing of it has
    /// changed, this machine did not get around to listening. A servo that lost its power comes back without torque.
    fn keep_hold(&mut self, holds: bool) {
        let by_load = self.was_late(LOAD_COUNTS_FOR, LOAD_COUNTS_TIMES);
        if self.let_go && holds && by_load && self.goal.is_some() && self.goal == self.held_goal {
            (self.in_hand, self.let_go) = (true, false);
            self.reading.goal_rad = self.goal_rad();
        }
    }

    fn take_torque(&mut self, holds: bool) {
        if self.in_hand && !holds {
            self.torque_lost = true;
        }
        self.in_hand &= holds;
        if !holds {
            self.force = None;
        }
        if std::mem::take(&mut self.found_at_start) && holds {
            self.in_hand = true;
            self.reading.goal_rad = self.goal_rad();
        }
        if !holds {
            self.reading.goal_rad = None;
        }
        self.reading.torque_on = Some(holds);
    }

    /// Angle of the goal in its register, rad.
    pub fn goal_rad(&self) -> Option<f64> {
        self.unit.joint_rad(i32::from(self.goal?.0))
    }

    /// It was asked for itself and did not answer.
    pub fn miss(&mut self) {
        self.missed = self.missed.saturating_add(1);
        self.in_vain = self.in_vain.saturating_add(1);
        self.verify = true;
        self.complaint = None;
    }

    /// It has not answered for too long: whatever was known of it is not any more.
    pub fn fall_silent(&mut self) {
        if self.silent {
            return;
        }
        if self.in_hand {
            (self.let_go, self.held_goal) = (true, self.goal);
        }
        (self.silent, self.in_hand, self.verify) = (true, false, true);
        self.found_at_start = false;
        (self.torque_lost, self.alarm, self.hold_pending, self.insist) = (false, false, false, false);
        (self.goal, self.ticks, self.force) = (None, None, None);
        if self.identity == Identity::Right {
            self.identity = Identity::Unknown;
        }
        let reading = &mut self.reading;
        (reading.torque_on, reading.goal_rad, reading.force) = (None, None, None);
        (reading.speed_rad_s, reading.load, reading.current_a) = (None, None, None);
    }

    /// Who answered to its id.
    pub fn identified(&mut self, found: FoundServo) {
        if found.is_model(&self.unit.servo.model) {
            self.identity = Identity::Right;
            self.verify = false;
        } else {
            self.bar(Bar::WrongModel(found));
        }
    }

    /// It is never written to again, until a scan finds who should be there.
    pub fn bar(&mut self, bar: Bar) {
        self.fall_silent();
        (self.silent, self.late_at, self.held_goal) = (true, None, None);
        self.identity = Identity::Barred(bar);
    }
}
