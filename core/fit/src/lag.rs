//! How far servos stop from where they are sent: their encoders say it at every touch. What gives way
//! under load and what friction holds back is fitted joint by joint, each drawn to zero as far as servos
//! usually have it. Without it a command would miss by what predictions from encoders never see.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_effects::arm::{Arm, Deviation};
use plumbline_effects::{Effect, Kind, Measurements, Present, Situation};

/// Spread of an encoder against what is fitted, rad: ticks, and what has not come to rest.
const NOISE_RAD: f64 = 1.5e-3;

/// Effects of the servos and the covariance of their values, row by row.
pub fn lag(measurements: &Measurements, arm: &Arm) -> Vec<(Present, Vec<f64>)> {
    let of_kind = |kind: Kind| Effect::sites(kind, Some(arm), None);
    let all: Vec<Effect> = of_kind(Kind::ServoDroop).into_iter().chain(of_kind(Kind::Stiction)).collect();
    let mut found = vec![];
    for (joint, part) in arm.parts.iter().enumerate() {
        let effects: Vec<&Effect> = all.iter().filter(|effect| effect.site == part.joint).collect();
        let n = effects.len();
        let typical = |k: usize| effects[k].parameters()[0].typical;
        let mut normal = DMatrix::<f64>::identity(n, n);
        let mut right = DVector::<f64>::zeros(n);
        for row in &measurements.rows {
            let Some(lag_rad) = row.lag_rad() else { continue };
            let slope = DVector::from_fn(n, |k, _| {
                let up = Vector3::z();
                let angles_rad = row.commanded_rad.as_deref().unwrap_or_default();
                let situation = Situation::new(arm, angles_rad, &row.direction, row.payload_kg, &up);
                let mut deviation = Deviation::none(arm.len());
                effects[k].deviate(&situation, &[typical(k)], &mut deviation);
                deviation.joint_rad[joint] / NOISE_RAD
            });
            normal += &slope * slope.transpose();
            right += slope * (-lag_rad[joint] / NOISE_RAD);
        }
        let Some(factor) = normal.cholesky() else { continue };
        let (values, covariance) = (factor.solve(&right), factor.inverse());
        for (k, effect) in effects.iter().enumerate() {
            let present = Present { effect: (*effect).clone(), values: vec![values[k] * typical(k)] };
            found.push((present, vec![covariance[(k, k)] * typical(k).powi(2)]));
        }
    }
    found
}
