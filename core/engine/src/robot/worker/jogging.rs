//! Jogging: the arm goes on as long as it is asked to, and no farther than it may.

use std::time::{Duration, Instant};

use plumbline_effects::ModelArm;
use plumbline_hardware::joints::{Motion, Refusal, Setpoint, SetpointKind};
use plumbline_model::robot::Posture;

use super::Worker;
use crate::ground::text::sentence;
use crate::robot::command::{JOG_DEADLINE_MS, JogRates};
use crate::robot::jog::joint_rates;
use crate::robot::unable::{FASTEST_JOG, NoDestination, Unable};

/// An arm may hang so far from its goals by its own weight and what rubs, rad.
const HANGS_RAD: f64 = 0.06;
/// A tip that goes level and sank by less than this is not lifted, m …
const SINKS_M: f64 = 1e-3;
/// … nor one that something presses down, m.
const PRESSED_DOWN_M: f64 = 0.04;
/// What it sank is taken off in a second, 1/s: faster, it is higher than before once the joints have come after their
/// goals (by 5 mm of a way of 40 with a toy in the hand, physics) …
const LIFTS_PER_S: f64 = 1.0;
/// … and it rises no steeper than this share of its way.
const STEEPEST: f64 = 0.2;
/// Goals that stand still are followed for so long: two cycles of the bus.
const STILL_FOR: Duration = Duration::from_millis(32);

/// Jogging: what is asked, until when, and where that leads.
#[derive(Clone, Debug)]
pub(in crate::robot) struct Jog {
    rates: JogRates,
    until: Instant,
    last: Instant,
    goal: Posture,
    /// How high the tip was, by the encoders, when it was asked to go level; `None`: it is not.
    level_m: Option<f64>,
}

impl Worker {
    pub(super) fn begin_jog(&mut self, rates: JogRates, now: Instant) -> Result<(), Unable> {
        let is_slow = |rate: &f64, fastest: f64| (-fastest..=fastest).contains(rate);
        let [fastest_m_s, fastest_rad_s] = FASTEST_JOG;
        if !rates.velocity_m_s.iter().all(|rate| is_slow(rate, fastest_m_s))
            || !is_slow(&rates.yaw_rad_s, fastest_rad_s)
        {
            return Err(Unable::TooFast);
        }
        if self.switches.stop.is_pressed() {
            return Err(Refusal::Stopped.into());
        }
        let until = now + Duration::from_millis(JOG_DEADLINE_MS);
        match &mut self.jog {
            Some(jog) => {
                (jog.rates, jog.until) = (rates, until);
            }
            None => {
                let goal = self.present().ok_or(Unable::NotRead)?;
                self.knows(self.chain.joints())?;
                self.refusal = None;
                (self.preview, self.running) = (None, None);
                self.jog = Some(Jog { rates, until, last: now, goal, level_m: None });
                self.step_jog(now);
            }
        }
        Ok(())
    }

    /// Another tip, or another model of the arm, is as high as it is.
    pub(super) fn forget_level(&mut self) {
        if let Some(jog) = &mut self.jog {
            jog.level_m = None;
        }
    }

    pub(super) fn end_jog(&mut self) -> Result<(), Unable> {
        if self.jog.take().is_some() {
            self.rest()?;
        }
        Ok(())
    }

    /// What was asked for is over, and the arm rests at its goals. It hangs a little below them: held where it hangs, it
    /// would sink as much once more. An arm that something keeps from its goals is held where it is.
    fn rest(&self) -> Result<(), Unable> {
        let arm = self.arm()?;
        let joints = self.chain.joints();
        let hangs = arm.state().and_then(|state| {
            let (goals, angles) = state.commanded.as_ref().zip(state.measured.as_ref())?;
            Some(joints.iter().map(|joint| (goals[*joint] - angles[*joint]).abs()).fold(0.0, f64::max))
        });
        if hangs.is_none_or(|hangs_rad| hangs_rad > HANGS_RAD) {
            return Ok(arm.hold()?);
        }
        let still = Setpoint {
            kind: SetpointKind::Velocity,
            joints: joints.iter().map(|joint| (*joint, 0.0)).collect(),
            valid_for: STILL_FOR,
        };
        Ok(arm.follow(still)?)
    }

    /// Joint speeds that take the tip where it is asked to; what goes level is lifted as far as it sank by its weight on
    /// the way. `None`: the arm reaches no farther that way.
    fn level_rates(&self, arm: &ModelArm, jog: &mut Jog, fastest_rad_s: f64) -> Option<Vec<f64>> {
        let asked = joint_rates(arm, &jog.goal, &jog.rates, fastest_rad_s)?;
        if jog.rates.velocity_m_s[2] != 0.0 {
            jog.level_m = None;
            return Some(asked);
        }
        let lifted = self.present().and_then(|measured| {
            let height_m = self.tip_by_encoders(&measured).isometry.translation.z;
            let level_m = *jog.level_m.get_or_insert(height_m);
            joint_rates(arm, &jog.goal, &lifted(&jog.rates, level_m - height_m)?, fastest_rad_s)
        });
        Some(lifted.unwrap_or(asked))
    }

