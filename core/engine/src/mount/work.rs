//! What takes time: solving, and reading and writing the file of the mount in use.

use std::sync::Arc;

use plumbline_model::robot::Rig;
use plumbline_model::{Cancelled, JobContext, StereoCalibration, counted};
use plumbline_vision::mount::{
    HeadView, MountCalibration, MountError, MountOptions, Target, calibrate_mount,
};

use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::shelf::{InUse, Shelf};
use crate::ground::text::sentence;
use crate::rig_models::made_at;
use crate::robot::RobotControl;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum MountWork {
    /// Solves the mount.
    Solve {
        /// The robot, its mount nominal.
        rig: Arc<Rig>,
        /// The eyes' calibration.
        eyes: Arc<StereoCalibration>,
        /// What was seen.
        views: Vec<HeadView>,
        /// For how long the eyes had been on by then, min.
        minutes_since_on: Option<f64>,
        /// What was looked at.
        target: Target,
    },
    /// Writes the accepted mount.
    Save {
        /// Where to.
        kept: InUse,
        /// Where it stays when another one takes its place.
        shelf: Shelf,
        /// What.
        mount: Arc<MountCalibration>,
    },
    /// Reads the mount that was accepted last.
    Restore {
        /// Where from.
        kept: InUse,
        /// Where it stays when another one takes its place.
        shelf: Shelf,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Puts one that was in use earlier in use again.
    UseEarlier {
        /// Its name on the shelf.
        id: String,
        /// The shelf.
        shelf: Shelf,
        /// Where to.
        kept: InUse,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Removes the file, so that the nominal mount is used again.
    Forget {
        /// Which.
        kept: InUse,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum MountResult {
    /// A proposal.
    Solved(Arc<MountCalibration>),
    /// It is in use from now on.
    Saved(Arc<MountCalibration>),
    /// What was in use, if anything was.
    Restored(Option<Arc<MountCalibration>>),
    /// The nominal mount is in use.
    Forgotten,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, MountWork, RobotControl>;

impl LongWork for MountWork {
    type Result = MountResult;

    fn title(&self) -> String {
        match self {
            Self::Solve { views, .. } => format!("Solve the mount from {}", counted(views.len(), "view")),
            Self::Save { .. } => "Use this mount".to_owned(),
            Self::Restore { .. } => "Read the mount in use".to_owned(),
            Self::UseEarlier { .. } => "Go back to an earlier mount".to_owned(),
            Self::Forget { .. } => "Go back to the nominal mount".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(self, Self::Restore { .. })
    }

    fn run(self, context: &dyn JobContext) -> Result<MountResult, JobError> {
        match self {
            Self::Solve { rig, eyes, views, minutes_since_on, target } => {
                let solved =
                    calibrate_mount(&rig, eyes.as_ref(), &views, &target, &MountOptions::default(), context);
                match solved {
                    Ok(mut mount) => {
                        mount.evidence.minutes_since_on = minutes_since_on;
                        Ok(MountResult::Solved(Arc::new(mount)))
                    }
                    Err(MountError::Cancelled(_)) => Err(JobError::Cancelled(Cancelled)),
                    Err(error) => Err(JobError::failed(sentence(&error.to_string()))),
                }
            }
            Self::Save { kept, shelf, mount } => {
                keep(&shelf, &mount)?;
                kept.put(JobError::failed, |file| mount.write(file).map_err(JobError::told))?;
                Ok(MountResult::Saved(mount))
            }
            Self::Restore { kept, shelf, rig } => {
                let mount = kept.read(|file| MountCalibration::read(file, &rig).map_err(JobError::told))?;
                if let Some(mount) = &mount {
                    keep(&shelf, mount)?;
                }
                Ok(MountResult::Restored(mount.map(Arc::new)))
            }
            Self::UseEarlier { id, shelf, kept, rig } => {
                let file = shelf.file_inside(&id).filter(|file| file.is_file());
                let file = file.ok_or_else(|| {
                    JobError::failed("This mount is not kept any more. Solve the mount again.")
                })?;
                let mount = MountCalibration::read(&file, &rig).map_err(JobError::told)?;
                kept.put(JobError::failed, |file| mount.write(file).map_err(JobError::told))?;
                Ok(MountResult::Saved(Arc::new(mount)))
            }
            Self::Forget { kept } => {
                kept.forget().map_err(|error| JobError::not_removed(kept.file(), &error))?;
                Ok(MountResult::Forgotten)
            }
        }
    }
}

/// Writes a mount to its shelf, unless it stands there.
fn keep(shelf: &Shelf, mount: &MountCalibration) -> Result<(), JobError> {
    let file = shelf.file(&made_at(mount.evidence.created));
    if file.is_file() {
        return Ok(());
    }
    shelf.make_folder().map_err(JobError::failed)?;
    mount.write(&file).map_err(JobError::told)
}

impl MountResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Solved(mount) => {
                let views = counted(mount.per_view.len(), "view");
                format!("The mount is solved from {views}: {:.3} px.", mount.rms_px)
            }
            Self::Saved(_) => "The calibrated mount is in use.".to_owned(),
            Self::Restored(_) => "The mount in use was read.".to_owned(),
            Self::Forgotten => "The nominal mount is in use.".to_owned(),
        }
    }
}
