//! Finds an object on the table with the eyes as they are calibrated and the model in use.

use plumbline_effects::{PlaceInRobot, RobotModel, SeenUnder};
use plumbline_grasp::outline::Boxes;
use plumbline_grasp::stands;
use plumbline_grasp::things::Thing;
use plumbline_model::detection::PixelBox;
use plumbline_model::{Detection, Eye, StereoCalibration};
use plumbline_vision::detect::{DetectSettings, DetectorOptions, EyesDetector, Part, shipped_detector};
use plumbline_vision::detect_places::{ObjectPlace, PlaceFinder, PlaceOptions};

use super::error::CommissionError;
use super::robot::{Robot, Sight};

/// Where an object is.
pub(super) struct Found {
    /// As it counts: where it stands, by its shape and the height of the table, else where both eyes see it.
    pub place: PlaceInRobot,
    /// Where both eyes see it.
    pub by_eyes: PlaceInRobot,
}

/// The detector that comes with the program, and places by what was commissioned.
pub(super) struct Seer {
    detector: EyesDetector,
    finder: PlaceFinder,
    model: RobotModel,
}

impl Seer {
    /// With the eyes and the model in use.
    pub fn new(calibration: &StereoCalibration, model: RobotModel) -> Result<Self, CommissionError> {
        let shipped = shipped_detector().ok_or(CommissionError::NoDetector)?;
        let detector = EyesDetector::open(&shipped.file, &DetectorOptions::default())?;
        let options = PlaceOptions::for_classes(&detector.info().names);
        let finder = PlaceFinder::new(Some(calibration), options);
        Ok(Self { detector, finder, model })
    }

    /// Looks for an object from home, then straight at where it was found, and again. The head stays there.
    pub fn look_for(&mut self, robot: &mut Robot, class: &str) -> Result<Option<Found>, CommissionError> {
        let home = self.model.rig().home();
        robot.go(&home);
        let Some(first) = self.find(robot, class)? else { return Ok(None) };
        let (pan_rad, tilt_rad) = self.model.look_at(first.place.point, &home);
        let eyes = &self.model.rig().eyes;
        robot.go(&home.with(&[eyes.pan, eyes.tilt], &[pan_rad, tilt_rad]));
        Ok(self.find(robot, class)?.or(Some(first)))
    }

    /// The middle of the surest object of a class, by name; `None` where none was found by both eyes.
    fn find(&mut self, robot: &mut Robot, class: &str) -> Result<Option<Found>, CommissionError> {
        let sight: Sight = robot.look()?;
        let seen = SeenUnder { t_secs: Some(robot.on_s()), ..SeenUnder::default() };
        let thing = Thing::of_class(class);
        let wanted = self.detector.info().names.index_of(thing.map_or(class, |thing| thing.class));
        let settings = DetectSettings::default();
        let (mut left, mut right): (Vec<Detection>, Vec<Detection>) = (vec![], vec![]);
        let whole = [Part::Lit; 2];
        self.detector.detect_in([&sight.left, &sight.right], whole, &settings, [&mut left, &mut right])?;
        let mut found: Vec<ObjectPlace> = vec![];
        self.finder.find((&sight.left, &left), (&sight.right, &right), &mut found);
        let of_class = found.iter().filter(|object| Some(object.class) == wanted);
        let placed = of_class.filter_map(|object| Some((object, object.place.as_ref().ok()?)));
        let surest = placed.max_by(|a, b| a.0.confidence.total_cmp(&b.0.confidence));
        Ok(surest.and_then(|(object, place)| {
            let middle = &place.middle;
            let by_eyes = self.model.place(&middle.point, &middle.covariance_m2, &sight.posture, &seen)?;
            let area = |eye: Eye, boxes: &[Detection]| {
                let PixelBox { x0_px, y0_px, x1_px, y1_px } = boxes.get(object.seen.index(eye)?)?.area;
                Some([x0_px, y0_px, x1_px, y1_px])
            };
            let boxes_px = [area(Eye::Left, &left), area(Eye::Right, &right)];
            let boxes = Boxes { boxes_px: &boxes_px, posture: &sight.posture, under: seen };
            let stands = thing.and_then(|thing| {
                let stands = stands::place(&self.model, &thing, &boxes, &middle.point, &middle.covariance_m2);
                stands.map(|stands| stands.place)
            });
            Some(Found { place: stands.unwrap_or(by_eyes), by_eyes })
        }))
    }
}
