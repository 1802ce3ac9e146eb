//! A way that ended merely because this computer was too busy to hear a joint in time: the arm holds until all of its
//! joints have been heard for a while, and goes on from where it stands.
//!
//! Only where nothing else has happened: what does not answer, has lost its torque, is hot or blocked ends it, and so
//! does a window that does not answer.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{
    Chains, HoldReason, JointReading, JointState, MoveOutcome, Refusal, Unheard,
};
use plumbline_model::robot::{JointIndex, Rig};

use super::GivenUp;

/// They have to be heard for so long before it goes on.
const HEARD_FOR: Duration = Duration::from_secs(1);
/// For so long they are waited for.
const WAITS_FOR: Duration = Duration::from_secs(20);
/// A servo that does not answer at all is waited for no longer than this: it may only seem so for a moment.
const SILENT_FOR: Duration = Duration::from_secs(1);
/// An angle that was read longer ago was not heard.
const FRESH: Duration = Duration::from_millis(250);
/// So often an order goes on after it has waited.
pub(super) const MOST: usize = 3;

/// Whether a way waits for joints that were late.
#[derive(Default)]
pub(super) struct Late {
    times: usize,
    waits: Option<Waits>,
    /// Who watches has not been told yet that it waits.
    news: Option<String>,
}

struct Waits {
    /// What ends it when they are not heard again.
    why: GivenUp,
    since: Instant,
    heard_since: Option<Instant>,
    silent_since: Option<Instant>,
}

/// What is looked at while it waits.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    pub rig: &'a Rig,
    /// Which joints move together.
    pub together: &'a Chains,
    pub state: &'a JointState,
    /// Joints that have somewhere to go.
    pub joints: &'a [JointIndex],
    /// The window gives no sign of life.
    pub is_alone: bool,
}

impl Late {
    /// What ended a move is waited out where that may be done; else it ends the order.
    pub fn begin(&mut self, why: GivenUp, is_late: bool, now: Instant) -> Result<(), GivenUp> {
        if !is_late || self.times >= MOST {
            return Err(why);
        }
        self.times += 1;
        self.news = Some(format!("The arm waits and goes on by itself: {why}."));
        self.waits = Some(Waits { why, since: now, heard_since: None, silent_since: None });
        Ok(())
    }

    /// Whether it still waits for these joints. What happened to them meanwhile ends it, and why: the arm must not
    /// go to its old goal by itself once somebody has made it hold anew.
    pub fn waits(&mut self, way: Way<'_>, now: Instant) -> Result<bool, GivenUp> {
        let Some(waits) = &mut self.waits else { return Ok(false) };
        way.may_go_on()?;
        let lasts = |since: Instant, long: Duration| now.saturating_duration_since(since) >= long;
        if let Err(silent) = way.check_silent() {
            let is_silent = lasts(*waits.silent_since.get_or_insert(now), SILENT_FOR);
            waits.heard_since = None;
            return if is_silent { Err(silent.into()) } else { Ok(true) };
        }
        waits.silent_since = None;
        if now.saturating_duration_since(waits.since) > WAITS_FOR {
            return Err(waits.why.clone());
        }
        if !way.is_heard(now) {
            waits.heard_since = None;
            return Ok(true);
        }
        let goes_on = lasts(*waits.heard_since.get_or_insert(now), HEARD_FOR);
        if goes_on {
            self.waits = None;
        }
        Ok(!goes_on)
    }

    /// Whether it waits just now.
    pub fn is_waiting(&self) -> bool {
        self.waits.is_some()
    }

    /// The operator holds it: the time in which they are to be heard does not run.
    pub fn paused(&mut self, now: Instant) {
        if let Some(waits) = &mut self.waits {
            (waits.since, waits.heard_since, waits.silent_since) = (now, None, None);
        }
    }

    /// What is to be said of it, once.
    pub fn take_news(&mut self) -> Option<String> {
        self.news.take()
    }
}

impl Way<'_> {
    /// Whether nothing has happened but that joints are late.
    fn may_go_on(&self) -> Result<(), GivenUp> {
        if self.is_alone {
            return Err(Refusal::NoHeartbeat.into());
        }
        let mut readings = self.joints.iter().filter_map(|joint| self.state.of(*joint));
        readings.try_for_each(|reading| self.holds(reading))
    }

    /// Whether a joint is still in hand. One that is silent is told of as such.
    fn holds(&self, reading: &JointReading) -> Result<(), GivenUp> {
        let joint = reading.joint;
        let name = || self.rig.servo_of(joint).map_or_else(String::new, |servo| servo.title.clone());
        if reading.torque_on == Some(false) {
            return Err(HoldReason::TorqueLost { joint, name: name(), servo: reading.servo }.into());
        }
        if reading.let_go && !is_silent(self.state, joint) {
            return Err(GivenUp::Lost(Refusal::LetGo { joint, name: name() }.to_string()));
        }
        Ok(())
    }

    /// Whether a servo that would keep the way from going on does not answer at all; which.
    fn check_silent(&self) -> Result<(), Refusal> {
        let unknown = self.state.unknown.iter().copied();
        let silent: Vec<_> = unknown.filter(|joint| is_silent(self.state, *joint)).collect();
        self.together.check(self.rig, self.joints, &silent, &[])
    }

    /// Whether it is known where all joints are that count for the way, and those that move were read just now and hold.
    /// A state that is not published anew gets old: it is looked at when they were read.
    fn is_heard(&self, now: Instant) -> bool {
        let is_fresh = |at: Instant| now.saturating_duration_since(at) < FRESH;
        let is_heard = |joint: &JointIndex| {
            self.state.of(*joint).is_some_and(|reading| {
                reading.torque_on == Some(true) && reading.read_at.is_some_and(is_fresh)
            })
        };
        let JointState { unknown, late, .. } = self.state;
        self.together.check(self.rig, self.joints, unknown, late).is_ok() && self.joints.iter().all(is_heard)
    }
}

/// Whether it is not known where a joint is, and this computer is not to blame.
fn is_silent(state: &JointState, joint: JointIndex) -> bool {
    state.unknown.contains(&joint) && !state.late.contains(&joint)
}

/// Whether a move was ended by nothing but a computer that was too busy.
pub(super) fn ended_late(outcome: &MoveOutcome, state: &JointState) -> bool {
    match outcome {
        MoveOutcome::Refused(refusal) | MoveOutcome::Held(HoldReason::Refused(refusal)) => {
            refused_late(refusal)
        }
        // Whether a slow adapter or a busy computer is to blame is not known of a servo that is read, though too seldom.
        // Waiting does no harm: where it goes on being slow, that is what ends the order.
        MoveOutcome::Held(HoldReason::Slow { joint, .. }) => !is_silent(state, *joint),
        MoveOutcome::Held(_) | MoveOutcome::Arrived { .. } | MoveOutcome::Replaced => false,
    }
}

/// The same of a move that did not begin.
pub(super) fn refused_late(refusal: &Refusal) -> bool {
    matches!(
        refusal,
        Refusal::Unknown { why: Unheard::TooBusy, .. }
            | Refusal::UnknownInChain { why: Unheard::TooBusy, .. }
    )
}
