//! Objects on a live pair.

use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::detection::{ClassNames, Detection};
use plumbline_model::{Stamp, StereoFrame};
use plumbline_vision::detect_places::ObjectPlace;

use super::attention::{self, Attention, Looks};
use super::view::{AllBecause, DetectionSettings, DetectionTiming, DetectionsView};
use super::{LoadedDetector, Objects};
use crate::ground::jobs::panic_message;
use crate::ground::stage::Stage;
use crate::ground::text::sentence;
use crate::ground::watched::WatchedThread;
use crate::live::{LiveSetup, NoSetup};

/// A pair, and with what it is looked at.
#[derive(Clone, Debug)]
pub struct DetectInput {
    /// The pair.
    pub frame: StereoFrame,
    /// Which look it is: the same one is not taken twice.
    pub turn: Turn,
    /// Of which source, counted.
    pub opened: u64,
    /// The detector.
    pub detector: Arc<LoadedDetector>,
    /// What is shown of what it finds.
    pub settings: Arc<DetectionSettings>,
    /// Whether pairs are photographs that have nothing to do with each other.
    pub photographs: bool,
    /// What places rest on, or why there are none.
    pub setup: Result<Arc<LiveSetup>, NoSetup>,
}

/// Which look at the live pairs it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Every pair is looked at, as fast as that goes; its number.
    Pair(u64),
    /// The arm moves and gets the processor: a look in so long; which one since the first pair.
    GivesWay(u64),
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct DetectOutput {
    /// Of which source.
    pub opened: u64,
    /// By which detector.
    pub detector: u64,
    /// Of which setup; `None` without one.
    pub generation: Option<u64>,
    /// With which settings.
    pub settings: Arc<DetectionSettings>,
    /// Whether this pair was looked at for the first time.
    pub is_new: bool,
    /// What was found, for the window and for counting.
    pub found: Found,
}

type Found = Result<(DetectionsView, Vec<ObjectPlace>), DetectFailure>;

/// Why nothing was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DetectFailure {
    /// A sentence.
    pub why: String,
    /// Whether the detector must not be used any more.
    pub broken: bool,
}

/// Keeps what the network said of the last pair, so that another threshold needs no new run, and
/// the room for it.
#[derive(Default)]
pub struct DetectStage {
    said: Option<Said>,
    attention: Attention,
    objects: Objects,
    left: Vec<Detection>,
    right: Vec<Detection>,
    shown_left: Vec<Detection>,
    shown_right: Vec<Detection>,
}

/// Of what the kept answer is.
#[derive(Clone, Copy, PartialEq)]
struct Said {
    opened: u64,
    seq: u64,
    captured_at: Instant,
    detector: u64,
    iou: f32,
    looks: Looks,
    timing: DetectionTiming,
}

impl Stage for DetectStage {
    type Input = DetectInput;
    type Output = DetectOutput;
    type Key = (Turn, u64, u64, Option<u64>, Arc<DetectionSettings>);
    const THREAD: WatchedThread = WatchedThread::Detect;

    fn stamp(input: &DetectInput) -> Stamp {
        input.frame.stamp
    }

    fn key(input: &DetectInput) -> Self::Key {
        // With the head each posture would be another setup, and as many looks.
        let stands = matches!(input.turn, Turn::Pair(_));
        let generation = input.setup.as_ref().ok().filter(|_| stands).map(|setup| setup.generation);
        (input.turn, input.opened, input.detector.id, generation, input.settings.clone())
    }

    fn process(&mut self, input: DetectInput) -> DetectOutput {
        let (is_new, found) = self.found(&input);
        DetectOutput {
            opened: input.opened,
            detector: input.detector.id,
            generation: input.setup.as_ref().ok().map(|setup| setup.generation),
            settings: input.settings,
            is_new,
            found,
        }
    }
}

impl DetectStage {
    fn found(&mut self, input: &DetectInput) -> (bool, Found) {
        let workspace = input.setup.as_ref().ok().filter(|_| !input.photographs);
        let workspace =
            workspace.ok_or(AllBecause::Unknown).and_then(|setup| attention::workspace(&input.frame, setup));
        let (is_new, looks, mut timing) = match self.said.filter(|said| said.is_of(input)) {
            Some(said) => (false, said.looks, said.timing),
            None => {
                let sizes_px = [input.frame.left.dimensions(), input.frame.right.dimensions()];
                let looks = self.attention.looks(input.opened, workspace, sizes_px);
                match self.ask(input, looks) {
                    Ok(timing) => (true, looks, timing),
                    Err(failure) => {
                        self.attention.forget();
                        return (true, Err(failure));
                    }
                }
            }
        };
        let begun = Instant::now();
        let names = &input.detector.facts.names;
        let mut left_out = 0;
        for (all, shown) in [(&self.left, &mut self.shown_left), (&self.right, &mut self.shown_right)] {
            shown.clear();
            shown.extend(all.iter().copied().filter(|found| is_shown(found, names, &input.settings)));
            left_out += all.len() - shown.len();
        }
        let boxes = [self.shown_left.as_slice(), self.shown_right.as_slice()];
        self.attention.looked(&looks, workspace, boxes);
        let found = self.objects.find(&input.frame, input.setup.as_ref(), names, boxes);
        let found = match found {
            Ok(found) => found,
            Err(defect) => {
                return (is_new, Err(DetectFailure { why: defect.to_string(), broken: false }));
            }
        };
        timing.places = begun.elapsed();
        let view = DetectionsView {
            stamp: input.frame.stamp,
            names: names.clone(),
            objects: found.objects,
            no_places_because: found.no_places_because,
            looked_at: looks.at,
            timing,
            left_out,
        };
        (is_new, Ok((view, found.places)))
    }

    /// Runs the network on both eyes.
    fn ask(&mut self, input: &DetectInput, looks: Looks) -> Result<DetectionTiming, DetectFailure> {
        self.said = None;
        let (left, right) = (&mut self.left, &mut self.right);
        let iou = input.settings.iou;
        // A foreign file decides what is computed here: its faults end with a sentence.
        let asked = std::panic::catch_unwind(AssertUnwindSafe(|| {
            let images = [&*input.frame.left, &*input.frame.right];
            input.detector.lock().detect_eyes(images, looks.parts, iou, [left, right])
        }));
        let timing = match asked {
            Ok(Ok(timing)) => timing,
            Ok(Err(why)) => return Err(DetectFailure { why: sentence(&why.to_string()), broken: false }),
            Err(panic) => {
                let why = format!(
                    "The detector {} failed inside ({}). The pictures go on without it; choose another one, or read it again.",
                    input.detector.facts.name,
                    panic_message(panic.as_ref())
                );
                return Err(DetectFailure { why, broken: true });
            }
        };
        self.said = Some(Said {
            opened: input.opened,
            seq: input.frame.stamp.seq,
            captured_at: input.frame.stamp.captured_at,
            detector: input.detector.id,
            iou,
            looks,
            timing,
        });
        Ok(timing)
    }
}

impl Said {
    fn is_of(&self, input: &DetectInput) -> bool {
        let stamp = &input.frame.stamp;
        (self.opened, self.seq, self.captured_at) == (input.opened, stamp.seq, stamp.captured_at)
            && self.detector == input.detector.id
            && self.iou == input.settings.iou
    }
}

fn is_shown(found: &Detection, names: &ClassNames, settings: &DetectionSettings) -> bool {
    match names.get(found.class) {
        Some(name) => settings.shows(name) && found.confidence >= settings.confidence_of(name),
        // A class without a name cannot be filtered by it.
        None => found.confidence >= settings.confidence,
    }
}
