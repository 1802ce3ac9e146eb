//! Servos that give way, seen from one side and with one weight: there friction and load go together.

use plumbline_effects::Kind;

use super::lag::{Lag, Slope};
use super::name::{named, or_friction};
use super::{FEWEST_OTHERS, FURTHEST, Joint, KNOWN, MORE, SMALLEST, SURE, Servos};
use crate::beforehand::MASS_SD;
use crate::compare::median;
use crate::finding::NamedEffect;

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

impl Servos<'_> {
    /// From one side and with one weight: a servo that lags more than the others, and the more the larger its
    /// load. Where the load hardly varies, friction that stops it short looks the same.
    pub(super) fn seen_from_one_side(&self, joint: &Joint) -> Option<NamedEffect> {
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
            || !alone && all_give(slope, self.others_in_proportion(joint))
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

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::super::cells::Cell;
    use super::super::lag::lag;
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
        lag(&cells, 0, false).expect("enough cells")
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
