//! Whether the gap shrinks on rows that were not used: every row is judged by a model that was
//! found, and whose frames were placed, without its block.

mod coverage;
mod folds;
mod judged;
mod part;
mod strangers;
mod telling;
mod unseen;

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use plumbline_effects::measurements::{Measurements, What};
use plumbline_model::JobContext;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rayon::prelude::*;

use crate::compare::{Compared, placed};
use crate::error::GapError;
use crate::finding::{Part, Residual, Shown, ShownUnit};
use crate::options::Options;
use crate::search::{self, Found};
use judged::{Judged, judged, noise_of};

/// Draws of blocks for the interval of the closure.
const DRAWS: usize = 1000;
/// There is nothing to close where the error is within this of what noise leaves.
const NOTHING_LEFT: f64 = 1.02;

/// One row, judged by models that do not know it.
#[derive(Clone, Copy, Debug)]
struct HeldOut {
    /// By place in [`Measurements::rows`].
    row: usize,
    block: usize,
    before: Judged,
    after: Judged,
    /// With what may be added alone, where that is judged by itself.
    part: Option<Judged>,
    /// What noise alone would leave.
    noise: f64,
    /// Coordinates inside of their predicted interval, and all.
    inside: (usize, usize),
}

/// What the held-out rows show.
pub(crate) struct Show {
    /// For people.
    pub shown: Shown,
    /// Per row: held-out arrows where it was judged.
    pub residuals: Vec<Residual>,
}

/// Judges every row by models found without it. Outliers have arrows but do not count.
///
/// # Errors
/// Cancelled.
pub(crate) fn show(
    measurements: &Measurements,
    compared: &Compared,
    found: &Found,
    options: &Options,
    one_by_one: bool,
    context: &dyn JobContext,
) -> Result<Show, GapError> {
    let chosen: Vec<usize> = (0..measurements.rows.len()).filter(|&i| !compared.outlier[i]).collect();
    let folds = folds::folds(measurements, &chosen, options.seed, one_by_one);
    let done = AtomicUsize::new(0);
    let held_out: Result<Vec<Vec<HeldOut>>, GapError> = (0..folds.count)
        .into_par_iter()
        .map(|fold| {
            context.checkpoint()?;
            let inside = |k: usize| folds.of_row[k] == fold;
            let training: Vec<usize> = (0..chosen.len()).filter(|&k| !inside(k)).map(|k| chosen[k]).collect();
            let mut tested: Vec<(usize, usize)> =
                (0..chosen.len()).filter(|&k| inside(k)).map(|k| (chosen[k], folds.block[k])).collect();
            if fold == 0 {
                // No model was made with outliers: any of them judges them fairly.
                tested.extend((0..compared.outlier.len()).filter(|&i| compared.outlier[i]).map(|i| (i, 0)));
            }
            let judged =
                without(measurements, compared, found, &training, &tested, options, &Quiet(context))?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            context.report(
                done as f64 / (folds.count + 1) as f64,
                &format!("held-out rows, {done} of {}", folds.count),
            );
            Ok(judged)
        })
        .collect();
    let mut held_out: Vec<HeldOut> = held_out?.into_iter().flatten().collect();
    held_out.sort_by_key(|row| row.row);
    let residuals = arrows(measurements, compared, &held_out);
    let unit = unit_of(measurements);
    let counted: Vec<HeldOut> = held_out
        .iter()
        .copied()
        .filter(|row| !compared.outlier[row.row] && counts(measurements.rows[row.row].what, unit))
        .collect();
    let mut shown = summary(&counted, unit, folds.words, options.seed);
    shown.part = part::summary(&counted, options.seed);
    let before: Vec<(usize, Vector3<f64>)> =
        held_out.iter().map(|row| (row.row, row.before.arrow_m)).collect();
    shown.telling = telling::telling(&compared.covariates, &before);
    shown.covariates.clone_from(&compared.covariates.names);
    context.checkpoint()?;
    if let Some((unseen, part_after)) =
        unseen::unseen(measurements, compared, found, &chosen, options, context)?
    {
        shown.unseen = Some(unseen);
        shown.part = shown.part.map(|part| Part { unseen_after: part_after, ..part });
    }
    Ok(Show { shown, residuals })
}

/// What is shown where no effect was found or nothing was to be held out: the error as it is.
pub(crate) fn nothing_added(measurements: &Measurements, compared: &Compared) -> Shown {
    let unit = unit_of(measurements);
    let rows: Vec<HeldOut> = measurements
        .rows
        .par_iter()
        .enumerate()
        .filter(|(i, row)| !compared.outlier[*i] && counts(row.what, unit))
        .filter_map(|(i, row)| {
            let judged = judged(measurements, row, &compared.assumed)?;
            let noise = noise_of(measurements, row, &compared.assumed, &compared.floor, 1.0)?;
            let row = HeldOut {
                row: i,
                block: i,
                before: judged,
                after: judged,
                part: None,
                noise,
                inside: (0, 0),
            };
            Some(row)
        })
        .collect();
    let mut shown = summary(&rows, unit, "no row was held out: nothing was added".to_owned(), 1);
    shown.covariates.clone_from(&compared.covariates.names);
    let before: Vec<(usize, Vector3<f64>)> = rows.iter().map(|row| (row.row, row.before.arrow_m)).collect();
    shown.telling = telling::telling(&compared.covariates, &before);
    shown.closure = None;
    shown.closure_range = None;
    shown
}

