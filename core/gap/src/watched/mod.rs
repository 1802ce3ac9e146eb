//! Logs of one place: a thing that stands still, seen again and again by eyes that stand still too.
//!
//! Such rows differ in time alone. Whether the mount is off, a zero of the neck, or the place that somebody
//! wrote down cannot be told there: what is constant is found along with the effects and has no name. What
//! grows is the eyes'. A thing that jumps was moved by hand, or an eye was knocked: before and after have a
//! constant of their own.

mod course;
mod jump;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use plumbline_effects::Measurements;
use plumbline_effects::measurements::Observation;

use crate::seen::nominal_place_m;
use crate::statistics::median;
use jump::{Jump, jumps};

/// A thing is watched that was seen at least so many times …
pub(crate) const LEAST_LOOKS: usize = 8;
/// … over so long, s.
const LEAST_TIME_S: f64 = 60.0;
/// It stands still within this, m; the head within this, rad.
const SAME_PLACE_M: f64 = 2e-3;
const SAME_POSTURE_RAD: f64 = 5e-3;
/// More things than this are watched only if each pair of images shows them all: else it is a grid that was
/// measured several times.
const MOST_APART: usize = 2;
/// Every so-many-th look is held out together.
const FOLDS: usize = 5;

/// Measurements in which what was watched is told.
pub(crate) struct Watched {
    /// Rows know their stand, each is a cell of its own.
    pub measurements: Measurements,
    /// Things that were watched.
    pub places: usize,
    /// What is to be said of it.
    pub words: Vec<String>,
}

/// The measurements with what was watched told, where all that the eyes saw of a session was; `None`
/// where there is no such session.
pub(crate) fn told(measurements: &Measurements) -> Option<Watched> {
    let mut told = Watched { measurements: measurements.clone(), places: 0, words: vec![] };
    let mut stands = 0;
    for session in 0..measurements.apparatuses.len() {
        let Some(things) = things(measurements, session) else { continue };
        let title = &measurements.apparatuses[session].title;
        told.words.push(of_watching(measurements, title, &things));
        for (number, thing) in things.iter().enumerate() {
            let found = jumps(measurements, thing);
            told.words.extend(found.iter().map(|jump| of_jump(title, number, things.len(), jump)));
            for &i in thing {
                let t_secs = measurements.rows[i].t_secs.unwrap_or_default();
                let after = found.iter().filter(|jump| t_secs > jump.between_s[0]).count();
                told.measurements.rows[i].stand = Some(stands + after);
            }
            stands += found.len() + 1;
        }
        told.places += things.len();
    }
    if told.places == 0 {
        return None;
    }
    apart(&mut told.measurements);
    Some(told)
}

/// Probability that noise alone makes things that were watched seem to go anywhere in the course of time;
/// `None` where none was watched. As many as there are count as so many tests.
pub(crate) fn course_by_chance(told: &Measurements) -> Option<f64> {
    let watched =
        |session: &usize| told.rows.iter().any(|row| row.session == *session && row.stand.is_some());
    let sessions = (0..told.apparatuses.len()).filter(watched);
    let things: Vec<Vec<usize>> = sessions.filter_map(|session| things(told, session)).flatten().collect();
    let of_thing = |thing: &Vec<usize>| jump::course_by_chance(told, thing, &jumps(told, thing));
    let least = things.iter().map(of_thing).reduce(f64::min)?;
    Some((least * things.len() as f64).min(1.0))
}

/// Rows of each thing in the order of time; `None`: not all that the eyes saw of this session was watched.
fn things(measurements: &Measurements, session: usize) -> Option<Vec<Vec<usize>>> {
    let rows = (0..measurements.rows.len()).filter(|&i| {
        let row = &measurements.rows[i];
        row.session == session && !row.what.is_placed()
    });
    let mut things: Vec<Vec<usize>> = vec![];
    for i in rows {
        let row = &measurements.rows[i];
        row.t_secs?;
        match things.iter_mut().find(|thing| is_same(&measurements.rows[thing[0]], row)) {
            Some(thing) => thing.push(i),
            None => things.push(vec![i]),
        }
    }
    let secs = |i: usize| measurements.rows[i].t_secs.unwrap_or_default();
    let millis = |thing: &Vec<usize>| -> BTreeSet<i64> {
        thing.iter().map(|&i| (secs(i) * 1e3).round() as i64).collect()
    };
    let all: Vec<BTreeSet<i64>> = things.iter().map(millis).collect();
    let lasts = |times: &BTreeSet<i64>| {
        let span_ms = times.last().zip(times.first()).map_or(0, |(last, first)| last - first);
        times.len() >= LEAST_LOOKS && span_ms as f64 >= LEAST_TIME_S * 1e3
    };
    let together = all.len() <= MOST_APART || all.windows(2).all(|pair| pair[0] == pair[1]);
    if all.is_empty() || !together || !all.iter().all(lasts) {
        return None;
    }
    things.iter_mut().for_each(|thing| thing.sort_by(|&a, &b| secs(a).total_cmp(&secs(b))));
    Some(things)
}

