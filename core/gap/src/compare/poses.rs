//! Poses that are too much alike to tell what is wrong with an arm.

use nalgebra::{Matrix3, Vector3};
use plumbline_effects::Assumed;
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_model::decompose;

use crate::error::GapError;

/// Commands that differ by less in every joint are one pose, rad.
const ONE_POSE_RAD: f64 = 5e-3;
/// Encoders of one pose differ by less, however an arm comes there, rad.
const ENCODERS_RAD: f64 = 0.05;
/// Weights that differ by less are one, kg.
const ONE_WEIGHT_KG: f64 = 1e-3;
/// Poses lie in one plane when they scatter across it by less than this, m …
const FLAT_M: f64 = 2e-3;
/// … and by less than this share of how far they scatter along it.
const FLAT_SHARE: f64 = 0.05;
/// Fewer poses in one plane are few, not flat.
const FEWEST: usize = 12;

/// Stops where the arm stood in one pose all the time: wherever its tip was measured, a frame can be laid there.
///
/// # Errors
/// [`GapError::OnePose`].
pub fn stop_at_one_pose(measurements: &Measurements) -> Result<(), GapError> {
    let Some(first) = measurements.rows.first() else { return Ok(()) };
    let is_same = |row: &Observation| {
        row.what.is_placed()
            && (row.payload_kg - first.payload_kg).abs() < ONE_WEIGHT_KG
            && is_alike(sent_to(row), sent_to(first), ONE_POSE_RAD)
            && row.encoder_rad.as_deref().zip(first.encoder_rad.as_deref()).is_none_or(
                // An arm that was led by hand with its commands left as they were.
                |(row, first)| is_alike(row, first, ENCODERS_RAD),
            )
    };
    if measurements.rows.iter().all(is_same) {
        return Err(GapError::OnePose { rows: measurements.rows.len() });
    }
    Ok(())
}

fn is_alike(one: &[f64], other: &[f64], within_rad: f64) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < within_rad)
}

/// Where the joints were sent; where that was not logged, where they were.
fn sent_to(row: &Observation) -> &[f64] {
    row.commanded_rad.as_deref().unwrap_or_else(|| row.angles_rad())
}

/// Says when all poses that were measured from outside lie in one plane.
pub fn in_one_plane(measurements: &Measurements, rows: &[&Observation], said: &mut Vec<String>) {
    let assumed = Assumed::nominal(measurements);
    let places_m: Vec<Vector3<f64>> = rows
        .iter()
        .filter(|row| row.what.is_pose())
        .filter_map(|row| measurements.predict(row, &assumed))
        .filter_map(|place| Some(Vector3::from_column_slice(place.get(..3)?)))
        .collect();
    if places_m.len() < FEWEST {
        return;
    }
    let count = places_m.len() as f64;
    let middle = places_m.iter().sum::<Vector3<f64>>() / count;
    let scatter: Matrix3<f64> =
        places_m.iter().map(|place| (place - middle) * (place - middle).transpose()).sum::<Matrix3<f64>>()
            / count;
    let Some(squares) = decompose::symmetric_eigenvalues(scatter) else { return };
    let (across_m, along_m) = (squares.min().max(0.0).sqrt(), squares.max().max(0.0).sqrt());
    if across_m < FLAT_M && across_m < FLAT_SHARE * along_m {
        said.push(
            "all poses lie in one plane: what is wrong across it can hardly be told from a frame that stands elsewhere. \
             Measure some poses above and below that plane, too"
                .to_owned(),
        );
    }
}
