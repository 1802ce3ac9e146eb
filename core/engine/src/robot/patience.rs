//! What holds because joints were not heard for a moment goes on by itself once they are.
//!
//! Only where what moves holds with torque and nothing was refused; a few times in a row at most, and not
//! when the operator, STOP or anything else speaks in between.

use std::time::{Duration, Instant};

use super::view::{JointView, MotionState, RobotView};

/// All joints have to be heard for so long before the run goes on.
const HEARD_FOR: Duration = Duration::from_secs(1);
/// For so long they are waited for.
const WAITS_FOR: Duration = Duration::from_secs(20);
/// An angle older than this was not heard.
const FRESH: Duration = Duration::from_millis(250);
/// So often in a row it goes on by itself; a touch that is made, or a pose that is seen, begins the row anew.
pub const MOST: usize = 3;

/// Whether a run of touches, or a tour of the head, that holds goes on.
#[derive(Clone, Debug, Default)]
pub struct Patience {
    in_a_row: usize,
    waits: Option<Waits>,
}

#[derive(Clone, Copy, Debug)]
struct Waits {
    since: Instant,
    heard_since: Option<Instant>,
}

/// What a look at the joints says.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// Nothing new, or nothing is waited for.
    Same,
    /// They are heard again: the run may go on.
    GoesOn,
    /// It is the operator's again; why, a sentence.
    GivesUp(String),
}

impl Patience {
    /// The joints were not heard. Returns whether it waits for them.
    pub fn begin(&mut self, now: Instant) -> bool {
        if self.in_a_row >= MOST {
            return false;
        }
        self.in_a_row += 1;
        self.waits = Some(Waits { since: now, heard_since: None });
        true
    }

    /// It is the operator who decides now. Returns whether it waited.
    pub fn end(&mut self) -> bool {
        self.waits.take().is_some()
    }

    /// What it waited with was done: whatever was, is over.
    pub fn done(&mut self) {
        *self = Self::default();
    }

    /// Looks whether the joints of these names are heard again.
    pub fn look(
        &mut self,
        robot: &RobotView,
        trouble: Option<String>,
        joints: &[String],
        now: Instant,
    ) -> Look {
        let Some(waits) = &mut self.waits else { return Look::Same };
        let (since, heard_since) = (waits.since, waits.heard_since);
        if let Some(why) = trouble.or_else(|| in_the_way(robot, joints)) {
            self.waits = None;
            return Look::GivesUp(why);
        }
        if !is_heard(robot, joints) {
            waits.heard_since = None;
            if now.saturating_duration_since(since) < WAITS_FOR {
                return Look::Same;
            }
            self.waits = None;
            return Look::GivesUp(format!("For {} s not all joints were heard.", WAITS_FOR.as_secs()));
        }
        waits.heard_since = heard_since.or(Some(now));
        if heard_since.is_none_or(|heard| now.saturating_duration_since(heard) < HEARD_FOR) {
            return Look::Same;
        }
        self.waits = None;
        Look::GoesOn
    }
}

/// What only a person can judge.
fn in_the_way(robot: &RobotView, joints: &[String]) -> Option<String> {
    if let MotionState::Moving { what, .. } = &robot.motion {
        return Some(format!("Something else is being moved ({what})."));
    }
    let needs_hold = |joint: &&JointView| {
        joints.contains(&joint.name) && (joint.let_go || joint.no_force || joint.torque_on == Some(false))
    };
    let joint = robot.joints.iter().find(needs_hold)?;
    Some(format!("{} does not hold: support what it carries, then switch its torque on.", joint.title))
}

/// Whether all holds, and every one of these joints was read just now and is well.
fn is_heard(robot: &RobotView, joints: &[String]) -> bool {
    let is_well = |name: &String| {
        robot.joints.iter().find(|joint| joint.name == *name).is_some_and(|joint| {
            joint.torque_on == Some(true)
                && joint.problem.is_none()
                && joint.age.is_some_and(|age| age < FRESH)
                && !robot.unknown.contains(&joint.joint)
        })
    };
    matches!(robot.motion, MotionState::Holding { .. }) && !joints.is_empty() && joints.iter().all(is_well)
}
