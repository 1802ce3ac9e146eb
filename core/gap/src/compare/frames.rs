//! Where the screen or the external device of each session stands, and where markers sit that were
//! mounted anew, by the rows themselves.
//!
//! Rows outside of what most of them agree on must not turn the frame: first the sum of absolute
//! residuals is made small, then Tukey's biweight with a wide corner.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3,
};
use plumbline_effects::Assumed;
use plumbline_effects::Nuisance;
use plumbline_effects::measurements::Measurements;
use plumbline_model::JobContext;
use plumbline_model::decompose;
use rayon::prelude::*;

use crate::error::GapError;
use crate::statistics::robust_sd;

/// Relinearizations at most; a frame that lies near its nominal place needs two.
const ROUNDS: usize = 12;
/// Reweighted solutions of one linearization.
const REWEIGHTED: usize = 12;
/// Corner of the biweight, in robust standard deviations. Wide: what effects do must stay in.
const BIWEIGHT: f64 = 8.0;
/// A frame that rows do not hold (all on a line, say) stays where it is nominally, within this: m
/// and rad.
const LOOSE: f64 = 3.0;
/// A turn by more than this in one step would leave the linear range, rad.
const FURTHEST_TURN_RAD: f64 = 0.5;

/// Residuals of some rows and how they change with what is free.
struct Linear {
    residual: Vec<f64>,
    gauge: DMatrix<f64>,
}

/// The nominal model with every frame, and every marker that was mounted anew, where the chosen rows put
/// it. A session without any of these rows keeps its frame, unless it shares it.
///
/// # Errors
/// Cancelled.
pub fn placed(
    measurements: &Measurements,
    rows: &[usize],
    context: &dyn JobContext,
) -> Result<Assumed, GapError> {
    let mut assumed = Assumed::nominal(measurements);
    let all = measurements.only(rows.iter().copied()).nuisances();
    for leader in 0..measurements.apparatuses.len() {
        let shares = |session: usize| measurements.frame_of(session) == leader;
        let own: Vec<usize> = rows
            .iter()
            .copied()
            .filter(|&i| shares(measurements.rows[i].session) && measurements.rows[i].what.is_placed())
            .collect();
        if own.is_empty() {
            continue;
        }
        if let Some(start) = aligned(measurements, &own, &assumed) {
            let sharing = (0..measurements.apparatuses.len()).filter(|&session| shares(session));
            sharing.for_each(|session| assumed.placements[session] = start);
        }
        let free: Vec<Nuisance> = all
            .iter()
            .copied()
            .filter(|nuisance| match *nuisance {
                Nuisance::Frame { session, .. } => session == leader,
                Nuisance::Mount { session, .. } => shares(session),
                Nuisance::Offset { .. } => false,
            })
            .collect();
        turn_mounts(measurements, &own, &free, &mut assumed);
        settle(measurements, &free, &own, &mut assumed, context)?;
    }
    let stands: Vec<Nuisance> =
        all.iter().copied().filter(|nuisance| matches!(nuisance, Nuisance::Offset { .. })).collect();
    if !stands.is_empty() {
        let own: Vec<usize> =
            rows.iter().copied().filter(|&i| measurements.rows[i].stand.is_some()).collect();
        settle(measurements, &stands, &own, &mut assumed, context)?;
    }
    Ok(assumed)
}

/// A marker can be turned in any way: the mean turn between tip and measured orientation, as a start.
fn turn_mounts(measurements: &Measurements, rows: &[usize], free: &[Nuisance], assumed: &mut Assumed) {
    for nuisance in free {
        let Nuisance::Mount { session, axis: 3 } = *nuisance else { continue };
        let own = rows.iter().map(|&i| &measurements.rows[i]);
        let own = own.filter(|row| row.session == session && row.marker == 0);
        let turns = own.filter_map(|row| {
            let tip = measurements.external_from_tip(row, assumed)?;
            Some(tip.rotation.inverse() * row.orientation?)
        });
        let sum: Matrix3<f64> = turns.map(|turn| turn.to_rotation_matrix().into_inner()).sum();
        let Some(svd) = decompose::svd(sum, true, true) else { continue };
        let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { continue };
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
        let turn = Rotation3::from_matrix_unchecked(u * mirror * v_t);
        let mount =
            Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_rotation_matrix(&turn));
        assumed.set_mount(session, mount);
    }
}

