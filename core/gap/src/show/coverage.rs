//! Whether predicted intervals hold what they promise.

use nalgebra::DMatrix;
use plumbline_effects::Measurements;
use plumbline_effects::measurements::Observation;

use crate::compare::NORMAL_95;
use crate::search::Found;

/// Number of coordinates of a row inside of their predicted 95 % interval, and their number.
pub(super) fn inside_95(
    measurements: &Measurements,
    row: &Observation,
    found: &Found,
) -> Option<(usize, usize)> {
    let doubt = &found.doubt;
    let tangents = measurements.tangents(row, &found.assumed, &doubt.effects)?;
    let floor = found.floor.of(row.what)?;
    let own = tangents.effects.ncols();
    let size = tangents.predicted.len();
    let mut spread = DMatrix::zeros(size, size);
    if doubt.covariance.ncols() == own + doubt.nuisances.len() {
        let mut jacobian = DMatrix::zeros(size, doubt.covariance.ncols());
        jacobian.view_mut((0, 0), (size, own)).copy_from(&tangents.effects);
        for (k, nuisance) in doubt.nuisances.iter().enumerate() {
            for c in 0..size {
                jacobian[(c, own + k)] = measurements.nuisance_slope(row, &tangents, c, *nuisance);
            }
        }
        spread = &jacobian * &doubt.covariance * jacobian.transpose();
    }
    let inside = (0..size)
        .filter(|&c| {
            let noise = floor.of_row(row, c) * doubt.noise_scale;
            let dirt = floor.of_row(row, c) * doubt.dirt_sigmas;
            let sigma = (spread[(c, c)] + noise * noise + dirt * dirt).sqrt();
            (row.measured[c] - tangents.predicted[c]).abs() <= NORMAL_95 * sigma
        })
        .count();
    Some((inside, size))
}
