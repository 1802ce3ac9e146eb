//! Fingers that hold: each is sent a little farther toward the closed hand than it is, again and again,
//! with a force that is limited first.
//!
//! A goal that stands still presses only as long as what is held keeps its shape and its place. So the
//! goals of a grip go on with the fingers, while the arm moves and while it stands, and no goal ever
//! lies farther than the rig's step from an angle just read: whatever becomes of the program, a finger
//! presses as it did and bends no farther than one step.

use std::time::Duration;

use plumbline_model::robot::{JointIndex, Posture};

use super::command::MoveOutcome;
use super::controller::Controller;
use super::exchange::Exchange;
use super::refusal::{HoldReason, Refusal};
use super::slot::{Force, Slot};
use crate::dynamixel::{BusError, Item};

/// More than this share of its torque shuts a servo down after seconds (MX-64 manual, "Shutdown";
/// overload): no grip may ask for it.
pub(super) const MOST_FORCE: f64 = 0.9;
/// A limit is taken when the servo says so, to this share of its torque.
const TAKEN: f64 = 0.01;
/// A servo is told its limit so often, and then it is given up.
const TRIES: u32 = 25;
/// A small share of the step is left for rounding to ticks.
const LEAD: f64 = 0.95;
/// Fingers whose goals stay nearer than this together are looked at by no guard anew, rad.
const SAME_RAD: f64 = 1e-4;
/// A finger that is slower than this has met something, or is there, rad/s.
const STANDS_RAD_S: f64 = 0.1;

/// Fingers that close and go on pressing, until they are moved otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Which.
    pub fingers: Vec<GripFinger>,
    /// Speed at which they close, rad/s: above 0, up to the rig's limit.
    pub speed_rad_s: f64,
}

/// A finger that closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripFinger {
    /// Its joint.
    pub joint: JointIndex,
    /// How far it bends where nothing is in its way, rad.
    pub goal_rad: f64,
    /// Largest share of its stall torque that it may use: above 0, up to 0.9.
    pub force: f64,
}

/// A finger of a grip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gripping {
    pub joint: JointIndex,
    goal_rad: f64,
    force: f64,
    speed_rad_s: f64,
    /// What it is commanded to.
    sent_rad: f64,
}

impl Controller {
    /// Begins to grip; fingers that grip already go on with what is new.
    pub(super) fn begin_grip(&mut self, grip: &Grip) -> Result<(), Refusal> {
        let bad = |what: String| Refusal::NotAMove { what };
        // NaN fails the comparisons.
        let is_too_much = |finger: &&GripFinger| !(finger.force > 0.0 && finger.force <= MOST_FORCE);
        if let Some(GripFinger { force, .. }) = grip.fingers.iter().find(is_too_much) {
            return Err(bad(format!(
                "a grip with {force} of the torque; give more than 0, up to {MOST_FORCE}"
            )));
        }
        if !(grip.speed_rad_s > 0.0 && grip.speed_rad_s <= self.limiter.rig.gate.speed_rad_s) {
            return Err(bad(format!("fingers that close at {} rad/s; give less", grip.speed_rad_s)));
        }
        let joints: Vec<JointIndex> = grip.fingers.iter().map(|finger| finger.joint).collect();
        // Fingers that press already go on from there.
        let (commanded, _) = self.may_move(&joints, &[])?;
        for finger in &grip.fingers {
            self.limiter.goal(finger.joint, finger.goal_rad, &commanded)?;
        }
        self.commanded = Some(commanded.clone());
        let moving = self.moving();
        // What made the arm hold before is over; what moves without these fingers goes on.
        if moving.is_empty() || moving.iter().any(|joint| joints.contains(joint)) {
            self.stay(MoveOutcome::Replaced, HoldReason::Asked);
        }
        self.grips.retain(|known| !joints.contains(&known.joint));
        let speed_rad_s = grip.speed_rad_s;
        for GripFinger { joint, goal_rad, force } in grip.fingers.iter().copied() {
            let sent_rad = commanded[joint];
            self.grips.push(Gripping { joint, goal_rad, force, speed_rad_s, sent_rad });
            if let Some(slot) = self.exchange.slots.iter_mut().find(|slot| slot.reading.joint == joint) {
                (slot.force, slot.eased, slot.force_tries) = (Some(Force::Limited(force)), 1.0, 0);
            }
        }
        Ok(())
    }

    /// These are moved otherwise: they do not grip any more, and get their force back.
    pub(super) fn end_grip(&mut self, joints: &[JointIndex]) {
        self.grips.retain(|grip| !joints.contains(&grip.joint));
        for slot in &mut self.exchange.slots {
            if joints.contains(&slot.reading.joint) && slot.is_limited() {
                (slot.force, slot.force_tries) = (Some(Force::Own), 0);
            }
        }
    }

    /// Whether a finger closes just now.
    pub(super) fn is_closing(&self) -> bool {
        self.grips.iter().any(|grip| {
            let slot = self.exchange.slots.iter().find(|slot| slot.reading.joint == grip.joint);
            slot.and_then(|slot| slot.reading.speed_rad_s).is_some_and(|speed| speed.abs() > STANDS_RAD_S)
        })
    }

