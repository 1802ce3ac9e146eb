//! A detector as the live stage uses it, and how one is opened.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use image::RgbImage;
use plumbline_model::detection::Detection;
use plumbline_vision::detect::{DetectError, Part};

use super::command::{DetectorChoice, Provider};
use super::view::{DetectionTiming, DetectorFacts};

/// Least confidence that is asked of a detector. Thresholds lie above it, so that moving one needs
/// no new run of the network.
pub const SHOWN_FROM: f32 = 0.05;

/// Why a detector cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DetectorError {
    /// It is switched off.
    #[error("no detector is chosen")]
    NoneChosen,
    /// This build has none of its own.
    #[error(
        "no detector comes with this version; choose an ONNX file, any export of a YOLO detector will do"
    )]
    NoneShipped,
    /// It cannot be opened, or finds nothing on this image.
    #[error(transparent)]
    Detector(#[from] DetectError),
}

/// Finds things on an image.
pub trait Detects: Send {
    /// What it is.
    fn facts(&self) -> DetectorFacts;

    /// Finds everything of at least [`SHOWN_FROM`]; boxes of a class that overlap by more than
    /// `iou` are one thing.
    ///
    /// # Errors
    /// Why nothing can be found on this image, and what to do.
    fn detect(
        &mut self,
        image: &RgbImage,
        iou: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError>;

    /// The same on a part of an image, for what can look at a part in less time. Things elsewhere may
    /// be found too.
    ///
    /// # Errors
    /// As [`Self::detect`].
    fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        iou: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        // Without parts of its own it sees everything.
        let _ = part;
        self.detect(image, iou, found)
    }

    /// Both eyes, left first; for what can look at both at once. The time is that which passed.
    ///
    /// # Errors
    /// As [`Self::detect`].
    fn detect_eyes(
        &mut self,
        images: [&RgbImage; 2],
        parts: [Part; 2],
        iou: f32,
        [left, right]: [&mut Vec<Detection>; 2],
    ) -> Result<DetectionTiming, DetectorError> {
        let of_left = self.detect_in(images[0], parts[0], iou, left)?;
        let of_right = self.detect_in(images[1], parts[1], iou, right)?;
        Ok(of_left.plus(&of_right))
    }
}

/// A detector that is ready. Only the stage that runs it ever waits for it.
pub struct LoadedDetector {
    /// Tells detectors apart, also two readings of the same file.
    pub id: u64,
    /// What it is.
    pub facts: Arc<DetectorFacts>,
    detector: Mutex<Box<dyn Detects>>,
}

impl LoadedDetector {
    /// Takes over a detector.
    pub fn new(detector: Box<dyn Detects>) -> Self {
        static LOADED: AtomicU64 = AtomicU64::new(1);
        let id = LOADED.fetch_add(1, Ordering::Relaxed);
        Self { id, facts: Arc::new(detector.facts()), detector: Mutex::new(detector) }
    }

    /// For running it.
    pub fn lock(&self) -> MutexGuard<'_, Box<dyn Detects>> {
        self.detector.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for LoadedDetector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LoadedDetector").field("id", &self.id).field("name", &self.facts.name).finish()
    }
}

type Opened = Result<Box<dyn Detects>, DetectorError>;
type Open = dyn Fn(&DetectorChoice, Provider) -> Opened + Send + Sync;

/// Opens detectors; takes its time, so never on a thread that draws.
#[derive(Clone)]
pub struct OpenDetector(Arc<Open>);

impl OpenDetector {
    /// Opens them like this.
    pub fn new(open: impl Fn(&DetectorChoice, Provider) -> Opened + Send + Sync + 'static) -> Self {
        Self(Arc::new(open))
    }

    /// Opens one.
    ///
    /// # Errors
    /// What is wrong and what to do.
    pub fn open(&self, choice: &DetectorChoice, provider: Provider) -> Opened {
        (self.0)(choice, provider)
    }
}

impl fmt::Debug for OpenDetector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("OpenDetector")
    }
}
