//! Where the screen sees a touch.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use plumbline_model::session::Touchscreen;

use crate::arm::Deviation;

/// How far from the border a touch panel errs, m.
const EDGE_M: f64 = 0.015;

/// The screen as predictions need it.
#[derive(Clone, Debug)]
pub struct Surface {
    middle_m: Point3<f64>,
    u: Vector3<f64>,
    v: Vector3<f64>,
    normal: Vector3<f64>,
    /// From the middle to the border, along u and v.
    half_m: [f64; 2],
}

impl Surface {
    /// Of a touchscreen.
    pub fn of(screen: &Touchscreen) -> Self {
        Self {
            middle_m: screen.point_at(screen.middle()).coords,
            u: screen.u_axis.vector(),
            v: screen.v_axis.vector(),
            normal: screen.normal().vector(),
            half_m: [0.5 * screen.width_m, 0.5 * screen.height_m],
        }
    }

    /// Middle of the image, robot frame.
    pub fn middle_m(&self) -> Point3<f64> {
        self.middle_m
    }

    /// Directions of growing u, of growing v and out of the glass, robot frame.
    pub fn axes(&self) -> [Vector3<f64>; 3] {
        [self.u, self.v, self.normal]
    }

    /// Direction out of the glass.
    pub fn normal(&self) -> &Vector3<f64> {
        &self.normal
    }

    /// Where a touch is seen along u and v from the middle of the image, and how high the model
    /// puts the fingertip over a glass that lies on a block of `raised_m`; m.
    pub fn touch_m(&self, tip: Point3<f64>, raised_m: f64, deviation: &Deviation) -> Vector3<f64> {
        let mut offset = tip - self.middle_m;
        if deviation.screen_m != Vector3::zeros() || deviation.screen_rad != Vector3::zeros() {
            let turned = UnitQuaternion::from_scaled_axis(deviation.screen_rad);
            offset = turned.inverse() * (offset - deviation.screen_m);
        }
        let (u_m, v_m) = (offset.dot(&self.u), offset.dot(&self.v));
        let [scale_u, scale_v] = deviation.screen_scale;
        let [bow_u, bow_v] = deviation.screen_bow_per_m;
        let glass_m = raised_m + bow_u * u_m * u_m + bow_v * v_m * v_m;
        let mut seen = [u_m / (1.0 + scale_u), v_m / (1.0 + scale_v)];
        if deviation.screen_edge_m != 0.0 {
            for (at_m, half_m) in seen.iter_mut().zip(self.half_m) {
                *at_m += deviation.screen_edge_m * toward_edge(*at_m, half_m);
            }
        }
        Vector3::new(seen[0], seen[1], offset.dot(&self.normal) - glass_m)
    }

    /// How that changes when the screen is moved rigidly: shift along and turn about u, v and the
    /// normal, one column each (m/m, m/rad).
    pub fn gauge(&self, tip: Point3<f64>) -> nalgebra::Matrix3x6<f64> {
        let axes = [self.u, self.v, self.normal];
        let lever = tip - self.middle_m;
        nalgebra::Matrix3x6::from_fn(|row, column| match column {
            0..3 => axes[column].dot(&axes[row]),
            _ => axes[column - 3].cross(&lever).dot(&axes[row]),
        })
    }
}

/// 1 at the upper border, −1 at the lower one, fading toward the middle.
fn toward_edge(at_m: f64, half_m: f64) -> f64 {
    // What lies outside of the panel is not touched; the model may put it there all the same.
    let fade = |from_m: f64| (-from_m.max(0.0) / EDGE_M).exp();
    fade(half_m - at_m) - fade(half_m + at_m)
}
