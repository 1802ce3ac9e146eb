//! What moved, told by what else did.

use nalgebra::Vector3;

use super::{CONFIRMED_BY, Sample};
use crate::watch::{Look, ReferenceKind, ReferenceSeen};

/// Of two turns the smaller counts as none below this share of the larger.
const NONE_SHARE: f64 = 0.25;

/// What moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// The left eye in its mount.
    LeftEye,
    /// The right eye in its mount.
    RightEye,
    /// Both, each in its own way.
    BothEyes,
    /// One against the other; the head moved meanwhile, so nobody saw which.
    OneEye,
    /// Both eyes together, while the encoders of the head stood still: the head has sagged, or everything
    /// before it was pushed.
    Head,
}

impl Mover {
    /// From how the left and the right eye turned, and the right one against the left, rad.
    pub(super) fn of([left, right, against]: &[Vector3<f64>; 3], knows_which: bool) -> Self {
        let most = left.norm().max(right.norm());
        if against.norm() < NONE_SHARE * most {
            return Self::Head;
        }
        if !knows_which {
            return Self::OneEye;
        }
        match (left.norm() < NONE_SHARE * most, right.norm() < NONE_SHARE * most) {
            (true, _) => Self::RightEye,
            (_, true) => Self::LeftEye,
            _ => Self::BothEyes,
        }
    }
}

/// Left, right, right against left, rad.
pub(super) fn turns(look: &Look) -> [Vector3<f64>; 3] {
    let [left, right] = look.turns_rad;
    [left, right, look.against_rad]
}

/// How the eyes turned since they stood so; turns are small, so they are taken off like vectors.
pub(super) fn since(before: &[Vector3<f64>; 3], look: &Look) -> [Vector3<f64>; 3] {
    let now = turns(look);
    [0, 1, 2].map(|k: usize| now[k] - before[k])
}

/// A reference that moved by itself, the eyes having stood.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnMotion {
    /// Its name, for people.
    pub name: String,
    /// What it is: a hand that moves by itself sags.
    pub kind: ReferenceKind,
    /// The first look that shows it, s.
    pub since_s: f64,
    /// The first look that shows it where it was, s; `None`: it is elsewhere still.
    pub until_s: Option<f64>,
    /// How far, robot frame, m; `None`: it is gone or covered.
    pub by_m: Option<Vector3<f64>>,
}

/// Notes what is seen again where it was, in all of the last looks.
fn note_that_are_back(own: &mut [OwnMotion], lately: &[Sample]) {
    for motion in own.iter_mut().filter(|motion| motion.until_s.is_none()) {
        let is_back = |sample: &Sample| {
            let mut all = sample.look.references.iter().filter(|one| one.name == motion.name);
            all.next().is_some_and(|seen| !seen.is_elsewhere())
        };
        if lately.iter().all(is_back) {
            motion.until_s = Some(lately[0].at_s);
        }
    }
}

/// Adds what moved by itself in the last looks, or takes up how far it is by now.
pub(super) fn note_own_motions(own: &mut Vec<OwnMotion>, samples: &[Sample]) {
    let Some(last) = samples.len().checked_sub(CONFIRMED_BY) else { return };
    let lately = &samples[last..];
    note_that_are_back(own, lately);
    for seen in &lately[CONFIRMED_BY - 1].look.references {
        let same = |sample: &Sample| {
            let all = sample.look.references.iter();
            all.filter(|one| one.name == seen.name).any(ReferenceSeen::is_elsewhere)
        };
        if !lately.iter().all(same) {
            continue;
        }
        // Seen elsewhere without a break since then it is the same motion.
        let under_way = own.iter_mut().rev().find(|motion| motion.name == seen.name).filter(|motion| {
            samples.iter().rev().take_while(|sample| sample.at_s >= motion.since_s).all(same)
        });
        match under_way {
            Some(motion) => motion.by_m = seen.own_m,
            None => own.push(OwnMotion {
                name: seen.name.clone(),
                kind: seen.kind,
                since_s: lately[0].at_s,
                until_s: None,
                by_m: seen.own_m,
            }),
        }
    }
}
