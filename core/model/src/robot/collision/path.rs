//! The straight way in joint angles between two postures.

use super::bodies::bit;
use super::model::{Allowance, CollisionError, CollisionModel, Contact, PostureCheck};
use super::solid::Solid;
use crate::robot::{JointIndex, Posture};

/// No point of the robot moves farther than this between two checks near an obstacle, m.
const STEP_M: f64 = 0.005;
/// Away from obstacles the step is this part of the smallest distance, so that nothing can be
/// reached in between.
const STEP_PART: f64 = 0.5;
/// A contact at the start may deepen by this much before it counts, m: leaving a contact turns a
/// part before it lifts it.
const LEAVING_M: f64 = 0.001;
/// Rounding of angles that does not count as turning beyond a limit, rad.
const LIMIT_SLACK_RAD: f64 = 1e-6;
/// Halvings that narrow down where a contact begins.
const HALVINGS: usize = 8;

/// What a way runs into.
#[derive(Clone, Debug, PartialEq)]
pub enum PathCheck {
    /// Nothing.
    Clear {
        /// The smallest distance at the checked postures, m; between them it is never less than
        /// half of this, or this less 5 mm.
        smallest_m: f64,
        /// Between these; `None` when nothing moves.
        between: Option<Contact>,
        /// Contacts of the start that the way leaves.
        leaves: Vec<Contact>,
    },
    /// Two bodies meet on the way.
    Collides {
        /// Where on the way, 0–1.
        at_fraction: f64,
        /// The two.
        contact: Contact,
        /// How deep they are in each other where it was noticed, m.
        depth_m: f64,
    },
    /// A joint turns beyond its limits, or farther than another joint's angle lets it.
    BeyondLimit {
        /// Where on the way, 0–1.
        at_fraction: f64,
        /// The joint.
        joint: JointIndex,
        /// Its name in the description.
        name: String,
        /// How far, rad.
        by_rad: f64,
        /// What is in the way, for people.
        why: String,
    },
}

/// What stops a joint at its own limit.
const OWN_LIMIT: &str = "the end of its range";

/// How things stand at one place on the way.
enum Standing {
    Free { nearest: Option<(f64, usize)> },
    Stopped(PathCheck),
}

/// The pairs that the way moves, and what is allowed to each.
struct Watch {
    pairs: Vec<usize>,
    allowed_m: Vec<f64>,
    /// How far the start is beyond each limit already, rad.
    excess_rad: Vec<f64>,
}

impl CollisionModel {
    /// Checks the way on which all joints turn evenly from one posture to the other, in steps of
    /// at most 5 mm near obstacles. Pairs that the way does not move are not looked at.
    ///
    /// # Errors
    /// When a posture is not of this robot or not a number.
    pub fn check_path(
        &self,
        from: &Posture,
        to: &Posture,
        allowances: &[Allowance],
    ) -> Result<PathCheck, CollisionError> {
        self.accept(from)?;
        self.accept(to)?;
        let (travel_m, moving) = self.travel_m(from, to);
        if moving == 0 {
            return Ok(self.standing_still(from, allowances));
        }
        let pairs: Vec<usize> =
            (0..self.pairs.len()).filter(|k| self.pairs[*k].moved_by & moving != 0).collect();
        let mut allowed_m = self.allowed_m(&pairs, allowances);
        let solids = self.solids(from);
        let leaves = self.tolerate_start(&pairs, &mut allowed_m, &solids);
        let watch = Watch { pairs, allowed_m, excess_rad: self.excesses_rad(from).collect() };
        let mut smallest: Option<(f64, usize)> = None;
        let (mut fraction, mut before) = (0.0, 0.0);
        loop {
            let nearest = match self.standing(from, to, fraction, &watch) {
                Standing::Free { nearest } => nearest,
                Standing::Stopped(_) => return Ok(self.first_stop(from, to, (before, fraction), &watch)),
            };
            smallest = match (smallest, nearest) {
                (Some(a), Some(b)) => Some(if b.0 < a.0 { b } else { a }),
                (a, b) => a.or(b),
            };
            if fraction >= 1.0 {
                break;
            }
            let step_m = nearest.map_or(STEP_M, |(distance_m, _)| STEP_M.max(STEP_PART * distance_m));
            before = fraction;
            fraction = (fraction + step_m / travel_m).min(1.0);
        }
        Ok(PathCheck::Clear {
            smallest_m: smallest.map_or(f64::INFINITY, |(distance_m, _)| distance_m),
            between: smallest.map(|(_, pair)| self.contact(pair)),
            leaves,
        })
    }

