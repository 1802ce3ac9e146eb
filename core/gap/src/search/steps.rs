//! A joint that jumps where it passes an angle: what catches there is in no library.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;

use super::linear::Linear;

/// Of all angles between two poses so many of the likeliest are looked at. The others are not less probable for it
/// beforehand: each has its share of what a jump somewhere has.
const LOOKED_AT: usize = 5;
/// Angles (rad, m) closer than this are the same pose again.
const SAME_ANGLE: f64 = 5e-3;
/// So many poses on either side at least.
const FEWEST_BESIDE: usize = 4;
/// Fewer angles tell no jump.
const FEWEST: usize = 20;
/// Keeps columns that are alike from being solved for, share of the largest.
const RIDGE: f64 = 1e-9;

/// Columns of one where a joint is beyond the angle, times what its turn does (`base`, one per line), and how many angles
/// there are. Which are likeliest is seen beside frames and all that goes smoothly with the joint's own angle: its zero, its
/// ratio, an encoder off its axis.
pub(super) fn steps(
    measurements: &Measurements,
    linear: &Linear,
    base: &[f64],
    joint: usize,
) -> (Vec<Vec<f64>>, usize) {
    let angle = |row: usize| measurements.rows[row].angles_rad().get(joint).copied();
    let mut known: Vec<f64> = (0..measurements.rows.len()).filter_map(angle).collect();
    known.sort_by(f64::total_cmp);
    known.dedup_by(|a, b| (*a - *b).abs() < SAME_ANGLE);
    if known.len() < FEWEST {
        return (vec![], 0);
    }
    let edges: Vec<f64> = known[FEWEST_BESIDE - 1..=known.len() - FEWEST_BESIDE]
        .windows(2)
        .map(|pair| 0.5 * (pair[0] + pair[1]))
        .collect();
    let of_line = |line: usize| angle(linear.row[line]);
    let column = |edge: f64| -> Vec<f64> {
        let is_beyond = |line: usize| of_line(line).is_some_and(|angle| angle > edge);
        (0..base.len()).map(|line| if is_beyond(line) { base[line] } else { 0.0 }).collect()
    };
    let Some(smooth) = Smooth::of(linear, base, &of_line) else { return (vec![], 0) };
    let left = smooth.left_of(linear.lines.column(linear.lines.ncols() - 1).clone_owned());
    let mut tried: Vec<(f64, Vec<f64>)> = edges
        .iter()
        .map(|&edge| {
            let own = column(edge);
            let beside = smooth.left_of(DVector::from_column_slice(&own));
            let square = beside.norm_squared();
            (if square > 0.0 { beside.dot(&left).powi(2) / square } else { 0.0 }, own)
        })
        .collect();
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    tried.truncate(LOOKED_AT);
    (tried.into_iter().map(|(_, own)| own).collect(), edges.len())
}

/// What frames do and what goes smoothly with the angle of a joint.
struct Smooth {
    columns: DMatrix<f64>,
    normal: Cholesky<f64, nalgebra::Dyn>,
}

impl Smooth {
    fn of(linear: &Linear, base: &[f64], angle: &dyn Fn(usize) -> Option<f64>) -> Option<Self> {
        let laws: [fn(f64) -> f64; 4] = [|_| 1.0, |angle| angle, f64::sin, f64::cos];
        let gauge = linear.gauge;
        let columns =
            DMatrix::from_fn(base.len(), gauge + laws.len(), |line, k| match k.checked_sub(gauge) {
                None => linear.lines[(line, k)],
                Some(law) => base[line] * angle(line).map_or(0.0, laws[law]),
            });
        let mut normal = columns.tr_mul(&columns);
        let ridge = RIDGE * normal.diagonal().max();
        for k in 0..normal.ncols() {
            normal[(k, k)] += ridge;
        }
        Some(Self { normal: Cholesky::new(normal)?, columns })
    }

    /// What they leave of a column.
    fn left_of(&self, column: DVector<f64>) -> DVector<f64> {
        let fitted = &self.columns * self.normal.solve(&self.columns.tr_mul(&column));
        column - fitted
    }
}
