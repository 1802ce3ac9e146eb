//! What a grasp rests on: the robot as it is known, its eyes, and what was learned from touches.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use plumbline_correction::CorrectionModel;
use plumbline_effects::RobotModel;
use plumbline_effects::robot_model::{PlaceInRobot, SeenUnder};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{LeftCamera, Point, Pose, Robot, StereoCalibration};

use crate::published::HandHeights;

/// The touchscreen's glass lies so much higher than the table on which it stands, m.
const GLASS_OVER_TABLE_M: f64 = 0.002;

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

    /// A place seen by the eyes, and how sure it is.
    pub fn place(
        &self,
        in_left: &Point<LeftCamera>,
        covariance_m2: &Matrix3<f64>,
        posture: &Posture,
    ) -> Option<PlaceInRobot> {
        self.model.place(in_left, covariance_m2, posture, &SeenUnder::default())
    }

    /// Height of what things stand on at a place: the glass where the touchscreen lies, the table
    /// beside it, in the plane in which the screen was found to lie, m.
    pub fn support_m(&self, x_m: f64, y_m: f64) -> f64 {
        let screen = self.model.touchscreen();
        let glass_m = self.glass_m(x_m, y_m);
        let on_glass = screen.contains(screen.pixel_at(Point::new(x_m, y_m, glass_m)));
        if on_glass { glass_m } else { glass_m - GLASS_OVER_TABLE_M }
    }

    /// Height of the glass at a place, or of its plane beside it, m.
    pub fn glass_m(&self, x_m: f64, y_m: f64) -> f64 {
        let screen = self.model.touchscreen();
        let normal: Vector3<f64> = screen.normal().vector();
        let origin = screen.origin.coords.coords;
        origin.z - (normal.x * (x_m - origin.x) + normal.y * (y_m - origin.y)) / normal.z
    }
}