    /// More than any two points of the robot can move against each other on the way, m, and the
    /// joints that turn, one bit each.
    fn travel_m(&self, from: &Posture, to: &Posture) -> (f64, u128) {
        let turns = from.angles_rad().iter().zip(to.angles_rad()).zip(&self.reach_m).enumerate();
        let mut sum = (0.0, 0);
        for (i, ((from, to), reach_m)) in turns {
            let turn_rad = (to - from).abs();
            if turn_rad > 0.0 {
                sum = (sum.0 + turn_rad * reach_m, sum.1 | bit(JointIndex(i)));
            }
        }
        (sum.0.max(1e-9), sum.1)
    }

    fn standing_still(&self, posture: &Posture, allowances: &[Allowance]) -> PathCheck {
        match self.check_posture(posture, allowances) {
            Ok(PostureCheck::Collides { contact, depth_m }) => {
                PathCheck::Collides { at_fraction: 0.0, contact, depth_m }
            }
            Ok(PostureCheck::Clear { smallest_m, between }) => {
                PathCheck::Clear { smallest_m, between: Some(between), leaves: vec![] }
            }
            Err(_) => PathCheck::Clear { smallest_m: f64::INFINITY, between: None, leaves: vec![] },
        }
    }

    /// Lets what touches at the start go on touching, but not deeper.
    fn tolerate_start(&self, pairs: &[usize], allowed_m: &mut [f64], solids: &[Solid]) -> Vec<Contact> {
        let mut leaves: Vec<Contact> = vec![];
        for (k, allowed_m) in pairs.iter().zip(allowed_m) {
            let depth_m = -self.distance_m(*k, solids);
            if depth_m > *allowed_m {
                *allowed_m = depth_m + LEAVING_M;
                let contact = self.contact(*k);
                if !leaves.contains(&contact) {
                    leaves.push(contact);
                }
            }
        }
        leaves
    }

    fn standing(&self, from: &Posture, to: &Posture, fraction: f64, watch: &Watch) -> Standing {
        let posture = from.toward(to, fraction);
        for (i, (now_rad, start_rad)) in self.excesses_rad(&posture).zip(&watch.excess_rad).enumerate() {
            if now_rad > start_rad.max(0.0) + LIMIT_SLACK_RAD {
                let (joint, why) = match i.checked_sub(self.limits.len()) {
                    None => (JointIndex(i), OWN_LIMIT),
                    Some(i) => (self.coupled[i].joint, self.coupled[i].why.as_str()),
                };
                return Standing::Stopped(PathCheck::BeyondLimit {
                    at_fraction: fraction,
                    joint,
                    name: self.description.joint(joint).name.clone(),
                    by_rad: now_rad,
                    why: why.to_owned(),
                });
            }
        }
        let worst = self.worst(&self.solids(&posture), &watch.pairs, &watch.allowed_m);
        match worst {
            Some(worst) if worst.collides => Standing::Stopped(PathCheck::Collides {
                at_fraction: fraction,
                contact: self.contact(worst.pair),
                depth_m: -worst.distance_m,
            }),
            worst => Standing::Free { nearest: worst.map(|worst| (worst.distance_m, worst.pair)) },
        }
    }

    /// How far each limit is exceeded, rad, negative inside: those of the joints, then those that
    /// depend on other joints.
    fn excesses_rad(&self, posture: &Posture) -> impl Iterator<Item = f64> {
        let own = self.limits.iter().zip(posture.angles_rad());
        let own = own.map(|(limits, angle)| (angle - limits.upper_rad).max(limits.lower_rad - angle));
        let coupled = self.coupled.iter().map(|coupled| {
            let largest_rad = coupled.largest_rad(posture[coupled.by]).unwrap_or(f64::INFINITY);
            posture[coupled.joint].abs() - largest_rad
        });
        own.chain(coupled)
    }

    /// Narrows down where between a free and a stopped place the way is first stopped.
    fn first_stop(&self, from: &Posture, to: &Posture, between: (f64, f64), watch: &Watch) -> PathCheck {
        let (mut free, mut stopped) = between;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (free + stopped);
            match self.standing(from, to, middle, watch) {
                Standing::Free { .. } => free = middle,
                Standing::Stopped(_) => stopped = middle,
            }
        }
        match self.standing(from, to, stopped, watch) {
            Standing::Stopped(check) => check,
            Standing::Free { .. } => unreachable!("the place was found to be stopped"),
        }
    }
}
