//! What effects of the eyes leave of the rows that they were found in.
//!
//! A law of a few numbers fits a course of hundreds of looks so well that the covariance of its values is next to
//! nothing; what it cannot follow is larger. So that is kept with the effects, and is in the uncertainty of every
//! place: as angles of the rays, which mean the same wherever one looks.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::StereoCameras;
use serde::{Deserialize, Serialize};

use crate::eyes::{natural, place, right_in_left_m};

/// What is left, one standard deviation of each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyesLeft {
    /// Of the direction in which something is seen, to the side and up or down, rad.
    pub bearing_rad: f64,
    /// Of the angle between the rays of both eyes, rad.
    pub disparity_rad: f64,
}

/// Angles are moved by this share of that between the rays to see how a place moves with them.
const STEP: f64 = 1e-4;

impl EyesLeft {
    /// Whether it can be; else why not.
    pub(super) fn check(&self) -> Result<(), String> {
        // No eye is off by half a turn, and NaN is none of these.
        let can_be = |angle_rad: f64| (0.0..=1.5).contains(&angle_rad);
        if can_be(self.bearing_rad) && can_be(self.disparity_rad) {
            return Ok(());
        }
        Err(format!(
            "what its effects of the eyes leave cannot be ({} and {} rad): search the gap and add them again",
            self.bearing_rad, self.disparity_rad
        ))
    }

    /// Covariance (m²) that it means at a place of the left camera (m) that both eyes of these cameras see.
    pub(crate) fn covariance_m2(&self, in_left_m: &Vector3<f64>, cameras: &StereoCameras) -> Matrix3<f64> {
        let to_right = right_in_left_m(cameras);
        let seen = natural(in_left_m, &to_right);
        let step_rad = STEP * seen[2];
        let moved = |k: usize, by_rad: f64| {
            let mut angles = seen;
            angles[k] += by_rad;
            place(angles, &to_right)
        };
        let per_rad = |k: usize| {
            let (ahead, behind) = (moved(k, step_rad)?, moved(k, -step_rad)?);
            Some((ahead - behind) / (2.0 * step_rad))
        };
        let each = [self.bearing_rad, self.bearing_rad, self.disparity_rad].into_iter().enumerate();
        // Where rays are next to parallel nothing is known of a place.
        let unknown = Matrix3::identity() * in_left_m.norm_squared();
        each.map(|(k, sd_rad)| {
            per_rad(k).map_or(unknown, |per_rad| per_rad * per_rad.transpose() * sd_rad.powi(2))
        })
        .sum()
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn numbers_that_are_none_are_refused() {
        let left = |bearing_rad, disparity_rad| EyesLeft { bearing_rad, disparity_rad };
        assert!(left(0.001, 0.0).check().is_ok());
        assert!(left(f64::NAN, 0.0).check().is_err());
        assert!(left(0.0, -0.001).check().is_err());
    }

    #[test]
    fn an_angle_means_more_the_farther_away_and_the_farther_to_the_side() {
        let left = EyesLeft { bearing_rad: 0.001, disparity_rad: 0.001 };
        let cameras = Rig::built_in("nico").expect("comes along").eyes.cameras;
        let baseline_m = cameras.baseline_m();
        let sigma_m = |at: Vector3<f64>| left.covariance_m2(&at, &cameras).trace().sqrt();
        let (near, far) = (sigma_m(Vector3::new(0.0, 0.0, 0.5)), sigma_m(Vector3::new(0.0, 0.0, 1.0)));
        // Along the line of sight: the square of the distance over the baseline; bearings and the baseline, which is no more
        // than a seventh of the distance, add a twentieth.
        assert!((near - 0.25 * 0.001 / baseline_m).abs() < 0.05 * near && far > 3.5 * near, "{near} {far}");
        assert!(sigma_m(Vector3::new(0.4, 0.0, 0.5)) > 1.5 * near);
    }

    #[test]
    fn a_covariance_is_how_places_spread_whose_angles_do() {
        let left = EyesLeft { bearing_rad: 2e-4, disparity_rad: 1e-4 };
        let cameras = Rig::built_in("nico").expect("comes along").eyes.cameras;
        let to_right = right_in_left_m(&cameras);
        // In the middle, and far off the axis, where a tangent is no angle any more.
        for at in [Vector3::new(0.02, 0.05, 0.5), Vector3::new(0.5, 0.3, 0.35)] {
            let seen = natural(&at, &to_right);
            let said = left.covariance_m2(&at, &cameras);
            let mut spread = Matrix3::zeros();
            // Both ends of each angle by itself: a design whose spread is exact where places move in proportion.
            for (k, sd) in [left.bearing_rad, left.bearing_rad, left.disparity_rad].into_iter().enumerate() {
                for end in [-1.0, 1.0] {
                    let mut angles = seen;
                    angles[k] += end * sd;
                    let off = place(angles, &to_right).expect("they meet") - at;
                    spread += 0.5 * off * off.transpose();
                }
            }
            assert!((said - spread).norm() < 0.01 * spread.norm(), "{said} {spread}");
        }
    }
}
