//! What servos do between the command and the encoder. Where encoders are logged, a touch is compared with
//! them, and a servo that gives way shows in no touch: commanded against encoder is a measurement of its
//! own.
//!
//! - [`cells`]: means of cells;
//! - [`lag`]: encoder less command of one joint, regressed on the torque of gravity (a servo that gives way)
//!   and, where rows come from both sides, on the direction of motion (friction);
//! - [`masses`]: all joints at once, with masses that are not quite those of the description;
//! - [`one_side`]: what rows from one side, with one weight, tell of servos that give way;
//! - [`rates`]: which joints have to be fast, and lag more for that;
//! - [`size`]: what of it reaches the fingertip, against the noise.

mod cells;
mod lag;
mod masses;
mod name;
mod one_side;
mod rates;
mod size;

use nalgebra::Vector3;
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_effects::{Assumed, Kind, Situation};

use crate::compare::median;
use crate::finding::NamedEffect;
use crate::floor::Floor;
use cells::Sides;
use lag::{FEWEST_CELLS, Lag, Slope};
use name::{Size, hardly, named, named_mass, or_play};
use rates::rates;
use size::Levers;

/// A slope counts from so many standard deviations on.
const SURE: f64 = 8.0;
/// What does less than this to the rows (units of their noise, frames placed) is not told, as in the search.
const SMALLEST: f64 = 0.5;
/// What moves the tip by less than this is not told in words, m.
const LEAST_M: f64 = 1e-3;
/// A servo has a fault of its own when it gives way by so many times what others do …
const MORE: f64 = 2.0;
/// … of which so many have to be known, to this share of it.
const FEWEST_OTHERS: usize = 2;
const KNOWN: f64 = 0.2;
/// No servo that holds an arm gives way by more, rad/N m.
const FURTHEST: f64 = 0.3;
/// Every joint lags a little behind while it moves; one that sticks does so by this many times more than a joint that is as
/// fast, though hardly surely: in development cases of the blind test no other one did by more than 1.6 that moved the tip by
/// as much as below, but servos of one robot are not all alike …
const STANDS_OUT: f64 = 1.8;
/// … surely, and where nothing tells how fast each is, by this many …
const STANDS_OUT_OF_ANY: f64 = 2.5;
/// … and what it does beyond that is no less than this (units of the rows' noise), or this where it surely stands out.
const SMALLEST_OF_FRICTION: f64 = 0.8;
const SMALLEST_WHERE_SURE: f64 = 0.6;
/// One that gives way more than others beyond so many standard deviations is soft, and friction stops it farther from its goal
/// for that: of 17 joints of development cases of the blind test that lagged so and gave way so, all were soft.
const SURE_BESIDE_LAG: f64 = 5.0;
/// A mass is another one when it is known to this share of the description's, is off by this share, and by
/// so many standard deviations.
const MASS_KNOWN: f64 = 0.1;
const LEAST_MASS: f64 = 0.1;
const SURE_OF_MASS: f64 = 4.0;

/// What was measured of a joint's servo.
struct Joint {
    j: usize,
    lag: Lag,
    /// rad per N m, with what is not known of the masses.
    gives: Option<Slope>,
    /// Full width, rad.
    sticks: Option<Slope>,
    /// Root mean square of the torque, N m.
    torque_nm: f64,
}

/// All that is looked at.
struct Servos<'a> {
    arm: &'a Arm,
    sides: Sides,
    joints: Vec<Joint>,
    masses: Vec<Slope>,
    levers: Levers<'a>,
    /// Length of one floor on the table, m.
    floor_m: f64,
    /// Encoders sit behind the gears.
    behind_gear: bool,
}

/// Servos that give way or stick more than the others, and masses that are other ones, the largest first;
/// and what all servos do, in words.
pub(crate) fn servos(
    measurements: &Measurements,
    floor: &Floor,
    assumed: &Assumed,
) -> (Vec<NamedEffect>, Option<String>) {
    let Some(servos) = Servos::of(measurements, floor, assumed) else { return (vec![], None) };
    let known = |kind: Kind| measurements.present.iter().any(|present| present.effect.kind == kind);
    let (mut found, words) = if known(Kind::ServoDroop) { (vec![], None) } else { servos.droops() };
    if !known(Kind::Stiction) {
        let present = measurements.present.iter().map(|present| &present.effect);
        let soft = present.filter(|effect| effect.kind == Kind::ServoDroop).map(|effect| effect.site.clone());
        let soft: Vec<String> = soft.chain(found.iter().map(|effect| effect.site.clone())).collect();
        found.extend(servos.sticking(&soft));
    }
    found.extend(servos.other_masses());
    found.sort_by(|a, b| b.size_m.total_cmp(&a.size_m));
    (found, words)
}

