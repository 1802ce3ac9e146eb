//! The robot whose eyes took the images: from files of its own, or as it was accepted in a lab.

use std::path::Path;
use std::sync::Arc;

use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::robot_model::Unmeasured;
use plumbline_effects::{PlaceInRobot, RobotModel, SeenUnder};
use plumbline_engine::eyes::store::Store as EyesStore;
use plumbline_engine::ground::World;
use plumbline_engine::rig_models::{Accepted, calibrated_at, in_use, mounted};
use plumbline_model::StereoCalibration;
use plumbline_model::robot::{Posture, Rig, RigPart};
use plumbline_vision::locate::Located;
use plumbline_vision::mount::MountCalibration;

use super::{LocateRobot, Stood};
use crate::OfflineError;
use crate::commission::CommissionError;
use crate::ik::find_rig;
use crate::session::ModelFile;

/// What an encoder may say beyond the limits of its joint: its zero is known no better, rad.
const BEYOND_LIMITS_RAD: f64 = 0.1;

const NO_MOUNT: &str = "The ± of places in the robot's frame is wide because no calibrated mount of the eyes was given: \
     it holds how far mounts usually are off. Calibrate the mount, and name its file with --mount.";

const MOUNT_OF_FILE: &str = "The ± of places in the robot's frame leaves out how well the mount of the eyes is known: the \
     rig file has a mount of its own and does not say it. Name the file of the calibrated mount with --mount.";

const NECK: &str = "The ± of places in the robot's frame is wide because nobody measured where the head looks straight ahead, \
     which no board tells: it holds how far zeros of necks usually are off. Looking at the hands measures it.";

const TURNED: &str = "The ± of places in the robot's frame is wide because the eyes were not as warm as when they were \
     calibrated: it holds how far eyes usually turn meanwhile.";

const TURNED_AND_NECK: &str = "The ± of places in the robot's frame is wide because the eyes were not as warm as when they \
     were calibrated, and nobody measured where the head looks straight ahead, which looking at the hands does: it holds \
     how far both usually are off.";

/// What the ± leaves out where a calibration of the eyes does not say how well it is known.
pub(super) const EYES_UNTOLD: &str = "The ± leaves out how well the eyes are calibrated: the calibration file does not say \
     it. A calibration made here does.";

/// The robot as it is known, and how it stood.
pub(super) struct Known {
    model: RobotModel,
    /// Whether the mount is one that the rig file brought along.
    mount_of_file: bool,
    posture: Posture,
    seen: SeenUnder,
}

impl Known {
    /// From files, with these eyes.
    pub fn of_files(files: &LocateRobot, eyes: &StereoCalibration) -> Result<Self, OfflineError> {
        let mut rig = find_rig(&files.rig)?;
        let effects = match ModelFile::read(&files.rig_model, &rig)? {
            ModelFile::Effects(effects) => Some(Arc::new(*effects)),
            ModelFile::Rig(other) => {
                rig = *other;
                None
            }
            ModelFile::Placement(placement) => {
                rig.touchscreen = placement.screen;
                None
            }
        };
        rig.need(RigPart::Eyes)?;
        let mount = files.mount.as_ref().map(|file| MountCalibration::read(file, &rig)).transpose()?;
        let accepted = Accepted {
            cameras: Some(&eyes.cameras),
            head_from_left: mount.as_ref().map(|mount| mount.head_from_left),
            calibrated_at: calibrated_at(Some(eyes), mount.as_ref()),
            mounted: mount.as_ref().map(mounted),
            screen: None,
            effects: effects.as_ref(),
        };
        let mut model = accepted.robot_model(&rig)?;
        let mount_of_file = mount.is_none() && has_own_mount(&rig);
        if mount_of_file {
            let others = model.not_calibrated();
            model = model.with_not_calibrated(Unmeasured { mount: false, ..others });
        }
        Ok(Self { mount_of_file, ..Self::new(model, &files.stood)? })
    }

