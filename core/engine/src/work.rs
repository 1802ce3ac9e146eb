//! Work that takes longer than a frame, as data: an immutable snapshot of what it needs, and
//! what comes out.

use plumbline_hardware::{CameraDevice, camera_devices};
use plumbline_model::JobContext;

use crate::detect::{DetectResult, DetectWork};
use crate::detector_scores::work::{ScoresResult, ScoresWork};
use crate::eyes::work::{EyesResult, EyesWork};
use crate::gaps::work::{GapResult, GapWork};
use crate::jobs::JobError;
use crate::label_sets::work::{LabelsResult, LabelsWork};
use crate::models::work::{ModelsResult, ModelsWork};
use crate::mount::work::{MountResult, MountWork};
use crate::touch::work::{TouchResult, TouchWork};

/// Something to do beside the window.
#[derive(Clone, Debug)]
pub enum Work {
    /// Looks which cameras this machine has.
    ListCameras,
    /// Part of detection.
    Detect(Box<DetectWork>),
    /// Part of calibrating the eyes.
    Eyes(Box<EyesWork>),
    /// Part of calibrating how they sit in the head.
    Mount(Box<MountWork>),
    /// Part of touching the screen.
    Touch(Box<TouchWork>),
    /// Part of correction models and tables.
    Models(Box<ModelsWork>),
    /// Part of the gap.
    Gap(Box<GapWork>),
    /// Part of the lab's own data sets.
    Labels(Box<LabelsWork>),
    /// Part of judging detectors.
    Scores(Box<ScoresWork>),
}

impl From<TouchWork> for Work {
    fn from(work: TouchWork) -> Self {
        Self::Touch(Box::new(work))
    }
}

impl From<LabelsWork> for Work {
    fn from(work: LabelsWork) -> Self {
        Self::Labels(Box::new(work))
    }
}

impl From<ScoresWork> for Work {
    fn from(work: ScoresWork) -> Self {
        Self::Scores(Box::new(work))
    }
}

impl From<GapWork> for Work {
    fn from(work: GapWork) -> Self {
        Self::Gap(Box::new(work))
    }
}

impl From<ModelsWork> for Work {
    fn from(work: ModelsWork) -> Self {
        Self::Models(Box::new(work))
    }
}

impl From<MountWork> for Work {
    fn from(work: MountWork) -> Self {
        Self::Mount(Box::new(work))
    }
}

impl From<DetectWork> for Work {
    fn from(work: DetectWork) -> Self {
        Self::Detect(Box::new(work))
    }
}

impl From<EyesWork> for Work {
    fn from(work: EyesWork) -> Self {
        Self::Eyes(Box::new(work))
    }
}

/// What came out.
#[derive(Clone, Debug)]
pub enum WorkResult {
    /// Cameras of this machine.
    Cameras(Vec<CameraDevice>),
    /// Part of detection.
    Detect(Box<DetectResult>),
    /// Part of calibrating the eyes.
    Eyes(Box<EyesResult>),
    /// Part of calibrating how they sit in the head.
    Mount(Box<MountResult>),
    /// Part of touching the screen.
    Touch(Box<TouchResult>),
    /// Part of correction models and tables.
    Models(Box<ModelsResult>),
    /// Part of the gap.
    Gap(Box<GapResult>),
    /// Part of the lab's own data sets.
    Labels(Box<LabelsResult>),
    /// Part of judging detectors.
    Scores(Box<ScoresResult>),
}

impl Work {
    /// What it does, for people.
    pub fn title(&self) -> String {
        match self {
            Self::ListCameras => "Look for cameras".to_owned(),
            Self::Detect(work) => work.title(),
            Self::Eyes(work) => work.title(),
            Self::Mount(work) => work.title(),
            Self::Touch(work) => work.title(),
            Self::Models(work) => work.title(),
            Self::Gap(work) => work.title(),
            Self::Labels(work) => work.title(),
            Self::Scores(work) => work.title(),
        }
    }

    /// Whether it is over so soon that it needs no line when it is done.
    pub fn is_quiet(&self) -> bool {
        match self {
            Self::ListCameras => true,
            Self::Detect(work) => work.is_quiet(),
            Self::Eyes(work) => work.is_quiet(),
            Self::Mount(work) => work.is_quiet(),
            Self::Touch(work) => work.is_quiet(),
            Self::Models(work) => work.is_quiet(),
            Self::Gap(work) => work.is_quiet(),
            Self::Labels(work) => work.is_quiet(),
            Self::Scores(work) => work.is_quiet(),
        }
    }

    /// Does it, on the thread of the caller.
    pub fn run(self, context: &dyn JobContext) -> Result<WorkResult, JobError> {
        match self {
            Self::ListCameras => Ok(WorkResult::Cameras(camera_devices())),
            Self::Detect(work) => work.run(context).map(Box::new).map(WorkResult::Detect),
            Self::Eyes(work) => work.run(context).map(Box::new).map(WorkResult::Eyes),
            Self::Mount(work) => work.run(context).map(Box::new).map(WorkResult::Mount),
            Self::Touch(work) => work.run(context).map(Box::new).map(WorkResult::Touch),
            Self::Models(work) => work.run(context).map(Box::new).map(WorkResult::Models),
            Self::Gap(work) => work.run(context).map(Box::new).map(WorkResult::Gap),
            Self::Labels(work) => work.run(context).map(Box::new).map(WorkResult::Labels),
            Self::Scores(work) => work.run(context).map(Box::new).map(WorkResult::Scores),
        }
    }
}

impl WorkResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Cameras(cameras) => format!("{} cameras", cameras.len()),
            Self::Detect(result) => result.summary(),
            Self::Eyes(result) => result.summary(),
            Self::Mount(result) => result.summary(),
            Self::Touch(result) => result.summary(),
            Self::Models(result) => result.summary(),
            Self::Gap(result) => result.summary(),
            Self::Labels(result) => result.summary(),
            Self::Scores(result) => result.summary(),
        }
    }
}
