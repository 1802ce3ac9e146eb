//! Eyes that are not as warm as when they were calibrated have turned since, and places are as uncertain by that.
//!
//! Where nobody watched how they turn it is taken as it usually is: housings reach their temperature with one time
//! constant, and on the whole way from cold to warm an eye turns by what the library of effects has as usual for a
//! right eye that turns against the left one. That both turn together is allowed the same.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::StereoCameras;

use super::place::SeenUnder;
use super::unmeasured::{turned_sideways, typical};
use super::{Kind, RobotModel};

/// Housings of eyes reach their temperature with about this time constant, s: twenty minutes are 95 % of the way.
pub const WARMING_S: f64 = 402.0;

/// Share of the way from cold to warm after so long, s.
pub fn warm_share(on_s: f64) -> f64 {
    -(-on_s.max(0.0) / WARMING_S).exp_m1()
}

/// How far eyes usually have turned since they were calibrated, one standard deviation, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// The right one to the side, against the left one.
    pub apart_rad: f64,
    /// Both together, about each axis.
    pub together_rad: f64,
}

/// Between the rays of both eyes this is 4 mm of depth at 0.45 m.
const COUNTS_RAD: f64 = 0.0015;

impl Turned {
    /// Whether places are off by millimeters by it: worth a word.
    pub fn counts(&self) -> bool {
        self.apart_rad.max(self.together_rad) > COUNTS_RAD
    }

    /// Covariance (left camera, m²) of a place there (m), by what moves it along the ray and by what moves all that is
    /// seen alike.
    pub(super) fn covariances_m2(
        &self,
        cameras: &StereoCameras,
        in_left_m: &Vector3<f64>,
    ) -> [Matrix3<f64>; 2] {
        let by_depth_m = turned_sideways(self.apart_rad, cameras, in_left_m);
        let across = Matrix3::identity() * in_left_m.norm_squared() - in_left_m * in_left_m.transpose();
        [by_depth_m * by_depth_m.transpose(), across * self.together_rad.powi(2)]
    }
}

impl RobotModel {
    /// How far the eyes usually have turned since they were calibrated, or were seen to have. Nothing is usual where an
    /// effect in force says it, and where nobody knows how long they have been on, now or then.
    pub fn turned_since(&self, seen: &SeenUnder) -> Turned {
        let calibrated_at = &self.rig.eyes.calibrated_at;
        let usual = typical(Kind::EyeYaw, "yaw_rad");
        let since = |then_s: Option<f64>, is_corrected: bool| {
            let on_s = seen.t_secs.filter(|_| !is_corrected);
            let share = on_s.zip(then_s).map(|(on_s, then_s)| warm_share(on_s) - warm_share(then_s));
            share.map_or(0.0, |share| usual * share.abs())
        };
        let apart_rad = since(calibrated_at.cameras_s, self.has_growth_apart()).max(seen.apart_rad);
        Turned { apart_rad, together_rad: since(calibrated_at.mount_s, self.has_growth_of_eyes()) }
    }
}
