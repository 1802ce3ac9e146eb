//! What a turn of a joint does to the rows, in units of their noise, once frames are placed.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_effects::{Assumed, Effect, Kind};

use crate::beforehand::standard;
use crate::floor::Floor;

/// Rows that are asked.
const MOST_ROWS: usize = 120;
/// Of a gram matrix of frames, so that what rows do not tell of them does no harm.
const RIDGE: f64 = 1e-9;

/// How rows change with every joint.
pub(super) struct Levers<'a> {
    /// Rows that are asked.
    pub rows: Vec<&'a Observation>,
    /// One column per frame direction, whitened.
    frames: DMatrix<f64>,
    /// Per joint: whitened change of every line per radian.
    joints: Vec<DVector<f64>>,
    /// Row of each line.
    row_of: Vec<usize>,
    /// Per joint: how far a radian moves the tip, root mean square, m.
    pub tip_m: Vec<f64>,
}

impl<'a> Levers<'a> {
    pub fn of(
        measurements: &Measurements,
        rows: &[&'a Observation],
        floor: &Floor,
        assumed: &Assumed,
    ) -> Option<Self> {
        let session = rows.first()?.session;
        let arm = measurements.apparatuses[session].arm.as_ref()?;
        let zeros = Effect::sites(Kind::JointZero, Some(arm), None);
        let of_joint = |part: &plumbline_effects::Part| zeros.iter().find(|e| e.site == part.joint).cloned();
        let zeros: Vec<Effect> = arm.parts.iter().map(of_joint).collect::<Option<_>>()?;
        let typical = zeros.first()?.parameters()[0].typical;
        let nuisances = measurements.nuisances();
        let every = rows.len().div_ceil(MOST_ROWS).max(1);
        let rows: Vec<&Observation> = rows.iter().copied().step_by(every).collect();
        let (mut frames, mut joints, mut row_of) = (vec![], vec![vec![]; zeros.len()], vec![]);
        let mut square = vec![0.0; zeros.len()];
        for (i, row) in rows.iter().enumerate() {
            let (Some(tangents), Some(own)) =
                (measurements.tangents(row, assumed, &zeros), floor.of(row.what))
            else {
                continue;
            };
            for c in 0..row.measured.len() {
                let sd = standard(row.what, c, own.of_row(row, c));
                let of_frame = |nuisance| measurements.nuisance_slope(row, &tangents, c, nuisance) / sd;
                frames.extend(nuisances.iter().map(|nuisance| of_frame(*nuisance)));
                row_of.push(i);
                for (j, lines) in joints.iter_mut().enumerate() {
                    let slope = tangents.effects[(c, j)] / typical;
                    lines.push(slope / sd);
                    if c < 3 {
                        square[j] += slope * slope;
                    }
                }
            }
        }
        let lines = row_of.len();
        Some(Self {
            tip_m: square.iter().map(|square| (square / rows.len().max(1) as f64).sqrt()).collect(),
            rows,
            frames: DMatrix::from_row_slice(lines, nuisances.len(), &frames),
            joints: joints.into_iter().map(DVector::from_vec).collect(),
            row_of,
        })
    }

    /// Root mean square of what turns of joints do (rad, one per joint in a row), in units of the noise, less
    /// what frames that stand elsewhere would do as well.
    pub fn size(&self, turns_rad: impl Fn(&Observation) -> Vec<f64>) -> f64 {
        let lines = self.row_of.len();
        let turns: Vec<Vec<f64>> = self.rows.iter().map(|row| turns_rad(row)).collect();
        let moved = DVector::from_fn(lines, |line, _| {
            let turns = &turns[self.row_of[line]];
            self.joints.iter().zip(turns).map(|(slopes, turn)| slopes[line] * turn).sum::<f64>()
        });
        let mut gram = self.frames.tr_mul(&self.frames);
        for k in 0..gram.nrows() {
            gram[(k, k)] += RIDGE * (1.0 + gram[(k, k)]);
        }
        let toward = self.frames.tr_mul(&moved);
        let left = match Cholesky::new(gram) {
            Some(gram) if !toward.is_empty() => &moved - &self.frames * gram.solve(&toward),
            _ => moved,
        };
        (left.norm_squared() / lines.max(1) as f64).sqrt()
    }
}
