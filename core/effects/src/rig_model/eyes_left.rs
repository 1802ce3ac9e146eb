//! What effects of the eyes leave of the rows that they were found in.
//!
//! A law of a few numbers fits a course of hundreds of looks so well that the covariance of its values is next to
//! nothing; what it cannot follow is larger. So that is kept with the effects, and is in the uncertainty of every
//! place: as angles of the rays, which mean the same wherever one looks.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What is left, one standard deviation of each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyesLeft {
    /// Of the direction in which something is seen, to the side and up or down, rad.
    pub bearing_rad: f64,
    /// Of the angle between the rays of both eyes, rad.
    pub disparity_rad: f64,
}

/// How much faster the tangent of a ray grows than its angle, with the tangents to the right and down.
pub(crate) fn tangents_per_angle(right: f64, down: f64) -> f64 {
    1.0 + right * right + down * down
}

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

    /// Covariance (m²) that it means at a place of the left camera (m), for eyes so far apart (m).
    pub(crate) fn covariance_m2(&self, in_left_m: &Vector3<f64>, baseline_m: f64) -> Matrix3<f64> {
        let depth_m = in_left_m.z;
        let tangents = tangents_per_angle(in_left_m.x / depth_m, in_left_m.y / depth_m);
        let [bearing, disparity] = [self.bearing_rad, self.disparity_rad].map(|rad| (rad * tangents).powi(2));
        // From bearings (tangents) and baseline over depth to a place.
        let along = in_left_m * (-depth_m / baseline_m);
        let slopes = Matrix3::from_columns(&[Vector3::x() * depth_m, Vector3::y() * depth_m, along]);
        slopes * Matrix3::from_diagonal(&Vector3::new(bearing, bearing, disparity)) * slopes.transpose()
    }
}

#[cfg(test)]
mod tests {
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
        let sigma_m = |at: Vector3<f64>| left.covariance_m2(&at, 0.07).trace().sqrt();
        let (near, far) = (sigma_m(Vector3::new(0.0, 0.0, 0.5)), sigma_m(Vector3::new(0.0, 0.0, 1.0)));
        // Along the line of sight: the square of the distance over the baseline.
        assert!((near - 0.25 * 0.001 / 0.07).abs() < 1e-4 && far > 3.5 * near, "{near} {far}");
        assert!(sigma_m(Vector3::new(0.4, 0.0, 0.5)) > 1.5 * near);
    }
}
