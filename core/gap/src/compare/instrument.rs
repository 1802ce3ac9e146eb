//! An instrument that is said to scatter more than its own measurements do: its figure is in another unit.

use plumbline_effects::measurements::{Measurements, What};

use crate::error::GapError;
use crate::statistics::median;

/// Twelve rows or more that scatter so many times less than their instrument's figure were not measured by it: by
/// chance their squares would not be a twenty-fifth of what they are on average.
const TOO_QUIET: f64 = 5.0;

/// Stops where the rows of a session, frames placed, lie nearer to the model than `sigma_m` lets them.
///
/// # Errors
/// [`GapError::WrongUnit`].
pub(super) fn check(measurements: &Measurements, residuals: &[Option<Vec<f64>>]) -> Result<(), GapError> {
    for (session, apparatus) in measurements.apparatuses.iter().enumerate() {
        let rows =
            measurements.rows.iter().zip(residuals).filter(|(row, _)| {
                row.session == session && matches!(row.what, What::Pose | What::OrientedPose)
            });
        let ratios: Vec<f64> = rows
            .filter_map(|(row, residual)| {
                let (sigma_m, residual) = (row.sigma_m?, residual.as_ref()?);
                Some(residual[..3].iter().map(|off| off * off).sum::<f64>().sqrt() / sigma_m)
            })
            .collect();
        let is_enough = ratios.len() >= super::FEWEST_ROWS;
        // Half of all lengths of three coordinates are shorter than 1.54 standard deviations of one.
        let Some(usual) = median(ratios.iter().copied()).filter(|_| is_enough) else { continue };
        if usual < 1.54 / TOO_QUIET {
            return Err(GapError::WrongUnit {
                session: apparatus.title.clone(),
                column: "sigma_m".to_owned(),
                seems: "millimeters".to_owned(),
                factor: 1000.0,
            });
        }
    }
    Ok(())
}
