//! Free-form rivals: what no effect of the library does, as a smooth function of something that
//! was logged.

use nalgebra::DMatrix;
use plumbline_effects::Kind;
use plumbline_effects::measurements::{Measurements, What};
use plumbline_model::JobContext;

use super::library::{Block, Library};
use super::linear::Linear;
use super::steps::steps;
use crate::covariates::Covariates;
use crate::error::GapError;

/// Smooth functions of each covariate.
const FUNCTIONS: usize = 6;
/// How probable it is beforehand that something is at work that is not in the library.
const UNKNOWN: f64 = 0.1;
/// Makes columns large against what is looked for: how large a rival is says the variant alone.
const LARGE: f64 = 100.0;

/// A rival.
#[derive(Clone, Debug)]
pub(super) struct Rival {
    /// What depends ("turn of the elbow", "along u").
    pub of: String,
    /// On what ("angle of the elbow").
    pub on: String,
    /// Where it is a joint that gives way differently as it warms: its site.
    pub softens: Option<String>,
}

/// All rivals with their columns.
pub(super) struct Rivals {
    pub rivals: Vec<Rival>,
    pub blocks: Vec<Block>,
    /// One line as in the linearization.
    pub columns: DMatrix<f64>,
}

/// One that goes with another joint, or in a step, and how many of its sort the joint has.
struct Other {
    rival: Rival,
    columns: Vec<Vec<f64>>,
    among: usize,
}

/// How much a joint gives way as it warms goes smoothly from cold to warm: what it always gives way, and these.
const FUNCTIONS_OF_WARMTH: usize = 3;

/// Of a joint on the angle of another one: what one pulls at another, by a cable say, goes smoothly.
const FUNCTIONS_OF_ANOTHER: usize = 3;

/// What moves.
enum Moved {
    /// A column of the lines.
    Column(usize),
    /// The measured coordinate itself.
    Coordinate(What, usize),
}

