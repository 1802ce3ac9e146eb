//! The folder of a lab: what the window keeps of a twin, written and read through the rooms' own
//! functions.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_effects::{RigModel, RobotModel};
use plumbline_engine::eyes::store::Store as EyesStore;
use plumbline_engine::ground::World;
use plumbline_engine::ground::shelf::InUse;
use plumbline_engine::rig_models::{self, screen_in};
use plumbline_model::StereoCalibration;
use plumbline_model::robot::Rig;
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_twin::Scenario;
use plumbline_vision::mount::MountCalibration;

use super::error::CommissionError;

/// Pairs of the board.
pub(super) const EYES_SESSION: &str = "commission_eyes";
/// Touches.
pub(super) const TOUCH_SESSION: &str = "commission_touch";

/// The lab and the robot in it.
pub(crate) struct Lab {
    /// What `--data-dir` takes.
    pub folder: PathBuf,
    /// The robot as described.
    pub rig: Arc<Rig>,
    /// What it really is; only the twin reads it.
    pub scenario: Scenario,
    /// Of all that is drawn by chance.
    pub seed: u64,
}

impl Lab {
    /// Where the twin's files are.
    pub fn world(&self) -> PathBuf {
        World::Twin.folder(&self.folder)
    }

    /// Where sessions are.
    pub fn sessions(&self) -> PathBuf {
        self.world().join("sessions")
    }

    /// Accepted calibrations of the eyes.
    pub fn eyes_store(&self) -> EyesStore {
        EyesStore::new(self.world().join("calibrations"))
    }

    /// The calibration of the eyes in use.
    pub fn calibration(&self) -> Result<StereoCalibration, CommissionError> {
        let list = self.eyes_store().list().map_err(CommissionError::room)?;
        let in_use =
            list.iter().find(|entry| entry.in_use).ok_or_else(|| self.gone("the eyes' calibration"))?;
        let (calibration, _) = self.eyes_store().load(&in_use.id).map_err(CommissionError::room)?;
        Ok(calibration)
    }

    /// Where the mount in use is.
    pub fn mount_file(&self) -> InUse {
        InUse::new(self.world().join("mount.toml"))
    }

    /// The mount in use.
    pub fn mount(&self) -> Result<MountCalibration, CommissionError> {
        let mount = self
            .mount_file()
            .read(|file| MountCalibration::read(file, &self.rig).map_err(CommissionError::from))?;
        mount.ok_or_else(|| self.gone("the mount of the eyes"))
    }

    /// Puts a mount in use.
    pub fn accept_mount(&self, mount: &MountCalibration) -> Result<(), CommissionError> {
        let no_folder = |error: std::io::Error| CommissionError::room(error);
        self.mount_file().put(no_folder, |file: &Path| Ok(mount.write(file)?))
    }

    /// The robot with its eyes as calibrated.
    pub fn rig_with_eyes(&self) -> Result<Rig, CommissionError> {
        Ok(self.mount()?.applied_to(&self.rig))
    }

    /// Where the screen was found to lie.
    pub fn placement(&self) -> Result<ScreenPlacement, CommissionError> {
        let placement = screen_in(&self.world())
            .read(|file| ScreenPlacement::read(file, &self.rig.name).map_err(CommissionError::room))?;
        placement.ok_or_else(|| self.gone("the place of the screen"))
    }

    /// Puts a place of the screen in use.
    pub fn accept_placement(&self, placement: &ScreenPlacement) -> Result<(), CommissionError> {
        let no_folder = |error: std::io::Error| CommissionError::room(error);
        screen_in(&self.world())
            .put(no_folder, |file: &Path| placement.write(file).map_err(CommissionError::room))
    }

    /// The robot with its screen where it was found to lie.
    pub fn rig_with_screen(&self) -> Result<Arc<Rig>, CommissionError> {
        let placed = self.placement()?.applied_to(&self.rig).map_err(CommissionError::room)?;
        Ok(Arc::new(placed))
    }

    /// The model with the effects in use.
    pub fn model(&self) -> Result<RigModel, CommissionError> {
        rig_models::load(&self.world(), &self.rig).map_err(CommissionError::room)
    }

    /// The robot as it is known: all that was accepted.
    pub fn known(&self) -> Result<RobotModel, CommissionError> {
        rig_models::in_use(&self.world(), &self.rig).map_err(CommissionError::room)
    }

    fn gone(&self, what: &'static str) -> CommissionError {
        CommissionError::Gone { what, folder: self.world() }
    }
}
