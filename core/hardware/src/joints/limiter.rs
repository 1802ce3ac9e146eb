//! Limits that every motion passes: of joints, of pairs of joints, of speed, and the guards.

use std::sync::Arc;

use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::command::{Move, Pace, Setpoint};
use super::guard::Guard;
use super::refusal::Refusal;
use super::trajectory::{PEAK_OVER_MEAN, Trajectory};

/// Postures looked at along a planned move.
const SAMPLES: usize = 64;
/// Rounding to ticks must not make a joint at its limit seem beyond it, rad.
const ROUNDING_RAD: f64 = 2e-3;
/// A move over nothing still takes this long, s.
const SHORTEST_S: f64 = 0.05;
/// A move that takes longer is a slip of the pen, s.
const LONGEST_S: f64 = 1800.0;

/// Knows the limits of a rig.
pub(super) struct Limiter {
    pub rig: Arc<Rig>,
    pub guards: Vec<Arc<dyn Guard>>,
}

impl Limiter {
    pub fn name(&self, joint: JointIndex) -> String {
        match self.rig.servo_of(joint) {
            Some(servo) => servo.title.clone(),
            None => format!("joint number {}", joint.0),
        }
    }

    /// Plans a move from `start` (what was commanded last) while the arm is at `present`.
    pub fn plan(&self, start: &Posture, present: &Posture, wanted: &Move) -> Result<Trajectory, Refusal> {
        if wanted.goals.is_empty() {
            return Err(Refusal::NotAMove { what: "it names no joint".to_owned() });
        }
        let mut end = start.clone();
        let mut joints = vec![];
        for (joint, goal_rad) in &wanted.goals {
            self.known(*joint, *goal_rad)?;
            end[*joint] = *goal_rad;
            joints.push(*joint);
        }
        for joint in &joints {
            self.position(*joint, &end)?;
        }
        let duration_s = self.duration_s(start, &end, &joints, wanted.pace)?;
        let line = Trajectory { start: start.clone(), end, joints, duration_s };
        let mut before = start.clone();
        for i in 1..=SAMPLES {
            let posture = line.at(i as f64 / SAMPLES as f64);
            self.coupled(&before, &posture, &line.joints)?;
            self.guarded(present, &posture)?;
            before = posture;
        }
        Ok(line)
    }

    fn duration_s(
        &self,
        start: &Posture,
        end: &Posture,
        joints: &[JointIndex],
        pace: Pace,
    ) -> Result<f64, Refusal> {
        let limit_rad_s = self.rig.gate.speed_rad_s;
        let turn = |joint: &JointIndex| (end[*joint] - start[*joint]).abs();
        let longest = joints.iter().copied().max_by(|a, b| turn(a).total_cmp(&turn(b)));
        let longest_rad = longest.as_ref().map_or(0.0, turn);
        let at_peak = |peak_rad_s: f64| (PEAK_OVER_MEAN * longest_rad / peak_rad_s).max(SHORTEST_S);
        let duration_s = match pace {
            Pace::Duration(duration) => duration.as_secs_f64(),
            Pace::SpeedFraction(share) if share > 0.0 && share <= 1.0 => at_peak(share * limit_rad_s),
            Pace::SpeedFraction(share) => {
                return Err(Refusal::NotAMove {
                    what: format!("{share} of the speed; give more than 0, up to 1"),
                });
            }
            Pace::PeakSpeed(peak) if peak > 0.0 && peak.is_finite() => at_peak(peak),
            Pace::PeakSpeed(peak) => {
                return Err(Refusal::NotAMove { what: format!("a speed of {peak} rad/s; give more than 0") });
            }
        };
        // NaN fails the comparison.
        if !(duration_s <= LONGEST_S) {
            return Err(Refusal::NotAMove {
                what: format!(
                    "it would take {duration_s:.0} s, and none may take longer than {LONGEST_S:.0} s; give it more speed"
                ),
            });
        }
        let wanted_rad_s = PEAK_OVER_MEAN * longest_rad / duration_s.max(1e-9);
        if let Some(joint) = longest.filter(|_| wanted_rad_s > limit_rad_s * (1.0 + 1e-9)) {
            let advice =
                format!("give the move at least {:.1} s", PEAK_OVER_MEAN * longest_rad / limit_rad_s);
            return Err(Refusal::Speed { joint, name: self.name(joint), wanted_rad_s, limit_rad_s, advice });
        }
        Ok(duration_s.max(SHORTEST_S))
    }

    /// Checks the goal of a joint, with the others where they are.
    pub fn goal(&self, joint: JointIndex, goal_rad: f64, others: &Posture) -> Result<(), Refusal> {
        self.known(joint, goal_rad)?;
        self.position(joint, &others.with(&[joint], &[goal_rad]))
    }

