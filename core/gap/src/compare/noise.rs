//! The noise floor: from repeats, else from near neighbors.
//!
//! Repeats: spread of residuals about the mean of their cell, pooled, without what lies further out
//! than four robust standard deviations. Near neighbors (Rice): each row less a plane through its
//! neighbors, after a smooth fit; right only as far as effects are smooth, so it is approximate.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use plumbline_effects::Assumed;
use plumbline_effects::measurements::{Measurements, Unit, What};
use plumbline_model::decompose;

use super::drift::{Deviation, Drift, drift};
use super::levers::{lagged, levers};
use super::neighbors::Points;
use super::structure::{Repeat, Structure, structure, wobble};
use super::sway::sway;
use crate::finding::FloorSource;
use crate::floor::{Floor, KindFloor, finest, of_freedom};
use crate::statistics::{ALIKE, median, robust_sd, stepped_sd};

/// Fewer degrees of freedom than this say too little of the spread: 20 know it to a sixth. What
/// repeats say is taken as it is, what neighbors say with doubt.
const FEWEST: f64 = 20.0;
/// Deviations beyond this many robust standard deviations are no noise.
const FAR: f64 = 4.0;
/// A coordinate that spreads less than this share of the others was not measured by itself: the
/// height of a touch follows from the command.
const NOT_MEASURED: f64 = 0.02;

/// Noise of the height of a touch against that along the glass, where only commands are known.
const HEIGHT_SHARE: f64 = 0.5;

/// A time law is an approximation: this share of the way that a watched thing goes counts as noise.
const LAW_SHARE: f64 = 0.03;
/// And this share of the longest way in the coordinates beside it: what turns one way turns a little the others.
const BESIDE_SHARE: f64 = 0.01;

/// Noise with what is known of where it comes from.
pub struct Noise {
    /// Per kind and coordinate.
    pub floor: Floor,
    /// Per kind of [`Floor::kinds`] and coordinate: whether repeats say it.
    pub repeated: Vec<Vec<bool>>,
    /// What changed between repeats over time, where something did.
    pub drift: Option<Drift>,
    /// What else repeats depend on.
    pub structure: Option<Structure>,
}

/// The floor of rows with these residuals (`None`: not predictable, or an outlier) under a model.
pub fn floor_of(measurements: &Measurements, assumed: &Assumed, residuals: &[Option<Vec<f64>>]) -> Noise {
    let mut kinds = vec![];
    let mut repeated = vec![];
    let mut source = FloorSource::Repeats;
    let mut changed: Option<Drift> = None;
    let mut depends: Option<Structure> = None;
    for what in What::ALL {
        if !measurements.has(what) {
            continue;
        }
        let repeats = within_cells(measurements, residuals, what).map(|(mut repeats, course)| {
            let other = structure_within(measurements, assumed, residuals, what, repeats.degrees_of_freedom);
            // The surer of both says what is noise.
            let left = match (&course, &other) {
                (Some(course), Some(other)) if other.p_value < course.p_value => &other.left[..],
                (Some(course), _) => &course.left,
                (None, Some(other)) => &other.left,
                (None, None) => &[],
            };
            repeats.sd.iter_mut().zip(left).for_each(|(sd, left)| *sd *= left.sqrt());
            changed = course.or(changed.take());
            depends = other.or(depends.take());
            repeats
        });
        let mut nearby = near_neighbors(measurements, residuals, what);
        if let Some(wobble) = watched_wobble(measurements, residuals, what) {
            // Neighbors in time hardly differ by a slow wobble, but by a quick one.
            let rest = scatter(measurements, residuals, what);
            let left = rest.iter().zip(&wobble.left).map(|(sd, left)| sd * left.sqrt());
            nearby.sd.iter_mut().zip(left).for_each(|(sd, left)| *sd = sd.min(left));
            depends = Some(wobble);
        }
        let known: Vec<bool> = match &repeats {
            Some(repeats) => {
                let units = what.coordinates().iter().map(|(_, unit)| *unit);
                let widest = |own: Unit| {
                    let of_unit = repeats.sd.iter().zip(what.coordinates()).filter(|(_, c)| c.1 == own);
                    of_unit.map(|(sd, _)| *sd).fold(0.0, f64::max)
                };
                repeats.sd.iter().zip(units).map(|(sd, unit)| *sd > NOT_MEASURED * widest(unit)).collect()
            }
            None => vec![false; what.len()],
        };
        let sigma_m = instrument(measurements, what);
        if repeats.is_none() {
            source = source.max(match sigma_m {
                Some(_) => FloorSource::Instrument,
                None if are_near(measurements, residuals, what) => FloorSource::Neighbors,
                None => FloorSource::Fitted,
            });
        }
        let free = repeats.as_ref().map_or(nearby.degrees_of_freedom, |repeats| repeats.degrees_of_freedom);
        let ways: Vec<f64> = (0..what.len()).map(|c| way(measurements, residuals, what, c)).collect();
        let least = follows_command(measurements, what, &known, repeats.as_ref().unwrap_or(&nearby));
        let sd = (0..what.len())
            .map(|c| match &repeats {
                Some(repeats) if known[c] => repeats.sd[c],
                None if c < 3 && sigma_m.is_some() => sigma_m.unwrap_or_default(),
                _ => nearby.sd[c].max(least[c]).hypot(of_law(&ways, c)),
            })
            .zip(what.coordinates())
            .map(|(sd, (_, unit))| sd.max(finest(*unit)))
            .collect();
        kinds.push(KindFloor { what, sd, degrees_of_freedom: free, sigma_m });
        repeated.push(known);
    }
    Noise { floor: Floor { kinds, source }, repeated, drift: changed, structure: depends }
}

