//! What servos do between the command and the encoder. Where encoders are logged, a touch is compared with
//! them, and a servo that gives way shows in no touch: commanded against encoder is a measurement of its
//! own.
//!
//! Per joint, encoder less command is regressed on the torque of gravity (a servo that gives way) and, where
//! rows come from both sides, on the direction of motion (friction), by means of cells.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_effects::{Assumed, Effect, Kind, Situation};

use crate::compare::{median, robust_sd};
use crate::finding::{ClassMember, FoundParameter, NamedEffect};
use crate::floor::Floor;

/// Fewer cells than this say nothing.
const FEWEST_CELLS: usize = 12;
/// A slope counts from so many standard deviations on.
const SURE: f64 = 8.0;
/// What moves the tip by less than this, and by less than the noise, is not told, m.
const LEAST_M: f64 = 1e-3;
/// A servo has a fault of its own when it gives way by so many times what others do …
const MORE: f64 = 2.0;
/// … of which so many have to be known, to this share of it.
const FEWEST_OTHERS: usize = 2;
const KNOWN: f64 = 0.2;
/// No servo that holds an arm gives way by more, rad/N m.
const FURTHEST: f64 = 0.3;
/// Every joint lags a little behind while it moves; one that sticks does so by this many times more.
const STANDS_OUT: f64 = 4.0;
/// How sure a name is that all of this speaks for (the torque is that of the description's masses).
const PROBABILITY: f64 = 0.97;
/// Cells further off than this many robust standard deviations do not count.
const FAR: f64 = 5.0;
/// From one side and with one weight a lag is that of the load when it grows from nothing in proportion to the
/// torque, and leaves at most so many times what other joints lag by.
const LEFT_OVER: f64 = 2.0;
/// Rounds of leaving out what is far off.
const ROUNDS: usize = 8;
/// Rows that are asked how far a turn moves the tip.
const MOST_ROWS: usize = 40;

/// A slope with its standard deviation.
#[derive(Clone, Copy, Debug)]
struct Slope {
    value: f64,
    sd: f64,
}

/// What a joint's servo does.
#[derive(Clone, Copy, Debug)]
struct Joint {
    j: usize,
    /// rad per N m.
    gives: Option<Slope>,
    /// Full width, rad.
    sticks: Option<Slope>,
    /// Root mean square of the torque, N m.
    torque_nm: f64,
    /// Root mean square of encoder less command, rad, and of what the torque leaves of it.
    lag_rad: f64,
    left_rad: f64,
    /// A turn of a radian moves the tip by so much, m.
    lever_m: f64,
}

/// Servos that give way or stick more than the others, the largest first, and what all of them do, in words.
pub(crate) fn servos(
    measurements: &Measurements,
    floor: &Floor,
    assumed: &Assumed,
) -> (Vec<NamedEffect>, Option<String>) {
    let Some(session) = (0..measurements.apparatuses.len()).max_by_key(|&s| logged(measurements, s).count())
    else {
        return (vec![], None);
    };
    let Some(arm) = &measurements.apparatuses[session].arm else { return (vec![], None) };
    let rows: Vec<&Observation> = logged(measurements, session).collect();
    let known = |kind: Kind| measurements.present.iter().any(|present| present.effect.kind == kind);
    let sides = Sides::of(&rows);
    let joints: Vec<Joint> =
        (0..arm.len()).filter_map(|j| joint(measurements, arm, &rows, assumed, &sides, j)).collect();
    let noise_m = floor.kinds.iter().filter(|kind| kind.what.is_placed());
    let noise_m = noise_m.map(|kind| kind.sd[0].hypot(kind.sd[1])).fold(LEAST_M, f64::max);
    let (mut found, words) =
        if known(Kind::ServoDroop) { (vec![], None) } else { droops(arm, &joints, &sides, noise_m) };
    if !known(Kind::Stiction) {
        found.extend(sticking(arm, &joints, noise_m));
    }
    found.sort_by(|a, b| b.size_m.total_cmp(&a.size_m));
    (found, words)
}

/// Rows of the arm that have both.
fn logged(measurements: &Measurements, session: usize) -> impl Iterator<Item = &Observation> {
    let both = |row: &&Observation| row.commanded_rad.is_some() && row.encoder_rad.is_some();
    measurements.rows.iter().filter(move |row| row.session == session && row.what.is_placed()).filter(both)
}

/// From where rows come, and with what.
struct Sides {
    /// From both sides.
    both: bool,
    /// With several weights.
    weights: bool,
}