/// Torque of gravity about each joint in a row, N m.
fn torques_nm(arm: &Arm, row: &Observation, payload_kg: f64) -> Vec<f64> {
    let up = Vector3::z();
    Situation::new(arm, row.angles_rad(), &row.direction, payload_kg, &up).torques_nm().to_vec()
}

impl<'a> Servos<'a> {
    fn of(measurements: &'a Measurements, floor: &Floor, assumed: &Assumed) -> Option<Self> {
        let sessions = 0..measurements.apparatuses.len();
        let session = sessions.max_by_key(|&s| cells::logged(measurements, s).count())?;
        let arm = measurements.apparatuses[session].arm.as_ref()?;
        let rows: Vec<&Observation> = cells::logged(measurements, session).collect();
        let sides = Sides::of(&rows);
        let cells = cells::cells(arm, &rows);
        if cells.len() < FEWEST_CELLS {
            return None;
        }
        let alone: Vec<Option<Lag>> = (0..arm.len()).map(|j| lag::lag(&cells, j, sides.both)).collect();
        let together = masses::fit(&cells, &alone);
        let reads = |j: usize| rows.iter().any(|row| row.reads_encoder(j));
        let joints = alone.into_iter().enumerate().filter(|(j, _)| reads(*j)).filter_map(|(j, lag)| {
            let lag = lag?;
            let of = |slopes: &[Option<Slope>]| slopes.get(j).copied().flatten();
            let gives = together.as_ref().and_then(|fit| of(&fit.gives)).or(lag.gives);
            let sticks = together.as_ref().and_then(|fit| of(&fit.sticks)).or(lag.sticks);
            let square: f64 = lag.used.iter().map(|&cell| cells[cell].torque_nm[j].powi(2)).sum();
            let torque_nm = (square / lag.used.len().max(1) as f64).sqrt();
            Some(Joint { j, lag, gives, sticks, torque_nm })
        });
        let joints: Vec<Joint> = joints.collect();
        let levers = Levers::of(measurements, &rows, floor, assumed)?;
        let placed = floor.kinds.iter().filter(|kind| kind.what.is_placed());
        let floor_m = placed.map(|kind| kind.sd[0].hypot(kind.sd[1])).fold(0.0, f64::max);
        let masses = together.map_or(vec![], |fit| fit.masses);
        let behind_gear = rows.iter().any(|row| row.encoder_behind_gear);
        Some(Self { arm, sides, joints, masses, levers, floor_m, behind_gear })
    }

    /// What turns of one joint do.
    fn size(&self, j: usize, turn_rad: impl Fn(&Observation) -> f64) -> Size {
        let sigmas = self.levers.size(|row| {
            let mut turns = vec![0.0; self.arm.len()];
            turns[j] = turn_rad(row);
            turns
        });
        Size { sigmas, m: sigmas * self.floor_m }
    }

    /// Servos that give way more than the others, and what all of them do alike, in words: a controller
    /// without integral action gives way everywhere, and that is its way, not what is wrong with a joint.
    fn droops(&self) -> (Vec<NamedEffect>, Option<String>) {
        if self.sides.are_one() {
            return (self.joints.iter().filter_map(|joint| self.seen_from_one_side(joint)).collect(), None);
        }
        let (mut found, mut alike) = (vec![], vec![]);
        for joint in &self.joints {
            let Some((slope, alone)) = joint.gives.zip(joint.lag.gives) else { continue };
            if slope.value <= 0.0 || slope.value > FURTHEST || alone.value < SURE * alone.sd {
                continue;
            }
            let size = self.size(joint.j, |row| slope.value * self.torque_nm(row, joint.j));
            if size.sigmas > SMALLEST && self.has_own_fault(joint, slope) {
                found.extend(named(self.arm, Kind::ServoDroop, joint.j, slope, &size));
            } else {
                let tip_m = slope.value * joint.torque_nm * self.levers.tip_m[joint.j];
                if tip_m > self.floor_m.max(LEAST_M) {
                    alike.push((slope.value, tip_m));
                }
            }
        }
        (found, give_way(&alike))
    }

    /// Torque about a joint in a row, N m.
    fn torque_nm(&self, row: &Observation, j: usize) -> f64 {
        match &row.torque_nm {
            Some(measured) => measured.get(j).copied().unwrap_or_default(),
            None => torques_nm(self.arm, row, row.payload_kg)[j],
        }
    }

    /// Whether a servo gives way more than the others.
    fn has_own_fault(&self, joint: &Joint, slope: Slope) -> bool {
        let others = self.joints.iter().filter(|other| other.j != joint.j);
        let known: Vec<f64> = others
            .filter_map(|other| other.gives)
            .filter(|other| other.sd < KNOWN * slope.value)
            .map(|other| other.value.abs())
            .collect();
        let usual = median(known.iter().copied()).filter(|_| known.len() >= FEWEST_OTHERS);
        usual.is_some_and(|usual| slope.value > MORE * usual)
    }