/// Whether two rows are of one thing, seen from one posture.
fn is_same(a: &Observation, b: &Observation) -> bool {
    let near = |a: &Point3<f64>, b: &Point3<f64>| (a - b).norm() < SAME_PLACE_M;
    a.what == b.what
        && a.object == b.object
        && a.truth_m.zip(b.truth_m).is_some_and(|(a, b)| near(&a, &b))
        && a.neck_rad.iter().zip(&b.neck_rad).all(|(a, b)| (a - b).abs() < SAME_POSTURE_RAD)
}

/// Every row is a measurement of its own, and every so-many-th look is held out together: a law of time is
/// used within the time that it was seen in.
fn apart(measurements: &mut Measurements) {
    let first = measurements.cell_count();
    for session in 0..measurements.apparatuses.len() {
        let own = |row: &Observation| row.session == session && row.stand.is_some();
        let millis = |row: &Observation| (row.t_secs.unwrap_or_default() * 1e3).round() as i64;
        let times: BTreeSet<i64> = measurements.rows.iter().filter(|row| own(row)).map(millis).collect();
        let number: BTreeMap<i64, usize> = times.into_iter().enumerate().map(|(k, t)| (t, k)).collect();
        for (i, row) in measurements.rows.iter_mut().enumerate().filter(|(_, row)| own(row)) {
            let look = number.get(&millis(row)).copied().unwrap_or_default();
            row.cell = first + i;
            row.pose = Some(first + FOLDS * session + look % FOLDS);
        }
    }
}

/// Part of every sentence about what was watched.
pub(crate) const WATCHED: &str = " watched for ";

fn of_watching(measurements: &Measurements, title: &str, things: &[Vec<usize>]) -> String {
    let secs = |i: &usize| measurements.rows[*i].t_secs.unwrap_or_default();
    let span_s =
        things.iter().map(|thing| secs(&thing[thing.len() - 1]) - secs(&thing[0])).fold(0.0, f64::max);
    let off_m = |thing: &Vec<usize>| {
        let off = |i: &usize| {
            let row = &measurements.rows[*i];
            Some(nominal_place_m(measurements, row)? - row.truth_m?)
        };
        let early: Vec<_> = thing.iter().take(thing.len().div_ceil(4)).filter_map(off).collect();
        let middle = |c: usize| median(early.iter().map(|off| off[c])).unwrap_or(0.0);
        middle(0).hypot(middle(1)).hypot(middle(2))
    };
    let most_m = things.iter().map(off_m).fold(0.0, f64::max);
    let (what, there) =
        if things.len() == 1 { ("one place was", "there") } else { ("places were", "at each") };
    let count = if things.len() == 1 { String::new() } else { format!("{} ", things.len()) };
    format!(
        "{title}: {count}{what}{WATCHED}{:.0} min. What is constant {there} (up to {:.0} mm) can be the mount, a zero of \
         the neck, or the place that was written down; it was set aside, and only what changes has a name. Measure \
         several places once to tell what is constant",
        span_s / 60.0,
        most_m * 1e3
    )
}

fn of_jump(title: &str, number: usize, things: usize, jump: &Jump) -> String {
    let which = if things == 1 { "the thing".to_owned() } else { format!("thing {}", number + 1) };
    let [from_s, to_s] = jump.between_s;
    format!(
        "{title}: between {:.1} and {:.1} min after the eyes were switched on {which} jumped by {:.0} mm: it was moved \
         by hand, or somebody knocked against the eyes. Before and after have a constant of their own",
        from_s / 60.0,
        to_s / 60.0,
        jump.by_m * 1e3
    )
}
