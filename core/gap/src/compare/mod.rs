//! How far measurement and model lie apart: frames placed, noise known, and whether that is more
//! than noise.

mod alike;
mod displacement;
mod drift;
mod frames;
mod instrument;
mod lack_of_fit;
mod levers;
mod mirror;
mod neighbors;
mod noise;
mod oddities;
mod outliers;
mod poses;
mod sets;
mod slips;
mod spread;
mod structure;
mod sway;
mod turns;
mod units;

use plumbline_effects::Assumed;
use plumbline_effects::measurements::{Measurements, What};
use plumbline_model::JobContext;
use rayon::prelude::*;

pub(crate) use crate::statistics::{NORMAL_95, f_tail, median, robust_sd};
pub(crate) use alike::alike;
pub(crate) use displacement::{at_m, of_arm};
pub(crate) use frames::placed;
pub(crate) use levers::HOW_FAR_SHORT;
pub(crate) use noise::{by_neighbors_of_eyes, structure_of};
pub(crate) use structure::Structure;

use crate::covariates::Covariates;
use crate::error::GapError;
use crate::finding::{Comparison, CoordinateComparison, FloorSource, KindComparison, OPEN_SIGMAS, Residual};
use crate::floor::Floor;
use crate::seen::nominal_place_m;

/// With fewer rows nothing can be told from noise.
pub const FEWEST_ROWS: usize = 12;
/// A misfit is real below this probability of noise alone …
const SIGNIFICANT: f64 = 0.01;
/// … and matters above this size, in standard deviations of one measurement.
const MATTERS_SIGMAS: f64 = 0.3;
/// Measured and predicted places of one and the same arm go together at least so much (R²).
const RELATED: f64 = 0.3;
/// Repeats that scatter further than this are no noise of a robot, m.
const WILD_M: f64 = 0.03;

/// A comparison with what the next steps need of it.
#[derive(Clone, Debug)]
pub(crate) struct Compared {
    /// For people.
    pub comparison: Comparison,
    /// Noise of one measurement.
    pub floor: Floor,
    /// Frames placed, no effects.
    pub assumed: Assumed,
    /// Per row: whether it is an outlier, or cannot be predicted.
    pub outlier: Vec<bool>,
    /// What residuals may depend on.
    pub covariates: Covariates,
    /// Whether measured and predicted have something to do with each other.
    pub is_related: bool,
    /// What is odd, in words.
    pub warnings: Vec<String>,
}

/// Stops where a column cannot be looked at: dead, in a wrong unit, of a joint that turns otherwise.
///
/// # Errors
/// Why, see [`GapError`], or cancelled.
pub(crate) fn refuse(measurements: &Measurements, context: &dyn JobContext) -> Result<(), GapError> {
    let rows = measurements.rows.len();
    if rows < FEWEST_ROWS {
        return Err(GapError::TooFew { rows, needed: FEWEST_ROWS });
    }
    context.report(0.0, "looking at units and columns");
    oddities::stop_at_dead_columns(measurements)?;
    poses::stop_at_one_pose(measurements)?;
    units::check(measurements, context)
}