impl Sides {
    fn of(rows: &[&Observation]) -> Self {
        let from = |side: &str| rows.iter().any(|row| row.approach.as_deref() == Some(side));
        let weights = rows.iter().map(|row| (row.payload_kg * 1e3).round() as i64);
        let weights = weights.collect::<std::collections::BTreeSet<_>>().len() > 1;
        Self { both: from("plus") && from("minus"), weights }
    }

    /// A torque goes with the posture, and so does how fast a joint moves.
    fn are_one(&self) -> bool {
        !self.both && !self.weights
    }
}

fn joint(
    measurements: &Measurements,
    arm: &Arm,
    rows: &[&Observation],
    assumed: &Assumed,
    sides: &Sides,
    j: usize,
) -> Option<Joint> {
    let mut cells = std::collections::BTreeMap::<usize, ([f64; 3], f64)>::new();
    let mut square = 0.0;
    for row in rows {
        let lag = row.lag_rad()?[j];
        let up = nalgebra::Vector3::z();
        let situation =
            Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &up).during(row);
        let torque_nm = situation.torques_nm()[j];
        square += torque_nm * torque_nm;
        let (sum, count) = cells.entry(row.cell).or_insert(([0.0; 3], 0.0));
        for (sum, value) in sum.iter_mut().zip([-lag, torque_nm, -0.5 * row.direction[j]]) {
            *sum += value;
        }
        *count += 1.0;
    }
    let means: Vec<[f64; 3]> = cells.values().map(|(sum, count)| sum.map(|sum| sum / count)).collect();
    if means.len() < FEWEST_CELLS {
        return None;
    }
    let [gives, sticks] =
        if sides.are_one() { [Some(in_proportion(&means)), None] } else { slopes(&means, sides.both)? };
    let zero = Effect::sites(Kind::JointZero, Some(arm), None);
    let zero = zero.into_iter().find(|effect| effect.site == arm.parts[j].joint)?;
    let every = rows.len().div_ceil(MOST_ROWS);
    let moved = rows.iter().step_by(every).filter_map(|row| {
        let tangents = measurements.tangents(row, assumed, std::slice::from_ref(&zero))?;
        let typical = zero.parameters()[0].typical;
        Some((0..3).map(|c| (tangents.effects[(c, 0)] / typical).powi(2)).sum::<f64>())
    });
    let moved: Vec<f64> = moved.collect();
    let lever_m = (moved.iter().sum::<f64>() / moved.len().max(1) as f64).sqrt();
    let rms = |of: &dyn Fn(&[f64; 3]) -> f64| {
        (means.iter().map(|cell| of(cell).powi(2)).sum::<f64>() / means.len() as f64).sqrt()
    };
    let slope = gives.map_or(0.0, |gives| gives.value);
    let (lag_rad, left_rad) = (rms(&|cell| cell[0]), rms(&|cell| cell[0] - slope * cell[1]));
    let torque_nm = (square / rows.len() as f64).sqrt();
    Some(Joint { j, gives, sticks, torque_nm, lag_rad, left_rad, lever_m })
}

/// Slope by torque of cells whose lag is nothing without a load.
fn in_proportion(cells: &[[f64; 3]]) -> Slope {
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| cells.iter().map(of).sum::<f64>();
    let torques = sum(&|cell| cell[1] * cell[1]).max(1e-12);
    let value = sum(&|cell| cell[0] * cell[1]) / torques;
    let left = sum(&|cell| (cell[0] - value * cell[1]).powi(2));
    Slope { value, sd: (left / (cells.len() as f64 - 1.0).max(1.0) / torques).sqrt() }
}

/// Whether from one side, too, the lag of a joint can only be of its load.
fn is_of_load(joint: &Joint, joints: &[Joint]) -> bool {
    let others = joints.iter().filter(|other| other.j != joint.j).map(|other| other.lag_rad);
    median(others)
        .is_some_and(|usual| joint.lag_rad > STANDS_OUT * usual && joint.left_rad < LEFT_OVER * usual)
}

