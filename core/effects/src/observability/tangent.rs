//! What an effect of usual size does to one touch.

use nalgebra::{Matrix3x6, Matrix3xX, Vector3};

use super::PlannedContact;
use crate::arm::{Arm, Deviation};
use crate::library::{Effect, Situation, Surface};

/// Difference step, in usual sizes of a parameter: small enough to be linear, large enough for
/// the last digits not to matter (cubic error and rounding both near 1e-6 of the tangent).
pub(super) const STEP: f64 = 0.01;

/// Tangents of one touch.
pub(super) struct ContactTangent {
    /// Along u, along v and height (m), per parameter of usual size.
    pub effects: Matrix3xX<f64>,
    /// The same for a rigid motion of the screen (per m, per rad).
    pub gauge: Matrix3x6<f64>,
    /// What the encoders see of each parameter of usual size (rad), the joints added in squares.
    pub encoder_rad: Vec<f64>,
}

impl ContactTangent {
    /// `from_encoders`: the prediction starts from encoder angles, in which a servo that gives way
    /// shows itself; else from commanded ones, and the touch has to show it.
    pub fn of(
        arm: &Arm,
        surface: &Surface,
        effects: &[Effect],
        contact: &PlannedContact,
        from_encoders: bool,
        step: f64,
    ) -> Self {
        let situation = Situation::new(
            arm,
            &contact.angles_rad,
            &contact.direction,
            contact.payload_kg,
            surface.normal(),
        );
        let none = Deviation::none(arm.len());
        let seen = |effect: &Effect, values: &[f64]| -> Vector3<f64> {
            let mut deviation = none.clone();
            effect.deviate(&situation, values, &mut deviation);
            surface.touch_m(arm.tip_m(&contact.angles_rad, &deviation), contact.screen_height_m, &deviation)
        };
        let mut columns: Vec<Vector3<f64>> = vec![];
        let mut encoder_rad = vec![];
        for effect in effects {
            let parameters = effect.parameters();
            for (k, parameter) in parameters.iter().enumerate() {
                let mut values = vec![0.0; parameters.len()];
                if from_encoders && effect.kind.is_seen_by_encoder() {
                    columns.push(Vector3::zeros());
                    let mut deviation = none.clone();
                    effect.deviate(&situation, &[parameter.typical], &mut deviation);
                    encoder_rad
                        .push(deviation.joint_rad.iter().map(|angle| angle * angle).sum::<f64>().sqrt());
                    continue;
                }
                values[k] = step * parameter.typical;
                let ahead = seen(effect, &values);
                values[k] = -step * parameter.typical;
                columns.push((ahead - seen(effect, &values)) / (2.0 * step));
                encoder_rad.push(0.0);
            }
        }
        let tip = arm.tip_m(&contact.angles_rad, &none);
        Self { effects: Matrix3xX::from_columns(&columns), gauge: surface.gauge(tip), encoder_rad }
    }
}
