//! Rows that nothing around them agrees with.

use std::collections::BTreeMap;

use plumbline_effects::measurements::{Measurements, Observation, What};

use super::neighbors::Points;
use crate::statistics::{ALIKE, median, robust_sd, stepped_sd};

/// A row this many robust standard deviations away from its neighbors is an outlier. Far: an
/// effect that few rows show must not be thrown away.
const FAR: f64 = 8.0;
/// Neighbors whose median a row is held against.
const NEIGHBORS: usize = 9;
/// The same of one place that is watched: it goes somewhere, fastest at the beginning.
const NEIGHBORS_IN_TIME: usize = 5;
/// So many in a row are no mishap but a condition: something changed.
const A_CONDITION: usize = 5;

/// What a change does is the same in all rows that it changed to this share: one that turns a screen moves its sides otherwise.
const NEAR: f64 = 0.7;
/// So large a share of a session's rows is more than a mishap when it begins at one moment …
const MANY: f64 = 0.1;
/// … and so few before it are off.
const HARDLY_ANY: f64 = 0.1;
/// What lies so many times as far off as the middle one of those that a change moved is a mishap all the same.
const MUCH_FARTHER: f64 = 4.0;
/// So many poses are no mishap of one.
const SEVERAL: usize = 3;

/// Per row, whether it is an outlier.
pub fn outliers(measurements: &Measurements, residuals: &[Option<Vec<f64>>]) -> Vec<bool> {
    let mut out = vec![false; measurements.rows.len()];
    for what in What::ALL {
        let chosen = (0..residuals.len()).filter(|&i| residuals[i].is_some());
        let points = Points::of(measurements, what, chosen);
        if points.rows.len() < NEIGHBORS + 3 {
            continue;
        }
        let watched = points.rows.iter().all(|&i| measurements.rows[i].stand.is_some());
        let nearest = points.nearest(if watched { NEIGHBORS_IN_TIME } else { NEIGHBORS });
        // Twice: the first round's outliers do not speak in the second.
        for _ in 0..2 {
            let off = off_by(&points, &nearest, residuals, &out, what.len());
            let scales: Vec<f64> = (0..what.len())
                .map(|c| {
                    let inside = off.iter().zip(&points.rows).filter(|(_, row)| !out[**row]);
                    let off: Vec<f64> = inside.map(|(off, _)| off[c]).collect();
                    if watched { stepped_sd(&off) } else { robust_sd(off) }
                })
                .collect();
            let finest = if watched { ALIKE } else { 0.05 } * scales.iter().copied().fold(0.0, f64::max);
            for (off, &row) in off.iter().zip(&points.rows) {
                out[row] =
                    off.iter().zip(&scales).any(|(off, scale)| off.abs() > FAR * scale.max(finest).max(1e-9));
            }
        }
        keep_conditions(measurements, residuals, &mut out);
        keep_changes(measurements, what, residuals, &mut out);
        keep_what_began(measurements, what, residuals, &mut out);
    }
    keep_repeated(measurements, residuals, &mut out);
    keep_sets(measurements, &mut out);
    out
}

/// What comes again, the same way, whenever a pose is measured is no mishap: a joint that jumps beyond an angle does so each time.
/// Where the arm did not move between the repeats, a mishap of that pose comes again as well; several poses have none.
fn keep_repeated(measurements: &Measurements, residuals: &[Option<Vec<f64>>], out: &mut [bool]) {
    let mut cells = BTreeMap::<(What, usize), Vec<usize>>::new();
    for (i, row) in measurements.rows.iter().enumerate() {
        cells.entry((row.what, row.cell)).or_default().push(i);
    }
    let comes_again = |own: &Vec<usize>| {
        own.len() > 1 && own.iter().all(|&i| out[i]) && alike(own.iter().map(|&i| &residuals[i]))
    };
    let again: Vec<Vec<usize>> = cells.into_values().filter(comes_again).collect();
    let are_several = again.len() >= SEVERAL;
    for own in again {
        let is_apart = own.windows(2).any(|pair| pair[1] - pair[0] > 1);
        if is_apart || are_several {
            own.iter().for_each(|&i| out[i] = false);
        }
    }
}

/// Where half of a set of what the eyes saw is off, or more of it, the eyes stood otherwise meanwhile: each of its rows is off
/// another way, by where it was seen, and none is a mishap.
fn keep_sets(measurements: &Measurements, out: &mut [bool]) {
    for label in measurements.sets_of_eyes() {
        let is_in = |i: &usize| measurements.rows[*i].set.as_ref() == Some(&label);
        let own: Vec<usize> = (0..out.len()).filter(is_in).collect();
        if 2 * own.iter().filter(|&&i| out[i]).count() >= own.len() {
            own.iter().for_each(|&i| out[i] = false);
        }
    }
}

/// Per point and coordinate, how far it lies from the median of its neighbors.
fn off_by(
    points: &Points,
    nearest: &[Vec<usize>],
    residuals: &[Option<Vec<f64>>],
    out: &[bool],
    size: usize,
) -> Vec<Vec<f64>> {
    let value = |row: usize, c: usize| residuals[row].as_ref().and_then(|residual| residual.get(c)).copied();
    nearest
        .iter()
        .zip(&points.rows)
        .map(|(around, &row)| {
            (0..size)
                .map(|c| {
                    let others = around.iter().map(|&j| points.rows[j]);
                    let inside: Vec<f64> = others.filter(|&j| !out[j]).filter_map(|j| value(j, c)).collect();
                    let middle = median(inside).unwrap_or(0.0);
                    value(row, c).unwrap_or(0.0) - middle
                })
                .collect()
        })
        .collect()
}

