//! From a pair of images to things with a place in the robot's frame.

use nalgebra::Matrix3;
use plumbline_model::detection::{ClassNames, PixelBox};
use plumbline_model::{Eye, Point, Robot, Workspace, decompose};
use plumbline_vision::detect::{DetectError, DetectSettings, EyesDetector, Part};
use plumbline_vision::detect_places::{ObjectPlace, PlaceFinder, PlaceOptions};
use serde::{Deserialize, Serialize};

use crate::body::Sight;
use crate::knowledge::Knowledge;

/// Where the effects of the eyes cannot be undone.
const BEYOND: &str = "the model of the eyes knows no such place";

/// A thing that was seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seen {
    /// Name of its class.
    pub class: String,
    /// 0–1.
    pub confidence: f32,
    /// Its box in the left and in the right eye: x0, y0, x1, y1 in raw px.
    pub boxes_px: [Option<[f32; 4]>; 2],
    /// Its middle, robot frame.
    pub place: Result<SeenPlace, String>,
}

/// Where something is, as the eyes see it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeenPlace {
    /// Robot frame, m.
    pub point_m: [f64; 3],
    /// Its covariance, m².
    pub covariance_m2: Matrix3<f64>,
    /// The part of it by the mount of the eyes, m²; zero in records of programs that did not tell it apart.
    #[serde(default)]
    pub by_mount_m2: Matrix3<f64>,
}

impl SeenPlace {
    /// The point.
    pub fn point(&self) -> Point<Robot> {
        let [x, y, z] = self.point_m;
        Point::new(x, y, z)
    }

    /// Standard deviation in the worst direction of the table's plane, m.
    pub fn sigma_on_table_m(&self) -> f64 {
        let mut flat = Matrix3::zeros();
        flat.fixed_view_mut::<2, 2>(0, 0).copy_from(&self.covariance_m2.fixed_view::<2, 2>(0, 0));
        decompose::symmetric_eigenvalues(flat).map_or(f64::INFINITY, |values| values.max().max(0.0).sqrt())
    }
}

/// Looks: a detector, and what pairs its boxes.
#[derive(Debug)]
pub struct Looker {
    detector: EyesDetector,
    places: PlaceFinder,
    settings: DetectSettings,
    names: ClassNames,
    found: Vec<ObjectPlace>,
}

impl Looker {
    /// With a detector, for the calibration of the eyes in use; one of single images looks at one eye
    /// after the other.
    pub fn new(detector: impl Into<EyesDetector>, knowledge: &Knowledge, settings: DetectSettings) -> Self {
        let detector = detector.into();
        let names = detector.info().names.clone();
        let options = PlaceOptions::for_classes(&names);
        let places = PlaceFinder::new(Some(&knowledge.calibration), options);
        Self { detector, places, settings, names, found: vec![] }
    }

    /// All things in a pair, the surest first.
    ///
    /// # Errors
    /// When the detector fails.
    pub fn look(&mut self, sight: &Sight, knowledge: &Knowledge) -> Result<Vec<Seen>, DetectError> {
        self.look_in(sight, knowledge, [Part::Lit; 2])
    }

    /// All things on the table, the surest first: what lies beside the workspace is not looked at, which
    /// takes less than half the time.
    ///
    /// # Errors
    /// When the detector fails.
    pub fn look_at_table(&mut self, sight: &Sight, knowledge: &Knowledge) -> Result<Vec<Seen>, DetectError> {
        let described = knowledge.model.rig().workspace(&sight.posture);
        let robot_from_left = knowledge.robot_from_left(&sight.posture);
        let workspace = Workspace { robot_from_left, ..described };
        let cameras = &knowledge.calibration.cameras;
        let part = |eye: Eye| Part::of_workspace(cameras, &workspace, eye, sight.left.dimensions());
        self.look_in(sight, knowledge, Eye::BOTH.map(part))
    }

    fn look_in(
        &mut self,
        sight: &Sight,
        knowledge: &Knowledge,
        parts: [Part; 2],
    ) -> Result<Vec<Seen>, DetectError> {
        let mut boxes = [vec![], vec![]];
        let [in_left, in_right] = &mut boxes;
        self.detector.detect_in([&sight.left, &sight.right], parts, &self.settings, [in_left, in_right])?;
        let [left, right] = &boxes;
        let under = sight.seen_under();
        self.places.find((&sight.left, left), (&sight.right, right), &mut self.found);
        let area = |eye: Eye, index: Option<usize>| {
            let PixelBox { x0_px, y0_px, x1_px, y1_px } = boxes[eye.index()].get(index?)?.area;
            Some([x0_px, y0_px, x1_px, y1_px])
        };
        let mut seen: Vec<Seen> = self
            .found
            .iter()
            .map(|thing| Seen {
                class: self.names.get(thing.class).unwrap_or_default().to_owned(),
                confidence: thing.confidence,
                boxes_px: Eye::BOTH.map(|eye| area(eye, thing.seen.index(eye))),
                place: thing.place.map_err(|why| why.to_string()).and_then(|place| {
                    let middle = &place.middle;
                    let place = knowledge.place(&middle.point, &middle.covariance_m2, &sight.posture, &under);
                    let place = place.ok_or_else(|| BEYOND.to_owned())?;
                    Ok(SeenPlace {
                        point_m: place.point.coords.coords.into(),
                        covariance_m2: place.covariance_m2,
                        by_mount_m2: place.by_mount_m2,
                    })
                }),
            })
            .collect();
        seen.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        Ok(seen)
    }
}
