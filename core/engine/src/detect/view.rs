//! What the detector sees live: boxes in both eyes, what belongs together, where it is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use plumbline_model::detection::{ClassIndex, ClassNames, PixelBox};
use plumbline_model::frame::Robot;
use plumbline_model::spread::radius_95_m;
use plumbline_model::{Eye, Pixel, Point, Raw, Rectified, Stamp};
pub use plumbline_vision::detect_places::NoPlace as Unplaced;
use serde::{Deserialize, Serialize};

use super::command::{DetectorChoice, Provider};
use crate::ground::statistics::StageStatistics;
use crate::ground::text::sentence;
use crate::live::{NoPlace, NoSetup, OtherSize};

/// Detection, live.
#[derive(Clone, Debug, Default)]
pub struct DetectView {
    /// Whether somebody looks at it; nothing is detected otherwise.
    pub wanted: bool,
    /// The detector in use, or why there is none.
    pub detector: DetectorState,
    /// Name of another detector that is being read while the one in use goes on.
    pub opening: Option<String>,
    /// Why another detector was not taken: a sentence.
    pub refused: Option<String>,
    /// What is shown of what it finds; remembered.
    pub settings: Arc<DetectionSettings>,
    /// The newest result.
    pub found: Option<Arc<DetectionsView>>,
    /// Why the newest result must not be taken for the present: a sentence.
    pub stale: Option<String>,
    /// Why nothing could be detected on the newest pair: a sentence.
    pub failed: Option<String>,
    /// How reliably each class is seen, by class number.
    pub rates: Arc<[ClassRates]>,
    /// Over how many pairs they were counted.
    pub counted: usize,
    /// Rate, age, drops.
    pub statistics: StageStatistics,
}

impl DetectView {
    /// What the detector in use is, if one is ready.
    pub fn facts(&self) -> Option<&Arc<DetectorFacts>> {
        match &self.detector {
            DetectorState::Ready(facts) => Some(facts),
            _ => None,
        }
    }
}

/// The detector in use, or why there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum DetectorState {
    /// None was asked for yet.
    #[default]
    None,
    /// Switched off by the operator.
    Off,
    /// Being read.
    Loading {
        /// Its name.
        name: String,
    },
    /// Ready.
    Ready(Arc<DetectorFacts>),
    /// Could not be used.
    Failed {
        /// Its name.
        name: String,
        /// What is wrong and what to do, a sentence.
        why: String,
    },
}

/// What a detector is, for people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetectorFacts {
    /// Short name.
    pub name: String,
    /// Where it was read from; `None` if it came with the program.
    pub file: Option<PathBuf>,
    /// Its classes, in the order that gives numbers their meaning.
    pub names: ClassNames,
    /// Where the names were found: "the file's metadata".
    pub names_from: String,
    /// Another list of names that does not agree, and where it was found.
    pub other_names: Option<(ClassNames, String)>,
    /// Size of what it looks at, kind of head, numbers, processor, version: name and value.
    pub rows: Vec<(String, String)>,
    /// What to know before using it, sentences.
    pub remarks: Vec<String>,
}

/// What is shown of what a detector finds. Remembered from start to start; classes by their names,
/// because another detector may number them differently.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DetectionSettings {
    /// Least confidence, 0–1.
    pub confidence: f32,
    /// Least confidence of single classes, in place of the one for all.
    pub class_confidence: BTreeMap<String, f32>,
    /// Boxes of a class that overlap by more than this are taken for one thing, 0–1.
    pub iou: f32,
    /// Classes that are not shown.
    pub hidden: BTreeSet<String>,
    /// What computes the network.
    pub provider: Provider,
    /// Which detector.
    pub detector: DetectorChoice,
}

impl Default for DetectionSettings {
    fn default() -> Self {
        Self {
            confidence: 0.25,
            class_confidence: BTreeMap::new(),
            iou: 0.7,
            hidden: BTreeSet::new(),
            provider: Provider::default(),
            detector: DetectorChoice::default(),
        }
    }
}

