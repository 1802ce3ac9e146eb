//! The whole way: compare, search, show, advise.

use std::time::Instant;

use plumbline_effects::{Kind, Measurements};
use plumbline_model::{Cancelled, JobContext};

use crate::bounds;
use crate::compare::{self, Compared, compare};
use crate::error::GapError;
use crate::finding::{FORMAT, Finding, FloorSource, NamedEffect, Shown, Unexplained, Verdict};
use crate::floor::Floor;
use crate::marker;
use crate::next;
use crate::offer;
use crate::options::Options;
use crate::search::{self, Found};
use crate::sentence;
use crate::servos;
use crate::show;
use crate::watched;

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
    let Some(watched) = watched::told(measurements) else {
        return found_in(measurements, &[], options, context);
    };
    let finding = found_in(&watched.measurements, &watched.words, options, context)?;
    // Several things that stand still are a grid as well: what is constant there has a name.
    if finding.verdict == Verdict::NoGap && watched.places > 2 {
        return found_in(measurements, &[], options, context);
    }
    Ok(finding)
}

/// The same, with what was told of the rows beforehand, in words.
fn found_in(
    measurements: &Measurements,
    told_before: &[String],
    options: &Options,
    context: &dyn JobContext,
) -> Result<Finding, GapError> {
    let start = Instant::now();
    context.checkpoint()?;
    // What cannot be looked at is refused with its own words, not taken for a turned marker.
    compare::refuse(measurements, context)?;
    let anew = marker::mounted_anew(measurements, context)?;
    let (measurements, told) = anew.as_ref().map_or((measurements, &[][..]), |(of, words)| (of, words));
    let mut compared = compare(measurements, options.seed, &Stage::new(context, 0.0, COMPARED))?;
    compared.warnings.extend(told_before.iter().chain(told).cloned());
    if !compared.comparison.is_gap || !compared.is_related {
        return Ok(without_search(measurements, compared, options, start));
    }
    let kept: Vec<usize> = (0..measurements.rows.len()).filter(|&i| !compared.outlier[i]).collect();
    let used = measurements.only(kept.iter().copied());
    let searching = Instant::now();
    let mut found =
        search::search(&used, &compared.floor, options, &Stage::new(context, COMPARED, SEARCHED))?;
    let search_s = searching.elapsed().as_secs_f64();
    // Against a floor that says nothing of the noise nothing is dirt.
    if found.effects.is_empty()
        && found.verdict != Verdict::NoGap
        && found.floor.source != FloorSource::Fitted
        && compared.comparison.size_sigmas < DIRT_SIGMAS
    {
        found.verdict = Verdict::NoGap;
    }
    context.checkpoint()?;
    if found.floor != compared.floor {
        with_floor(&mut compared, &found.floor);
    }
    let mut shown = if options.show && !found.assumed.effects.is_empty() {
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
    bounds::still_structured(&mut found, &used, &compared);
    bounds::no_all_clear_without_them(&mut found, &used, &compared);
    bounds::still_alike(&mut found, &used, options.seed, context)?;
    bounds::bound_by_own_rows(&mut found, &used);
    bounds::bound_by_what_can_be(&mut found);
    bounds::bound_by_held_out(&mut found, &used, &shown, &mut compared.warnings);
    let partial = offer::offer(&mut found, &mut shown, &mut compared.warnings);
    if let Some(words) = no_help(&found, &shown, options) {
        compared.warnings.insert(0, words);
    }
    let servos = servos::servos(&used, &compared.floor, &found.assumed);
    let mut finding = assemble(measurements, compared, Some(found), shown, options);
    finding.next = next;
    finding.partial = partial;
    with_servos(&mut finding, servos);
    finding.seconds = start.elapsed().as_secs_f64();
    finding.sentence = sentence::of(&finding);
    context.report(1.0, "done");
    Ok(finding)
}

/// What servos do between command and encoder stands beside what touches say of the arm.
fn with_servos(finding: &mut Finding, (servos, words): (Vec<NamedEffect>, Option<String>)) {
    finding.warnings.extend(words);
    let unrelated = finding.verdict == Verdict::NotInLibrary && finding.effects.is_empty();
    if servos.is_empty() || unrelated {
        return;
    }
    // Where the finger is where the joint was sent, an encoder that stays behind has play in its drive: nothing
    // holds the joint back.
    let plays = |servo: &NamedEffect| {
        let same = |effect: &NamedEffect| effect.id == Kind::Backlash.id() && effect.site == servo.site;
        let may_play = servo.class.iter().any(|member| member.id == Kind::Backlash.id());
        (servo.id == Kind::Stiction.id() || may_play) && finding.effects.iter().any(same)
    };
    let servos: Vec<NamedEffect> = servos.into_iter().filter(|servo| !plays(servo)).collect();
    if finding.verdict == Verdict::NoGap && !servos.is_empty() {
        finding.verdict = Verdict::Named;
    }
    if finding.verdict == Verdict::Named && servos.iter().any(|servo| servo.class.len() > 1) {
        finding.verdict = Verdict::Class;
    }
    finding
        .effects
        .retain(|effect| servos.iter().all(|servo| (&servo.id, &servo.site) != (&effect.id, &effect.site)));
    finding.effects.extend(servos);
}

/// The answer where there is nothing to search for, or nothing that may be named.
fn without_search(
    measurements: &Measurements,
    compared: Compared,
    options: &Options,
    start: Instant,
) -> Finding {
    let shown = show::nothing_added(measurements, &compared);
    let servos = servos::servos(measurements, &compared.floor, &compared.assumed);
    let mut finding = assemble(measurements, compared, None, shown, options);
    with_servos(&mut finding, servos);
    finding.seconds = start.elapsed().as_secs_f64();
    finding.sentence = sentence::of(&finding);
    finding
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
    // Where some of it may not be added, the rest is what somebody would add.
    let after = shown.part.as_ref().map_or(shown.after, |part| part.after);
    let helps = after < shown.before || !options.show || found.assumed.effects.is_empty();
    (!helps).then(|| {
        "what was found does not make the error smaller on rows that were not used: do not add it, measure more rows \
         in other places first"
            .to_owned()
    })
}

/// Rows that the search does not believe are outliers too.
fn flag_outliers(compared: &mut Compared, kept: &[usize], found: &Found) {
    let mut dropped = 0;
    for (&i, weight) in kept.iter().zip(&found.weights) {
        if *weight < bounds::NOT_BELIEVED {
            compared.comparison.residuals[i].outlier = true;
            dropped += 1;
        }
    }
    if dropped as f64 > bounds::MANY * kept.len() as f64 {
        compared.warnings.push(format!(
            "{dropped} of {} rows fit nothing that was found and hardly counted: look at them first (gray on the map)",
            kept.len()
        ));
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
    let many = found.as_ref().and_then(|found| found.many);
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
        partial: false,
        many,
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