    /// Whether the arm stands at its goals.
    fn holds(&self) -> bool {
        let state = self.arm().ok().and_then(|arm| arm.state());
        state.is_some_and(|state| matches!(state.motion, Motion::Holding(_)))
    }

    /// Sends the next joint speeds of a jog; ends it when its time is over or it would lead
    /// into something.
    pub(super) fn step_jog(&mut self, now: Instant) {
        let Some(mut jog) = self.jog.take() else { return };
        if self.switches.stop.is_pressed() {
            let _ = self.arm().map(|arm| arm.hold());
            return;
        }
        if now >= jog.until {
            let _ = self.rest();
            return;
        }
        let fastest = self.peak_speed_rad_s();
        let speeds = match &self.arm_model {
            Some(arm) => match self.level_rates(arm, &mut jog, fastest) {
                Some(speeds) => speeds,
                None => {
                    if !self.holds() {
                        let _ = self.rest();
                    }
                    return self.refuse(Unable::NoFarther.to_string());
                }
            },
            None => return self.refuse(Unable::from(NoDestination::NoTip).to_string()),
        };
        let step_s = now.saturating_duration_since(jog.last).as_secs_f64().min(0.1);
        let ahead = |seconds: f64| {
            let angles: Vec<f64> = self
                .chain
                .joints()
                .iter()
                .zip(&speeds)
                .map(|(joint, speed)| jog.goal[*joint] + speed * seconds)
                .collect();
            jog.goal.with(self.chain.joints(), &angles)
        };
        // Looks as far ahead as the setpoint lasts.
        let lookahead_s = JOG_DEADLINE_MS as f64 / 1e3;
        if let Err(reason) = self.paths.check(&jog.goal, &ahead(lookahead_s)) {
            let _ = self.arm().map(|arm| arm.hold());
            return self.refuse(reason.of_jog().to_string());
        }
        let goal = ahead(step_s);
        let setpoint = Setpoint {
            kind: SetpointKind::Velocity,
            joints: self.chain.joints().iter().copied().zip(speeds.iter().copied()).collect(),
            valid_for: Duration::from_millis(JOG_DEADLINE_MS),
        };
        match self.arm().map(|arm| arm.follow(setpoint)) {
            Ok(Ok(())) => {
                (jog.goal, jog.last) = (goal, now);
                // Where the arm really is counts more than where it was sent.
                if let Some(present) = self.present()
                    && present.distance_rad(&jog.goal) > 0.2
                {
                    jog.goal = present;
                }
                self.jog = Some(jog);
            }
            Ok(Err(refusal)) => self.refuse(sentence(&refusal.to_string())),
            Err(reason) => self.refuse(reason.to_string()),
        }
    }
}

/// What is asked for, and so much upward that a tip that goes level comes back to the height from which it `sank_m`;
/// `None`: as asked. A tip that is higher than it was is never lowered.
fn lifted(rates: &JogRates, sank_m: f64) -> Option<JogRates> {
    let [x, y, z] = rates.velocity_m_s;
    let speed_m_s = x.hypot(y);
    let sinks = z == 0.0 && speed_m_s > 0.0 && (SINKS_M..PRESSED_DOWN_M).contains(&sank_m);
    let up_m_s = (LIFTS_PER_S * sank_m).min(STEEPEST * speed_m_s);
    sinks.then_some(JogRates { velocity_m_s: [x, y, up_m_s], ..*rates })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_level_and_sinks_is_lifted_a_little_and_nothing_else_is() {
        let asked = |velocity_m_s| JogRates { velocity_m_s, yaw_rad_s: 0.1 };
        let forward = asked([0.02, 0.0, 0.0]);
        assert_eq!(lifted(&forward, 0.002), Some(asked([0.02, 0.0, 0.002])));
        assert_eq!(lifted(&forward, 0.02), Some(asked([0.02, 0.0, 0.004])), "no steeper than a ramp");
        for sank_m in [-0.02, 0.0, 5e-4, 0.05, f64::NAN] {
            assert_eq!(lifted(&forward, sank_m), None, "{sank_m}");
        }
        for other in [asked([0.0, 0.0, 0.02]), asked([0.02, 0.0, -0.01]), asked([0.0; 3])] {
            assert_eq!(lifted(&other, 0.01), None, "{other:?}");
        }
    }
}