/// An external frame can lie anywhere: least squares of the two point sets (Kabsch), as a start.
fn aligned(measurements: &Measurements, rows: &[usize], assumed: &Assumed) -> Option<Isometry3<f64>> {
    let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = rows
        .iter()
        .map(|&i| &measurements.rows[i])
        .filter(|row| row.what.is_pose())
        .filter_map(|row| {
            let tip = measurements.predict(row, assumed)?;
            Some((Vector3::from_row_slice(&tip[..3]), Vector3::from_row_slice(&row.measured[..3])))
        })
        .collect();
    if pairs.len() < 4 {
        return None;
    }
    // Medians of absolute distances find the rows that agree; three rounds leave the others out.
    let mut kept: Vec<bool> = vec![true; pairs.len()];
    let mut found = None;
    for _ in 0..6 {
        let chosen: Vec<_> =
            pairs.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(pair, _)| *pair).collect();
        let place = kabsch(&chosen)?;
        let miss: Vec<f64> =
            pairs.iter().map(|(from, to)| (place * Point3::from(*from) - Point3::from(*to)).norm()).collect();
        let mut sorted = miss.clone();
        sorted.sort_by(f64::total_cmp);
        let limit = (3.0 * sorted[sorted.len() / 2]).max(sorted[sorted.len() * 6 / 10]);
        kept = miss.iter().map(|miss| *miss <= limit).collect();
        found = Some(place);
    }
    found
}

fn kabsch(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Isometry3<f64>> {
    let count = pairs.len() as f64;
    let from = pairs.iter().map(|(from, _)| from).sum::<Vector3<f64>>() / count;
    let to = pairs.iter().map(|(_, to)| to).sum::<Vector3<f64>>() / count;
    let spread: Matrix3<f64> = pairs.iter().map(|(a, b)| (b - to) * (a - from).transpose()).sum();
    let svd = decompose::svd(spread, true, true)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(u * mirror * v_t));
    let shift = to - turn * from;
    shift
        .iter()
        .all(|value| value.is_finite())
        .then(|| Isometry3::from_parts(Translation3::from(shift), turn))
}

fn settle(
    measurements: &Measurements,
    free: &[Nuisance],
    rows: &[usize],
    assumed: &mut Assumed,
    context: &dyn JobContext,
) -> Result<(), GapError> {
    for _ in 0..ROUNDS {
        context.checkpoint()?;
        let linear: Vec<Linear> = rows
            .par_iter()
            .filter_map(|&i| {
                let row = &measurements.rows[i];
                let tangents = measurements.tangents(row, assumed, &[])?;
                let residual = row.measured.iter().zip(&tangents.predicted).map(|(m, p)| m - p).collect();
                let gauge = DMatrix::from_fn(row.measured.len(), free.len(), |c, k| {
                    measurements.nuisance_slope(row, &tangents, c, free[k])
                });
                Some(Linear { residual, gauge })
            })
            .collect();
        let Some(step) = reweighted(&linear, free, assumed) else { return Ok(()) };
        measurements.move_nuisances(assumed, free, step.as_slice(), FURTHEST_TURN_RAD);
        if step.norm() < 1e-7 {
            break;
        }
    }
    Ok(())
}

/// The step of what is free that makes residuals robustly small.
fn reweighted(linear: &[Linear], free: &[Nuisance], assumed: &Assumed) -> Option<DVector<f64>> {
    let size = linear.iter().map(|row| row.residual.len()).max()?;
    let count = free.len();
    let precision = DVector::from_iterator(
        count,
        free.iter().map(|nuisance| match nuisance {
            Nuisance::Frame { .. } => LOOSE.powi(-2),
            Nuisance::Mount { .. } | Nuisance::Offset { .. } => nuisance.prior_sd().powi(-2),
        }),
    );
    let stands = DVector::from_iterator(count, free.iter().map(|nuisance| nuisance.value(assumed)));
    let mut step = DVector::zeros(count);
    for round in 0..REWEIGHTED {
        let left: Vec<DVector<f64>> =
            linear.iter().map(|row| DVector::from_column_slice(&row.residual) - &row.gauge * &step).collect();
        let scales: Vec<f64> = (0..size)
            .map(|c| robust_sd(left.iter().filter_map(|left| left.get(c).copied())).max(1e-5))
            .collect();
        // Prior precision is that of lengths and turns themselves: worth nothing beside many rows.
        let mut normal = DMatrix::from_diagonal(&precision);
        let mut right = -(&stands + &step).component_mul(&precision);
        for (row, left) in linear.iter().zip(&left) {
            let off = left.iter().zip(&scales).map(|(left, scale)| (left / scale).abs()).fold(0.0, f64::max);
            let weight = if round < REWEIGHTED / 2 {
                1.0 / off.max(1.0)
            } else {
                (1.0 - (off / BIWEIGHT).powi(2)).max(0.0).powi(2)
            };
            if weight == 0.0 {
                continue;
            }
            let inverse = DMatrix::from_diagonal(&DVector::from_iterator(
                left.len(),
                scales.iter().take(left.len()).map(|scale| weight / (scale * scale)),
            ));
            let weighted = row.gauge.transpose() * inverse;
            normal += &weighted * &row.gauge;
            right += &weighted * left;
        }
        step += normal.cholesky()?.solve(&right);
    }
    Some(step)
}