impl DetectionSettings {
    /// Least confidence of a class.
    pub fn confidence_of(&self, class: &str) -> f32 {
        self.class_confidence.get(class).copied().unwrap_or(self.confidence)
    }

    /// Whether a class is shown.
    pub fn shows(&self, class: &str) -> bool {
        !self.hidden.contains(class)
    }
}

/// What was found on one pair.
#[derive(Clone, Debug)]
pub struct DetectionsView {
    /// Of the pair.
    pub stamp: Stamp,
    /// Names of the classes.
    pub names: ClassNames,
    /// Everything found, most certain first; a box of the left eye and one of the right eye that
    /// belong together are one object.
    pub objects: Vec<ObjectView>,
    /// Why no object has a place: no calibration, images of another size. A sentence.
    pub no_places_because: Option<String>,
    /// What of the pair was looked at.
    pub looked_at: LookedAt,
    /// Where the time went.
    pub timing: DetectionTiming,
    /// How many boxes were left out by threshold or filter, left and right together.
    pub left_out: usize,
}

/// What of a pair was looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LookedAt {
    /// Where the workspace is in both eyes.
    Workspace {
        /// Share of the images, mean of both eyes, 0–1.
        share: f64,
        /// Whether more than that, for things that were seen beyond it.
        with_beyond: bool,
    },
    /// All that the lenses show.
    All(AllBecause),
}

impl LookedAt {
    /// For the operator: "the workspace, 31 % of the images".
    pub fn words(&self) -> String {
        match self {
            Self::Workspace { share, with_beyond } => {
                let beyond = if *with_beyond { " and what is beyond it" } else { "" };
                format!("the workspace{beyond}, {:.0} % of the images", 100.0 * share)
            }
            Self::All(why) => format!("all of the images: {why}"),
        }
    }
}

/// Why all of a pair was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AllBecause {
    /// It is time.
    #[error("now and then, for what is beyond the workspace")]
    NowAndThen,
    /// Something is looked for.
    #[error("something moved beyond the workspace")]
    Searching,
    /// The head looks elsewhere.
    #[error("the workspace is not in view")]
    OutOfView,
    /// No calibration fits these images, or they are photographs that have nothing to do with each other.
    #[error("nobody knows where the workspace is")]
    Unknown,
}

/// One thing, seen by one or both eyes.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectView {
    /// What it is.
    pub class: ClassIndex,
    /// Name of that.
    pub name: String,
    /// In the left eye.
    pub left: Option<SeenBox>,
    /// In the right eye.
    pub right: Option<SeenBox>,
    /// How far the two boxes lie from each other's epipolar line, pixels.
    pub epipolar_px: Option<f64>,
    /// Why the other eye has no box for it, a sentence.
    pub alone_because: Option<String>,
    /// Where both eyes see it, or why that is not known.
    pub place: Result<ObjectPlaceView, NoObjectPlace>,
    /// Where it stands, by its known shape and the height of the table; `None`: its shape or that height is not
    /// known, or it does not seem to stand there.
    pub stands: Option<ObjectPlaceView>,
    /// Parts of the raw left image whose pixels decided its distance.
    pub voted: Arc<[PixelBox]>,
    /// What lies behind it would have got into its distance: a sentence.
    pub leak: Option<String>,
    /// What else makes it doubtful, sentences: the eyes call it differently, boxes and pixels
    /// disagree, no pixels could be matched.
    pub doubts: Vec<String>,
}

impl ObjectView {
    /// Its box in an eye.
    pub fn seen(&self, eye: Eye) -> Option<&SeenBox> {
        match eye {
            Eye::Left => self.left.as_ref(),
            Eye::Right => self.right.as_ref(),
        }
    }

    /// Where it is, as well as that is known: where it stands, else where both eyes see it.
    ///
    /// # Errors
    /// Why neither is known.
    pub fn best_place(&self) -> Result<&ObjectPlaceView, &NoObjectPlace> {
        self.stands.as_ref().map_or(self.place.as_ref(), Ok)
    }

