//! An arm whose hand is known to stand beside where it is described.

use std::sync::Arc;

use nalgebra::Vector3;

use super::model::{Allowance, Body, CollisionError, CollisionModel, PostureCheck};
use super::path::PathCheck;
use crate::robot::{JointIndex, LinkIndex, Posture, Rig};

/// Everything that stands around the robot.
const SURROUNDINGS: [Body; 3] = [Body::Table, Body::Touchscreen, Body::Floor];

/// The bodies of a robot that is sent beside where its hand ends. For the robot as it is described the hand stands among
/// surroundings that were moved by as much; of the other links nobody knows how far they are off, so they are looked at
/// where everything stands.
#[derive(Clone, Debug)]
pub struct BesideModel {
    still: Arc<CollisionModel>,
    /// `None`: nothing is moved.
    moved: Option<Moved>,
}

#[derive(Clone, Debug)]
struct Moved {
    bodies: CollisionModel,
    /// In the moved model only the hand counts, …
    not_others: Vec<Allowance>,
    /// … and in the other one everything else.
    not_hand: Vec<Allowance>,
}

impl BesideModel {
    /// For a rig and its bodies, and the hand that the last joint of a chain moves; `beside_m` is the point that is sent
    /// less the place where the hand ends, robot axes.
    pub fn new(still: Arc<CollisionModel>, rig: &Rig, chain: &[JointIndex], beside_m: Vector3<f64>) -> Self {
        let hand = chain.last().map_or_else(Vec::new, |joint| still.links_moved_by(*joint));
        if beside_m.norm() == 0.0 || hand.is_empty() {
            return Self { still, moved: None };
        }
        let bodies = still.among(&rig.with_surroundings_moved(beside_m));
        let links = 0..rig.description.links().len();
        let others: Vec<LinkIndex> = links.map(LinkIndex).filter(|link| !hand.contains(link)).collect();
        let never = |links: &[LinkIndex]| {
            SURROUNDINGS
                .map(|body| Allowance { links: links.to_vec(), body, depth_m: f64::INFINITY })
                .to_vec()
        };
        let moved = Some(Moved { bodies, not_others: never(&others), not_hand: never(&hand) });
        Self { still, moved }
    }

    /// As [`CollisionModel::check_posture`].
    ///
    /// # Errors
    /// When the posture is not of this robot or not a number.
    pub fn check_posture(
        &self,
        posture: &Posture,
        allowances: &[Allowance],
    ) -> Result<PostureCheck, CollisionError> {
        let Some(moved) = &self.moved else { return self.still.check_posture(posture, allowances) };
        let of_hand = moved.bodies.check_posture(posture, &[allowances, &moved.not_others].concat())?;
        if let PostureCheck::Collides { .. } = of_hand {
            return Ok(of_hand);
        }
        let others = self.still.check_posture(posture, &[allowances, &moved.not_hand].concat())?;
        Ok(match (&of_hand, &others) {
            (PostureCheck::Clear { smallest_m: a, .. }, PostureCheck::Clear { smallest_m: b, .. })
                if a < b =>
            {
                of_hand
            }
            _ => others,
        })
    }

    /// As [`CollisionModel::check_path`].
    ///
    /// # Errors
    /// When a posture is not of this robot or not a number.
    pub fn check_path(
        &self,
        from: &Posture,
        to: &Posture,
        allowances: &[Allowance],
    ) -> Result<PathCheck, CollisionError> {
        let Some(moved) = &self.moved else { return self.still.check_path(from, to, allowances) };
        let of_hand = moved.bodies.check_path(from, to, &[allowances, &moved.not_others].concat())?;
        if !matches!(of_hand, PathCheck::Clear { .. }) {
            return Ok(of_hand);
        }
        let others = self.still.check_path(from, to, &[allowances, &moved.not_hand].concat())?;
        Ok(match (&of_hand, &others) {
            (PathCheck::Clear { smallest_m: a, .. }, PathCheck::Clear { smallest_m: b, .. }) if a < b => {
                of_hand
            }
            _ => others,
        })
    }
}
