//! When a thing that was watched was somewhere else at once.

use nalgebra::{Cholesky, DMatrix, DVector, Rotation3, Vector3};
use plumbline_effects::Measurements;

use crate::seen::{nominal_in_left_m, nominal_place_m};
use crate::statistics::f_tail;

/// Rows before and after a jump.
const LEAST_ROWS: usize = 3;
/// Time constants of the courses that are no jump, s.
const COURSES_S: [f64; 3] = [100.0, 400.0, 1600.0];
/// What may be found by chance is spent on: the usual course along the line of sight and across it, and any course.
const USUAL_COURSE: [f64; 3] = [0.6, 0.1, 0.1];
const ANY_COURSE: [f64; 3] = [0.1, 0.05, 0.05];
/// A jump counts from this probability by chance on …
const SIGNIFICANT: f64 = 1e-4;
/// … and from this size on, in what it leaves.
const LEAST_SIGMAS: f64 = 5.0;
/// What a fit leaves is no finer than this, m.
const LEAST_M: f64 = 1e-5;
/// At most so many.
const MOST: usize = 3;

/// A jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jump {
    /// Times of the rows before and after it, s.
    pub between_s: [f64; 2],
    /// How far, m.
    pub by_m: f64,
}

/// Jumps of the place of a thing whose rows come in the order of time.
pub(super) fn jumps(measurements: &Measurements, rows: &[usize]) -> Vec<Jump> {
    let seen = seen(measurements, rows);
    let mut found: Vec<Jump> = vec![];
    while found.len() < MOST {
        let Some(next) = next(&seen, &found) else { break };
        found.push(next);
        found.sort_by(|a, b| a.between_s[0].total_cmp(&b.between_s[0]));
    }
    found
}

/// Times (s) and places where the nominal eyes see the thing (m).
fn seen(measurements: &Measurements, rows: &[usize]) -> Vec<(f64, [f64; 3])> {
    let of_row = |&i: &usize| {
        let row = &measurements.rows[i];
        Some((row.t_secs?, nominal_place_m(measurements, row)?.coords.into()))
    };
    rows.iter().filter_map(of_row).collect()
}

/// Probability that noise alone makes a thing seem to go anywhere in the course of time, beside its jumps.
///
/// Eyes that turn against each other move what they see along the line of sight above all, and as one warm-up
/// goes: most of what may be found by chance is spent on that one question, the rest on other times and on the
/// directions across (weighted Bonferroni).
pub(super) fn course_by_chance(measurements: &Measurements, rows: &[usize], jumps: &[Jump]) -> f64 {
    let seen = along_and_across(measurements, rows);
    let Some((first_s, _)) = seen.first().copied() else { return 1.0 };
    let still = left(&seen, &|t_s| jumped(jumps, t_s));
    let by_chance = |constants_s: &[f64]| -> Option<[f64; 3]> {
        let grown = |t_s: f64| constants_s.iter().map(move |constant_s| share(t_s - first_s, *constant_s));
        let moving = left(&seen, &|t_s| jumped(jumps, t_s).into_iter().chain(grown(t_s)).collect());
        let ((before, _), (after, _)) = (still?, moving?);
        let used = constants_s.len() as f64;
        let free = seen.len() as f64 - used - 1.0 - jumps.len() as f64;
        let chance = |c: usize| {
            let rest = (after[c] / free).max(LEAST_M * LEAST_M);
            f_tail((before[c] - after[c]) / used / rest, used, free)
        };
        (free >= 4.0).then(|| [0, 1, 2].map(chance))
    };
    let mut least = 1.0_f64;
    for (constants_s, weights) in [(&COURSES_S[1..2], USUAL_COURSE), (&COURSES_S[..], ANY_COURSE)] {
        let Some(chances) = by_chance(constants_s) else { continue };
        least = chances.iter().zip(weights).map(|(chance, weight)| chance / weight).fold(least, f64::min);
    }
    least
}