    /// Whether both eyes see it.
    pub fn in_both(&self) -> bool {
        self.left.is_some() && self.right.is_some()
    }

    /// The larger of the confidences.
    pub fn confidence(&self) -> f32 {
        let of = |seen: &Option<SeenBox>| seen.as_ref().map_or(0.0, |seen| seen.confidence);
        of(&self.left).max(of(&self.right))
    }
}

/// Why it is not known where an object is: a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoObjectPlace {
    /// Nothing can be measured.
    #[error(transparent)]
    Setup(#[from] NoSetup),
    /// Images of other eyes.
    #[error(transparent)]
    OtherSize(#[from] OtherSize),
    /// Its boxes tell no place.
    #[error("{}", sentence(&.0.to_string()))]
    Boxes(#[from] Unplaced),
    /// The model in use knows no place that looks so.
    #[error("{}", sentence(&.0.to_string()))]
    Model(#[from] NoPlace),
}

/// A box in one eye.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenBox {
    /// How sure the detector is, 0–1.
    pub confidence: f32,
    /// On the raw image.
    pub area: PixelBox,
    /// The same outline on the rectified image of that eye, in order; empty where it lies outside.
    pub rectified: Arc<[Pixel<Rectified>]>,
    /// The epipolar line of its middle in the raw image of the other eye; empty without a
    /// calibration.
    pub line_in_other: Arc<[Pixel<Raw>]>,
}

/// Where an object is.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPlaceView {
    /// Its middle, in the robot's frame, by the model in use.
    pub point_in_robot: Point<Robot>,
    /// Standard deviations along x, y, z of the robot, with those of the model's effects and of what nobody measured
    /// of the eyes, meters.
    pub sigma_m: [f64; 3],
    /// Why they are wide, and what to do; `None`: all that the place rests on was measured.
    pub wide_because: Option<&'static str>,
    /// Covariance in the robot's frame, m².
    pub covariance_m2: nalgebra::Matrix3<f64>,
    /// Distance from the left eye, meters.
    pub range_m: f64,
    /// Standard deviation of that, meters.
    pub range_sigma_m: f64,
    /// The model of the robot, for people: "as described", "with 2 effects".
    pub model: Arc<str>,
}

impl ObjectPlaceView {
    /// So near to its middle it is with 95 %, meters.
    pub fn within_m(&self) -> f64 {
        radius_95_m(&self.covariance_m2)
    }
}

/// Where the time of one result went: both eyes one after the other, or of two at once the one that
/// took longer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectionTiming {
    /// Scaling and padding the images.
    pub before: Duration,
    /// The network.
    pub network: Duration,
    /// Reading its answer, suppressing doubles.
    pub after: Duration,
    /// Pairing, and places in space.
    pub places: Duration,
}

impl DetectionTiming {
    /// Of two images, one after the other.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            before: self.before + other.before,
            network: self.network + other.network,
            after: self.after + other.after,
            places: self.places + other.places,
        }
    }

    /// All of it.
    pub fn total(&self) -> Duration {
        self.before + self.network + self.after + self.places
    }
}

/// How reliably a class is seen, over the last pairs. Nobody knows what truly stands before the
/// eyes: the figures compare one eye with the other, and a pair with the pairs around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClassRates {
    /// Name of the class.
    pub name: String,
    /// Share of the pairs in which the left eye saw at least one.
    pub left: f64,
    /// The same of the right eye.
    pub right: f64,
    /// Of all objects of the class, the share that both eyes saw as one; `None` if there was none.
    pub agree: Option<f64>,
    /// Share of the objects that usually are there and were missed by both eyes; `None` if there
    /// usually is none.
    pub lost: Option<f64>,
}

impl ClassRates {
    /// Whether it was seen at all.
    pub fn was_seen(&self) -> bool {
        self.left > 0.0 || self.right > 0.0
    }
}
