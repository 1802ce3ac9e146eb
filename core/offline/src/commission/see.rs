//! Finds an object on the table with the eyes as they are calibrated.

use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{Kind, RigModel};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Detection, Point, Robot as RobotFrame, StereoCalibration};
use plumbline_vision::detect::{DetectSettings, Detector, DetectorOptions, shipped_detector};
use plumbline_vision::detect_places::{ObjectPlace, PlaceFinder, PlaceOptions};

use super::error::CommissionError;
use super::robot::{Robot, Sight};

/// The detector that comes with the program, and places by the eyes' calibration.
pub(super) struct Seer {
    detector: Detector,
    finder: PlaceFinder,
    rig: Rig,
    /// True less encoder of the neck's turn, rad.
    neck_rad: f64,
}

impl Seer {
    /// With these eyes; `rig` has them where they sit.
    pub fn new(calibration: &StereoCalibration, rig: Rig, model: &RigModel) -> Result<Self, CommissionError> {
        let pan = &rig.description.joint(rig.eyes.pan).name;
        let of_neck = |effect: &&ModelEffect| effect.id == Kind::HeadJoint.id() && effect.site == *pan;
        let neck_rad = model.effects().iter().filter(of_neck).flat_map(|effect| &effect.values).sum();
        let shipped = shipped_detector().ok_or(CommissionError::NoDetector)?;
        let detector = shipped.open(&DetectorOptions::default())?;
        let options = PlaceOptions::for_classes(&detector.info().names);
        let finder = PlaceFinder::new(Some(calibration), options);
        Ok(Self { detector, finder, rig, neck_rad })
    }

    /// Looks for an object from home, then straight at where it was found, and again. The head stays there.
    pub fn look_for(
        &mut self,
        robot: &mut Robot,
        class: &str,
    ) -> Result<Option<Point<RobotFrame>>, CommissionError> {
        let home = self.rig.home();
        robot.go(&home);
        let Some(first) = self.find(&robot.look()?, class)? else { return Ok(None) };
        let (pan_rad, tilt_rad) = self.rig.look_at(first, &home);
        let head = [self.rig.eyes.pan, self.rig.eyes.tilt];
        robot.go(&home.with(&head, &[pan_rad, tilt_rad]));
        Ok(self.find(&robot.look()?, class)?.or(Some(first)))
    }

    /// The middle of the surest object of a class, by name; `None` where none was found by both eyes.
    pub fn find(&mut self, sight: &Sight, class: &str) -> Result<Option<Point<RobotFrame>>, CommissionError> {
        let wanted = self.detector.info().names.index_of(class);
        let settings = DetectSettings::default();
        let (mut left, mut right): (Vec<Detection>, Vec<Detection>) = (vec![], vec![]);
        self.detector.detect(&sight.left, &settings, &mut left)?;
        self.detector.detect(&sight.right, &settings, &mut right)?;
        let mut found: Vec<ObjectPlace> = vec![];
        self.finder.find((&sight.left, &left), (&sight.right, &right), &mut found);
        let of_class = found.iter().filter(|object| Some(object.class) == wanted);
        let placed = of_class.filter_map(|object| Some((object.confidence, object.place.as_ref().ok()?)));
        let surest = placed.max_by(|a, b| a.0.total_cmp(&b.0));
        Ok(surest.map(|(_, place)| self.robot_from(&sight.posture, place.middle.point)))
    }

    fn robot_from(
        &self,
        posture: &Posture,
        in_left: Point<plumbline_model::LeftCamera>,
    ) -> Point<RobotFrame> {
        let mut posture = posture.clone();
        posture[self.rig.eyes.pan] += self.neck_rad;
        self.rig.robot_from_left(&posture) * in_left
    }
}
