//! When a thing that was watched was somewhere else at once.

use nalgebra::{Rotation3, Vector3};
use plumbline_effects::{Growth, Measurements};

use super::course::{Course, Left};
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
/// … and from this size on, in what it leaves, beside whatever else goes on meanwhile …
const LEAST_SIGMAS: f64 = 5.0;
/// … or from this one on where it is all that goes on.
const LEAST_ALONE_SIGMAS: f64 = 1.5;
/// Whoever moves a thing by hand moves it further than a detector's box goes in one of its steps: seen from the eyes, rad;
/// and what a pixel is there.
const LEAST_RAD: f64 = 8e-3;
const RAD_PER_PX: f64 = 1.0 / 150.0;
/// A step stands for all that goes on where it is no less probable than a smooth course: log odds.
const AS_WELL: f64 = 0.0;
/// What a fit leaves is no finer than this, m.
const LEAST_M: f64 = 1e-5;
/// At most so many.
const MOST: usize = 3;
/// Smooth courses: time constants (s) of what warms up, of what warms it, and rows that each turn of a wobble needs.
const WARM_S: [f64; 8] = [100.0, 160.0, 250.0, 400.0, 650.0, 1000.0, 1600.0, 4000.0];
const LATE_S: [f64; 3] = [0.0, 60.0, 240.0];
const ROWS_PER_TURN: usize = 5;

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
    let Some(seen) = Course::measured(measurements, rows, RAD_PER_PX) else { return vec![] };
    let Some(places) = places(measurements, rows) else { return vec![] };
    let mut found: Vec<Jump> = vec![];
    while found.len() < MOST {
        let Some(between_s) = next(&seen, &found) else { break };
        found.push(Jump { between_s, by_m: f64::NAN });
        found.sort_by(|a, b| a.between_s[0].total_cmp(&b.between_s[0]));
    }
    for k in 0..found.len() {
        let mut columns: Vec<Jump> = found.clone();
        let own = columns.remove(k);
        let with = |t_s: f64| [jumped(&columns, t_s), vec![after(t_s, &own)]].concat();
        let last = places.fitted(&with).map_or(vec![], |left| left.last);
        found[k].by_m = last.iter().map(|part| part * part).sum::<f64>().sqrt();
    }
    found
}

/// Where the nominal eyes see the thing, m.
fn places(measurements: &Measurements, rows: &[usize]) -> Option<Course> {
    let of_row = |&i: &usize| {
        let row = &measurements.rows[i];
        Some((row.t_secs?, nominal_place_m(measurements, row)?.coords))
    };
    in_space(rows.iter().filter_map(of_row).collect())
}

fn in_space(seen: Vec<(f64, Vector3<f64>)>) -> Option<Course> {
    let times: Vec<f64> = seen.iter().map(|(t_s, _)| *t_s).collect();
    (!seen.is_empty()).then(|| Course::new(times, 3, |r, c| seen[r].1[c], vec![LEAST_M; 3], f64::NAN))
}