    /// Checks the numbers of a setpoint.
    pub fn setpoint(&self, setpoint: &Setpoint) -> Result<(), Refusal> {
        let limit_rad_s = self.rig.gate.speed_rad_s;
        for (joint, value) in &setpoint.joints {
            self.known(*joint, *value)?;
            let is_velocity = setpoint.kind == super::command::SetpointKind::Velocity;
            if is_velocity && value.abs() > limit_rad_s * (1.0 + 1e-9) {
                let (name, advice) = (self.name(*joint), "jog slower".to_owned());
                return Err(Refusal::Speed {
                    joint: *joint,
                    name,
                    wanted_rad_s: *value,
                    limit_rad_s,
                    advice,
                });
            }
        }
        Ok(())
    }

    /// A small step from what was commanded last.
    pub fn step(
        &self,
        commanded: &Posture,
        present: &Posture,
        next: &Posture,
        joints: &[JointIndex],
    ) -> Result<(), Refusal> {
        for joint in joints {
            let before = self.rig.limits(*joint).excess_rad(commanded[*joint]).abs();
            let after = self.rig.limits(*joint).excess_rad(next[*joint]).abs();
            // Back from beyond a limit is allowed.
            if after.is_nan() || after > before {
                self.position(*joint, next)?;
            }
        }
        self.coupled(commanded, next, joints)?;
        self.guarded(present, next)
    }

    fn known(&self, joint: JointIndex, value: f64) -> Result<(), Refusal> {
        if self.rig.servo_of(joint).is_none() {
            return Err(Refusal::NoServo { joint });
        }
        if !value.is_finite() {
            return Err(Refusal::NotANumber { joint, name: self.name(joint) });
        }
        Ok(())
    }

    fn position(&self, joint: JointIndex, posture: &Posture) -> Result<(), Refusal> {
        let limits = self.rig.limits(joint);
        let wanted_rad = posture[joint];
        let beyond_rad = limits.excess_rad(wanted_rad);
        if beyond_rad.abs() <= ROUNDING_RAD {
            return Ok(());
        }
        let limit_rad = wanted_rad - beyond_rad;
        Err(Refusal::Position { joint, name: self.name(joint), wanted_rad, limit_rad, beyond_rad })
    }

    /// Limits that depend on another joint, unless the posture makes it no worse than `before`.
    fn coupled(&self, before: &Posture, posture: &Posture, joints: &[JointIndex]) -> Result<(), Refusal> {
        for limit in &self.rig.coupled_limits {
            if !joints.contains(&limit.joint) && !joints.contains(&limit.by) {
                continue;
            }
            let excess = |posture: &Posture| {
                let largest_rad = limit.largest_rad(posture[limit.by])?;
                Some((posture[limit.joint].abs() - largest_rad, largest_rad))
            };
            let Some((beyond_rad, largest_rad)) = excess(posture) else { continue };
            let was_rad = excess(before).map_or(0.0, |(beyond_rad, _)| beyond_rad);
            if beyond_rad > ROUNDING_RAD && beyond_rad > was_rad + 1e-9 {
                let (joint, name) = (limit.joint, self.name(limit.joint));
                let (wanted_rad, why) = (posture[limit.joint], limit.why.clone());
                return Err(Refusal::Coupled { joint, name, wanted_rad, largest_rad, why });
            }
        }
        Ok(())
    }

    /// From where joints set out that were sent somewhere: one that hangs farther from its goal than one step, from
    /// where it is. So do those at rest where they were sent on into something: a finger that was lowered onto the
    /// glass presses on it, and each way that set out from its goals would begin in there. Others that rest do so only
    /// where these are not enough.
    pub fn set_out(
        &self,
        sent: &Posture,
        present: &Posture,
        joints: &[JointIndex],
        at_rest: &[JointIndex],
    ) -> Posture {
        let mut start = sent.clone();
        for joint in joints {
            // NaN fails the comparison.
            if !((start[*joint] - present[*joint]).abs() <= self.rig.gate.step_rad) {
                start[*joint] = present[*joint];
            }
        }
        for only_these in [true, false] {
            if at_rest.is_empty() || self.guarded(present, &start).is_ok() {
                break;
            }
            for joint in at_rest.iter().filter(|joint| !only_these || joints.contains(joint)) {
                start[*joint] = present[*joint];
            }
        }
        start
    }

    fn guarded(&self, present: &Posture, goal: &Posture) -> Result<(), Refusal> {
        self.guards.iter().try_for_each(|guard| guard.check(present, goal))
    }
}
