//! How goals move: along a line, or after setpoints; never far ahead of the joints.

use std::time::{Duration, Instant};

use plumbline_model::robot::{JointIndex, Posture};

use super::command::{MoveOutcome, SetpointKind};
use super::controller::{Controller, Mode};
use super::refusal::HoldReason;
use super::slot::Slot;

/// After the last goal the joints get this long to come to rest.
const SETTLE: Duration = Duration::from_millis(500);
/// A joint slower than this is at rest, rad/s.
const AT_REST_RAD_S: f64 = 0.02;
/// Jogging reaches its speed within this time, s.
const JOG_RAMP_S: f64 = 0.15;
/// How fast a streamed goal is approached, 1/s.
const APPROACH_PER_S: f64 = 8.0;
/// Bits of an advance that are tried where a whole one would go too far ahead.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

impl Controller {
    /// Joints that move now.
    pub(super) fn moving(&self) -> Vec<JointIndex> {
        match &self.mode {
            Mode::Hold(_) => vec![],
            Mode::Move { line, .. } => line.joints.clone(),
            Mode::Follow { setpoint, .. } => setpoint.joints.iter().map(|(joint, _)| *joint).collect(),
        }
    }

    /// Moves the goals by one step.
    pub(super) fn advance(&mut self, now: Instant, dt_s: f64) {
        let (Some(commanded), Some(measured)) = (self.commanded.clone(), self.measured()) else { return };
        let joints = self.moving();
        if !self.is_fresh(&joints) {
            return self.wait_for_readings(now, &joints);
        }
        self.waits_since = None;
        let wanted = match &mut self.mode {
            Mode::Hold(_) => return,
            Mode::Move { .. } => return self.advance_move(now, dt_s, &commanded, &measured, &joints),
            Mode::Follow { setpoint, speeds_rad_s, .. } => {
                let gate = &self.limiter.rig.gate;
                let mut next = commanded.clone();
                for (joint, value) in &setpoint.joints {
                    let wanted_rad_s = match setpoint.kind {
                        SetpointKind::Velocity => *value,
                        SetpointKind::Position => {
                            let usual = gate.usual_speed_rad_s;
                            (APPROACH_PER_S * (value - commanded[*joint])).clamp(-usual, usual)
                        }
                    };
                    let ramp = gate.speed_rad_s * dt_s / JOG_RAMP_S;
                    let change = (wanted_rad_s - speeds_rad_s[*joint]).clamp(-ramp, ramp);
                    speeds_rad_s[*joint] += change;
                    next[*joint] += speeds_rad_s[*joint] * dt_s;
                }
                next
            }
        };
        if let Err(refusal) = self.limiter.step(&commanded, &measured, &wanted, &joints) {
            self.refuse(refusal.clone());
            return self
                .stay(MoveOutcome::Held(HoldReason::Refused(refusal.clone())), HoldReason::Refused(refusal));
        }
        if self.note_behind(now, &commanded, &measured, &wanted, &joints) {
            self.commanded = Some(wanted);
        } else {
            self.pause();
        }
    }

    /// What was not read just now is not moved; with it the rest waits, but not for ever.
    fn wait_for_readings(&mut self, now: Instant, joints: &[JointIndex]) {
        let since = now.duration_since(*self.waits_since.get_or_insert(now));
        if since < self.options.following_timeout {
            return self.pause();
        }
        let waited_for = self
            .exchange
            .slots
            .iter()
            .filter(|slot| joints.contains(&slot.reading.joint))
            .max_by_key(|slot| slot.silence());
        let Some(slot) = waited_for else { return };
        let (joint, name, age) = (slot.reading.joint, slot.unit.servo.title.clone(), slot.silence());
        self.hold(HoldReason::Slow { joint, name, age, since });
    }

    /// Jogging starts anew from rest.
    fn pause(&mut self) {
        if let Mode::Follow { speeds_rad_s, .. } = &mut self.mode {
            *speeds_rad_s = Posture::new(vec![0.0; speeds_rad_s.len()]);
        }
    }

