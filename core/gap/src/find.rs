//! The whole way: compare, search, show, advise.

use std::time::Instant;

use plumbline_effects::Measurements;
use plumbline_model::{Cancelled, JobContext};

use crate::compare::{Compared, compare};
use crate::error::GapError;
use crate::finding::{FORMAT, Finding, FloorSource, NamedEffect, Shown, Unexplained, Verdict};
use crate::floor::Floor;
use crate::next;
use crate::options::Options;
use crate::search::{self, Found};
use crate::sentence;
use crate::show;

/// Where each stage ends, as a share of the whole.
const COMPARED: f64 = 0.1;
const SEARCHED: f64 = 0.3;
const SHOWN: f64 = 0.9;
/// Rows are held out one by one only where all searches together take no longer than this, s.
const PATIENCE_S: f64 = 60.0;
/// A misfit smaller than this that nothing explains is dirt, not a gap; standard deviations of one
/// measurement.
const DIRT_SIGMAS: f64 = 0.6;

/// Looks for the gap, names what is missing and shows how far it closes.
///
/// # Errors
/// When there is too little to look at, a column is in a wrong unit or was not logged, or the work
/// was cancelled.
pub fn find(
    measurements: &Measurements,
    options: &Options,
    context: &dyn JobContext,
) -> Result<Finding, GapError> {
    let start = Instant::now();
    context.checkpoint()?;
    let compared = compare(measurements, options.seed, &Stage::new(context, 0.0, COMPARED))?;
    if !compared.comparison.is_gap || !compared.is_related {
        return Ok(without_search(measurements, compared, options, start));
    }
    let kept: Vec<usize> = (0..measurements.rows.len()).filter(|&i| !compared.outlier[i]).collect();
    let used = measurements.only(kept.iter().copied());
    let searching = Instant::now();
    let mut found =
        search::search(&used, &compared.floor, options, &Stage::new(context, COMPARED, SEARCHED))?;
    let search_s = searching.elapsed().as_secs_f64();
    if found.effects.is_empty()
        && found.verdict != Verdict::NoGap
        && compared.comparison.size_sigmas < DIRT_SIGMAS
    {
        found.verdict = Verdict::NoGap;
    }
    context.checkpoint()?;
    let mut compared = compared;
    if found.floor.source == FloorSource::Fitted {
        with_floor(&mut compared, &found.floor);
    }
    let shown = if options.show && !found.assumed.effects.is_empty() {
        let one_by_one = search_s * kept.len() as f64 / 2.0 < PATIENCE_S;
        let stage = Stage::new(context, SEARCHED, SHOWN);
        let show = show::show(measurements, &compared, &found, options, one_by_one, &stage)?;
        compared.comparison.residuals = show.residuals;
        show.shown
    } else {
        show::nothing_added(measurements, &compared)
    };
    context.report(SHOWN, "next experiment");
    let advising = Stage::new(context, SHOWN, 1.0);
    let next = next::advise(&used, &compared.floor, &found, options, &advising)?;
    if options.advise {
        let mut effects = std::mem::take(&mut found.effects);
        next::split_by(&mut effects, &used, &compared.floor, &found, options, &advising)?;
        found.effects = effects;
    }
    flag_outliers(&mut compared, &kept, &found);
    if let Some(words) = no_help(&found, &shown, options) {
        compared.warnings.push(words);
    }
    bound_by_held_out(&mut found, &shown, &mut compared.warnings);
    let mut finding = assemble(measurements, compared, Some(found), shown, options);
    finding.next = next;
    finding.seconds = start.elapsed().as_secs_f64();
    finding.sentence = sentence::of(&finding);
    context.report(1.0, "done");
    Ok(finding)
}

/// The answer where there is nothing to search for, or nothing that may be named.
fn without_search(
    measurements: &Measurements,
    compared: Compared,
    options: &Options,
    start: Instant,
) -> Finding {
    let shown = show::nothing_added(measurements, &compared);
    let mut finding = assemble(measurements, compared, None, shown, options);
    finding.seconds = start.elapsed().as_secs_f64();
    finding.sentence = sentence::of(&finding);
    finding
}