/// Rows that follow each other and are off the same way are no outliers.
fn keep_conditions(measurements: &Measurements, residuals: &[Option<Vec<f64>>], out: &mut [bool]) {
    let mut start = 0;
    while start < out.len() {
        let first = &measurements.rows[start];
        let mut end = start;
        while end < out.len()
            && out[end]
            && measurements.rows[end].session == first.session
            && measurements.rows[end].what == first.what
        {
            end += 1;
        }
        if end - start >= A_CONDITION && alike(residuals[start..end].iter()) {
            out[start..end].iter_mut().for_each(|out| *out = false);
        }
        start = end.max(start + 1);
    }
}

/// Where from some row of a session on, or up to one, half or more are off, and the same way, something changed there: a screen
/// that was knocked in the middle is off for its neighbors at some places and not at others.
fn keep_changes(measurements: &Measurements, what: What, residuals: &[Option<Vec<f64>>], out: &mut [bool]) {
    let sessions = measurements.rows.iter().map(|row| row.session).max().map_or(0, |last| last + 1);
    for session in 0..sessions {
        let is_own = |row: &Observation| row.session == session && row.what == what;
        let mut own: Vec<usize> = (0..out.len()).filter(|&i| is_own(&measurements.rows[i])).collect();
        for _ in 0..2 {
            let has_changed = |first: &usize| {
                let after = &own[*first..];
                let off: Vec<usize> = after.iter().copied().filter(|&i| out[i]).collect();
                let is_condition = off.len() >= A_CONDITION && 2 * off.len() >= after.len();
                is_condition && alike(off.iter().map(|&i| &residuals[i]))
            };
            let changed = (0..own.len()).filter(|&first| out[own[first]]).find(has_changed);
            if let Some(first) = changed {
                let after = &own[first..];
                for i in near_their_median(after, residuals, out) {
                    out[i] = false;
                }
            }
            own.reverse();
        }
    }
}

/// Where from some row of a session on, or up to one, half or more are off, many, and hardly any of the others, something
/// changed there, whichever way each of them is off: a horn that slipped moves the flange here this way and there that way.
fn keep_what_began(
    measurements: &Measurements,
    what: What,
    residuals: &[Option<Vec<f64>>],
    out: &mut [bool],
) {
    let how_far = |i: usize| {
        residuals[i].as_ref().map_or(0.0, |off| off.iter().map(|value| value * value).sum::<f64>().sqrt())
    };
    let sessions = measurements.rows.iter().map(|row| row.session).max().map_or(0, |last| last + 1);
    for session in 0..sessions {
        let is_own = |row: &Observation| row.session == session && row.what == what;
        let mut own: Vec<usize> = (0..out.len()).filter(|&i| is_own(&measurements.rows[i])).collect();
        for _ in 0..2 {
            // From there on those that are off are the most more than those that are not.
            let (mut more, mut most, mut first) = (0_i64, 0, own.len());
            for at in (0..own.len()).rev() {
                more += if out[own[at]] { 1 } else { -1 };
                if more > most {
                    (most, first) = (more, at);
                }
            }
            let (before, after) = own.split_at(first);
            let off = |rows: &[usize]| rows.iter().filter(|&&i| out[i]).count() as f64;
            let many = (A_CONDITION as f64).max(MANY * own.len() as f64);
            if off(after) >= many && off(before) <= HARDLY_ANY * before.len() as f64 && !before.is_empty() {
                let usual = median(after.iter().filter(|&&i| out[i]).map(|&i| how_far(i))).unwrap_or(0.0);
                after.iter().for_each(|&i| out[i] &= how_far(i) > MUCH_FARTHER * usual);
            }
            own.reverse();
        }
    }
}

/// Of those of these rows that are off, the ones that are off about as the middle one is: a mishap before the change, or after
/// it, stays one.
fn near_their_median(rows: &[usize], residuals: &[Option<Vec<f64>>], out: &[bool]) -> Vec<usize> {
    let off: Vec<(usize, &Vec<f64>)> =
        rows.iter().filter(|&&i| out[i]).filter_map(|&i| Some((i, residuals[i].as_ref()?))).collect();
    let size = off.first().map_or(0, |(_, first)| first.len());
    let middle: Vec<f64> =
        (0..size).filter_map(|c| median(off.iter().map(|(_, residual)| residual[c]))).collect();
    let length = middle.iter().map(|value| value * value).sum::<f64>().sqrt();
    let distance = |residual: &[f64]| {
        residual.iter().zip(&middle).map(|(value, middle)| (value - middle).powi(2)).sum::<f64>().sqrt()
    };
    off.iter().filter(|(_, residual)| distance(residual) <= NEAR * length).map(|(i, _)| *i).collect()
}

fn alike<'a>(residuals: impl Iterator<Item = &'a Option<Vec<f64>>>) -> bool {
    let known: Vec<&Vec<f64>> = residuals.flatten().collect();
    let Some(size) = known.first().map(|first| first.len()) else { return false };
    if known.iter().any(|residual| residual.len() != size) {
        return false;
    }
    let length: f64 = known.iter().map(|r| r.iter().map(|v| v * v).sum::<f64>().sqrt()).sum();
    let together: f64 =
        (0..size).map(|c| known.iter().map(|r| r[c]).sum::<f64>()).map(|sum| sum * sum).sum::<f64>().sqrt();
    together > 0.7 * length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_other_widths_are_not_alike() {
        let pose = Some(vec![0.02, 0.0, 0.0]);
        let oriented = Some(vec![0.02, 0.0, 0.0, 0.1, 0.0, 0.0]);
        assert!(alike([&pose, &pose].into_iter()));
        assert!(!alike([&pose, &oriented].into_iter()) && !alike([&oriented, &pose].into_iter()));
    }
}