/// Judges the tested rows by what the training rows alone tell.
fn without(
    measurements: &Measurements,
    compared: &Compared,
    whole: &Found,
    training: &[usize],
    tested: &[(usize, usize)],
    options: &Options,
    context: &dyn JobContext,
) -> Result<Vec<HeldOut>, GapError> {
    let known = measurements.only(training.iter().copied());
    let mut before = placed(measurements, training, context)?;
    let mut found = search::search(&known, &compared.floor, options, context)?;
    let mut part = part::is_divided(whole).then(|| part::of(&known, &compared.floor, whole, &found));
    let models = [&mut before, &mut found.assumed].into_iter().chain(part.as_mut());
    strangers::place(measurements, &compared.floor, training, tested, models.collect());
    let scale = whole.doubt.noise_scale;
    Ok(tested
        .par_iter()
        .filter_map(|&(i, block)| {
            let row = &measurements.rows[i];
            Some(HeldOut {
                row: i,
                block,
                before: judged(measurements, row, &before)?,
                after: judged(measurements, row, &found.assumed)?,
                part: match &part {
                    Some(part) => Some(judged(measurements, row, part)?),
                    None => None,
                },
                noise: noise_of(measurements, row, &found.assumed, &compared.floor, scale)?,
                inside: coverage::inside_95(measurements, row, &found)?,
            })
        })
        .collect())
}

/// Meters wherever a length was measured.
fn unit_of(measurements: &Measurements) -> ShownUnit {
    if measurements.rows.iter().all(|row| row.what == What::EyePoints) {
        ShownUnit::Pixel
    } else {
        ShownUnit::Meter
    }
}

fn counts(what: What, unit: ShownUnit) -> bool {
    (what == What::EyePoints) == (unit == ShownUnit::Pixel)
}

fn summary(rows: &[HeldOut], unit: ShownUnit, blocks: String, seed: u64) -> Shown {
    let [before, after, floor] = means(rows);
    let (inside, all) = rows.iter().fold((0, 0), |sum, row| (sum.0 + row.inside.0, sum.1 + row.inside.1));
    let worst = |of: fn(&HeldOut) -> f64| {
        let mut errors: Vec<f64> = rows.iter().map(of).collect();
        errors.sort_by(|a, b| b.total_cmp(a));
        errors.truncate((rows.len().div_ceil(10)).max(1));
        errors.iter().sum::<f64>() / errors.len().max(1) as f64
    };
    Shown {
        blocks,
        rows: rows.len(),
        unit,
        before,
        after,
        floor,
        closure: closure([before, after, floor]),
        closure_range: closure_range(rows, seed),
        worst_tenth: [worst(|row| row.before.error), worst(|row| row.after.error)],
        inside_95: inside as f64 / all.max(1) as f64,
        unseen: None,
        part: None,
        covariates: vec![],
        telling: vec![],
    }
}

/// Mean errors before, after, and by noise alone.
fn means(rows: &[HeldOut]) -> [f64; 3] {
    let count = rows.len().max(1) as f64;
    let mean = |of: fn(&HeldOut) -> f64| rows.iter().map(of).sum::<f64>() / count;
    [mean(|row| row.before.error), mean(|row| row.after.error), mean(|row| row.noise)]
}

fn closure([before, after, floor]: [f64; 3]) -> Option<f64> {
    (before > NOTHING_LEFT * floor).then(|| (before - after) / (before - floor))
}

/// 95 % of the closures of draws of whole blocks.
fn closure_range(rows: &[HeldOut], seed: u64) -> Option<[f64; 2]> {
    closure(means(rows))?;
    let mut blocks = std::collections::BTreeMap::<usize, Vec<HeldOut>>::new();
    for row in rows {
        blocks.entry(row.block).or_default().push(*row);
    }
    if blocks.len() < 3 {
        return None;
    }
    let sums: Vec<[f64; 4]> = blocks
        .values()
        .map(|rows| {
            let sum = |of: fn(&HeldOut) -> f64| rows.iter().map(of).sum::<f64>();
            [sum(|row| row.before.error), sum(|row| row.after.error), sum(|row| row.noise), rows.len() as f64]
        })
        .collect();
    let mut random = StdRng::seed_from_u64(seed);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .filter_map(|_| {
            let mut total = [0.0; 4];
            for _ in 0..sums.len() {
                let block = &sums[random.random_range(0..sums.len())];
                total.iter_mut().zip(block).for_each(|(total, value)| *total += value);
            }
            closure([total[0] / total[3], total[1] / total[3], total[2] / total[3]])
        })
        .collect();
    if drawn.len() < DRAWS / 2 {
        return None;
    }
    drawn.sort_by(f64::total_cmp);
    let at = |share: f64| drawn[((drawn.len() - 1) as f64 * share).round() as usize];
    Some([at(0.025), at(0.975)])
}

fn arrows(measurements: &Measurements, compared: &Compared, held_out: &[HeldOut]) -> Vec<Residual> {
    let mut residuals = compared.comparison.residuals.clone();
    debug_assert_eq!(residuals.len(), measurements.rows.len(), "one residual per row");
    for row in held_out {
        residuals[row.row].before_m = row.before.arrow_m.into();
        residuals[row.row].after_m = row.after.arrow_m.into();
    }
    residuals
}

/// Lets the work be cancelled, but keeps its progress to itself: several run at once.
struct Quiet<'a>(&'a dyn JobContext);

impl JobContext for Quiet<'_> {
    fn checkpoint(&self) -> Result<(), plumbline_model::Cancelled> {
        self.0.checkpoint()
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}