/// Compares what was measured with the nominal model, the frames of all sessions placed.
///
/// # Errors
/// When the data cannot be looked at, see [`GapError`], or cancelled.
pub(crate) fn compare(
    measurements: &Measurements,
    seed: u64,
    context: &dyn JobContext,
) -> Result<Compared, GapError> {
    let rows = measurements.rows.len();
    if rows < FEWEST_ROWS {
        return Err(GapError::TooFew { rows, needed: FEWEST_ROWS });
    }
    let mut warnings = measurements.remarks();
    warnings.extend(oddities::warnings(measurements));
    context.report(0.1, "placing frames");
    let all: Vec<usize> = (0..rows).collect();
    let mut assumed = placed(measurements, &all, context)?;
    let mut residuals = residuals(measurements, &assumed);
    let predictable = residuals.iter().flatten().count();
    if 2 * predictable < rows || predictable < FEWEST_ROWS {
        return Err(GapError::OutOfView { predictable, rows });
    }
    context.checkpoint()?;
    context.report(0.3, "looking for outliers");
    let mut outlier = outliers::outliers(measurements, &residuals);
    if outlier.iter().any(|out| *out) {
        warnings.push(words_of_outliers(measurements, &outlier));
        let kept: Vec<usize> = all.iter().copied().filter(|&i| !outlier[i]).collect();
        assumed = placed(measurements, &kept, context)?;
        residuals = self::residuals(measurements, &assumed);
    }
    for (out, residual) in outlier.iter_mut().zip(&mut residuals) {
        *out |= residual.is_none();
        if *out {
            *residual = None;
        }
    }
    let kept = outlier.iter().filter(|out| !**out).count();
    let is_watched = measurements.rows.iter().any(|row| row.stand.is_some());
    let needed = if is_watched { crate::watched::LEAST_LOOKS } else { FEWEST_ROWS };
    if kept < needed {
        return Err(GapError::TooFew { rows: kept, needed });
    }
    context.checkpoint()?;
    context.report(0.4, "measuring the noise");
    instrument::check(measurements, &residuals)?;
    let noise = noise::floor_of(measurements, &assumed, &residuals);
    warn_of_noise(&noise.floor, &mut warnings);
    let covariates = Covariates::of(measurements);
    context.report(0.5, "testing for a gap");
    let mut misfit =
        lack_of_fit::misfit(measurements, &residuals, &noise, &assumed, &covariates, seed, context)?;
    if let Some(course) = &noise.drift {
        misfit.p_value = misfit.p_value.min(course.p_value);
        misfit.size_sigmas = misfit.size_sigmas.max(course.size_sigmas);
    }
    if let Some(p_value) = crate::watched::course_by_chance(measurements) {
        // Two tests: twice the smaller probability.
        misfit.p_value = (2.0 * misfit.p_value.min(p_value)).min(1.0);
    }
    if let Some(structure) = &noise.structure {
        misfit.p_value = misfit.p_value.min(structure.p_value);
        misfit.size_sigmas = misfit.size_sigmas.max(structure.size_sigmas);
    }
    // Repeats tell the noise whatever their neighbors do.
    if noise.floor.source != FloorSource::Repeats
        && let Some(alike) = alike(measurements, &residuals, seed, context)?
    {
        misfit.p_value = misfit.p_value.min(alike.p_value);
        misfit.size_sigmas = misfit.size_sigmas.max(alike.size_sigmas);
    }
    let is_related = related(measurements, &residuals);
    if !is_related {
        // It decides the verdict, so it comes first.
        let words = "measured and predicted places have hardly anything to do with each other: the rows may be \
                     shuffled, or of another robot or tip. No effect is named from such data";
        warnings.insert(0, words.to_owned());
    }
    let comparison = Comparison {
        rows,
        rows_kept: residuals.iter().flatten().count(),
        cells: cells(measurements, &outlier),
        kinds: kinds(measurements, &residuals, &noise.floor),
        floor_from_repeats: noise.floor.is_from_repeats(),
        floor_source: noise.floor.source,
        p_value: misfit.p_value,
        size_sigmas: misfit.size_sigmas,
        is_gap: misfit.p_value < SIGNIFICANT && misfit.size_sigmas > MATTERS_SIGMAS
            || is_open(noise.floor.source, misfit.size_sigmas),
        residuals: in_sample(measurements, &assumed, &outlier, &covariates),
    };
    Ok(Compared { comparison, floor: noise.floor, assumed, outlier, covariates, is_related, warnings })
}

/// Whether it takes a search to tell if there is a gap. Without a floor nothing is small against it; what lies far beyond
/// the figure of an instrument may be what the arm itself scatters, but a few rows that go with nothing do not say so.
fn is_open(source: FloorSource, size_sigmas: f64) -> bool {
    match source {
        FloorSource::Fitted => true,
        FloorSource::Instrument => size_sigmas > OPEN_SIGMAS,
        FloorSource::Repeats | FloorSource::Neighbors => false,
    }
}

/// Measured less predicted natural coordinates of every row; `None` where the model sees nothing.
pub(crate) fn residuals(measurements: &Measurements, assumed: &Assumed) -> Vec<Option<Vec<f64>>> {
    measurements
        .rows
        .par_iter()
        .map(|row| {
            let predicted = measurements.predict(row, assumed)?;
            let residual: Vec<f64> = row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
            residual.iter().all(|value| value.is_finite()).then_some(residual)
        })
        .collect()
}

fn words_of_outliers(measurements: &Measurements, outlier: &[bool]) -> String {
    let found: Vec<String> = measurements
        .rows
        .iter()
        .zip(outlier)
        .filter(|(_, out)| **out)
        .map(|(row, _)| (row.row + 1).to_string())
        .collect();
    let first = found.iter().take(5).cloned().collect::<Vec<_>>().join(", ");
    let more = if found.len() > 5 { ", …" } else { "" };
    let share = found.len() as f64 / outlier.len() as f64;
    let advice =
        if share > 0.1 { ": so many point to a fault of the measurement, look at them first" } else { "" };
    match found.len() {
        1 => format!("row {first} lies far from all others around it and was not used{advice}"),
        count => format!(
            "{count} rows ({first}{more}) lie far from all others around them and were not used{advice}"
        ),
    }
}

