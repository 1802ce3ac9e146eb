//! The robot as it is known in a world: its description, with all that was accepted there. It is put
//! together here and nowhere else, from what is on disk or from what the rooms hold.

use std::path::Path;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::robot_model::{Mounted, Unmeasured};
use plumbline_effects::{RigModel, RigModelError, RobotModel};
use plumbline_model::frame::{Head, LeftCamera, Pose};
use plumbline_model::robot::{CalibratedAt, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{StereoCalibration, StereoCameras};
use plumbline_vision::mount::MountCalibration;

use super::{ModelInUseError, load};
use crate::eyes::store::Store;
use crate::ground::shelf::{InUse, Shelf};

/// What was accepted in a world. What is `None` is as the description has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Accepted<'a> {
    /// Lenses, and how the eyes sit to each other.
    pub cameras: Option<&'a StereoCameras>,
    /// How the eyes sit in the head.
    pub head_from_left: Option<Pose<Head, LeftCamera>>,
    /// How warm the eyes were when both were calibrated.
    pub calibrated_at: CalibratedAt,
    /// How well that is known.
    pub mounted: Option<Mounted>,
    /// Where the touchscreen lies.
    pub screen: Option<&'a Touchscreen>,
    /// Effects.
    pub effects: Option<&'a Arc<RigModel>>,
}

impl Accepted<'_> {
    /// Whether a model is of just that.
    pub fn is_in(&self, model: &RobotModel, described: &Rig) -> bool {
        let rig = model.rig();
        let same_effects = self.effects.map_or_else(
            || model.is_nominal(),
            |effects| {
                let for_eyes = effects.for_eyes_of(rig);
                let is_new = !Arc::ptr_eq(&for_eyes, effects);
                Arc::ptr_eq(model.added(), &for_eyes) || is_new && *model.added() == for_eyes
            },
        );
        same_effects
            && rig.eyes.calibrated_at == self.calibrated_at
            && rig.eyes.cameras == *self.cameras.unwrap_or(&described.eyes.cameras)
            && rig.eyes.head_from_left == self.head_from_left.unwrap_or(described.eyes.head_from_left)
            && model.mounted() == self.mounted.as_ref()
            && model.not_calibrated() == self.not_calibrated()
            && rig.touchscreen == *self.screen.unwrap_or(&described.touchscreen)
    }

    /// What of the eyes nobody calibrated: it is taken as described. The neck's zero is told by effects alone.
    fn not_calibrated(&self) -> Unmeasured {
        Unmeasured { mount: self.mounted.is_none(), lenses: self.cameras.is_none(), neck: true }
    }

    /// The description with it. Effects on the eyes that were found with other eyes are not in force, but for what
    /// grows while they warm up, beside a calibration of which it is known how warm they were.
    ///
    /// # Errors
    /// When the effects are of another robot, or have no place in this one.
    pub fn robot_model(&self, described: &Rig) -> Result<RobotModel, RigModelError> {
        let mut rig = described.clone();
        rig.eyes.calibrated_at = self.calibrated_at;
        if let Some(cameras) = self.cameras {
            rig.eyes.cameras = *cameras;
        }
        if let Some(head_from_left) = self.head_from_left {
            rig.eyes.head_from_left = head_from_left;
        }
        if let Some(screen) = self.screen {
            rig.touchscreen = screen.clone();
        }
        let rig = Arc::new(rig);
        let model = match self.effects {
            None => RobotModel::nominal(rig),
            Some(effects) => {
                let effects = effects.for_eyes_of(&rig);
                RobotModel::new(rig, effects)?
            }
        };
        Ok(model.with_mounted(self.mounted).with_not_calibrated(self.not_calibrated()))
    }
}

/// How warm the eyes were when the calibrations in use were made.
pub fn calibrated_at(eyes: Option<&StereoCalibration>, mount: Option<&MountCalibration>) -> CalibratedAt {
    // A time before switching on is none, whatever file it comes from.
    let seconds = |minutes: f64| Some(60.0 * minutes).filter(|seconds| *seconds >= 0.0);
    CalibratedAt {
        cameras_s: eyes.and_then(|eyes| eyes.evidence.as_ref()?.minutes_since_on).and_then(seconds),
        mount_s: mount.and_then(|mount| mount.evidence.minutes_since_on).and_then(seconds),
    }
}

/// How well a mount is known.
pub fn mounted(mount: &MountCalibration) -> Mounted {
    Mounted { covariance: mount.covariance, rest_sigma_rad: mount.angle_sigma_rad }
}

/// What the operator is told of effects that were found with other eyes; `None`: there are none.
pub fn other_eyes(effects: &[&ModelEffect]) -> Option<String> {
    let title = |effect: &&ModelEffect| {
        if effect.title.is_empty() { effect.name() } else { effect.title.clone() }
    };
    let titles: Vec<String> = effects.iter().map(title).collect();
    (!titles.is_empty()).then(|| {
        format!(
            "Left out of the model while these eyes are in use, for it was found with others: {}. Bring those back on the \
             timeline, or find what is missing again, in Gap.",
            titles.join("; ")
        )
    })
}

/// The robot with all that was accepted in the folder of a world: calibration and mount of the eyes,
/// place of the touchscreen, effects. `described` is the robot as its description has it.
///
/// # Errors
/// A sentence, when something that was accepted cannot be used.
pub fn in_use(folder: &Path, described: &Rig) -> Result<RobotModel, ModelInUseError> {
    let calibration = Store::of_world(folder).in_use()?;
    let mount = mount_in(folder)
        .read(|file| MountCalibration::read(file, described).map_err(ModelInUseError::from))?;
    let placement = screen_in(folder)
        .read(|file| ScreenPlacement::read(file, &described.name).map_err(ModelInUseError::from))?;
    let effects = Arc::new(load(folder, described)?);
    let accepted = Accepted {
        cameras: calibration.as_ref().map(|calibration| &calibration.cameras),
        head_from_left: mount.as_ref().map(|mount| mount.head_from_left),
        calibrated_at: calibrated_at(calibration.as_ref(), mount.as_ref()),
        mounted: mount.as_ref().map(mounted),
        screen: placement.as_ref().map(|placement| &placement.screen),
        effects: Some(&effects),
    };
    Ok(accepted.robot_model(described)?)
}

/// The mount in use, in the folder of a world.
pub fn mount_in(folder: &Path) -> InUse {
    InUse::new(folder.join("mount.toml"))
}

/// All mounts that were in use, in the folder of a world.
pub fn mounts_in(folder: &Path) -> Shelf {
    Shelf::new(folder.join("mounts"), "toml")
}

/// All places of the screen that were in use, in the folder of a world.
pub fn screens_in(folder: &Path) -> Shelf {
    Shelf::new(folder.join("screens"), "toml")
}

/// The name of what was made at this time, on its shelf and on the timeline.
pub fn made_at(at: Timestamp) -> String {
    at.to_string().replace(':', "-")
}

/// The place of the screen in use, in the folder of a world.
pub fn screen_in(folder: &Path) -> InUse {
    InUse::new(folder.join("screen.toml"))
}