/// What near neighbors say of the noise of eyes under a model with these residuals, where they told it; never more than it was.
/// What a mount that sits elsewhere does bends so much over a table that planes through neighbors leave some of it. `columns` were
/// fitted to all rows.
pub fn by_neighbors_of_eyes(
    measurements: &Measurements,
    floor: &Floor,
    residuals: &[Option<Vec<f64>>],
    columns: usize,
) -> Option<Floor> {
    let bends = measurements.rows.iter().all(|row| !row.what.is_placed() && row.stand.is_none());
    if floor.source != FloorSource::Neighbors || !bends {
        return None;
    }
    let inflate = of_freedom(residuals, columns);
    let mut next = floor.clone();
    for kind in &mut next.kinds {
        if within_cells(measurements, residuals, kind.what).is_some() {
            continue;
        }
        let nearby = near_neighbors(measurements, residuals, kind.what);
        let units = kind.what.coordinates().iter().map(|(_, unit)| finest(*unit));
        let all = kind.sd.iter_mut().zip(&nearby.sd).zip(units);
        all.for_each(|((sd, own), finest)| *sd = sd.min((inflate * own).max(finest)));
    }
    Some(next)
}

/// What a time law may be off by in a coordinate, in its unit: places and eye points have one unit each.
fn of_law(ways: &[f64], c: usize) -> f64 {
    let longest = ways.iter().copied().fold(0.0, f64::max);
    (LAW_SHARE * ways[c]).max(BESIDE_SHARE * longest)
}

/// How far a coordinate of things that were watched goes in the course of time, in its unit; 0 where none
/// was.
fn way(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What, c: usize) -> f64 {
    let rows = measurements.rows.iter().zip(residuals);
    let watched = rows.filter(|(row, _)| row.what == what && row.stand.is_some());
    let mut all: Vec<f64> = watched.filter_map(|(_, residual)| residual.as_ref()?.get(c).copied()).collect();
    all.sort_by(f64::total_cmp);
    let at = |share: f64| all.get((share * all.len().saturating_sub(1) as f64) as usize).copied();
    at(0.95).zip(at(0.05)).map_or(0.0, |(high, low)| high - low)
}

/// The least noise of coordinates that follow from the command: the height of a touch whose
/// encoders were not logged. How high the finger really was is as little known as where it met the
/// glass; as in the score of a plan, half of that is taken. Repeats of a command then say the same
/// height again and count once.
fn follows_command(
    measurements: &Measurements,
    what: What,
    known: &[bool],
    measured: &KindFloor,
) -> Vec<f64> {
    let mut least = vec![0.0; what.len()];
    let mut own = measurements.rows.iter().filter(|row| row.what == what).peekable();
    let by_command = own.peek().is_some_and(|row| row.encoder_rad.is_none());
    if what != What::Touch || known[2] || !by_command {
        return least;
    }
    let (mut rows, mut cells) = (0, std::collections::BTreeSet::new());
    for row in own {
        rows += 1;
        cells.insert(row.cell);
    }
    let level = (0.5 * (measured.sd[0].powi(2) + measured.sd[1].powi(2))).sqrt();
    least[2] = HEIGHT_SHARE * level * (f64::from(rows) / cells.len() as f64).sqrt();
    least
}

