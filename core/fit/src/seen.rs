//! What the eyes see of the hand, beside what the arm's effects say of it; and how neck and eyes move all
//! that is seen.

use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use plumbline_effects::{Assumed, Effect, Measurements};
use plumbline_model::robot::Rig;

use crate::usual::moves_palm;

/// How places that are seen from home move with the neck and with the eyes in the head.
pub struct Looked<'a> {
    rig: &'a Rig,
    /// The head at home.
    robot_from_head: Isometry3<f64>,
}

impl<'a> Looked<'a> {
    /// By a robot as described.
    pub fn new(rig: &'a Rig) -> Self {
        let left = rig.robot_from_left(&rig.home()).isometry;
        Self { rig, robot_from_head: left * rig.eyes.head_from_left.isometry.inverse() }
    }

    /// Takes places as they are seen to where they are when the neck's zero (rad) is off, and the eyes sit
    /// turned (rad) and shifted (m), axes of the head.
    pub fn moved(&self, [neck_rad, turn @ .., x_m, y_m, z_m]: &[f64; 7]) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from_column_slice(turn));
        let eyes = Isometry3::from_parts(Translation3::new(*x_m, *y_m, *z_m), turn);
        let (home, pan) = (self.rig.home(), self.rig.eyes.pan);
        let mount = self.rig.eyes.head_from_left.isometry;
        let turned = self.rig.robot_from_left(&home.with(&[pan], &[home[pan] + neck_rad])).isometry;
        turned * mount.inverse() * eyes * self.robot_from_head.inverse()
    }
}

/// A hand that was seen.
#[derive(Clone, Debug)]
pub struct SeenHand {
    /// Place of the palm by the eyes, their neck's zero taken for right, robot frame, m.
    pub palm_m: Vector3<f64>,
    /// Inverse of its covariance, robot axes, 1/m².
    pub information: Matrix3<f64>,
}

/// Hands over the table.
#[derive(Clone, Debug)]
pub struct SeenHands {
    /// The arm that ends in the palm, and its angles, one row per hand.
    pub arm: Measurements,
    /// What was seen of each.
    pub seen: Vec<SeenHand>,
}

/// How one of them changes with all unknowns, how far it is seen from where the arm has it, and what that
/// is worth.
pub type Against = (DMatrix<f64>, Vector3<f64>, Matrix3<f64>);

impl SeenHands {
    /// Those of them whose numbers are wanted.
    pub(crate) fn only(&self, is_wanted: impl Fn(usize) -> bool) -> Self {
        let mut arm = self.arm.clone();
        let mut number = 0;
        arm.rows.retain(|_| {
            number += 1;
            is_wanted(number - 1)
        });
        let seen = self.seen.iter().enumerate().filter(|(i, _)| is_wanted(*i));
        Self { arm, seen: seen.map(|(_, hand)| hand.clone()).collect() }
    }

    /// All of them against the arm with effects; the unknowns of neck and eyes begin at `neck`, after
    /// them comes how far all hands are seen beside where they are (`beside_m`), then effects. `None` when the arm cannot be predicted.
    pub fn against(
        &self,
        looked: &Looked<'_>,
        assumed: &Assumed,
        effects: &[Effect],
        neck: usize,
        eyes: &[f64; 7],
        beside_m: &Vector3<f64>,
    ) -> Option<Vec<Against>> {
        let of_palm = assumed.effects.iter().filter(|present| moves_palm(&present.effect)).cloned().collect();
        let assumed =
            Assumed { effects: of_palm, placements: vec![Isometry3::identity()], ..Assumed::default() };
        let mut all = vec![];
        for (row, hand) in self.arm.rows.iter().zip(&self.seen) {
            let tangents = self.arm.tangents(row, &assumed, effects)?;
            let offset = neck + eyes.len();
            let first = offset + 3;
            let mut slopes = DMatrix::zeros(3, first + tangents.effects.ncols());
            slopes.columns_mut(first, tangents.effects.ncols()).copy_from(&tangents.effects);
            let mut at = first;
            for effect in effects {
                let width = effect.parameters().len();
                if !moves_palm(effect) {
                    slopes.columns_mut(at, width).fill(0.0);
                }
                at += width;
            }
            let by_eyes = |eyes: &[f64; 7]| (looked.moved(eyes) * Point3::from(hand.palm_m)).coords;
            const STEP: f64 = 1e-4;
            for k in 0..eyes.len() {
                let (mut ahead, mut behind) = (*eyes, *eyes);
                ahead[k] += STEP;
                behind[k] -= STEP;
                slopes.set_column(neck + k, &((by_eyes(&behind) - by_eyes(&ahead)) / (2.0 * STEP)));
            }
            slopes.view_mut((0, offset), (3, 3)).fill_diagonal(1.0);
            let predicted = Vector3::from_column_slice(&tangents.predicted) + beside_m;
            all.push((slopes, by_eyes(eyes) - predicted, hand.information));
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_neck_whose_zero_is_off_moves_what_is_seen_as_the_head_does() {
        let rig = Rig::built_in("nico").expect("valid");
        let (home, pan) = (rig.home(), rig.eyes.pan);
        let in_left = Point3::new(0.05, 0.1, 0.4);
        let at = |turn_rad: f64| {
            rig.robot_from_left(&home.with(&[pan], &[home[pan] + turn_rad])).isometry * in_left
        };
        let looked = Looked::new(&rig);
        let moved = looked.moved(&[0.03, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) * at(0.0);
        assert!((moved - at(0.03)).norm() < 1e-12);
        let shifted = looked.moved(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.002, 0.0]) * at(0.0);
        assert!(((shifted - at(0.0)).norm() - 0.002).abs() < 1e-12);
        let none = looked.moved(&[0.0; 7]) * at(0.0);
        assert!((none - at(0.0)).norm() < 1e-12);
    }
}
