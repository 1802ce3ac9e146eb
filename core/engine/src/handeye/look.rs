//! A look, carried out on the thread of a job.

use std::path::PathBuf;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_effects::RobotModel;
use plumbline_fit::ArmTouches;
use plumbline_grasp::Halt;
use plumbline_handeye::{HandEyeError, Start, Tied, tie};
use plumbline_model::robot::Rig;
use plumbline_model::{Cancelled, JobContext, Session, StereoCalibration};

use super::progress::{Progress, Unreported, Watcher};
use crate::gap::search::measured;
use crate::grasp::{LedBody, Ropes};
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// What a look rests on.
#[derive(Clone, Debug)]
pub struct Look {
    /// The robot as described.
    pub described: Arc<Rig>,
    /// The robot as it is known.
    pub model: Arc<RobotModel>,
    /// The calibration of the eyes.
    pub calibration: Arc<StereoCalibration>,
    /// The touches that it was learned from.
    pub touches: PathBuf,
    /// Orders to the arm, pairs of the eyes, and an end.
    pub ropes: Ropes,
    /// When it was asked for.
    pub at: Timestamp,
    /// For the window.
    pub progress: Progress,
}

impl Look {
    /// Looks, and sizes both arms. Nothing is put in use.
    pub fn carry_out(&self, context: &dyn JobContext) -> Result<Tied, JobError> {
        context.report(0.0, "reading the touches");
        let rig = self.model.rig();
        let sessions = [Session::read(&self.touches).map_err(JobError::told)?];
        let measurements = measured(std::slice::from_ref(&self.touches), rig)
            .map_err(|error| JobError::Failed(sentence(&error.to_string())))?;
        let few =
            || JobError::failed("The touches are too few to learn an arm from: touch the screen again.");
        let touches = ArmTouches::of(&sessions, &measurements).ok_or_else(few)?;
        let start = Start {
            described: self.with_touched_screen(&sessions[0]),
            model: (*self.model).clone(),
            calibration: self.calibration.clone(),
        };
        let mut body = LedBody::new(rig.clone(), self.ropes.clone(), context);
        let mut watcher = Watcher { progress: self.progress.clone(), context, looks: 0 };
        tie(&mut body, &start, &touches, self.at, &mut watcher, &Unreported(context)).map_err(|error| {
            match error {
                HandEyeError::Cancelled(_) | HandEyeError::Halted(Halt::Cancelled) => Cancelled.into(),
                other => JobError::Failed(sentence(&other.to_string())),
            }
        })
    }

    /// The description with the screen where the touches take it to lie: what they say is relative to that.
    fn with_touched_screen(&self, session: &Session) -> Arc<Rig> {
        let mut rig = (*self.described).clone();
        if let Some(screen) = &session.manifest.touchscreen {
            rig.touchscreen = screen.clone();
        }
        Arc::new(rig)
    }
}