/// What makes rows that were not used worse has no name, whatever speaks for it on those that were; and
/// a closure beyond one says that the floor was not the floor.
fn bound_by_held_out(found: &mut Found, shown: &Shown, warnings: &mut Vec<String>) {
    let named = matches!(found.verdict, Verdict::Named | Verdict::Class);
    if shown.closure.is_some() && named && shown.after >= shown.before {
        found.verdict = Verdict::NotInLibrary;
        found.unexplained.probability = found.unexplained.probability.max(0.5);
    }
    if shown.closure.is_some_and(|closure| closure > 1.0) {
        warnings.push(
            "more of the gap closes than the noise leaves open: the noise was taken too large. Repeat a few measurements \
             from the same side"
                .to_owned(),
        );
    }
}

/// The comparison against the noise that was found along with the effects.
fn with_floor(compared: &mut Compared, floor: &Floor) {
    let (mut squares, mut count) = (0.0, 0.0);
    for kind in &mut compared.comparison.kinds {
        let Some(own) = floor.of(kind.what) else { continue };
        for (coordinate, sd) in kind.coordinates.iter_mut().zip(&own.sd) {
            coordinate.floor = *sd;
            squares += (coordinate.rms / sd).powi(2);
            count += 1.0;
        }
    }
    compared.comparison.size_sigmas = (squares / f64::max(count, 1.0) - 1.0).max(0.0).sqrt();
    compared.floor = floor.clone();
}

/// Says when named effects do not help on rows that were not used.
fn no_help(found: &Found, shown: &Shown, options: &Options) -> Option<String> {
    let helps = shown.after < shown.before || !options.show || found.assumed.effects.is_empty();
    (!helps).then(|| {
        "what was found does not make the error smaller on rows that were not used: do not add it, measure more rows \
         in other places first"
            .to_owned()
    })
}

/// Rows that the search does not believe are outliers too.
fn flag_outliers(compared: &mut Compared, kept: &[usize], found: &Found) {
    for (&i, weight) in kept.iter().zip(&found.weights) {
        if *weight < 0.1 {
            compared.comparison.residuals[i].outlier = true;
        }
    }
}

fn assemble(
    measurements: &Measurements,
    compared: Compared,
    found: Option<Found>,
    shown: Shown,
    options: &Options,
) -> Finding {
    let unrelated = !compared.is_related;
    let undetermined = found.as_ref().map_or_else(Vec::new, |found| found.undetermined.clone());
    let unexplained = Unexplained {
        p_value: compared.comparison.p_value,
        probability: if unrelated { 1.0 } else { 0.0 },
        depends_on: vec![],
        share: 1.0,
    };
    let (verdict, effects, candidates, unexplained, assumed): (_, Vec<NamedEffect>, _, _, _) = match found {
        Some(found) => (found.verdict, found.effects, found.candidates, found.unexplained, found.assumed),
        None => {
            let verdict = if unrelated { Verdict::NotInLibrary } else { Verdict::NoGap };
            (verdict, vec![], vec![], unexplained, compared.assumed)
        }
    };
    Finding {
        format: FORMAT,
        rig: measurements.rig.clone(),
        sessions: measurements.apparatuses.iter().map(|apparatus| apparatus.title.clone()).collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seed: options.seed,
        verdict,
        sentence: String::new(),
        comparison: compared.comparison,
        effects,
        candidates,
        shown,
        unexplained,
        next: None,
        placements: assumed.placements,
        mounts: assumed.mounts,
        undetermined,
        left_out: measurements.left_out.clone(),
        warnings: compared.warnings,
        seconds: 0.0,
    }
}

/// A part of the whole work, with its own progress from 0 to 1.
struct Stage<'a> {
    context: &'a dyn JobContext,
    from: f64,
    to: f64,
}

impl<'a> Stage<'a> {
    fn new(context: &'a dyn JobContext, from: f64, to: f64) -> Self {
        Self { context, from, to }
    }
}

impl JobContext for Stage<'_> {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        self.context.checkpoint()
    }
    fn report(&self, fraction: f64, doing: &str) {
        self.context.report(self.from + (self.to - self.from) * fraction, doing);
    }
}