fn warn_of_noise(floor: &Floor, warnings: &mut Vec<String>) {
    let from = match floor.source {
        FloorSource::Repeats => None,
        FloorSource::Instrument => {
            Some("taken from the instrument's own figure, and what the arm adds is fitted")
        }
        FloorSource::Neighbors => Some("estimated from near neighbors and is approximate"),
        FloorSource::Fitted => Some(
            "not known, since too few rows were measured nearly like another one: it is what the best model leaves",
        ),
    };
    if let Some(from) = from {
        let again = if floor.kinds.iter().any(|kind| kind.what == What::Touch) {
            "Ten touches of the same few places, each from the same side,"
        } else if floor.kinds.iter().any(|kind| kind.what.is_pose()) {
            "A few poses, each measured several times and come to from the same side,"
        } else {
            "A few places that are seen several times each, the head brought anew in between,"
        };
        warnings.push(format!(
            "there are too few repeats to take the noise from them: it was {from}. {again} would tell it"
        ));
    }
    for kind in floor.kinds.iter().filter(|kind| kind.what.is_placed()) {
        let widest = kind.sd.iter().copied().fold(0.0, f64::max);
        if widest > WILD_M {
            warnings.push(format!(
                "measurements of the same scatter by {:.0} mm: something is loose or the rows are mixed up; effects \
                 smaller than that cannot be seen",
                widest * 1e3
            ));
        }
    }
}

/// Whether measured places follow predicted ones.
fn related(measurements: &Measurements, residuals: &[Option<Vec<f64>>]) -> bool {
    let (mut left, mut whole) = (0.0, 0.0);
    // Where one thing was watched nothing was to be followed.
    if measurements.rows.iter().all(|row| row.stand.is_some()) {
        return true;
    }
    for what in What::ALL {
        let kept: Vec<(&Vec<f64>, &Vec<f64>)> = measurements
            .rows
            .iter()
            .zip(residuals)
            .filter(|(row, _)| row.what == what && row.stand.is_none())
            .filter_map(|(row, residual)| Some((&row.measured, residual.as_ref()?)))
            .collect();
        // The height of a touch is always measured as zero, and so is a turn against what was measured.
        let telling = match what {
            What::Touch => 2,
            What::OrientedPose => 3,
            What::Pose | What::Place | What::EyePoints => what.len(),
        };
        for c in 0..telling {
            let Some(middle) = median(kept.iter().map(|(measured, _)| measured[c])) else { continue };
            let scatter = robust_sd(kept.iter().map(|(_, residual)| residual[c]));
            let spread = robust_sd(kept.iter().map(|(measured, _)| measured[c] - middle)).max(1e-9);
            // The coordinate in which rows hardly differ says nothing.
            left += scatter * scatter * f64::from(spread > 0.0);
            whole += spread * spread;
        }
    }
    left < (1.0 - RELATED) * whole
}

fn cells(measurements: &Measurements, outlier: &[bool]) -> usize {
    let kept = measurements.rows.iter().zip(outlier).filter(|(_, out)| !**out);
    kept.map(|(row, _)| row.cell).collect::<std::collections::BTreeSet<_>>().len()
}

fn kinds(measurements: &Measurements, residuals: &[Option<Vec<f64>>], floor: &Floor) -> Vec<KindComparison> {
    let mut kinds: Vec<KindComparison> = vec![];
    let mut whole = 0.0;
    for kind in &floor.kinds {
        let kept: Vec<&Vec<f64>> = measurements
            .rows
            .iter()
            .zip(residuals)
            .filter(|(row, _)| row.what == kind.what)
            .filter_map(|(_, residual)| residual.as_ref())
            .collect();
        let coordinates = kind.what.coordinates().iter().enumerate().map(|(c, (name, unit))| {
            let squares: f64 = kept.iter().map(|residual| residual[c] * residual[c]).sum();
            let share = squares / (kind.sd[c] * kind.sd[c]);
            whole += share;
            let rms = (squares / kept.len().max(1) as f64).sqrt();
            CoordinateComparison { name: (*name).to_owned(), unit: *unit, rms, floor: kind.sd[c], share }
        });
        let coordinates = coordinates.collect();
        kinds.push(KindComparison { what: kind.what, coordinates });
    }
    for coordinate in kinds.iter_mut().flat_map(|kind| &mut kind.coordinates) {
        coordinate.share /= whole.max(f64::MIN_POSITIVE);
    }
    kinds
}

/// Residuals with frames placed on all rows; held-out ones take their place where the gap is shown.
fn in_sample(
    measurements: &Measurements,
    assumed: &Assumed,
    outlier: &[bool],
    covariates: &Covariates,
) -> Vec<Residual> {
    measurements
        .rows
        .iter()
        .enumerate()
        .map(|(i, row)| {
            let placement = &assumed.placements[row.session];
            let arrow = if row.what.is_placed() {
                measurements.predict(row, assumed).and_then(|predicted| {
                    let residual: Vec<f64> =
                        row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
                    of_arm(measurements, row, placement, &residual)
                })
            } else {
                nominal_place_m(measurements, row).zip(row.truth_m).map(|(place, truth)| place - truth)
            };
            let arrow: [f64; 3] = arrow.map_or([0.0; 3], Into::into);
            Residual {
                session: row.session,
                what: row.what,
                row: row.row,
                set: row.set.clone().unwrap_or_default(),
                at_m: at_m(measurements, row, placement),
                before_m: arrow,
                after_m: arrow,
                covariates: covariates.values[i].clone(),
                outlier: outlier[i],
            }
        })
        .collect()
}
