//! A column in a wrong unit. Everything that follows would be nonsense, so it stops here, and says
//! which column and which unit.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_effects::{Assumed, EyesDeviation};
use plumbline_model::JobContext;
use plumbline_model::decompose;

use super::{frames, turns};
use crate::error::GapError;
use crate::statistics::{median, robust_sd};

/// Degrees in a radian.
const DEGREES: f64 = 57.295_779_513_082_32;
/// How far the ratio of measured and predicted may lie from a unit's factor.
const NEAR: f64 = 1.2;
/// No joint of an arm is found beyond this, rad.
const FARTHEST_JOINT_RAD: f64 = 2.0 * std::f64::consts::PI;
/// A block under the screen is lower, m; a weight in the hand is lighter, kg.
const HIGHEST_BLOCK_M: f64 = 2.0;
const HEAVIEST_KG: f64 = 20.0;
/// Directions in which predictions spread less than this share of the widest say nothing.
const THIN: f64 = 0.15;
/// Frames placed, a model of the right unit is not off by more, m. Below it no unit is suspected
/// of angles that are possible in both.
const GROSS_M: f64 = 0.04;
/// What is off by more than this, frames placed and in whatever unit, is another robot, m.
const ANOTHER_ROBOT_M: f64 = 0.3;
/// The right unit makes residuals smaller at least by this.
const CLEARLY: f64 = 5.0;

/// Stops where a column is in another unit than its name says.
///
/// # Errors
/// [`GapError::WrongUnit`], or cancelled.
pub fn check(measurements: &Measurements, context: &dyn JobContext) -> Result<(), GapError> {
    for session in 0..measurements.apparatuses.len() {
        let rows: Vec<&Observation> = measurements.rows.iter().filter(|row| row.session == session).collect();
        conditions(measurements, session, &rows)?;
        angles_by_size(measurements, session, &rows)?;
        places(measurements, session, &rows)?;
        context.checkpoint()?;
        lengths(measurements, session, &rows)?;
        angles_by_fit(measurements, session, context)?;
    }
    Ok(())
}

fn wrong(measurements: &Measurements, session: usize, column: String, seems: &str, factor: f64) -> GapError {
    let session = measurements.apparatuses[session].title.clone();
    GapError::WrongUnit { session, column, seems: seems.to_owned(), factor }
}

/// Heights and weights.
fn conditions(measurements: &Measurements, session: usize, rows: &[&Observation]) -> Result<(), GapError> {
    let largest =
        |value: fn(&Observation) -> f64| rows.iter().map(|row| value(row).abs()).fold(0.0, f64::max);
    let height = largest(|row| row.screen_height_m);
    if height > HIGHEST_BLOCK_M {
        return Err(wrong(measurements, session, "screen_height_m".to_owned(), "millimeters", 1000.0));
    }
    if largest(|row| row.payload_kg) > HEAVIEST_KG {
        return Err(wrong(measurements, session, "payload_kg".to_owned(), "grams", 1000.0));
    }
    Ok(())
}

/// Angles that no joint can have.
fn angles_by_size(
    measurements: &Measurements,
    session: usize,
    rows: &[&Observation],
) -> Result<(), GapError> {
    let Some(arm) = &measurements.apparatuses[session].arm else { return Ok(()) };
    for (j, part) in arm.parts.iter().enumerate() {
        let (unit, factor) = if part.slides { ("millimeters", 1000.0) } else { ("degrees", DEGREES) };
        for (prefix, is_encoder) in [("cmd", false), ("enc", true)] {
            let angles: Vec<f64> = rows
                .iter()
                .filter_map(
                    |row| if is_encoder { row.encoder_rad.as_ref() } else { row.commanded_rad.as_ref() },
                )
                .map(|angles| angles[j].abs())
                .collect();
            let beyond = angles.iter().filter(|angle| **angle > FARTHEST_JOINT_RAD).count();
            if beyond > angles.len() / 10 {
                return Err(wrong(measurements, session, part.column(prefix), unit, factor));
            }
        }
        let commanded = spread(rows, |row| row.commanded_rad.as_ref().map(|angles| angles[j]));
        let encoder = spread(rows, |row| row.encoder_rad.as_ref().map(|angles| angles[j]));
        let (Some(commanded), Some(encoder)) = (commanded, encoder) else { continue };
        for (column, ratio) in [("enc", encoder / commanded), ("cmd", commanded / encoder)] {
            if near(ratio, factor) && commanded.max(encoder) > 0.5 {
                return Err(wrong(measurements, session, part.column(column), unit, factor));
            }
        }
    }
    Ok(())
}

