//! Reading detectors and settings, beside the window.

use std::sync::Arc;

use plumbline_model::{JobContext, counted};

use super::command::{DetectorChoice, Provider};
use super::detector::{LoadedDetector, OpenDetector};
use super::store::Store;
use super::view::DetectionSettings;
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// Something to do for detection.
#[derive(Clone, Debug)]
pub enum DetectWork {
    /// Reads what is remembered.
    Restore(Store),
    /// Remembers.
    Keep(Store, Arc<DetectionSettings>),
    /// Reads a detector and makes it ready.
    Open {
        /// How.
        open: OpenDetector,
        /// Which one.
        choice: DetectorChoice,
        /// Where it is computed.
        provider: Provider,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum DetectResult {
    /// What was remembered, and what is wrong with it.
    Restored(DetectionSettings, Option<String>),
    /// These settings are remembered.
    Kept(Arc<DetectionSettings>),
    /// A detector is ready.
    Opened(Arc<LoadedDetector>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, DetectWork>;

impl LongWork for DetectWork {
    type Result = DetectResult;

    fn title(&self) -> String {
        match self {
            Self::Restore(_) => "Read the settings of detection".to_owned(),
            Self::Keep(..) => "Keep the settings of detection".to_owned(),
            Self::Open { choice, .. } => format!("Read the detector {}", choice.name()),
        }
    }

    fn is_quiet(&self) -> bool {
        // What comes of a detector is said where its boxes are.
        true
    }

    fn run(self, context: &dyn JobContext) -> Result<DetectResult, JobError> {
        match self {
            Self::Restore(store) => Ok(match store.read() {
                Ok(settings) => DetectResult::Restored(settings, None),
                Err(problem) => {
                    DetectResult::Restored(DetectionSettings::default(), Some(problem.to_string()))
                }
            }),
            Self::Keep(store, settings) => {
                store.keep(&settings).map_err(JobError::failed)?;
                Ok(DetectResult::Kept(settings))
            }
            Self::Open { open, choice, provider } => {
                context.checkpoint()?;
                context.report(0.1, "reading it and making it ready");
                let detector = open
                    .open(&choice, provider)
                    .map_err(|why| JobError::Failed(sentence(&why.to_string())))?;
                context.checkpoint()?;
                Ok(DetectResult::Opened(Arc::new(LoadedDetector::new(detector))))
            }
        }
    }
}

impl DetectResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(..) => "Settings of detection read.".to_owned(),
            Self::Kept(_) => "Settings of detection kept.".to_owned(),
            Self::Opened(detector) => {
                let facts = &detector.facts;
                format!("Detector {}: {}.", facts.name, counted(facts.names.len(), "class"))
            }
        }
    }
}
