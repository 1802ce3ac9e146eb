//! Whether predicted intervals hold what they promise.

use nalgebra::DMatrix;
use plumbline_effects::Measurements;
use plumbline_effects::measurements::Observation;

use crate::compare::NORMAL_95;
use crate::floor::Floor;
use crate::search::Found;

/// Number of coordinates of a row inside of their predicted 95 % interval, and their number.
pub(super) fn inside_95(
    measurements: &Measurements,
    row: &Observation,
    floor: &Floor,
    found: &Found,
) -> Option<(usize, usize)> {
    let doubt = &found.doubt;
    let tangents = measurements.tangents(row, &found.assumed, &doubt.effects)?;
    let sd = &floor.of(row.what)?.sd;
    let own = tangents.effects.ncols();
    let gauge_at = own + 6 * row.session;
    let size = tangents.predicted.len();
    let mut spread = DMatrix::zeros(size, size);
    if doubt.covariance.ncols() >= gauge_at + 6 {
        let mut jacobian = DMatrix::zeros(size, doubt.covariance.ncols());
        jacobian.view_mut((0, 0), (size, own)).copy_from(&tangents.effects);
        jacobian.view_mut((0, gauge_at), (size, 6)).copy_from(&tangents.gauge);
        spread = &jacobian * &doubt.covariance * jacobian.transpose();
    }
    let inside = (0..size)
        .filter(|&c| {
            let noise = sd[c] * doubt.noise_scale;
            let dirt = sd[c] * doubt.dirt_sigmas;
            let sigma = (spread[(c, c)] + noise * noise + dirt * dirt).sqrt();
            (row.measured[c] - tangents.predicted[c]).abs() <= NORMAL_95 * sigma
        })
        .count();
    Some((inside, size))
}
