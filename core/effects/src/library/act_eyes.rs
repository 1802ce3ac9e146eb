//! What effects do to the eyes.

use nalgebra::Vector3;

use super::{Effect, Kind};
use crate::eyes::{EyeSituation, EyesDeviation};

impl Effect {
    /// What it does to the eyes in a situation, added to `deviation`; one value per parameter.
    /// Nothing where the row lacks what it depends on.
    pub fn deviate_eyes(&self, situation: &EyeSituation, values: &[f64], deviation: &mut EyesDeviation) {
        let value = values[0];
        match self.kind {
            Kind::CameraMount => {
                deviation.mount_m += Vector3::new(value, values[1], values[2]);
                deviation.mount_rad += Vector3::new(values[3], values[4], values[5]);
            }
            Kind::HeadJoint => {
                if let Some(angle) = self.joint.and_then(|j| deviation.neck_rad.get_mut(j)) {
                    *angle += value;
                }
            }
            Kind::EyeYaw => {
                let part = if self.shape.is_some() { self.grown(situation.t_secs) } else { 1.0 };
                deviation.right_rad.y += value * part;
            }
            Kind::ImageShift => {
                deviation.right_shift_px[0] += value;
                deviation.right_shift_px[1] += values[1];
            }
            Kind::FocalOrBaseline => {
                let scale = if self.shape.is_some() {
                    &mut deviation.baseline_scale
                } else {
                    &mut deviation.focal_scale
                };
                *scale += value;
            }
            Kind::EyeRoll => {
                deviation.right_rad.z += value;
                deviation.right_rad.x += values[1];
            }
            Kind::LensDistortion => deviation.distortion_px += value,
            Kind::BackgroundBleed if situation.background_m.is_some() => deviation.background_share += value,
            Kind::ForegroundFattening => {
                // Only as far as there is a step in depth behind the edge.
                let range_m = situation.in_left_m.coords.norm();
                let step =
                    situation.background_m.map_or(0.0, |behind_m| 1.0 - range_m / behind_m.max(range_m));
                deviation.box_px[0] += value * step;
            }
            Kind::SeenSurface => deviation.nearer_m += value,
            Kind::BoxBias => {
                deviation.box_px[0] += value;
                deviation.box_px[1] += values[1];
            }
            _ => {}
        }
    }
}
