//! What effects do to the arm, the tip and the screen.

use nalgebra::Vector3;

use super::{Effect, Kind, Situation};
use crate::arm::Deviation;

/// A tooth has two flanks: gravity has chosen one when it is clearly larger than this, N m.
const SEATING_TORQUE_NM: f64 = 0.02;
/// How far a usual bracket gives under load, rad/(N m). Only needed to see a wrong mass, which
/// shows through what gives way under it.
const USUAL_COMPLIANCE_RAD_PER_NM: f64 = 0.015;
/// How hard a finger presses on the glass when it is noticed, N.
const PRESSING_N: f64 = 1.0;
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
        let value = values[0];
        match (self.kind, self.joint) {
            (Kind::LinkLength, Some(j)) => {
                deviation.shift_m[j] += situation.arm.parts[j].before.translation.vector.normalize() * value;
            }
            (Kind::LinkBending, Some(j)) => bend(situation, j, value, deviation),
            (Kind::SidewaysGive, Some(j)) => deviation.skew_rad[j] += situation.sideways_nm[j] * value,
            (Kind::AxisSkew, Some(j)) => {
                let [a, b] = self.across.unwrap_or_default();
                deviation.skew_rad[j] += a * value + b * values[1];
            }
            (_, Some(j)) => deviation.joint_rad[j] += self.turn_rad(situation, j, values),
            (kind, None) if kind.is_shared() => {
                for (j, angle) in deviation.joint_rad.iter_mut().enumerate() {
                    *angle += self.turn_rad(situation, j, values);
                }
            }
            (_, None) => self.deviate_tip_or_screen(situation, values, deviation),
        }
    }

    /// How far a joint is turned.
    fn turn_rad(&self, situation: &Situation<'_>, j: usize, values: &[f64]) -> f64 {
        let value = values[0];
        let (Some(angle), Some(torque)) = (situation.angles_rad.get(j), situation.torques_nm.get(j)) else {
            return 0.0;
        };
        if self.kind.is_seen_by_encoder() && situation.starts_from_encoders() {
            return 0.0;
        }
        match self.kind {
            Kind::JointZero => value,
            Kind::JointScale => value * angle,
            Kind::JointEccentricity | Kind::ToothRipple => {
                let (sine, cosine) = (self.shape.unwrap_or(1.0) * angle).sin_cos();
                value * sine + values[1] * cosine
            }
            Kind::Backlash => 0.5 * value * situation.direction_of(j),
            Kind::Stiction => -0.5 * value * situation.direction_of(j),
            Kind::GravityBacklash => 0.5 * value * (torque / SEATING_TORQUE_NM).tanh(),
            Kind::ServoDroop | Kind::JointSag => value * torque,
            Kind::TorqueLimit => {
                let limit = self.shape.unwrap_or(f64::INFINITY);
                value * torque.signum() * (torque.abs() - limit).max(0.0)
            }
            Kind::Creep => value * torque * self.grown(situation.row.and_then(|row| row.hold_secs)),
            Kind::ServoWarmUp => value * self.grown(situation.row.and_then(|row| row.t_secs)),
            Kind::SlippedHorn => value * self.stepped(situation),
            Kind::EarlyLog => value * situation.lag_rad(j),
            Kind::JointCoupling => value * j.checked_sub(1).map_or(0.0, |i| situation.angles_rad[i]),
            _ => 0.0,
        }
    }

    /// Part of its full size that it has reached.
    pub(super) fn grown(&self, t_secs: Option<f64>) -> f64 {
        let (Some(t_secs), Some((constant_s, delay_s))) = (t_secs, self.growth_s()) else { return 0.0 };
        -(-(t_secs - delay_s).max(0.0) / constant_s).exp_m1()
    }

    /// 1 after the moment of the step, 0 before.
    fn stepped(&self, situation: &Situation<'_>) -> f64 {
        let after = situation.row.and_then(|row| row.t_secs).zip(self.shape);
        f64::from(u8::from(after.is_some_and(|(t_secs, moment)| t_secs > moment)))
    }

    fn deviate_tip_or_screen(&self, situation: &Situation<'_>, values: &[f64], deviation: &mut Deviation) {
        let value = values[0];
        match self.kind {
            Kind::TipOffset => deviation.tip_m += Vector3::new(value, values[1], values[2]),
            Kind::FingerBend => {
                // The glass presses along its normal; only what is across the finger bends it.
                let (normal, finger) = (situation.normal, situation.finger);
                deviation.contact_m += (normal - finger * finger.dot(&normal)) * (PRESSING_N * value);
            }
            Kind::FingerRoll => deviation.contact_m += situation.roll * value,
            Kind::TouchDrag => deviation.contact_m += situation.sweep * value,
            Kind::SpeedOvershoot => {
                for (j, angle) in deviation.joint_rad.iter_mut().enumerate() {
                    *angle += value * situation.speed_rad_s(j);
                }
            }
            Kind::BaseTilt => {
                deviation.base_rad += Vector3::new(value, values[1], values[2]);
                deviation.base_m += Vector3::new(values[3], values[4], values[5]);
            }
            Kind::TorsoLean => deviation.base_rad += situation.lean_nm * value,
            Kind::PayloadMass => {
                for (offset, torque) in deviation.joint_rad.iter_mut().zip(&situation.torques_per_kg_nm) {
                    *offset += USUAL_COMPLIANCE_RAD_PER_NM * torque * value;
                }
            }
            Kind::ScreenBumped => {
                let part = self.stepped(situation);
                deviation.screen_m += Vector3::new(value, values[1], 0.0) * part;
                deviation.screen_rad += Vector3::z() * (values[2] * part);
            }
            Kind::ScreenScale => {
                deviation.screen_scale[0] += value;
                deviation.screen_scale[1] += values[1];
            }
            // A screen that moves is an arm that moves the other way.
            Kind::ScreenTilt => {
                deviation.base_rad -= Vector3::new(value, values[1], values[2]);
                deviation.base_m -= Vector3::new(values[3], values[4], values[5]);
            }
            Kind::ScreenBow => {
                deviation.screen_bow_per_m[0] += value;
                deviation.screen_bow_per_m[1] += values[1];
            }
            Kind::PanelEdge => deviation.screen_edge_m += value,
            _ => {}
        }
    }
}

