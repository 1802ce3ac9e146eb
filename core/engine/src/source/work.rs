//! What takes time: asking the system.

use plumbline_hardware::{CameraDevice, camera_devices};
use plumbline_model::{JobContext, counted};

use super::command::Control;
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum SourceWork {
    /// Looks which cameras this machine has.
    ListCameras,
}

/// What came out.
#[derive(Clone, Debug)]
pub enum SourceResult {
    /// Cameras of this machine.
    Cameras(Vec<CameraDevice>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, SourceWork, Control>;

impl LongWork for SourceWork {
    type Result = SourceResult;

    fn title(&self) -> String {
        match self {
            Self::ListCameras => "Look for cameras".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        true
    }

    fn run(self, _context: &dyn JobContext) -> Result<SourceResult, JobError> {
        match self {
            Self::ListCameras => Ok(SourceResult::Cameras(camera_devices())),
        }
    }
}

impl SourceResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Cameras(cameras) => counted(cameras.len(), "camera"),
        }
    }
}