    /// The goals of fingers that grip go on.
    pub(super) fn advance_grips(&mut self, dt_s: f64) {
        self.ease_warm_hands();
        if self.grips.is_empty() {
            return;
        }
        let alone = self.heartbeat_age().is_some_and(|age| age > self.options.heartbeat_timeout);
        if self.options.stop.is_pressed() || alone {
            // They press as they do, and no farther.
            self.grips.clear();
            return;
        }
        let (Some(commanded), Some(measured)) = (self.commanded.clone(), self.measured()) else { return };
        self.drop_unfit_grips();
        let nexts: Vec<f64> = self.grips.iter().map(|grip| self.next_rad(grip, &measured, dt_s)).collect();
        let joints: Vec<JointIndex> = self.grips.iter().map(|grip| grip.joint).collect();
        let sent: Vec<f64> = self.grips.iter().map(|grip| grip.sent_rad).collect();
        let from = commanded.with(&joints, &sent);
        let mut to = from.with(&joints, &nexts);
        if from.distance_rad(&to) > SAME_RAD && self.limiter.step(&from, &measured, &to, &joints).is_err() {
            // Who is in the way stays; the others go on.
            to = from.clone();
            for (joint, next_rad) in joints.iter().zip(&nexts) {
                let one = to.with(&[*joint], &[*next_rad]);
                if self.limiter.step(&from, &measured, &one, &[*joint]).is_ok() {
                    to = one;
                }
            }
        }
        for grip in &mut self.grips {
            grip.sent_rad = to[grip.joint];
        }
        self.commanded = Some(to);
    }

    /// Where a finger is sent next: nearer to its goal, and no farther ahead of it than a step.
    fn next_rad(&self, grip: &Gripping, measured: &Posture, dt_s: f64) -> f64 {
        let slot = self.exchange.slots.iter().find(|slot| slot.reading.joint == grip.joint);
        let window = self.options.write_window;
        if !slot.is_some_and(|slot| slot.may_be_written(window) && slot.has_force(Force::Limited(grip.force)))
        {
            return grip.sent_rad;
        }
        let most_rad = grip.speed_rad_s * dt_s;
        let next_rad = grip.sent_rad + (grip.goal_rad - grip.sent_rad).clamp(-most_rad, most_rad);
        let lead_rad = LEAD * self.limiter.rig.gate.step_rad;
        next_rad.clamp(measured[grip.joint] - lead_rad, measured[grip.joint] + lead_rad)
    }

    /// Fingers that are limp, silent, too hot or do not take their limit grip no more.
    fn drop_unfit_grips(&mut self) {
        let hot_c = self.limiter.rig.gate.hot_c;
        let mut refusals = vec![];
        let slots = &mut self.exchange.slots;
        let commanded = &mut self.commanded;
        self.grips.retain(|grip| {
            let Some(slot) = slots.iter_mut().find(|slot| slot.reading.joint == grip.joint) else {
                return false;
            };
            let (joint, name) = (grip.joint, slot.unit.servo.title.clone());
            let hot_c = slot.reading.temperature_c.filter(|t| *t >= hot_c).map(|t| (t, hot_c));
            let refusal = if !slot.holds_torque() || slot.has_no_force() {
                // Told by what is shown of the joint.
                return false;
            } else if let Some((temperature_c, limit_c)) = hot_c {
                if let (Some(commanded), Some(angle_rad)) = (commanded.as_mut(), slot.reading.angle_rad) {
                    commanded[joint] = angle_rad;
                }
                Refusal::Hot { joint, name, temperature_c, limit_c }
            // One that took its limit and not the smaller one goes on as it is: with its own force it would press harder.
            } else if slot.force_tries > TRIES && slot.eased == 1.0 {
                Refusal::Force { joint, name, share: grip.force }
            } else {
                return true;
            };
            slot.force = Some(Force::Own);
            slot.force_tries = 0;
            refusals.push(refusal);
            false
        });
        refusals.into_iter().for_each(|refusal| self.refuse(refusal));
    }
}

impl Slot {
    /// Whether its limit is as it was told.
    pub(super) fn has_force(&self, force: Force) -> bool {
        match force {
            Force::Limited(share) => {
                self.reading.force.is_some_and(|now| (now - share * self.eased).abs() <= TAKEN)
            }
            Force::Own => false,
        }
    }
}

impl Exchange {
    /// Tells one servo whose limit of torque is to be another what it is; one in each cycle, so that
    /// nobody else waits.
    pub(super) fn set_forces(&mut self, window: Duration) -> Result<(), BusError> {
        let due = |slot: &Slot| {
            slot.may_be_written(window)
                && slot.force_tries <= TRIES
                && slot.force.is_some_and(|force| !slot.has_force(force))
        };
        let Some(i) = self.slots.iter().position(due) else { return Ok(()) };
        self.slots[i].force_tries += 1;
        match self.slots[i].force {
            Some(Force::Limited(share)) => {
                let slot = &self.slots[i];
                let register = slot.unit.table.register(Item::TorqueLimit).copied();
                let raw = register.and_then(|register| Some((register, register.raw(share * slot.eased)?)));
                if let Some((register, raw)) = raw {
                    let id = slot.unit.id();
                    self.bus.write_once(id, register.address, &register.bytes(raw))?;
                }
            }
            Some(Force::Own) => {
                let is_restored = self.restore_force(i)?;
                self.slots[i].force = (!is_restored).then_some(Force::Own);
            }
            None => {}
        }
        Ok(())
    }
}