/// Robust spread of a column over rows that have it.
fn spread(rows: &[&Observation], value: impl Fn(&Observation) -> Option<f64>) -> Option<f64> {
    let values: Vec<f64> = rows.iter().filter_map(|row| value(row)).collect();
    let middle = median(values.iter().copied())?;
    Some(robust_sd(values.iter().map(|value| value - middle))).filter(|spread| *spread > 0.0)
}

fn near(ratio: f64, factor: f64) -> bool {
    ratio / factor < NEAR && factor / ratio < NEAR
}

/// Units of length by their factor against a meter.
fn length_of(ratio: f64) -> Option<(&'static str, f64)> {
    let units = [("millimeters", 1000.0), ("centimeters", 100.0)];
    units.into_iter().find(|(_, factor)| near(ratio, *factor))
}

/// What the eyes estimated against the known places.
fn places(measurements: &Measurements, session: usize, rows: &[&Observation]) -> Result<(), GapError> {
    let Some(eyes) = &measurements.apparatuses[session].eyes else { return Ok(()) };
    let nominal = EyesDeviation::none(eyes.neck.len());
    let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = rows
        .iter()
        .filter_map(|row| {
            let in_left = match row.what {
                What::Place => eyes.place(&row.measured)?,
                What::EyePoints => {
                    let [left_u, left_v, right_u, right_v] = *row.measured.first_chunk::<4>()?;
                    let left = plumbline_model::Pixel::new(left_u, left_v);
                    eyes.cameras.triangulate(left, plumbline_model::Pixel::new(right_u, right_v))?.coords
                }
                _ => return None,
            };
            let estimate = eyes.robot_from_left(&row.neck_rad, &nominal) * in_left;
            Some((estimate.coords, row.truth_m?.coords))
        })
        .collect();
    if pairs.len() < 6 {
        return Ok(());
    }
    let are_estimates = rows.iter().any(|row| row.what == What::Place);
    let whole =
        median(pairs.iter().map(|(estimate, truth)| estimate.norm() / truth.norm().max(1e-9))).unwrap_or(1.0);
    if let Some((unit, factor)) = length_of(whole).filter(|_| are_estimates) {
        return Err(wrong(measurements, session, "est_x_m, est_y_m, est_z_m".to_owned(), unit, factor));
    }
    if let Some((unit, factor)) = length_of(1.0 / whole) {
        return Err(wrong(measurements, session, "true_x_m, true_y_m, true_z_m".to_owned(), unit, factor));
    }
    for c in 0..3 {
        let estimate = median(pairs.iter().map(|(estimate, _)| estimate[c].abs())).unwrap_or(0.0);
        let truth = median(pairs.iter().map(|(_, truth)| truth[c].abs())).unwrap_or(0.0);
        if estimate.max(truth) < 1.5 || estimate.min(truth) < 1e-6 {
            continue;
        }
        let axis = ["x", "y", "z"][c];
        if let Some((unit, factor)) = length_of(estimate / truth).filter(|_| are_estimates) {
            return Err(wrong(measurements, session, format!("est_{axis}_m"), unit, factor));
        }
        if let Some((unit, factor)) = length_of(truth / estimate) {
            return Err(wrong(measurements, session, format!("true_{axis}_m"), unit, factor));
        }
    }
    Ok(())
}

/// Measured lengths of touches and poses: regressed on the prediction, a coordinate of any rigid
/// frame has a gradient of length one.
fn lengths(measurements: &Measurements, session: usize, rows: &[&Observation]) -> Result<(), GapError> {
    for (what, columns) in [
        (What::Touch, &["the touchscreen's width_m", "the touchscreen's height_m"][..]),
        (What::Pose, &["meas_x_m", "meas_y_m", "meas_z_m"][..]),
        (What::OrientedPose, &["meas_x_m", "meas_y_m", "meas_z_m"][..]),
    ] {
        let assumed = Assumed::nominal(measurements);
        let (mut predicted, mut measured) = (vec![], vec![]);
        for row in rows.iter().filter(|row| row.what == what) {
            if let Some(prediction) = measurements.predict(row, &assumed) {
                predicted.push(prediction);
                measured.push(row.measured.clone());
            }
        }
        if predicted.len() < 12 {
            continue;
        }
        let gradients: Vec<Option<f64>> = (0..columns.len())
            .map(|c| gradient(&predicted, &measured.iter().map(|row| row[c]).collect::<Vec<_>>()))
            .collect();
        let units: Vec<Option<(&str, f64)>> = gradients.iter().map(|g| g.and_then(length_of)).collect();
        let Some((unit, factor)) = units.iter().flatten().next().copied() else { continue };
        let named: Vec<&str> =
            columns.iter().zip(&units).filter(|(_, own)| own.is_some()).map(|(name, _)| *name).collect();
        return Err(wrong(measurements, session, named.join(", "), unit, factor));
    }
    Ok(())
}