/// Whether rows have others that were measured nearly alike. Where more than a few joints move by
/// themselves, neighbors in the widest directions differ in all others.
fn are_near(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> bool {
    let points = Points::of(measurements, what, one_per_cell(measurements, residuals, what).into_iter());
    let watched = points.rows.iter().all(|&i| measurements.rows[i].stand.is_some());
    // What the eyes err by changes slowly over all that they see; what an arm errs by does not.
    let by_eyes = watched || !what.is_placed();
    points.are_near() && (by_eyes || points.reach_near(&points.nearest(points.of_a_plane())))
}

/// Rows of a kind, the first of each cell: repeats lie on the same place and would make planes of one point.
fn one_per_cell(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Vec<usize> {
    let mut seen = std::collections::BTreeSet::new();
    (0..measurements.rows.len())
        .filter(|&i| residuals[i].is_some() && measurements.rows[i].what == what)
        .filter(|&i| seen.insert(measurements.rows[i].cell))
        .collect()
}

/// Median of the instrument's own standard deviations, m; `None` where a row has none.
fn instrument(measurements: &Measurements, what: What) -> Option<f64> {
    let own = measurements.rows.iter().filter(|row| row.what == what).map(|row| row.sigma_m);
    let all: Vec<f64> = own.collect::<Option<_>>()?;
    median(all)
}

fn within_cells(
    measurements: &Measurements,
    residuals: &[Option<Vec<f64>>],
    what: What,
) -> Option<(KindFloor, Option<Drift>)> {
    let mut cells = BTreeMap::<usize, Vec<&Vec<f64>>>::new();
    for (row, residual) in measurements.rows.iter().zip(residuals) {
        if let Some(residual) = residual.as_ref().filter(|_| row.what == what) {
            cells.entry(row.cell).or_default().push(residual);
        }
    }
    cells.retain(|_, members| members.len() >= 2);
    let free: f64 = cells.values().map(|members| members.len() as f64 - 1.0).sum();
    if free < FEWEST {
        return None;
    }
    let sd = (0..what.len())
        .map(|c| {
            let spread: Vec<f64> = cells
                .values()
                .flat_map(|members| {
                    let count = members.len() as f64;
                    let mean = members.iter().map(|residual| residual[c]).sum::<f64>() / count;
                    let inflate = (count / (count - 1.0)).sqrt();
                    members.iter().map(move |residual| (residual[c] - mean) * inflate)
                })
                .collect();
            let robust = robust_sd(spread.iter().copied());
            pooled(&spread, robust)
        })
        .collect();
    let course = drift(&deviations(measurements, residuals, what), free);
    Some((KindFloor { what, sd, degrees_of_freedom: free, sigma_m: None }, course))
}

/// What repeats of any kind still depend on under a model with these residuals, or, where the noise is not told (`is_told`), poses
/// without any: the largest.
pub fn structure_of(
    measurements: &Measurements,
    assumed: &Assumed,
    residuals: &[Option<Vec<f64>>],
    is_told: bool,
) -> Option<Structure> {
    let of = |what: What| -> Option<Structure> {
        if let Some(wobble) = watched_wobble(measurements, residuals, what) {
            return Some(wobble);
        }
        let Some((repeats, course)) = within_cells(measurements, residuals, what) else {
            return if is_told { None } else { sway(measurements, residuals, what) };
        };
        let course = course.map(|course| Structure::new("time".to_owned(), course.p_value, course.left));
        let other = structure_within(measurements, assumed, residuals, what, repeats.degrees_of_freedom);
        course.into_iter().chain(other).max_by(|a, b| a.size_sigmas.total_cmp(&b.size_sigmas))
    };
    let all = What::ALL.into_iter().filter(|what| measurements.has(*what)).filter_map(of);
    all.max_by(|a, b| a.size_sigmas.total_cmp(&b.size_sigmas))
}

/// What a wobble over time does to things that were watched: what stood still at one place is one cell.
fn watched_wobble(
    measurements: &Measurements,
    residuals: &[Option<Vec<f64>>],
    what: What,
) -> Option<Structure> {
    let rows = of_stands(measurements, residuals, what);
    let stands: std::collections::BTreeSet<usize> = rows.iter().map(|row| row.cell).collect();
    wobble(&rows, rows.len() as f64 - stands.len() as f64)
}

/// Standard deviation of each coordinate about the mean of what stood still.
fn scatter(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Vec<f64> {
    let rows = of_stands(measurements, residuals, what);
    let of = |c: usize| rows.iter().map(|row| row.off[c].powi(2)).sum::<f64>() / rows.len().max(1) as f64;
    (0..what.len()).map(|c| of(c).sqrt()).collect()
}

/// Rows of one kind of the session in which most was watched, less the mean of what stood still at one place.
fn of_stands(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Vec<Repeat> {
    let mut sessions = BTreeMap::<usize, Vec<(usize, f64, &Vec<f64>)>>::new();
    for (row, residual) in measurements.rows.iter().zip(residuals).filter(|(row, _)| row.what == what) {
        if let (Some(stand), Some(t_secs), Some(residual)) = (row.stand, row.t_secs, residual) {
            sessions.entry(row.session).or_default().push((stand, t_secs, residual));
        }
    }
    let Some(seen) = sessions.into_values().max_by_key(Vec::len) else { return vec![] };
    let mut sums = BTreeMap::<usize, (Vec<f64>, f64)>::new();
    for (stand, _, residual) in &seen {
        let (sum, count) = sums.entry(*stand).or_insert_with(|| (vec![0.0; residual.len()], 0.0));
        sum.iter_mut().zip(residual.iter()).for_each(|(sum, value)| *sum += value);
        *count += 1.0;
    }
    // Things that are seen together share what that look is off by: they are one look.
    let mut looks = BTreeMap::<i64, Vec<(usize, f64, Vec<f64>)>>::new();
    for (stand, t_secs, residual) in seen {
        let (sum, count) = &sums[&stand];
        let off = residual.iter().zip(sum).map(|(value, sum)| value - sum / count).collect();
        looks.entry((t_secs * 1e3).round() as i64).or_default().push((stand, t_secs, off));
    }
    let mut known: Vec<Vec<usize>> = vec![];
    let one = |together: Vec<(usize, f64, Vec<f64>)>| {
        let stands: Vec<usize> = together.iter().map(|(stand, ..)| *stand).collect();
        let cell = known.iter().position(|other| *other == stands).unwrap_or(known.len());
        if cell == known.len() {
            known.push(stands);
        }
        let mean = |c: usize| together.iter().map(|(.., off)| off[c]).sum::<f64>() / together.len() as f64;
        let off = (0..what.len()).map(mean).collect();
        Repeat {
            cell,
            when: together[0].1,
            turned_rad: vec![],
            temperature_c: None,
            at: None,
            off,
            levers: vec![],
            lagged: vec![],
        }
    };
    looks.into_values().map(one).collect()
}

/// What repeats of one kind depend on, of the session with most of them.
fn structure_within(
    measurements: &Measurements,
    assumed: &Assumed,
    residuals: &[Option<Vec<f64>>],
    what: What,
    free: f64,
) -> Option<Structure> {
    let of_kind = |i: &usize| measurements.rows[*i].what == what;
    let mut sessions = BTreeMap::<usize, Vec<usize>>::new();
    for i in (0..measurements.rows.len()).filter(of_kind) {
        sessions.entry(measurements.rows[i].session).or_default().push(i);
    }
    let share =
        |own: &[usize]| own.len() as f64 / sessions.values().map(Vec::len).sum::<usize>().max(1) as f64;
    let (session, rows) = sessions.iter().max_by_key(|(_, own)| own.len())?;
    let repeats = repeats(measurements, assumed, residuals, rows);
    let apparatus = &measurements.apparatuses[*session];
    let parts = if what.is_placed() {
        apparatus.arm.as_ref().map(|arm| &arm.parts)
    } else {
        apparatus.eyes.as_ref().map(|eyes| &eyes.neck.parts)
    };
    let titles: Vec<String> = parts.into_iter().flatten().map(|part| part.title.clone()).collect();
    let timed = rows.iter().all(|&i| measurements.rows[i].t_secs.is_some());
    structure(&repeats, free * share(rows), if timed { "time" } else { "the order of the rows" }, &titles)
}

/// Rows of cells with repeats, in their order, less the mean of their cell.
fn repeats(
    measurements: &Measurements,
    assumed: &Assumed,
    residuals: &[Option<Vec<f64>>],
    rows: &[usize],
) -> Vec<Repeat> {
    let timed = rows.iter().all(|&i| measurements.rows[i].t_secs.is_some());
    let mut ordered = rows.to_vec();
    if timed {
        ordered.sort_by(|&a, &b| {
            let t_secs = |i: usize| measurements.rows[i].t_secs.unwrap_or_default();
            t_secs(a).total_cmp(&t_secs(b))
        });
    }
    let stands = |i: usize| -> &[f64] {
        let row = &measurements.rows[i];
        if row.what.is_placed() { row.angles_rad() } else { &row.neck_rad }
    };
    // What was measured first in a cell says where it lies.
    let mut places = BTreeMap::<usize, [f64; 2]>::new();
    for row in ordered.iter().map(|&i| &measurements.rows[i]).filter(|row| row.what.is_placed()) {
        if let [x, y, ..] = row.measured[..] {
            places.entry(row.cell).or_insert([x, y]);
        }
    }
    let mut means = BTreeMap::<usize, (Vec<f64>, f64)>::new();
    for (i, residual) in rows.iter().filter_map(|&i| Some((i, residuals[i].as_ref()?))) {
        let (sum, count) =
            means.entry(measurements.rows[i].cell).or_insert_with(|| (vec![0.0; residual.len()], 0.0));
        sum.iter_mut().zip(residual).for_each(|(sum, value)| *sum += value);
        *count += 1.0;
    }
    let mut all = vec![];
    for (place, &i) in ordered.iter().enumerate() {
        let row = &measurements.rows[i];
        let Some((residual, (sum, count))) = residuals[i].as_ref().zip(means.get(&row.cell)) else {
            continue;
        };
        if *count < 2.0 {
            continue;
        }
        let turned_rad = place.checked_sub(1).map_or(vec![], |before| {
            stands(i).iter().zip(stands(ordered[before])).map(|(now, then)| now - then).collect()
        });
        let warmth = row.temperature_c.as_ref().filter(|all| !all.is_empty());
        all.push(Repeat {
            cell: row.cell,
            when: row.t_secs.filter(|_| timed).unwrap_or(place as f64),
            turned_rad,
            temperature_c: warmth.map(|all| all.iter().sum::<f64>() / all.len() as f64).or(row.ambient_c),
            at: places.get(&row.cell).copied(),
            off: residual.iter().zip(sum).map(|(value, sum)| value - sum / count).collect(),
            levers: levers(measurements, assumed, i),
            lagged: lagged(measurements, assumed, i),
        });
    }
    all
}

/// Rows of cells with repeats whose time is known, less the mean of their cell.
fn deviations(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Vec<Deviation> {
    let mut cells = BTreeMap::<(usize, usize), Vec<(f64, &Vec<f64>)>>::new();
    for (row, residual) in measurements.rows.iter().zip(residuals) {
        if let (Some(residual), Some(t_secs)) = (residual.as_ref().filter(|_| row.what == what), row.t_secs) {
            cells.entry((row.session, row.cell)).or_default().push((t_secs, residual));
        }
    }
    // Times of different sessions have different beginnings: the first one speaks.
    let session = cells.keys().next().map(|(session, _)| *session);
    let own = cells.iter().filter(|((of, _), members)| Some(*of) == session && members.len() >= 2);
    own.flat_map(|((_, cell), members)| {
        let count = members.len() as f64;
        let mean = |c: usize| members.iter().map(|(_, residual)| residual[c]).sum::<f64>() / count;
        let means: Vec<f64> = (0..what.len()).map(mean).collect();
        members
            .iter()
            .map(|(t_secs, residual)| Deviation {
                cell: *cell,
                t_secs: *t_secs,
                off: residual.iter().zip(&means).map(|(value, mean)| value - mean).collect(),
            })
            .collect::<Vec<_>>()
    })
    .collect()
}

/// Root mean square of what is not far out, by a robust standard deviation.
fn pooled(spread: &[f64], robust: f64) -> f64 {
    let limit = FAR * robust;
    let (sum, count) = spread
        .iter()
        .filter(|value| limit == 0.0 || value.abs() <= limit)
        .fold((0.0, 0usize), |(sum, count), value| (sum + value * value, count + 1));
    if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
}

fn near_neighbors(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> KindFloor {
    let chosen = one_per_cell(measurements, residuals, what);
    let mut points = Points::of(measurements, what, chosen.into_iter());
    let sets = if what.is_placed() { vec![] } else { measurements.sets_of_eyes() };
    if !sets.is_empty() {
        // What an eye turned from one set to the next is no noise.
        let number = |&i: &usize| sets.iter().position(|set| measurements.rows[i].set.as_ref() == Some(set));
        points.split(points.rows.iter().map(|i| number(i).unwrap_or(sets.len())).collect());
    }
    let count = points.rows.len();
    let values = DMatrix::from_fn(count, what.len(), |i, c| {
        residuals[points.rows[i]].as_ref().and_then(|residual| residual.get(c)).copied().unwrap_or(0.0)
    });
    let smooth = points.quadratic().insert_column(0, 1.0);
    let columns = smooth.ncols();
    let values = if count >= 3 * columns { less_fit(&smooth, values) } else { values };
    let d = points.directions();
    let nearest = points.nearest(points.of_a_plane());
    let watched = points.rows.iter().all(|&i| measurements.rows[i].stand.is_some());
    let mut spread = vec![vec![]; what.len()];
    for (i, around) in nearest.iter().enumerate() {
        if around.len() < d + 2 {
            continue;
        }
        let plane = DMatrix::from_fn(around.len(), d + 1, |k, c| {
            if c == 0 { 1.0 } else { points.at[(around[k], c - 1)] - points.at[(i, c - 1)] }
        });
        // The value of the plane here is its constant: weights are the first row of its inverse.
        let Some(inverse) = decompose::pseudo_inverse(plane, 1e-9) else { continue };
        let weights = inverse.row(0);
        let inflate = (1.0 + weights.norm_squared()).sqrt();
        for (c, spread) in spread.iter_mut().enumerate() {
            let here: f64 =
                around.iter().zip(weights.iter()).map(|(&j, weight)| values[(j, c)] * weight).sum();
            spread.push((values[(i, c)] - here) / inflate);
        }
    }
    let mut sd: Vec<f64> = (0..what.len())
        .map(|c| {
            if spread[c].is_empty() {
                values.column(c).norm() / (count.max(1) as f64).sqrt()
            } else if watched {
                pooled(&spread[c], stepped_sd(&spread[c]))
            } else {
                pooled(&spread[c], robust_sd(spread[c].iter().copied()))
            }
        })
        .collect();
    if watched {
        let least = ALIKE * sd.iter().copied().fold(0.0, f64::max);
        sd.iter_mut().for_each(|sd| *sd = sd.max(least));
    }
    KindFloor { what, sd, degrees_of_freedom: (0.5 * count as f64).max(1.0), sigma_m: None }
}

/// What a least-squares fit of these columns leaves, made as large as its degrees of freedom say.
fn less_fit(columns: &DMatrix<f64>, values: DMatrix<f64>) -> DMatrix<f64> {
    let scaled = DMatrix::from_columns(
        &columns
            .column_iter()
            .map(|column| column / column.norm().max(1e-300))
            .collect::<Vec<DVector<f64>>>(),
    );
    let fit = decompose::svd(scaled.clone(), true, true).and_then(|svd| svd.solve(&values, 1e-9).ok());
    match fit {
        Some(fit) => {
            let free = (columns.nrows() - columns.ncols()) as f64 / columns.nrows() as f64;
            (values - scaled * fit) / free.sqrt()
        }
        None => values,
    }
}
