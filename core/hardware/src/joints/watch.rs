//! What ends a motion: nobody there, a servo that is hot, overloaded, silent or stuck.

use std::time::Instant;

use plumbline_model::robot::JointIndex;

use super::command::MoveOutcome;
use super::controller::{Controller, Mode};
use super::refusal::{HoldReason, Refusal};

impl Controller {
    /// Ends a motion that must not go on.
    pub(super) fn watch(&mut self, now: Instant) {
        let mut moving = self.moving();
        if moving.is_empty() {
            return;
        }
        // What is carried is as good as its fingers.
        moving.extend(self.grips.iter().map(|grip| grip.joint));
        if let Some(age) = self.heartbeat_age().filter(|age| *age > self.options.heartbeat_timeout) {
            let reason = HoldReason::NoHeartbeat(age);
            return self.stay(MoveOutcome::Held(reason.clone()), reason);
        }
        if let Mode::Follow { given_at, setpoint, .. } = &self.mode
            && given_at.elapsed() > setpoint.valid_for
        {
            return self.stay(MoveOutcome::Held(HoldReason::JogEnded), HoldReason::JogEnded);
        }
        let unknown = self.unknown();
        if let Err(refusal) = self.chains.check(&self.limiter.rig, &moving, &unknown, &self.late())
            && matches!(refusal, Refusal::UnknownInChain { .. })
        {
            self.refuse(refusal.clone());
            return self.hold(HoldReason::Refused(refusal));
        }
        if let Some(reason) = (0..self.exchange.slots.len()).find_map(|i| self.unfit(i, &moving, now)) {
            self.hold(reason);
        }
    }

    /// Why a servo makes the arm hold.
    fn unfit(&mut self, i: usize, moving: &[JointIndex], now: Instant) -> Option<HoldReason> {
        let gate = self.limiter.rig.gate;
        let slot = &self.exchange.slots[i];
        let reading = &slot.reading;
        let (joint, name, servo) = (reading.joint, slot.unit.servo.title.clone(), reading.servo);
        if !moving.contains(&joint) {
            return None;
        }
        if !slot.in_use() {
            return Some(HoldReason::NoAnswer { joint, name, servo, cycles: slot.missed });
        }
        if slot.torque_lost || reading.torque_on == Some(false) {
            return Some(HoldReason::TorqueLost { joint, name, servo });
        }
        if slot.has_no_force() {
            return Some(HoldReason::Refused(Refusal::NoForce { joint, name }));
        }
        if slot.alarm {
            let words = slot.complaint.clone().unwrap_or_default();
            return Some(HoldReason::Alarm { joint, name, servo, words });
        }
        if let Some(temperature_c) = reading.temperature_c.filter(|t| *t >= gate.hot_c) {
            let limit_c = gate.hot_c;
            return Some(HoldReason::Refused(Refusal::Hot { joint, name, temperature_c, limit_c }));
        }
        let load = reading.load.map(f64::abs).filter(|load| *load >= gate.load);
        let since = load.map(|_| self.heavy_since[i].unwrap_or(now));
        self.heavy_since[i] = since;
        if let (Some(load), Some(since)) = (load, since)
            && now.duration_since(since) >= self.options.load_timeout
        {
            return Some(HoldReason::Heavy { joint, name, load, limit: gate.load });
        }
        let behind_rad =
            self.commanded.as_ref().zip(reading.angle_rad).map(|(goals, angle_rad)| goals[joint] - angle_rad);
        if let (Some(since), Some(behind_rad)) = (self.behind_since[i], behind_rad)
            && now.duration_since(since) >= self.options.following_timeout
        {
            let since = now.duration_since(since);
            return Some(HoldReason::NotFollowing { joint, name, behind_rad, since });
        }
        None
    }
}