/// Length of the gradient of a measured coordinate over the predicted place, by robust regression
/// along the directions in which predictions spread; `None` where they say little of it.
fn gradient(predicted: &[Vec<f64>], measured: &[f64]) -> Option<f64> {
    let count = predicted.len();
    let mut weights = DVector::from_element(count, 1.0);
    let mut found = None;
    for _ in 0..15 {
        let whole = weights.sum();
        let mean =
            |value: &dyn Fn(usize) -> f64| (0..count).map(|i| weights[i] * value(i)).sum::<f64>() / whole;
        let middle: [f64; 3] = std::array::from_fn(|c| mean(&|i| predicted[i][c]));
        let level = mean(&|i| measured[i]);
        let root = |i: usize| weights[i].sqrt();
        let columns = DMatrix::from_fn(count, 3, |i, c| root(i) * (predicted[i][c] - middle[c]));
        let values = DVector::from_fn(count, |i, _| root(i) * (measured[i] - level));
        let svd = decompose::svd(columns, true, true)?;
        // Touches lie on a plane: across it the prediction says nothing.
        let thin = THIN * svd.singular_values.max();
        let solution = svd.solve(&values, thin).ok()?;
        let left = DVector::from_fn(count, |i, _| {
            let along: f64 = (0..3).map(|c| solution[c] * (predicted[i][c] - middle[c])).sum();
            measured[i] - level - along
        });
        let scale = robust_sd(left.iter().copied()).max(1e-9);
        weights = left.map(|value| 1.0 / (value / scale).abs().max(1.0));
        found = Some((solution.norm(), scale));
    }
    let (length, left) = found?;
    let middle = median(measured.iter().copied())?;
    let whole = robust_sd(measured.iter().map(|value| value - middle));
    (left < 0.5 * whole).then_some(length)
}

/// Angles that are possible in both units: the one that fits.
fn angles_by_fit(
    measurements: &Measurements,
    session: usize,
    context: &dyn JobContext,
) -> Result<(), GapError> {
    let Some(arm) = &measurements.apparatuses[session].arm else { return Ok(()) };
    let only = measurements.only((0..measurements.rows.len()).filter(|&i| {
        let row = &measurements.rows[i];
        row.session == session && row.what.is_placed()
    }));
    if only.rows.len() < 12 {
        return Ok(());
    }
    let off = typical_miss(&only, context)?;
    if off < GROSS_M {
        return turns::check(measurements, session, context);
    }
    for (j, part) in arm.parts.iter().enumerate() {
        for factor in if part.slides { [1000.0, 100.0] } else { [DEGREES, 1.0 / DEGREES] } {
            let mut other = only.clone();
            for row in &mut other.rows {
                for angles in [&mut row.commanded_rad, &mut row.encoder_rad].into_iter().flatten() {
                    angles[j] /= factor;
                }
            }
            let largest = other.rows.iter().map(|row| row.angles_rad()[j].abs()).fold(0.0, f64::max);
            if largest < FARTHEST_JOINT_RAD && CLEARLY * typical_miss(&other, context)? < off {
                let prefix =
                    if only.rows.iter().any(|row| row.encoder_rad.is_some()) { "enc" } else { "cmd" };
                let seems = match length_of(factor).filter(|_| part.slides) {
                    Some((unit, _)) => unit,
                    None if factor > 1.0 => "degrees",
                    None => "converted to radians twice",
                };
                return Err(wrong(measurements, session, part.column(prefix), seems, factor));
            }
        }
    }
    turns::check(measurements, session, context)?;
    if off > ANOTHER_ROBOT_M {
        let session = measurements.apparatuses[session].title.clone();
        return Err(GapError::AnotherRobot { session, off_m: off });
    }
    Ok(())
}

/// Median length of the residual, frames placed, m.
fn typical_miss(measurements: &Measurements, context: &dyn JobContext) -> Result<f64, GapError> {
    let rows: Vec<usize> = (0..measurements.rows.len()).collect();
    let assumed = frames::placed(measurements, &rows, context)?;
    let misses = measurements.rows.iter().filter_map(|row| {
        let predicted = measurements.predict(row, &assumed)?;
        Some(row.measured.iter().zip(&predicted).take(3).map(|(m, p)| (m - p).powi(2)).sum::<f64>().sqrt())
    });
    Ok(median(misses).unwrap_or(0.0))
}