    fn advance_move(
        &mut self,
        now: Instant,
        dt_s: f64,
        commanded: &Posture,
        measured: &Posture,
        joints: &[JointIndex],
    ) {
        let Mode::Move { line, fraction, arrived_at, .. } = &self.mode else { return };
        let fraction = *fraction;
        if let Some(at) = arrived_at {
            let moves = |slot: &&Slot| {
                joints.contains(&slot.reading.joint)
                    && slot.reading.speed_rad_s.is_some_and(|v| v.abs() > AT_REST_RAD_S)
            };
            let waited = now.duration_since(*at);
            let at_rest = waited > SETTLE / 5 && !self.exchange.slots.iter().any(|slot| moves(&slot));
            if at_rest || waited > SETTLE {
                let residual_rad =
                    joints.iter().map(|j| (commanded[*j] - measured[*j]).abs()).fold(0.0, f64::max);
                self.stay(MoveOutcome::Arrived { residual_rad }, HoldReason::Arrived);
            }
            return;
        }
        // Where a joint is behind, the whole move waits for it.
        let whole = dt_s / line.duration_s;
        let tries: Vec<(f64, Posture)> = PARTS
            .iter()
            .map(|part| (fraction + part * whole).min(1.0))
            .map(|fraction| (fraction, line.at(fraction)))
            .collect();
        let fits =
            tries.iter().find(|(_, next)| self.too_far_ahead(commanded, measured, next, joints).is_empty());
        let (new_fraction, wanted) = fits.unwrap_or(&tries[0]).clone();
        if let Err(refusal) = self.limiter.step(commanded, measured, &wanted, joints) {
            self.refuse(refusal.clone());
            return self.hold(HoldReason::Refused(refusal));
        }
        let made = if self.note_behind(now, commanded, measured, &wanted, joints) {
            self.commanded = Some(wanted);
            new_fraction - fraction
        } else {
            0.0
        };
        let longest_s = self.options.following_timeout.as_secs_f64();
        let Mode::Move { fraction, arrived_at, progress, .. } = &mut self.mode else { return };
        *fraction += made;
        *arrived_at = (*fraction >= 1.0).then_some(now);
        progress.note(dt_s, whole, made);
        if let Some(since_s) = progress.creeps_for_s(longest_s) {
            self.hold_what_creeps(commanded, measured, joints, since_s);
        }
    }

    /// A move that hardly comes forward ends; the joint that is behind most is named.
    fn hold_what_creeps(
        &mut self,
        commanded: &Posture,
        measured: &Posture,
        joints: &[JointIndex],
        since_s: f64,
    ) {
        let behind_rad = |joint: JointIndex| commanded[joint] - measured[joint];
        let slots = self.exchange.slots.iter().filter(|slot| joints.contains(&slot.reading.joint));
        let most = slots.max_by(|one, other| {
            let of = |slot: &Slot| behind_rad(slot.reading.joint).abs();
            of(one).total_cmp(&of(other))
        });
        let Some(slot) = most else { return };
        let (joint, name) = (slot.reading.joint, slot.unit.servo.title.clone());
        let since = Duration::from_secs_f64(since_s);
        self.hold(HoldReason::NotFollowing { joint, name, behind_rad: behind_rad(joint), since });
    }

    /// Joints whose next goal would be farther ahead of the present angle than the step limit, and
    /// farther than it is now.
    pub(super) fn too_far_ahead(
        &self,
        commanded: &Posture,
        measured: &Posture,
        next: &Posture,
        joints: &[JointIndex],
    ) -> Vec<JointIndex> {
        let step_rad = self.limiter.rig.gate.step_rad;
        let is_too_far = |joint: &&JointIndex| {
            let ahead = (next[**joint] - measured[**joint]).abs();
            // A small share of the step is left for rounding to ticks.
            ahead > step_rad * 0.95
                && ahead > (commanded[**joint] - measured[**joint]).abs() - 1e-12
                && next[**joint] != commanded[**joint]
        };
        joints.iter().filter(is_too_far).copied().collect()
    }

    /// Notes which joints are behind; returns whether none is.
    fn note_behind(
        &mut self,
        now: Instant,
        commanded: &Posture,
        measured: &Posture,
        next: &Posture,
        joints: &[JointIndex],
    ) -> bool {
        let behind = self.too_far_ahead(commanded, measured, next, joints);
        for (slot, since) in self.exchange.slots.iter().zip(&mut self.behind_since) {
            *since = behind.contains(&slot.reading.joint).then(|| since.unwrap_or(now));
        }
        behind.is_empty()
    }
}