/// Times (s) and places seen from the left eye: along the line of sight to the thing, then across, m.
fn along_and_across(measurements: &Measurements, rows: &[usize]) -> Vec<(f64, [f64; 3])> {
    let of_row = |&i: &usize| {
        let row = &measurements.rows[i];
        Some((row.t_secs?, nominal_in_left_m(measurements, row)?.coords))
    };
    let seen: Vec<(f64, Vector3<f64>)> = rows.iter().filter_map(of_row).collect();
    let middle: Vector3<f64> = seen.iter().map(|(_, at)| at).sum();
    let Some(turn) = Rotation3::rotation_between(&middle, &Vector3::x()) else { return vec![] };
    seen.into_iter().map(|(t_s, at)| (t_s, (turn * at).into())).collect()
}

/// A constant, and one for each jump.
fn jumped(jumps: &[Jump], t_s: f64) -> Vec<f64> {
    let after = jumps.iter().map(|jump| f64::from(u8::from(t_s > jump.between_s[0])));
    std::iter::once(1.0).chain(after).collect()
}

/// What grows with each time constant after so long.
fn grown(since_s: f64) -> Vec<f64> {
    COURSES_S.iter().map(|constant_s| share(since_s, *constant_s)).collect()
}

fn share(since_s: f64, constant_s: f64) -> f64 {
    1.0 - (-since_s / constant_s).exp()
}

/// The surest jump beside those that are known.
fn next(seen: &[(f64, [f64; 3])], known: &[Jump]) -> Option<Jump> {
    let first_s = seen.first()?.0;
    let course = |t_s: f64| [jumped(known, t_s), grown(t_s - first_s)].concat();
    let (before, _) = left(seen, &course)?;
    let free = seen.len() as f64 - (2 + COURSES_S.len() + known.len()) as f64;
    if free < 4.0 {
        return None;
    }
    let mut best: Option<(f64, Jump)> = None;
    let mut tried = 0;
    for k in LEAST_ROWS..=seen.len().saturating_sub(LEAST_ROWS) {
        let between_s = [seen[k - 1].0, seen[k].0];
        let near = |jump: &Jump| {
            let apart = seen.iter().filter(|(t, _)| (*t > jump.between_s[0]) != (*t > between_s[0])).count();
            apart < LEAST_ROWS
        };
        if between_s[0] >= between_s[1] || known.iter().any(near) {
            continue;
        }
        tried += 3;
        let with = |t_s: f64| {
            let mut all = course(t_s);
            all.push(f64::from(u8::from(t_s > between_s[0])));
            all
        };
        let Some((after, values)) = left(seen, &with) else { continue };
        let (mut chance, mut sigmas, mut square) = (1.0_f64, 0.0_f64, 0.0);
        for c in 0..3 {
            let rest = (after[c] / free).max(LEAST_M * LEAST_M);
            chance = chance.min(f_tail((before[c] - after[c]) / rest, 1.0, free));
            sigmas = sigmas.max(values[c].abs() / rest.sqrt());
            square += values[c] * values[c];
        }
        if sigmas > LEAST_SIGMAS && best.as_ref().is_none_or(|(least, _)| chance < *least) {
            best = Some((chance, Jump { between_s, by_m: square.sqrt() }));
        }
    }
    best.filter(|(chance, _)| chance * f64::from(tried) < SIGNIFICANT).map(|(_, jump)| jump)
}

/// Sum of squares that a fit of columns leaves of each coordinate, and the values of the last column.
fn left(seen: &[(f64, [f64; 3])], columns: &dyn Fn(f64) -> Vec<f64>) -> Option<([f64; 3], [f64; 3])> {
    let rows: Vec<DVector<f64>> = seen.iter().map(|(t_s, _)| DVector::from_vec(columns(*t_s))).collect();
    let width = rows.first()?.len();
    let design = DMatrix::from_fn(rows.len(), width, |r, c| rows[r][c]);
    let values = DMatrix::from_fn(rows.len(), 3, |r, c| seen[r].1[c] - seen[0].1[c]);
    let mut normal = design.tr_mul(&design);
    for k in 0..width {
        normal[(k, k)] += 1e-9 * rows.len() as f64;
    }
    let fit = Cholesky::new(normal)?.solve(&design.tr_mul(&values));
    let off = values - design * &fit;
    let square = |c: usize| off.column(c).norm_squared();
    Some(([0, 1, 2].map(square), [0, 1, 2].map(|c| fit[(width - 1, c)])))
}
