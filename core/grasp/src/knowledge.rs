//! What a grasp rests on: the robot as it is known, its eyes, and what was learned from touches.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use plumbline_correction::CorrectionModel;
use plumbline_effects::RobotModel;
use plumbline_effects::robot_model::{PlaceInRobot, SeenUnder};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{LeftCamera, Point, Pose, Robot, StereoCalibration};

use crate::published::HandHeights;
use crate::table;

/// What a grasp rests on.
#[derive(Clone, Debug)]
pub struct Knowledge {
    /// The robot as it is known: lenses, mount of the eyes, place of the screen, effects.
    pub model: RobotModel,
    /// The robot as described, which the published methods know.
    pub described: Arc<Rig>,
    /// The calibration of the eyes.
    pub calibration: Arc<StereoCalibration>,
    /// Models learned from touches, where they were trained.
    pub corrections: Corrections,
}

/// What was learned from touches, for the published methods.
#[derive(Clone, Debug, Default)]
pub struct Corrections {
    /// Placement and heights.
    pub m1: Option<Arc<CorrectionModel>>,
    /// Horizontal network, heights interpolated.
    pub m2: Option<Arc<CorrectionModel>>,
    /// Network.
    pub m3: Option<Arc<CorrectionModel>>,
    /// Heights at which the open hand met the table, where it was lowered.
    pub hand: Option<Arc<HandHeights>>,
}

impl Knowledge {
    /// Where the left eye is.
    pub fn robot_from_left(&self, posture: &Posture) -> Pose<Robot, LeftCamera> {
        self.model.robot_from_left(posture)
    }

    /// A place seen by the eyes under these conditions, and how sure it is.
    pub fn place(
        &self,
        in_left: &Point<LeftCamera>,
        covariance_m2: &Matrix3<f64>,
        posture: &Posture,
        under: &SeenUnder,
    ) -> Option<PlaceInRobot> {
        self.model.place(in_left, covariance_m2, posture, under)
    }

    /// How far beside a place (robot frame) both eyes see it by their calibration alone, with the head
    /// where [`Self::robot_from_left`] has it, robot frame, m: what the effects of the eyes do there. `None`:
    /// one of them does not see it.
    pub fn seen_beside_m(
        &self,
        place: &Point<Robot>,
        posture: &Posture,
        under: &SeenUnder,
    ) -> Option<Vector3<f64>> {
        let (left, right) = self.model.project(place, posture, under)?;
        let in_left = self.calibration.cameras.triangulate(left, right)?;
        Some((self.robot_from_left(posture) * in_left).coords.coords - place.coords.coords)
    }

    /// Height of what things stand on at a place, see [`table::support_m`].
    pub fn support_m(&self, x_m: f64, y_m: f64) -> f64 {
        table::support_m(&self.model, x_m, y_m)
    }

    /// Height of the glass at a place, or of its plane beside it, m.
    pub fn glass_m(&self, x_m: f64, y_m: f64) -> f64 {
        table::glass_m(&self.model, x_m, y_m)
    }
}

#[cfg(test)]
mod tests {
    use plumbline_effects::rig_model::{ModelEffect, RigModel};
    use plumbline_effects::{Effect, Kind};

    use super::*;

    /// Long after they were switched on, s.
    const WARM_S: f64 = 3600.0;

    /// A robot whose right eye turns while it gets warm.
    fn warming() -> Knowledge {
        let described = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let mut added = RigModel::nominal(&described);
        added.contents.effects.push(ModelEffect {
            id: Kind::EyeYaw.id().to_owned(),
            site: "right".to_owned(),
            title: String::new(),
            tip: None,
            shape: Some(Effect::yaw_growth(400.0, 0.0)),
            reference_s: 0.0,
            values: vec![0.01],
            covariance: vec![],
            probability: None,
            parameters: vec![],
        });
        Knowledge {
            model: RobotModel::new(described.clone(), Arc::new(added)).expect("it fits"),
            calibration: Arc::new(StereoCalibration::bare(described.eyes.cameras)),
            described,
            corrections: Corrections::default(),
        }
    }

    #[test]
    fn an_effect_that_grows_with_the_warmth_of_the_eyes_moves_places_and_hands_alike() {
        let knowledge = warming();
        let posture = knowledge.described.home();
        let truly = Point::new(0.3, -0.1, 0.08);
        let under = |t_secs: Option<f64>| SeenUnder { t_secs, ..SeenUnder::default() };
        let (left, right) = knowledge.model.project(&truly, &posture, &under(Some(WARM_S))).expect("in view");
        let in_left = knowledge.calibration.cameras.triangulate(left, right).expect("rays meet");
        let place = |t_secs| {
            let place = knowledge.place(&in_left, &Matrix3::zeros(), &posture, &under(t_secs));
            place.expect("a place").point
        };
        let off_m = |t_secs| place(t_secs).distance_m(&truly);
        assert!(off_m(Some(WARM_S)) < 1e-6, "{} m", off_m(Some(WARM_S)));
        assert!(off_m(None) > 0.01 && off_m(Some(0.0)) > 0.01, "{} m", off_m(None));
        assert!(off_m(Some(400.0)) > 0.003 && off_m(Some(400.0)) < off_m(None));
        // What is looked for is looked for where the eyes would see it.
        let beside_m =
            |t_secs| knowledge.seen_beside_m(&truly, &posture, &under(t_secs)).expect("in view").norm();
        assert!((beside_m(Some(WARM_S)) - off_m(None)).abs() < 1e-6 && beside_m(None) < 1e-9);
    }
}