/// Slopes by torque and by direction of cells: (encoder less command, torque, direction).
fn slopes(cells: &[[f64; 3]], sided: bool) -> Option<[Option<Slope>; 2]> {
    let mut kept: Vec<[f64; 3]> = cells.to_vec();
    for round in 1..=ROUNDS {
        if kept.len() < FEWEST_CELLS {
            return None;
        }
        let varies = |k: usize| robust_sd(kept.iter().map(|cell| cell[k])) > 1e-6;
        // Directions are two, so their spread about the median may be nothing.
        let used: Vec<usize> = [varies(1).then_some(1), sided.then_some(2)].into_iter().flatten().collect();
        let columns = 1 + used.len();
        let design =
            DMatrix::from_fn(kept.len(), columns, |r, c| if c == 0 { 1.0 } else { kept[r][used[c - 1]] });
        let values = DVector::from_iterator(kept.len(), kept.iter().map(|cell| cell[0]));
        let inverse = Cholesky::new(design.tr_mul(&design))?.inverse();
        let fit = &inverse * design.tr_mul(&values);
        let left = &values - &design * &fit;
        let spread = robust_sd(left.iter().copied());
        let inside: Vec<[f64; 3]> = kept
            .iter()
            .zip(left.iter())
            .filter(|(_, left)| left.abs() <= FAR * spread)
            .map(|(c, _)| *c)
            .collect();
        if inside.len() == kept.len() || spread == 0.0 || round == ROUNDS {
            let variance = left.norm_squared() / (kept.len() - columns) as f64;
            let slope = |k: usize| {
                let place = 1 + used.iter().position(|used| *used == k)?;
                Some(Slope { value: fit[place], sd: (variance * inverse[(place, place)]).sqrt() })
            };
            return Some([slope(1), slope(2)]);
        }
        kept = inside;
    }
    None
}

/// Servos that give way more than the others, and what all of them do alike, in words: a controller without
/// integral action gives way everywhere, and that is its way, not what is wrong with a joint.
fn droops(arm: &Arm, joints: &[Joint], sides: &Sides, noise_m: f64) -> (Vec<NamedEffect>, Option<String>) {
    let size_m = |joint: &Joint, value: f64| value * joint.torque_nm * joint.lever_m;
    let (mut found, mut alike) = (vec![], vec![]);
    for joint in joints {
        let Some(slope) = joint.gives.filter(|slope| slope.value > SURE * slope.sd) else { continue };
        let size = size_m(joint, slope.value);
        if size < noise_m || slope.value > FURTHEST {
            continue;
        }
        if sides.are_one() {
            if is_of_load(joint, joints) {
                found.extend(named(arm, Kind::ServoDroop, &arm.parts[joint.j].joint, slope, (size, noise_m)));
            }
            continue;
        }
        let others = joints.iter().filter(|other| other.j != joint.j).filter_map(|other| other.gives);
        let known: Vec<f64> =
            others.filter(|other| other.sd < KNOWN * slope.value).map(|other| other.value.abs()).collect();
        let usual = median(known.iter().copied()).filter(|_| known.len() >= FEWEST_OTHERS);
        if usual.is_some_and(|usual| slope.value > MORE * usual) {
            found.extend(named(arm, Kind::ServoDroop, &arm.parts[joint.j].joint, slope, (size, noise_m)));
        } else {
            alike.push((slope.value, size));
        }
    }
    let words = median(alike.iter().map(|(value, _)| *value)).map(|usual| {
        let moved_m = alike.iter().map(|(_, size)| size * size).sum::<f64>().sqrt();
        format!(
            "the servos give way under load like springs of {:.0} N m/rad: where encoders are not read, the fingertip \
             is up to {:.0} mm beside its command. Raise the integral gain, or predict from encoders",
            1.0 / usual,
            moved_m * 1e3
        )
    });
    (found, words)
}

fn sticking(arm: &Arm, joints: &[Joint], noise_m: f64) -> Vec<NamedEffect> {
    let usual = median(joints.iter().filter_map(|joint| Some(joint.sticks?.value.abs()))).unwrap_or(0.0);
    let stands_out = |slope: &Slope| slope.value > SURE * slope.sd && slope.value > STANDS_OUT * usual;
    joints
        .iter()
        .filter_map(|joint| Some((joint, joint.sticks.filter(stands_out)?)))
        .filter_map(|(joint, slope)| {
            let size_m = 0.5 * slope.value * joint.lever_m;
            let site = &arm.parts[joint.j].joint;
            (size_m > noise_m).then(|| named(arm, Kind::Stiction, site, slope, (size_m, noise_m))).flatten()
        })
        .collect()
}