/// The link between joints `j − 1` and `j` as a beam that is held at the former: a force F at its
/// end shifts the end by c F with c = L³/3EI, and turns it by 3c/2L of it; a moment M turns it by
/// 3c/L² M and shifts it by 3c/2L of it.
fn bend(situation: &Situation<'_>, j: usize, compliance_m_per_n: f64, deviation: &mut Deviation) {
    let joints = &situation.frames.robot_from_joint;
    let before = &situation.arm.parts[j].before;
    let length_m = before.translation.vector.norm();
    let along = joints[j - 1].rotation * (before.translation.vector / length_m);
    let across = |v: &Vector3<f64>| v - along * along.dot(v);
    let (force, moment) = (across(&situation.weights_n[j]), across(&situation.moments_nm[j]));
    let (c, slope) = (compliance_m_per_n, 1.5 * compliance_m_per_n / length_m);
    let shift = force * c + moment.cross(&along) * slope;
    let turn = along.cross(&force) * slope + moment * (2.0 * slope / length_m);
    let robot_from_before = joints[j - 1].rotation;
    deviation.shift_m[j] += robot_from_before.inverse() * shift;
    deviation.skew_rad[j] += (robot_from_before * before.rotation).inverse() * turn;
}

impl Situation<'_> {
    /// Whether the prediction already holds what encoders see.
    fn starts_from_encoders(&self) -> bool {
        self.row.is_some_and(|row| row.encoder_rad.is_some())
    }

    fn direction_of(&self, j: usize) -> f64 {
        self.direction.get(j).copied().unwrap_or_default()
    }

    /// Commanded less encoder angle.
    fn lag_rad(&self, j: usize) -> f64 {
        let Some(row) = self.row else { return 0.0 };
        let (Some(commanded), Some(encoder)) = (&row.commanded_rad, &row.encoder_rad) else { return 0.0 };
        commanded.get(j).zip(encoder.get(j)).map_or(0.0, |(c, e)| c - e)
    }

    /// How fast a joint arrived: by the side of its approach where that is known, else by the way
    /// from the last command.
    fn speed_rad_s(&self, j: usize) -> f64 {
        let Some(row) = self.row else { return 0.0 };
        let side = self.direction_of(j);
        match row.move_secs.filter(|secs| *secs > 0.0) {
            Some(secs) if side != 0.0 => side * LAST_STRETCH_RAD / secs,
            _ => row.speed_rad_s.as_ref().and_then(|speeds| speeds.get(j)).copied().unwrap_or_default(),
        }
    }
}