    /// By how much a servo gives way where that is more than the others do, though perhaps too little by itself for a name, and
    /// where it explains how far friction stops it (from side to side, rad): with a friction that is less than the most that
    /// gravity asks of any joint.
    fn softness(&self, joint: &Joint, stops_rad: f64) -> Option<Slope> {
        let (slope, alone) = joint.gives.zip(joint.lag.gives)?;
        let is_sure = alone.value > SURE_BESIDE_LAG * alone.sd && slope.value <= FURTHEST;
        let most_nm =
            self.joints.iter().filter(|one| self.turns(one)).map(|one| one.torque_nm).fold(0.0, f64::max);
        let explains = 0.5 * stops_rad < slope.value * most_nm;
        (is_sure && explains && self.turns(joint) && self.has_own_fault(joint, slope)).then_some(slope)
    }

    fn turns(&self, joint: &Joint) -> bool {
        !self.arm.parts[joint.j].slides
    }

    /// Servos that stay behind, from both sides, by more than others that are as fast: they stick, or are soft, unless it is
    /// `told` of that joint that it is.
    fn sticking(&self, told: &[String]) -> Vec<NamedEffect> {
        let known = rates(self.arm, &self.levers.rows);
        let more = if known.is_some() { STANDS_OUT } else { STANDS_OUT_OF_ANY };
        let rate = |j: usize| known.as_ref().map_or(1.0, |rates| rates[j]);
        let all = self.joints.iter().filter_map(|joint| Some(joint.sticks?.value.abs() / rate(joint.j)));
        let usual = median(all).unwrap_or(0.0);
        let found = self.joints.iter().filter_map(|joint| {
            let (slope, lags) = (joint.sticks?, usual * rate(joint.j));
            if slope.value < SURE * slope.sd || slope.value < more * lags {
                return None;
            }
            // All lag alike while they move; what one does beyond that is its own.
            let own = Slope { value: slope.value - lags, sd: slope.sd.hypot(0.5 * lags) };
            let back = |row: &Observation| {
                -0.5 * own.value * row.direction.get(joint.j).copied().unwrap_or_default()
            };
            let size = self.size(joint.j, back);
            let surely = slope.value >= STANDS_OUT_OF_ANY * lags;
            if size.sigmas < if surely { SMALLEST_WHERE_SURE } else { SMALLEST_OF_FRICTION } {
                return None;
            }
            let found = match self.softness(joint, slope.value / rate(joint.j)) {
                Some(_) if told.contains(&self.arm.parts[joint.j].joint) => None,
                Some(gives) => {
                    let size = self.size(joint.j, |row| gives.value * self.torque_nm(row, joint.j));
                    named(self.arm, Kind::ServoDroop, joint.j, gives, &size)
                }
                None => named(self.arm, Kind::Stiction, joint.j, own, &size),
            }?;
            let found = if surely { found } else { hardly(found) };
            if self.behind_gear { or_play(self.arm, joint.j, found) } else { Some(found) }
        });
        found.collect()
    }

    /// Links that are heavier or lighter than described, as servos that give way feel it beside a known
    /// weight.
    fn other_masses(&self) -> Vec<NamedEffect> {
        if !self.sides.weights {
            return vec![];
        }
        let is_other = |mass: &Slope| {
            mass.sd < MASS_KNOWN && mass.value.abs() > LEAST_MASS && mass.value.abs() > SURE_OF_MASS * mass.sd
        };
        let links = self.masses.iter().enumerate().filter(|(_, mass)| is_other(mass));
        links
            .filter_map(|(link, mass)| {
                let alone = cells::with_only(self.arm, link);
                let sigmas = self.levers.size(|row| {
                    let mut turns = torques_nm(&alone, row, 0.0);
                    for (j, turn) in turns.iter_mut().enumerate() {
                        let gives = self.joints.iter().find(|joint| joint.j == j).and_then(|one| one.gives);
                        *turn *= mass.value * gives.map_or(0.0, |gives| gives.value);
                    }
                    turns
                });
                let size = Size { sigmas, m: sigmas * self.floor_m };
                (sigmas > SMALLEST).then(|| named_mass(self.arm, link, *mass, &size)).flatten()
            })
            .collect()
    }
}

/// What servos do all alike, in words: how far each gives way (rad/N m) and moves the tip by it (m).
fn give_way(alike: &[(f64, f64)]) -> Option<String> {
    median(alike.iter().map(|(value, _)| *value)).map(|usual| {
        let moved_m = alike.iter().map(|(_, size)| size * size).sum::<f64>().sqrt();
        format!(
            "the servos give way under load like springs of {:.0} N m/rad: where encoders are not read, the fingertip \
             is up to {:.0} mm beside its command. Raise the integral gain, or predict from encoders",
            1.0 / usual,
            moved_m * 1e3
        )
    })
}
