//! Jogging: the arm goes on as long as it is asked to, and no farther than it may.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{Motion, Refusal, Setpoint, SetpointKind};
use plumbline_model::robot::Posture;

use super::Worker;
use crate::ground::text::sentence;
use crate::robot::command::{JOG_DEADLINE_MS, JogRates};
use crate::robot::jog::joint_rates;
use crate::robot::unable::{FASTEST_JOG, NoDestination, Unable};

/// An arm may hang so far from its goals by its own weight and what rubs, rad.
const HANGS_RAD: f64 = 0.06;
/// Goals that stand still are followed for so long: two cycles of the bus.
const STILL_FOR: Duration = Duration::from_millis(32);

/// Jogging: what is asked, until when, and where that leads.
#[derive(Clone, Debug)]
pub(in crate::robot) struct Jog {
    rates: JogRates,
    until: Instant,
    last: Instant,
    goal: Posture,
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
            Some(jog) => (jog.rates, jog.until) = (rates, until),
            None => {
                let goal = self.present().ok_or(Unable::NotRead)?;
                self.knows(self.chain.joints())?;
                self.refusal = None;
                (self.preview, self.running) = (None, None);
                self.jog = Some(Jog { rates, until, last: now, goal });
                self.step_jog(now);
            }
        }
        Ok(())
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
            Some(arm) => match joint_rates(arm, &jog.goal, &jog.rates, fastest) {
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