    /// All that was accepted in a lab, as its window would use it; and its calibrated eyes.
    pub fn of_lab(lab: &Path, stood: &Stood) -> Result<(StereoCalibration, Self), OfflineError> {
        let world = World::Twin.folder(lab);
        let no_lab = |why| OfflineError::NoLab { folder: lab.to_owned(), why };
        if !world.is_dir() {
            return Err(no_lab("it has no folder twin"));
        }
        let calibration = EyesStore::of_world(&world).in_use().map_err(CommissionError::room)?;
        let calibration = calibration.ok_or_else(|| no_lab("no calibration of the eyes is in use"))?;
        let model = in_use(&world, &Rig::built_in("nico")?).map_err(CommissionError::room)?;
        // A commissioning that has accepted none has not come far enough.
        if model.mounted().is_none() {
            return Err(no_lab("no mount of the eyes is in use"));
        }
        Ok((calibration, Self::new(model, stood)?))
    }

    fn new(model: RobotModel, stood: &Stood) -> Result<Self, OfflineError> {
        let rig = model.rig();
        let mut posture = rig.home();
        for (joint, asked_rad) in [rig.eyes.pan, rig.eyes.tilt].into_iter().zip(stood.head_rad) {
            let Some(angle_rad) = asked_rad else { continue };
            let limits = rig.limits(joint);
            if limits.excess_rad(angle_rad).abs() > BEYOND_LIMITS_RAD || !angle_rad.is_finite() {
                let joint = rig.description.joint(joint).name.clone();
                return Err(OfflineError::HeadAngle { joint, angle_rad, limits });
            }
            posture[joint] = angle_rad;
        }
        let seen = SeenUnder { t_secs: stood.eyes_on_s, ..SeenUnder::default() };
        Ok(Self { model, mount_of_file: false, posture, seen })
    }

    /// What it is called for people.
    pub fn title(&self) -> String {
        self.model.title()
    }

    /// Its effects in force, as `id@site`.
    pub fn effects(&self) -> Vec<String> {
        self.model.added().effects().iter().map(ModelEffect::name).collect()
    }

    /// How the head stood (pan, tilt), rad.
    pub fn head_rad(&self) -> [f64; 2] {
        let eyes = &self.model.rig().eyes;
        [eyes.pan, eyes.tilt].map(|joint| self.posture[joint])
    }

    /// Why places are stated with a wide uncertainty, or what it leaves out, and what to do: a sentence or two.
    pub fn wide_because(&self) -> Option<&'static str> {
        match self.mount_of_file {
            true => Some(MOUNT_OF_FILE),
            false if self.model.unmeasured().mount => Some(NO_MOUNT),
            false => {
                of_eyes_and_neck(self.model.turned_since(&self.seen).counts(), self.model.unmeasured().neck)
            }
        }
    }

    /// Where something is; `None`: with the effects of the model there is no such place.
    pub fn place(&self, found: &Located) -> Option<PlaceInRobot> {
        self.model.place(&found.point, &found.covariance_m2, &self.posture, &self.seen)
    }
}

/// Where the mount was measured: what of the eyes that have turned since and of the neck was not.
fn of_eyes_and_neck(turned: bool, neck: bool) -> Option<&'static str> {
    match (turned, neck) {
        (true, true) => Some(TURNED_AND_NECK),
        (true, false) => Some(TURNED),
        (false, true) => Some(NECK),
        (false, false) => None,
    }
}

/// Whether a rig file of a robot that comes with the program has another mount of the eyes than that robot is described
/// with: then somebody measured it. Of other robots nobody here knows the description.
fn has_own_mount(rig: &Rig) -> bool {
    let described = Rig::built_in(&rig.name);
    described.is_ok_and(|described| described.eyes.head_from_left != rig.eyes.head_from_left)
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    #[test]
    fn cold_eyes_and_a_neck_that_nobody_measured_are_named_together() {
        let said = |turned, neck| of_eyes_and_neck(turned, neck).unwrap_or_default();
        for (turned, neck) in [(true, true), (true, false), (false, true), (false, false)] {
            assert_eq!(said(turned, neck).contains("not as warm"), turned, "{}", said(turned, neck));
            assert_eq!(said(turned, neck).contains("straight ahead"), neck, "{}", said(turned, neck));
        }
    }

    #[test]
    fn a_mount_in_a_rig_file_is_told_from_the_described_one() {
        let mut rig = (*default_rig()).clone();
        assert!(!has_own_mount(&rig), "as it is described");
        rig.eyes.head_from_left.isometry.translation.vector.x += 0.004;
        assert!(has_own_mount(&rig));
        rig.name = "another".to_owned();
        assert!(!has_own_mount(&rig), "nobody knows how it is described");
    }
}
