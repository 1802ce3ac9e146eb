//! What servos do between the command and the encoder. Where encoders are logged, a touch is compared with
//! them, and a servo that gives way shows in no touch: commanded against encoder is a measurement of its
//! own.
//!
//! - [`cells`]: means of cells;
//! - [`lag`]: encoder less command of one joint, regressed on the torque of gravity (a servo that gives way)
//!   and, where rows come from both sides, on the direction of motion (friction);
//! - [`masses`]: all joints at once, with masses that are not quite those of the description;
//! - [`rates`]: which joints have to be fast, and lag more for that;
//! - [`size`]: what of it reaches the fingertip, against the noise.

mod cells;
mod lag;
mod masses;
mod name;
mod rates;
mod size;

use nalgebra::Vector3;
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_effects::{Assumed, Kind, Situation};

use crate::beforehand::MASS_SD;
use crate::compare::median;
use crate::finding::NamedEffect;
use crate::floor::Floor;
use cells::Sides;
use lag::{FEWEST_CELLS, Lag, Slope};
use name::{Size, hardly, named, named_mass, or_friction, or_play};
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
/// One that gives way more than others beyond so many standard deviations is soft, and friction stops it farther from its goal
/// for that: of 17 joints of development cases of the blind test that lagged so and gave way so, all were soft.
const SURE_BESIDE_LAG: f64 = 5.0;
/// … surely, and where nothing tells how fast each is, by this many …
const STANDS_OUT_OF_ANY: f64 = 2.5;
/// … and what it does beyond that is no less than this (units of the rows' noise), or this where it surely stands out.
const SMALLEST_OF_FRICTION: f64 = 0.8;
const SMALLEST_WHERE_SURE: f64 = 0.6;
/// From one side and with one weight a servo lags by so many times what others do, always by nearly as much; by this many
/// where it is sure that the lag grows with the load …
const MORE_FROM_ONE_SIDE: f64 = 3.0;
const MORE_WHERE_IT_GROWS: f64 = 2.0;
const LEFT_OVER: f64 = 0.5;
/// Where others bear enough that they would lag so many times what is usual, were they as soft, and lag by less than this share
/// of that, they hold.
const WOULD_SHOW: f64 = 3.0;
const HOLDS: f64 = 0.4;
/// They tell of one that bears no less than they do by this factor.
const ABOUT_AS_MUCH: f64 = 3.0;
/// What lags so many times as far need not be seen to grow.
const FAR_MORE: f64 = 4.5;
/// … and more with a larger load, by so many standard deviations. It is surely the load where what the lag
/// grows by and what it is in proportion to the torque agree to this share.
const HARDLY: f64 = 2.0;
const AGREE: f64 = 0.5;
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

    /// From one side and with one weight: a servo that lags more than the others, and the more the larger its
    /// load. Where the load hardly varies, friction that stops it short looks the same.
    fn seen_from_one_side(&self, joint: &Joint) -> Option<NamedEffect> {
        let others = self.joints.iter().filter(|other| other.j != joint.j);
        let usual = median(others.map(|other| other.lag.rms_rad))?;
        let (lag, grows) = (&joint.lag, joint.lag.gives?);
        let more = if lag.surely_grows() { MORE_WHERE_IT_GROWS } else { MORE_FROM_ONE_SIDE };
        let slope = lag.of_load_slope();
        // Friction toward the load hides what a servo gives way by; that the others hold tells it all the same.
        let alone = lag.surely_grows() && self.others_hold(joint, slope, usual);
        let stands_out = alone || lag.rms_rad > more * usual && lag.sd_rad < LEFT_OVER * lag.rms_rad;
        // What lags far more than the others need not be seen to grow, only not to fall.
        let far = lag.rms_rad > FAR_MORE * usual;
        let grows = if far { grows.value > -HARDLY * grows.sd } else { grows.value > HARDLY * grows.sd };
        if !stands_out
            || !grows
            || slope.value <= 0.0
            || slope.value > FURTHEST
            || all_give(slope, self.others_in_proportion(joint))
        {
            return None;
        }
        let size = self.size(joint.j, |row| slope.value * self.torque_nm(row, joint.j));
        if size.sigmas < SMALLEST {
            return None;
        }
        let found = named(self.arm, Kind::ServoDroop, joint.j, slope, &size)?;
        if alone || lag.is_of_load() { Some(found) } else { or_friction(self.arm, joint.j, found) }
    }

    /// Whether others that bear about as much would show it, were they as soft as this one, and do not.
    fn others_hold(&self, joint: &Joint, slope: Slope, usual_rad: f64) -> bool {
        let others = self.joints.iter().filter(|other| other.j != joint.j && self.turns(other));
        let others =
            others.filter(|other| other.torque_nm < ABOUT_AS_MUCH * joint.torque_nm).map(|other| Other {
                would_rad: slope.value * other.torque_nm,
                does_rad: other.lag.rms_rad,
                grows: other.lag.gives.map_or(0.0, |grows| grows.value / slope.value),
            });
        self.turns(joint) && holds(others, usual_rad)
    }

    fn others_in_proportion(&self, joint: &Joint) -> impl Iterator<Item = Slope> {
        self.joints.iter().filter(move |other| other.j != joint.j).map(|other| other.lag.in_proportion)
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

impl Lag {
    /// Whether from one side, too, the lag can only be of the load: it surely grows with the torque, and by as
    /// much as were it nothing without one.
    fn is_of_load(&self) -> bool {
        let Some(grows) = self.gives else { return false };
        let whole = self.in_proportion.value;
        grows.value > 0.5 * SURE * grows.sd && (grows.value - whole).abs() < AGREE * whole
    }

    /// Whether it surely lags the more the larger the load.
    fn surely_grows(&self) -> bool {
        self.gives.is_some_and(|grows| grows.value > SURE * grows.sd)
    }

    /// By how much it gives way. Where that is seen well, by what it grows by: friction takes its part of the load from what
    /// comes from one side. Else had it no offset, and two ways of looking at it that differ say how well that is known.
    /// So do masses that nobody weighed.
    fn of_load_slope(&self) -> Slope {
        let masses = |value: f64| self.mass_share * MASS_SD * value;
        if let Some(grows) = self.gives.filter(|_| self.surely_grows()) {
            return Slope { value: grows.value, sd: grows.sd.hypot(masses(grows.value)) };
        }
        let Slope { value, sd } = self.in_proportion;
        let apart = self.gives.map_or(0.0, |grows| 0.5 * (grows.value - value));
        Slope { value, sd: sd.hypot(apart).hypot(masses(value)) }
    }
}

/// Whether from one side the others give way about as much, as servos without integral action do: the one that lags farther
/// then only bears more.
fn all_give(slope: Slope, others: impl Iterator<Item = Slope>) -> bool {
    let known: Vec<f64> = others
        .filter(|other| other.value > 0.0 && other.sd < KNOWN * slope.value)
        .map(|other| other.value)
        .collect();
    let usual = median(known.iter().copied()).filter(|_| known.len() >= FEWEST_OTHERS);
    usual.is_some_and(|usual| slope.value < MORE * usual)
}

/// Another servo beside one that gives way.
struct Other {
    /// What it would lag by, were it as soft, and what it does.
    would_rad: f64,
    does_rad: f64,
    /// What it lags more per torque, as a share of what the soft one does: friction may hide the whole, and not what it grows by.
    grows: f64,
}

/// Whether some would show it, and none does.
fn holds(others: impl Iterator<Item = Other>, usual_rad: f64) -> bool {
    let telling: Vec<Other> = others.filter(|other| other.would_rad > WOULD_SHOW * usual_rad).collect();
    let is_stiff = |other: &Other| other.does_rad < HOLDS * other.would_rad && other.grows < HOLDS;
    !telling.is_empty() && telling.iter().all(is_stiff)
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

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::cells::Cell;
    use super::*;

    /// Cells from one side: what does not depend on the torque (rad), and what does (rad/N m).
    fn one_sided(constant: f64, gives: f64, seed: u64) -> Lag {
        noisy(constant, gives, 1e-3, seed)
    }

    fn noisy(constant: f64, gives: f64, noise_rad: f64, seed: u64) -> Lag {
        let mut random = StdRng::seed_from_u64(seed);
        let cell = |_| {
            let torque: f64 = random.random_range(0.3..1.5);
            let noise = noise_rad * random.random_range(-1.7..1.7);
            let lag_rad = vec![gives * torque + constant + noise];
            Cell { lag_rad, back: vec![-0.5], torque_nm: vec![torque], of_links_nm: vec![] }
        };
        let cells: Vec<Cell> = (0..40).map(cell).collect();
        lag::lag(&cells, 0, false).expect("enough cells")
    }

    #[test]
    fn from_one_side_a_lag_is_of_the_load_when_it_is_nothing_without_one() {
        for seed in 0..20 {
            assert!(one_sided(0.0, 0.03, seed).is_of_load());
            // A little friction beside it does not hide it.
            assert!(one_sided(0.004, 0.03, seed).is_of_load());
            // One that lags as much wherever it is loaded is late, not soft.
            assert!(!one_sided(0.02, 0.0, seed).is_of_load());
        }
    }

    #[test]
    fn one_that_bears_more_than_servos_as_soft_as_itself_has_no_fault() {
        let slope = |value: f64| Slope { value, sd: 0.05 * value };
        let alike = [0.028, 0.033, 0.03].map(slope);
        assert!(all_give(slope(0.035), alike.into_iter()));
        assert!(!all_give(slope(0.09), alike.into_iter()), "three times as soft");
        // What hardly bears anything, or lags to the other side, says nothing of how soft servos are.
        let untold = [Slope { value: 0.4, sd: 0.2 }, slope(-0.05), slope(0.03)];
        assert!(!all_give(slope(0.035), untold.into_iter()));
    }

    #[test]
    fn servos_that_bear_as_much_and_do_not_lag_tell_the_soft_one() {
        // What each would lag by, were it as soft, and what it does, in mrad, where 1.8 are usual.
        let other = |would_rad: f64, does_rad: f64, grows: f64| Other { would_rad, does_rad, grows };
        let stiff = || other(7.2, 1.6, 0.1);
        assert!(holds([stiff(), other(2.6, 4.5, 0.0), other(0.0, 3.0, 0.0)].into_iter(), 1.8));
        assert!(!holds([stiff(), other(6.0, 5.0, 0.1)].into_iter(), 1.8), "another one gives way as well");
        assert!(
            !holds([stiff(), other(6.0, 1.0, 0.9)].into_iter(), 1.8),
            "so does one whose friction hides it"
        );
        assert!(!holds([other(2.6, 0.5, 0.0), other(0.0, 3.0, 0.0)].into_iter(), 1.8), "nobody bears enough");
    }

    #[test]
    fn two_ways_that_differ_make_a_slope_less_sure() {
        let lag = noisy(0.01, 0.03, 1e-2, 1);
        let slope = lag.of_load_slope();
        assert!(!lag.surely_grows() && slope.sd > 2.0 * lag.in_proportion.sd, "{slope:?}");
        assert!((slope.value - 0.03).abs() < 2.0 * slope.sd, "{slope:?}");
    }

    #[test]
    fn where_it_is_seen_to_grow_friction_that_takes_its_part_of_the_load_does_not_make_a_servo_stiffer() {
        for seed in 0..20 {
            // Friction holds a third of the load from the one side that touches come from.
            let lag = one_sided(-0.01, 0.03, seed);
            let slope = lag.of_load_slope();
            assert!(lag.surely_grows() && (slope.value - 0.03).abs() < 4.0 * slope.sd, "{slope:?}");
            assert!(lag.in_proportion.value < 0.8 * slope.value, "in proportion it would seem stiffer");
        }
    }
}