/// Probability that noise alone makes a thing seem to go anywhere in the course of time, beside its jumps.
///
/// Eyes that turn against each other move what they see along the line of sight above all, and as one warm-up
/// goes: most of what may be found by chance is spent on that one question, the rest on other times and on the
/// directions across (weighted Bonferroni).
pub(super) fn course_by_chance(measurements: &Measurements, rows: &[usize], jumps: &[Jump]) -> f64 {
    let Some(seen) = along_and_across(measurements, rows) else { return 1.0 };
    let first_s = seen.t_s[0];
    let still = seen.fitted(&|t_s| jumped(jumps, t_s));
    let by_chance = |constants_s: &[f64]| -> Option<[f64; 3]> {
        let grown = |t_s: f64| constants_s.iter().map(move |constant_s| share(t_s - first_s, *constant_s));
        let moving = seen.fitted(&|t_s| jumped(jumps, t_s).into_iter().chain(grown(t_s)).collect());
        let (before, after) = (&still.as_ref()?.squares, moving?.squares);
        let used = constants_s.len() as f64;
        let free = seen.t_s.len() as f64 - used - 1.0 - jumps.len() as f64;
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

/// Places seen from the left eye: along the line of sight to the thing, then across, m.
fn along_and_across(measurements: &Measurements, rows: &[usize]) -> Option<Course> {
    let of_row = |&i: &usize| {
        let row = &measurements.rows[i];
        Some((row.t_secs?, nominal_in_left_m(measurements, row)?.coords))
    };
    let seen: Vec<(f64, Vector3<f64>)> = rows.iter().filter_map(of_row).collect();
    let middle: Vector3<f64> = seen.iter().map(|(_, at)| at).sum();
    let turn = Rotation3::rotation_between(&middle, &Vector3::x())?;
    in_space(seen.into_iter().map(|(t_s, at)| (t_s, turn * at)).collect())
}

/// A constant, and one for each jump.
fn jumped(jumps: &[Jump], t_s: f64) -> Vec<f64> {
    std::iter::once(1.0).chain(jumps.iter().map(|jump| after(t_s, jump))).collect()
}

fn after(t_s: f64, jump: &Jump) -> f64 {
    f64::from(u8::from(t_s > jump.between_s[0]))
}

/// What grows with each time constant after so long.
fn grown(since_s: f64) -> Vec<f64> {
    COURSES_S.iter().map(|constant_s| share(since_s, *constant_s)).collect()
}

fn share(since_s: f64, constant_s: f64) -> f64 {
    1.0 - (-since_s / constant_s).exp()
}

/// The best smooth course beside jumps that are known: its score.
fn smooth(seen: &Course, known: &[Jump]) -> f64 {
    let (first_s, last_s) = (seen.t_s[0], seen.t_s[seen.t_s.len() - 1]);
    let mut best = f64::NEG_INFINITY;
    let mut try_one = |columns: usize, of: &dyn Fn(f64) -> Vec<f64>| {
        let left = seen.fitted(&|t_s| [jumped(known, t_s), of(t_s)].concat());
        let score = left.map_or(f64::NEG_INFINITY, |left| seen.score(&left, columns));
        best = best.max(score);
    };
    for (time_constant_s, late_s) in WARM_S.into_iter().flat_map(|s| LATE_S.map(|late_s| (s, late_s))) {
        let growth = Growth { time_constant_s, delay_s: 0.0, late_s };
        try_one(1, &|t_s| vec![growth.share(t_s)]);
    }
    try_one(COURSES_S.len(), &|t_s| grown(t_s - first_s));
    // Turns by halves.
    for halves in 2..=2 * seen.t_s.len() / ROWS_PER_TURN {
        let phase = |t_s: f64| std::f64::consts::PI * halves as f64 * (t_s - first_s) / (last_s - first_s);
        try_one(2, &|t_s| vec![phase(t_s).sin(), phase(t_s).cos()]);
    }
    best
}

/// The surest jump beside those that are known: times of the rows before and after it, s.
fn next(seen: &Course, known: &[Jump]) -> Option<[f64; 2]> {
    let moments: Vec<[f64; 2]> = moments(seen, known);
    let course = |t_s: f64| [jumped(known, t_s), grown(t_s - seen.t_s[0])].concat();
    let beside = surest(seen, &moments, &course, 1 + known.len() + COURSES_S.len());
    let alone = surest(seen, &moments, &|t_s| jumped(known, t_s), 1 + known.len());
    let is_sure = |step: &Step| step.chance < SIGNIFICANT && step.by_rad > LEAST_RAD;
    let is_beside = |step: &Step| is_sure(step) && step.sigmas > LEAST_SIGMAS;
    let is_alone = |step: &Step| {
        is_sure(step)
            && step.sigmas > LEAST_ALONE_SIGMAS
            && step.score - (moments.len() as f64).ln() >= smooth(seen, known) + AS_WELL
    };
    beside.filter(is_beside).or_else(|| alone.filter(is_alone)).map(|step| step.between_s)
}

/// Pairs of times between which a thing may have jumped.
fn moments(seen: &Course, known: &[Jump]) -> Vec<[f64; 2]> {
    let near = |jump: &Jump, at_s: f64| {
        let apart = seen.t_s.iter().filter(|t| (**t > jump.between_s[0]) != (**t > at_s)).count();
        apart < LEAST_ROWS
    };
    (LEAST_ROWS..=seen.t_s.len().saturating_sub(LEAST_ROWS))
        .map(|k| [seen.t_s[k - 1], seen.t_s[k]])
        .filter(|[from_s, to_s]| from_s < to_s && !known.iter().any(|jump| near(jump, *from_s)))
        .collect()
}

/// A step beside a course.
struct Step {
    between_s: [f64; 2],
    /// Probability by chance, of all moments that were tried.
    chance: f64,
    /// The largest part of it, in what is left.
    sigmas: f64,
    /// The same seen from the eyes, rad.
    by_rad: f64,
    /// See [`Course::score`].
    score: f64,
}

/// The step that is least by chance beside a course of so many columns; all coordinates jump together.
fn surest(
    seen: &Course,
    moments: &[[f64; 2]],
    course: &dyn Fn(f64) -> Vec<f64>,
    columns: usize,
) -> Option<Step> {
    let free = seen.t_s.len() as f64 - 1.0 - columns as f64;
    if free < 4.0 {
        return None;
    }
    let before = seen.fitted(course)?.squares;
    let width = seen.width() as f64;
    let of = |between_s: &[f64; 2]| {
        let own = Jump { between_s: *between_s, by_m: f64::NAN };
        let left: Left = seen.fitted(&|t_s| [course(t_s), vec![after(t_s, &own)]].concat())?;
        let rest = |c: usize| (left.squares[c] / free).max(seen.least[c].powi(2));
        let gained = |c: usize| (before[c] - left.squares[c]) / rest(c);
        let all: f64 = (0..seen.width()).map(gained).sum();
        let sigmas = (0..seen.width()).map(|c| left.last[c].abs() / rest(c).sqrt()).fold(0.0, f64::max);
        let by_rad = seen.unit_rad * left.last.iter().map(|part| part.abs()).fold(0.0, f64::max);
        let chance = f_tail(all / width, width, width * free) * moments.len() as f64;
        Some(Step { between_s: *between_s, chance, sigmas, by_rad, score: seen.score(&left, 1) })
    };
    moments.iter().filter_map(of).min_by(|a, b| a.chance.total_cmp(&b.chance))
}
