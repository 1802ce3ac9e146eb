//! What effects of the eyes leave of the rows that they were found in.
//!
//! A law of a few numbers fits a course of hundreds of looks so well that the covariance of its values is next to
//! nothing; what it cannot follow is larger. So that is kept with the effects, and is in the uncertainty of every
//! place: in the ray and the disparity, where it means the same wherever one looks.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What is left, in natural coordinates of the left eye: bearing right and down (tangents), baseline over depth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyesLeft {
    /// Mean of the products of what is left, row by row.
    covariance: [f64; 9],
}

impl EyesLeft {
    /// Of the mean of the products of what is left.
    pub fn new(covariance: &Matrix3<f64>) -> Self {
        Self { covariance: std::array::from_fn(|k| covariance[(k / 3, k % 3)]) }
    }

    /// Whether it can be; else why not.
    pub(super) fn check(&self) -> Result<(), String> {
        let own = [0, 4, 8].map(|k| self.covariance[k]);
        if self.covariance.iter().all(|number| number.is_finite()) && own.iter().all(|square| *square >= 0.0)
        {
            return Ok(());
        }
        let all = &self.covariance;
        Err(format!(
            "what its effects of the eyes leave cannot be ({all:?}): search the gap and add them again"
        ))
    }

    /// Covariance (m²) that it means at a place of the left camera (m), for eyes so far apart (m).
    pub(crate) fn covariance_m2(&self, in_left_m: &Vector3<f64>, baseline_m: f64) -> Matrix3<f64> {
        let depth_m = in_left_m.z;
        let along = in_left_m * (-depth_m / baseline_m);
        let slopes = Matrix3::from_columns(&[Vector3::x() * depth_m, Vector3::y() * depth_m, along]);
        slopes * Matrix3::from_row_slice(&self.covariance) * slopes.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_are_refused() {
        assert!(EyesLeft::new(&Matrix3::identity()).check().is_ok());
        assert!(EyesLeft::new(&Matrix3::from_element(f64::NAN)).check().is_err());
        assert!(EyesLeft::new(&-Matrix3::identity()).check().is_err());
    }
}
