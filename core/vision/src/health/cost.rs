//! What a turn of an eye costs where the robot works.

use nalgebra::Vector3;
use plumbline_model::{LeftCamera, Point, StereoCameras, decompose};

use super::turn::{Turn, turned};

/// Error of places that a calibration makes because an eye has turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Mean over the places, m.
    pub error_m: f64,
    /// Its standard deviation, m.
    pub sigma_m: f64,
}

/// How far off a calibration puts these places, its right eye having turned; `None`: an eye does not see any
/// of them.
pub fn cost(cameras: &StereoCameras, turn: &Turn, places: &[Point<LeftCamera>]) -> Option<Cost> {
    let error_m = mean_error_m(cameras, &turn.rotation_rad, places)?;
    // The turn's uncertainty carried along its three main directions.
    let axes = decompose::symmetric_eigen(turn.covariance_rad2)?;
    let mut variance_m2 = 0.0;
    for (k, variance_rad2) in axes.eigenvalues.iter().enumerate() {
        let axis: Vector3<f64> = axes.eigenvectors.column(k).into();
        let there = turn.rotation_rad + axis * variance_rad2.max(0.0).sqrt();
        let shift_m = mean_shift_m(cameras, &turn.rotation_rad, &there, places)?;
        variance_m2 += shift_m.powi(2);
    }
    Some(Cost { error_m, sigma_m: variance_m2.sqrt() })
}

fn mean_error_m(cameras: &StereoCameras, turn: &Vector3<f64>, places: &[Point<LeftCamera>]) -> Option<f64> {
    mean_shift_m(cameras, &Vector3::zeros(), turn, places)
}

/// How far apart a calibration puts the same places after two turns, in the mean.
fn mean_shift_m(
    cameras: &StereoCameras,
    first: &Vector3<f64>,
    second: &Vector3<f64>,
    places: &[Point<LeftCamera>],
) -> Option<f64> {
    let put = |turn: &Vector3<f64>, place: &Point<LeftCamera>| {
        let eyes = turned(cameras, turn);
        let left = eyes.left.project(&place.coords.coords).ok()?;
        let right = eyes.right.project(&(eyes.right_from_left.isometry * place.coords).coords).ok()?;
        cameras.triangulate(left, right)
    };
    let shift =
        |place: &Point<LeftCamera>| Some((put(first, place)?.coords - put(second, place)?.coords).norm());
    let shifts: Vec<f64> = places.iter().filter_map(shift).collect();
    (!shifts.is_empty()).then(|| shifts.iter().sum::<f64>() / shifts.len() as f64)
}
