//! A condition that no training row had: does the model hold there too?

use std::collections::BTreeMap;

use plumbline_effects::Measurements;
use plumbline_effects::measurements::Observation;
use plumbline_model::JobContext;

use super::{Quiet, counts, means, part, unit_of, without};
use crate::compare::Compared;
use crate::error::GapError;
use crate::finding::Unseen;
use crate::options::Options;
use crate::search::Found;

/// A condition needs so many rows to be judged …
const FEWEST_HELD_OUT: usize = 8;
/// … and so many to be left.
const FEWEST_LEFT: usize = 24;

/// Holds out the first of weight, height and side that has two levels with enough rows; beside it the mean error with what
/// may be added alone, where that is judged by itself.
pub(super) fn unseen(
    measurements: &Measurements,
    compared: &Compared,
    found: &Found,
    chosen: &[usize],
    options: &Options,
    context: &dyn JobContext,
) -> Result<Option<(Unseen, Option<f64>)>, GapError> {
    let Some((what, held_out)) = condition(measurements, chosen) else { return Ok(None) };
    let training: Vec<usize> = chosen.iter().copied().filter(|i| !held_out.contains(i)).collect();
    let tested: Vec<(usize, usize)> = held_out.iter().map(|&i| (i, 0)).collect();
    let rows = without(measurements, compared, found, &training, &tested, options, &Quiet(context))?;
    let unit = unit_of(measurements);
    let rows: Vec<_> = rows.into_iter().filter(|row| counts(measurements.rows[row.row].what, unit)).collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let [before, after, floor] = means(&rows);
    let part_after = part::summary(&rows, options.seed).map(|part| part.after);
    Ok(Some((Unseen { what, rows: rows.len(), before, after, floor }, part_after)))
}

/// The level of a condition that a row has.
type Level<'a> = &'a dyn Fn(&Observation) -> Option<String>;

/// The rows of one level, and what it is called.
fn condition(measurements: &Measurements, chosen: &[usize]) -> Option<(String, Vec<usize>)> {
    let micro = |value: f64| (value * 1e6).round() as i64;
    let weight = |row: &Observation| row.what.is_placed().then(|| micro(row.payload_kg).to_string());
    let height = |row: &Observation| row.what.is_placed().then(|| micro(row.screen_height_m).to_string());
    let side = |row: &Observation| row.approach.clone();
    let words_of = |row: &Observation, kind: usize| match kind {
        0 if row.payload_kg == 0.0 => "without a weight".to_owned(),
        0 => format!("with a weight of {:.0} g", row.payload_kg * 1e3),
        1 if row.screen_height_m == 0.0 => "with the screen at its nominal height".to_owned(),
        1 => format!("with the screen {:.0} mm higher", row.screen_height_m * 1e3),
        _ => format!("approached from the side \"{}\"", row.approach.clone().unwrap_or_default()),
    };
    let levels: [Level<'_>; 3] = [&weight, &height, &side];
    for (kind, level) in levels.iter().enumerate() {
        let mut by_level = BTreeMap::<String, Vec<usize>>::new();
        for &i in chosen {
            if let Some(level) = level(&measurements.rows[i]) {
                by_level.entry(level).or_default().push(i);
            }
        }
        if by_level.len() < 2 {
            continue;
        }
        // The smallest group: most stays to learn from.
        let held_out = by_level
            .into_values()
            .filter(|rows| rows.len() >= FEWEST_HELD_OUT && chosen.len() - rows.len() >= FEWEST_LEFT)
            .min_by_key(Vec::len);
        if let Some(held_out) = held_out {
            return Some((words_of(&measurements.rows[held_out[0]], kind), held_out));
        }
    }
    None
}
