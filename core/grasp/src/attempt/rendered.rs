//! Finds the hand by rendering it where the arm's model has it.

use nalgebra::Matrix3;
use plumbline_model::frame::Tip;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Point, Pose, Robot};

use super::align::{FoundHand, HandFinder, HandMissing};
use crate::body::Sight;
use crate::hand::{EyesAt, HandOptions, HandShape, HandShapeError, Pair, Predicted, look_for_hand};
use crate::knowledge::Knowledge;

/// The hand of one arm, rendered from the rig's description.
#[derive(Clone, Debug)]
pub struct RenderedHand {
    shape: HandShape,
    options: HandOptions,
}

/// Why a hand cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoHand {
    /// It has no shape.
    #[error(transparent)]
    Shape(#[from] HandShapeError),
}

impl RenderedHand {
    /// The hand that ends in a tip of an arm.
    ///
    /// # Errors
    /// When the description has no such hand, or no shape for it.
    pub fn of_rig(rig: &Rig, tip: &str) -> Result<Self, NoHand> {
        Ok(Self { shape: HandShape::of_rig(rig, tip)?, options: HandOptions::default() })
    }
}

impl HandFinder for RenderedHand {
    fn find(
        &mut self,
        knowledge: &Knowledge,
        before: &Sight,
        now: &Sight,
        commanded: &Posture,
        robot_from_palm: &Pose<Robot, Tip>,
        covariance_m2: &Matrix3<f64>,
    ) -> Result<FoundHand, HandMissing> {
        let eyes = EyesAt {
            cameras: knowledge.calibration.cameras,
            robot_from_left: knowledge.robot_from_left(&now.posture),
        };
        // It is rendered where the eyes, as calibrated, would see it.
        let palm = robot_from_palm.translation_m();
        let beside_m = knowledge
            .seen_beside_m(&Point::new(palm.x, palm.y, palm.z), &now.posture, &now.seen_under())
            .ok_or_else(|| HandMissing("it is beside what both eyes see".to_owned()))?;
        let mut robot_from_tip = *robot_from_palm;
        robot_from_tip.isometry.translation.vector += beside_m;
        let predicted = Predicted { posture: commanded, robot_from_tip, covariance_m2: *covariance_m2 };
        let (before, now) = (Some(Pair::from(before)), Pair::from(now));
        let seen = look_for_hand(before, now, &eyes, &self.shape, &predicted, &self.options)
            .map_err(|why| HandMissing(why.to_string()))?;
        let found = palm + seen.offset_m;
        Ok(FoundHand { palm: Point::new(found.x, found.y, found.z), covariance_m2: seen.covariance_m2 })
    }
}
