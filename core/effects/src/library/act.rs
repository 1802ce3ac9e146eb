//! What effects do to the arm, the tip, the screen and the eyes.

use super::entry::{Act, Is, Turning};
use super::{Effect, Kind, Situation};
use crate::arm::Deviation;
use crate::eyes::{EyeSituation, EyesDeviation};

/// How far a joint turns on its last stretch, where only the side of its approach is known, rad.
const LAST_STRETCH_RAD: f64 = 0.1;

impl Effect {
    /// What it does to the arm in a situation, added to `deviation`; one value per parameter.
    /// Linear in the values. Nothing where the row lacks what it depends on.
    pub fn deviate(&self, situation: &Situation<'_>, values: &[f64], deviation: &mut Deviation) {
        let mut at = 0;
        for member in &self.members {
            let count = member.parameters().len();
            member.deviate(situation, &values[at..at + count], deviation);
            at += count;
        }
        if at > 0 {
            return;
        }
        let turning = |joint| Turning { effect: self, situation, joint, values };
        match (self.kind.entry().act, self.joint) {
            (Act::Turn(turn), Some(j)) => deviation.joint_rad[j] += self.turn_rad(turn, &turning(j)),
            (Act::Turn(turn), None) => {
                for (j, angle) in deviation.joint_rad.iter_mut().enumerate() {
                    *angle += self.turn_rad(turn, &turning(j));
                }
            }
            (Act::Joint(act), Some(j)) => act(&turning(j), deviation),
            (Act::Arm(act), _) => act(self, situation, values, deviation),
            (Act::Joint(_), None) | (Act::Eyes(_) | Act::Unseen, _) => {}
        }
    }

    /// What it does to the eyes in a situation, added to `deviation`; one value per parameter.
    /// Nothing where the row lacks what it depends on.
    pub fn deviate_eyes(&self, situation: &EyeSituation, values: &[f64], deviation: &mut EyesDeviation) {
        match self.kind.entry().act {
            Act::Eyes(act) => act(self, situation, values, deviation),
            Act::Turn(_) | Act::Joint(_) | Act::Arm(_) | Act::Unseen => {}
        }
    }

    /// How far a joint is turned.
    fn turn_rad(&self, turn: fn(&Turning<'_>) -> f64, at: &Turning<'_>) -> f64 {
        let situation = at.situation;
        let known = situation.angles_rad.len().min(situation.torques_nm.len());
        if at.joint >= known || situation.encoder_sees(self.kind, at.joint) { 0.0 } else { turn(at) }
    }

    /// Part of its full size that it has reached.
    pub(super) fn grown(&self, t_secs: Option<f64>) -> f64 {
        t_secs.zip(self.growth()).map_or(0.0, |(t_secs, growth)| growth.share(t_secs))
    }

    /// How much of it is there beside the calibration of the eyes: all, or of what grows the part that it has grown
    /// since the calibration; less than nothing before. Nothing where the time is not known.
    pub(super) fn part(&self, t_secs: Option<f64>) -> f64 {
        let Some(growth) = self.growth() else { return 1.0 };
        // A law without a time constant is all there at once: what begins cold began with nothing.
        let held = if self.reference_s > 0.0 { growth.share(self.reference_s) } else { 0.0 };
        t_secs.map_or(0.0, |t_secs| growth.share(t_secs) - held)
    }

    /// 1 after the moment of the step, 0 before.
    pub(super) fn stepped(&self, t_secs: Option<f64>) -> f64 {
        let after = t_secs.zip(self.shape);
        f64::from(u8::from(after.is_some_and(|(t_secs, moment)| t_secs > moment)))
    }
}

impl Situation<'_> {
    /// Whether the angle that the prediction starts from already holds what effects of this kind do to a joint.
    fn encoder_sees(&self, kind: Kind, j: usize) -> bool {
        let Some(row) = self.row.filter(|row| row.reads_encoder(j)) else { return false };
        let entry = kind.entry();
        entry.is(Is::SeenByEncoder) || entry.is(Is::SeenBehindGear) && row.encoder_behind_gear
    }

    pub(super) fn direction_of(&self, j: usize) -> f64 {
        self.direction.get(j).copied().unwrap_or_default()
    }

    /// Commanded less encoder angle: as repeats tell it, where there are some. What the row's own reading is
    /// off by stands in its lag and in its prediction, so that noise of encoders would look like angles that
    /// were logged too early.
    pub(super) fn lag_rad(&self, j: usize) -> f64 {
        let Some(row) = self.row else { return 0.0 };
        if let Some(lag_rad) = &row.usual_lag_rad {
            return lag_rad.get(j).copied().unwrap_or(0.0);
        }
        let (Some(commanded), Some(encoder)) = (&row.commanded_rad, &row.encoder_rad) else { return 0.0 };
        commanded.get(j).zip(encoder.get(j)).map_or(0.0, |(c, e)| c - e)
    }

    /// What of that the servo gave way by under its load: no way that was left to go.
    pub(super) fn given_way_rad(&self, j: usize) -> f64 {
        let given_way = self.row.and_then(|row| row.given_way_rad.as_ref());
        given_way.and_then(|given_way| given_way.get(j)).copied().unwrap_or_default()
    }

    /// How fast a joint arrived: by the side of its approach where that is known, else by the way
    /// from the last command.
    pub(super) fn speed_rad_s(&self, j: usize) -> f64 {
        let Some(row) = self.row else { return 0.0 };
        let side = self.direction_of(j);
        match row.move_secs.filter(|secs| *secs > 0.0) {
            Some(secs) if side != 0.0 => side * LAST_STRETCH_RAD / secs,
            _ => row.speed_rad_s.as_ref().and_then(|speeds| speeds.get(j)).copied().unwrap_or_default(),
        }
    }
}
