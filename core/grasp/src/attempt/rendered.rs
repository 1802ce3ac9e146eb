//! Finds the hand by rendering it where the arm's model has it.

use nalgebra::{Isometry3, Matrix3, Translation3};
use plumbline_model::robot::{Chain, DescriptionError, Posture, Rig};
use plumbline_model::{Point, Pose, Robot};

use super::align::{FoundHand, HandFinder, HandMissing};
use crate::body::Sight;
use crate::hand::{EyesAt, HandOptions, HandShape, HandShapeError, Pair, Predicted, look_for_hand};
use crate::knowledge::Knowledge;

/// The hand of one arm, rendered from the rig's description.
#[derive(Clone, Debug)]
pub struct RenderedHand {
    shape: HandShape,
    chain: Chain,
    options: HandOptions,
}

/// Why a hand cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoHand {
    /// It has no shape.
    #[error(transparent)]
    Shape(#[from] HandShapeError),
    /// Its arm is not described.
    #[error(transparent)]
    Description(#[from] DescriptionError),
}

impl RenderedHand {
    /// The hand that ends in a tip of an arm.
    ///
    /// # Errors
    /// When the description has no such hand, or no shape for it.
    pub fn of_rig(rig: &Rig, tip: &str) -> Result<Self, NoHand> {
        Ok(Self {
            shape: HandShape::of_rig(rig, tip)?,
            chain: rig.chain(tip)?,
            options: HandOptions::default(),
        })
    }
}

impl HandFinder for RenderedHand {
    fn find(
        &mut self,
        knowledge: &Knowledge,
        before: &Sight,
        now: &Sight,
        commanded: &Posture,
        palm: Point<Robot>,
        covariance_m2: &Matrix3<f64>,
    ) -> Result<FoundHand, HandMissing> {
        let turn = self.chain.robot_from_tip_in(commanded).isometry.rotation;
        let place = Isometry3::from_parts(Translation3::from(palm.coords.coords), turn);
        let eyes = EyesAt {
            cameras: knowledge.calibration.cameras.clone(),
            robot_from_left: knowledge.robot_from_left(&now.posture),
        };
        let predicted =
            Predicted { posture: commanded, robot_from_tip: Pose::new(place), covariance_m2: *covariance_m2 };
        let (before, now) = (Some(Pair::from(before)), Pair::from(now));
        let seen = look_for_hand(before, now, &eyes, &self.shape, &predicted, &self.options)
            .map_err(|why| HandMissing(why.to_string()))?;
        let found = palm.coords.coords + seen.offset_m;
        Ok(FoundHand { palm: Point::new(found.x, found.y, found.z), covariance_m2: seen.covariance_m2 })
    }
}