fn named(
    arm: &Arm,
    kind: Kind,
    site: &str,
    slope: Slope,
    (size_m, noise_m): (f64, f64),
) -> Option<NamedEffect> {
    let effect = Effect::find(kind.id(), site, None, Some(arm), None)?;
    let covariance = DMatrix::from_element(1, 1, slope.sd * slope.sd);
    let reported = effect.report(&[slope.value], &covariance).into_iter();
    let parameters = reported.map(|one| FoundParameter {
        name: one.name,
        value: one.value,
        low: one.low,
        high: one.high,
        text: one.text,
    });
    let class = ClassMember {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        probability: 1.0,
    };
    Some(NamedEffect {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        probability: PROBABILITY,
        class_probability: PROBABILITY,
        parameters: parameters.collect(),
        shape: None,
        values: vec![slope.value],
        covariance: vec![slope.sd * slope.sd],
        size_sigmas: size_m / noise_m,
        size_m,
        class: vec![class],
        split_by: None,
        runner_up: None,
        not_addable: None,
    })
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    /// Cells from both sides with a servo that gives way by 0.03 rad/N m and sticks by 0.01 rad.
    fn cells(gives: f64, sticks: f64, seed: u64) -> Vec<[f64; 3]> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..80)
            .map(|i| {
                let torque = random.random_range(-0.5..1.5);
                let half_less = if i % 2 == 0 { -0.5 } else { 0.5 };
                let noise = 1e-3 * random.random_range(-1.7..1.7);
                [gives * torque + sticks * half_less + 0.002 + noise, torque, half_less]
            })
            .collect()
    }

    #[test]
    fn what_gives_way_and_what_sticks_are_told_apart() {
        for seed in 0..10 {
            let [gives, sticks] = slopes(&cells(0.03, 0.01, seed), true).expect("enough cells");
            let (gives, sticks) = (gives.expect("torques differ"), sticks.expect("both sides"));
            assert!(
                (gives.value - 0.03).abs() < 4.0 * gives.sd && gives.value > SURE * gives.sd,
                "{gives:?}"
            );
            assert!(
                (sticks.value - 0.01).abs() < 4.0 * sticks.sd && sticks.value > SURE * sticks.sd,
                "{sticks:?}"
            );
        }
    }

    #[test]
    fn a_servo_that_holds_has_no_slope() {
        let sure = |slope: Option<Slope>| slope.is_some_and(|slope| slope.value.abs() > SURE * slope.sd);
        let alarms = (0..200)
            .filter_map(|seed| slopes(&cells(0.0, 0.0, 500 + seed), true))
            .filter(|[gives, sticks]| sure(*gives) || sure(*sticks))
            .count();
        assert_eq!(alarms, 0);
    }

    #[test]
    fn cells_that_are_far_off_do_not_hide_the_rest() {
        // One far cell after the other comes out from behind the next.
        let mut cells = cells(0.03, 0.01, 4);
        for (k, cell) in cells.iter_mut().step_by(8).enumerate() {
            cell[0] += 0.03 * 3.0_f64.powi(k as i32);
        }
        let [gives, sticks] = slopes(&cells, true).expect("most cells agree");
        let (gives, sticks) = (gives.expect("torques differ"), sticks.expect("both sides"));
        assert!((gives.value - 0.03).abs() < 4.0 * gives.sd, "{gives:?}");
        assert!((sticks.value - 0.01).abs() < 4.0 * sticks.sd, "{sticks:?}");
    }

    #[test]
    fn from_one_side_a_lag_is_of_the_load_when_it_is_nothing_without_one() {
        let one_sided = |mut cells: Vec<[f64; 3]>| {
            cells.iter_mut().for_each(|cell| cell[2] = 0.0);
            cells
        };
        let with = |cells: &[[f64; 3]], j: usize| {
            let gives = in_proportion(cells);
            let rms = |slope: f64| {
                let left = cells.iter().map(|cell| (cell[0] - slope * cell[1]).powi(2));
                (left.sum::<f64>() / cells.len() as f64).sqrt()
            };
            let (lag_rad, left_rad) = (rms(0.0), rms(gives.value));
            Joint { j, gives: Some(gives), sticks: None, torque_nm: 1.0, lag_rad, left_rad, lever_m: 0.3 }
        };
        let others: Vec<Joint> = (1..6).map(|j| with(&one_sided(cells(0.0, 0.0, j as u64)), j)).collect();
        let loaded = with(&one_sided(cells(0.03, 0.0, 6)), 0);
        let gives = loaded.gives.expect("a slope");
        assert!((gives.value - 0.03).abs() < 0.003 && gives.value > SURE * gives.sd, "{gives:?}");
        let joints = |first: Joint| std::iter::once(first).chain(others.iter().copied()).collect::<Vec<_>>();
        assert!(is_of_load(&loaded, &joints(loaded)));
        // One that lags as much wherever it is loaded is late, not soft.
        let late: Vec<[f64; 3]> = cells(0.0, 0.0, 7).into_iter().map(|[l, t, d]| [l + 0.02, t, d]).collect();
        let late = with(&one_sided(late), 0);
        assert!(!is_of_load(&late, &joints(late)));
    }

    #[test]
    fn from_one_side_friction_is_not_looked_for() {
        let [_, sticks] = slopes(&cells(0.03, 0.01, 3), false).expect("enough cells");
        assert!(sticks.is_none());
    }
}