/// Rivals with their columns, one line as in `linear`; their blocks are numbered from the end of
/// the library's on and share one name: only one at a time.
///
/// # Errors
/// Cancelled.
pub(super) fn rivals(
    measurements: &Measurements,
    covariates: &Covariates,
    library: &Library,
    linear: &Linear,
    context: &dyn JobContext,
) -> Result<Rivals, GapError> {
    let mut rivals = vec![];
    let mut columns: Vec<Vec<Vec<f64>>> = vec![];
    let mut add =
        |of: String, moved: &Moved, covariate: usize, sided: Option<usize>, softens: Option<&str>| {
            let base = base(measurements, linear, moved);
            let value = |row: usize| covariates.values[row][covariate];
            let count = if softens.is_some() { FUNCTIONS_OF_WARMTH } else { FUNCTIONS };
            let Some(own) = functions(linear, covariates, &base, &value, sided, count) else { return };
            let (name, _) = &covariates.names[covariate];
            let on = match sided.and_then(|sided| covariates.names.get(sided)) {
                Some((with, _)) if with.starts_with("direction") => format!("{name} and its direction"),
                Some((with, _)) => format!("{name} and {with}"),
                None => name.clone(),
            };
            rivals.push(Rival { of, on, softens: softens.map(str::to_owned) });
            columns.push(own);
        };
    let find = |name: &str| covariates.names.iter().position(|(known, _)| known == name);
    for (effect, block) in library.effects.iter().zip(&library.blocks) {
        let neck = effect.kind == Kind::HeadJoint;
        if effect.kind != Kind::JointZero && !neck || effect.is_of_every_site() {
            continue;
        }
        context.checkpoint()?;
        let title = effect.title.split(':').next().unwrap_or_default().to_owned();
        let moved = Moved::Column(linear.gauge + block.start);
        let of = format!("turn of {title}");
        let angle = find(&format!("angle of {title}"));
        let direction = find(&format!("direction of {title}"));
        for what in ["angle", "torque", "temperature"] {
            if let Some(covariate) = find(&format!("{what} of {title}")) {
                add(of.clone(), &moved, covariate, None, None);
            }
        }
        if let (Some(angle), Some(direction)) = (angle, direction) {
            add(of.clone(), &moved, angle, Some(direction), None);
        }
        let time = find("time");
        if let Some(time) = time {
            add(of.clone(), &moved, time, None, None);
        }
        // A joint that gives way differently as it warms.
        let torque = find(&format!("torque of {title}"));
        let warmth = find(&format!("temperature of {title}")).or(time);
        if let (Some(torque), Some(warmth)) = (torque, warmth) {
            add(of.clone(), &moved, warmth, Some(torque), Some(&effect.site));
        }
    }
    for (what, on) in [
        (What::Touch, &["place along u", "place along v", "time", "duration of the move"][..]),
        (What::Pose, &["time"]),
        (What::OrientedPose, &["time"]),
        (What::Place, &EYES),
        (What::EyePoints, &EYES),
    ] {
        if !measurements.has(what) {
            continue;
        }
        for coordinate in 0..what.len() {
            for on in on {
                if let Some(covariate) = find(on) {
                    let of = super::linear::coordinate_name(what, coordinate).to_owned();
                    add(of, &Moved::Coordinate(what, coordinate), covariate, None, None);
                }
            }
        }
    }
    // Each is as probable as every other one. What joints do by each other and in steps adds to that, all others, and
    // all steps, of one joint together as much as one rival.
    let each = UNKNOWN / rivals.len().max(1) as f64;
    let mut shares = vec![each; rivals.len()];
    for other in of_other_joints(measurements, covariates, library, linear, context)? {
        rivals.push(other.rival);
        columns.push(other.columns);
        shares.push(each / other.among as f64);
    }
    let mut start = library.columns;
    let blocks = columns
        .iter()
        .zip(shares)
        .map(|(own, share)| {
            start += own.len();
            (start - own.len(), own.len(), share)
        })
        .map(|(start, len, share)| Block {
            start,
            len,
            kind: None,
            is_family: false,
            is_of_all: false,
            is_one_sided: false,
            grows: None,
            name: library.names.len(),
            log_prior: share.ln(),
        })
        .collect();
    let lines = linear.lines.nrows();
    let columns = columns.concat();
    let matrix = DMatrix::from_fn(lines, columns.len(), |line, column| columns[column][line]);
    Ok(Rivals { rivals, blocks, columns: matrix })
}

/// Of an arm that is measured from outside: the turn of each joint by how far it came (a joint that remembers), by the
/// angle of another one (what a cable pulls at), and in a step at an angle of its own (what catches). With each, how many
/// of its sort the joint has.
fn of_other_joints(
    measurements: &Measurements,
    covariates: &Covariates,
    library: &Library,
    linear: &Linear,
    context: &dyn JobContext,
) -> Result<Vec<Other>, GapError> {
    if !measurements.has(What::Pose) && !measurements.has(What::OrientedPose) {
        return Ok(vec![]);
    }
    let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref());
    let titles: Vec<&str> =
        arm.map_or(vec![], |arm| arm.parts.iter().map(|part| part.title.as_str()).collect());
    let came = came(measurements);
    let mut found = vec![];
    for (effect, block) in library.effects.iter().zip(&library.blocks) {
        if effect.kind != Kind::JointZero || effect.is_of_every_site() {
            continue;
        }
        let title = effect.title.split(':').next().unwrap_or_default();
        let Some(own) = titles.iter().position(|known| *known == title) else { continue };
        let of_turn = |on: String| Rival { of: format!("turn of {title}"), on, softens: None };
        let base = base(measurements, linear, &Moved::Column(linear.gauge + block.start));
        let (columns, among) = steps(measurements, linear, &base, own, context)?;
        for column in columns {
            let rival = of_turn(format!("angle of {title}, in a step"));
            let columns = vec![column.into_iter().map(|value| LARGE * value).collect()];
            found.push(Other { rival, columns, among });
        }
        let mut add = |on: String, value: &dyn Fn(usize) -> Option<f64>, count: usize, among: usize| {
            if let Some(columns) = functions(linear, covariates, &base, value, None, count) {
                found.push(Other { rival: of_turn(on), columns, among });
            }
        };
        let way = |row: usize| came[row].as_ref().and_then(|turned| turned.get(own)).copied();
        add(format!("way that {title} came"), &way, FUNCTIONS, 1);
        for (other, name) in titles.iter().enumerate().filter(|(other, _)| *other != own) {
            let angle = |row: usize| measurements.rows[row].angles_rad().get(other).copied();
            add(format!("angle of {name}"), &angle, FUNCTIONS_OF_ANOTHER, titles.len() - 1);
        }
    }
    Ok(found)
}

/// How far each joint turned since the row before it in time, by rows, rad; `None` where that row is not there.
fn came(measurements: &Measurements) -> Vec<Option<Vec<f64>>> {
    let rows = &measurements.rows;
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| {
        let when = |i: usize| rows[i].t_secs.unwrap_or_default();
        let by_time = when(a).total_cmp(&when(b));
        rows[a].session.cmp(&rows[b].session).then(by_time).then(rows[a].row.cmp(&rows[b].row))
    });
    let mut came = vec![None; rows.len()];
    for pair in order.windows(2) {
        let (before, now) = (&rows[pair[0]], &rows[pair[1]]);
        let is_next = before.session == now.session && before.row.abs_diff(now.row) == 1;
        if is_next && before.what.is_placed() && now.what.is_placed() {
            let turned = now.angles_rad().iter().zip(before.angles_rad()).map(|(now, then)| now - then);
            came[pair[1]] = Some(turned.collect());
        }
    }
    came
}

const EYES: [&str; 6] = [
    "distance from the eyes",
    "distance from the middle of the image",
    "distance of the background",
    "place along x of the table",
    "place along y of the table",
    "time",
];

fn base(measurements: &Measurements, linear: &Linear, moved: &Moved) -> Vec<f64> {
    match moved {
        Moved::Column(column) => linear.lines.column(*column).iter().copied().collect(),
        Moved::Coordinate(what, coordinate) => (0..linear.row.len())
            .map(|line| {
                let own = measurements.rows[linear.row[line]].what == *what;
                f64::from(u8::from(own && linear.coordinate[line] == *coordinate))
            })
            .collect(),
    }
}

/// Cosines of a covariate (by rows) over its range, so many of them, times what moves. `None` when too few rows know it.
fn functions(
    linear: &Linear,
    covariates: &Covariates,
    base: &[f64],
    of_row: &dyn Fn(usize) -> Option<f64>,
    sided: Option<usize>,
    count: usize,
) -> Option<Vec<Vec<f64>>> {
    let value = |line: usize| of_row(linear.row[line]);
    let known: Vec<f64> = (0..base.len()).filter_map(value).collect();
    let (low, high) = known.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
    let mut distinct = known.clone();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup_by(|a, b| (*a - *b).abs() < 1e-3 * (high - low));
    if distinct.len() < FUNCTIONS + 3 || known.len() * 2 < base.len() {
        return None;
    }
    let side =
        |line: usize| sided.map_or(1.0, |sided| covariates.values[linear.row[line]][sided].unwrap_or(0.0));
    let columns = (0..count).map(|k| {
        (0..base.len())
            .map(|line| {
                let Some(value) = value(line) else { return 0.0 };
                let share = (value - low) / (high - low);
                // With a direction, an offset is a rival, too: sides differ by more than a play.
                let order = if sided.is_some() { k } else { k + 1 } as f64;
                LARGE * base[line] * side(line) * (std::f64::consts::PI * order * share).cos()
            })
            .collect()
    });
    Some(columns.collect())
}
