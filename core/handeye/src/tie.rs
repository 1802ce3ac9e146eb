//! What it begins with, and what is known once body and screen were seen.

use std::sync::Arc;

use nalgebra::Matrix6;
use plumbline_effects::robot_model::Mounted;
use plumbline_effects::{RigModel, RobotModel};
use plumbline_fit::{Known, NECK_SD_RAD, SeenScreen as ByEyes};
use plumbline_grasp::{Corrections, Knowledge};
use plumbline_model::StereoCalibration;
use plumbline_model::robot::Rig;
use serde::{Deserialize, Serialize};

use crate::HandEyeError;
use crate::body::SeenBody;
use crate::screen::SeenScreen;
use crate::table::TableBeside;

/// The robot as it is known before.
#[derive(Clone, Debug)]
pub struct Start {
    /// As described.
    pub described: Arc<Rig>,
    /// With its eyes as calibrated and mounted, the screen where it was placed, and the effects in use.
    pub model: RobotModel,
    /// The calibration of the eyes.
    pub calibration: Arc<StereoCalibration>,
}

impl Start {
    /// How well it is known how the eyes sit in the head.
    ///
    /// # Errors
    /// When nobody measured it.
    pub fn mounted(&self) -> Result<&Mounted, HandEyeError> {
        self.model.mounted().ok_or(HandEyeError::NoMount)
    }

    /// The robot with other effects.
    ///
    /// # Errors
    /// When they do not fit to it.
    pub fn with(&self, added: RigModel) -> Result<Self, HandEyeError> {
        let mounted = self.model.mounted().copied();
        let model = RobotModel::new(self.model.rig().clone(), Arc::new(added))?;
        let model = model.with_mounted(mounted).with_not_calibrated(self.model.not_calibrated());
        Ok(Self { model, ..self.clone() })
    }

    /// What finding a hand rests on.
    pub(crate) fn knowledge(&self) -> Knowledge {
        Knowledge {
            described: self.described.clone(),
            model: self.model.clone(),
            calibration: self.calibration.clone(),
            corrections: Corrections::default(),
        }
    }
}

/// What the eyes saw of what does not move.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tie {
    /// The robot's own body; `None`: its edges were not seen.
    pub body: Option<SeenBody>,
    /// The frame of the touchscreen; `None`: its edges were not seen.
    pub screen: Option<SeenScreen>,
    /// The table around it; `None`: it shows the eyes too little to match.
    pub table: Option<TableBeside>,
}

impl Tie {
    /// The same, as a fit takes it.
    pub fn held(&self, start: &Start) -> Result<Held, HandEyeError> {
        Ok(Held {
            screen: self.screen.as_ref().map(SeenScreen::by_eyes),
            neck_rad: self.body.map_or((0.0, NECK_SD_RAD), |body| (body.neck_rad, body.neck_sd_rad)),
            mount: start.mounted()?.covariance,
        })
    }
}

/// What the eyes saw, as a fit takes it.
#[derive(Clone, Debug)]
pub struct Held {
    screen: Option<ByEyes>,
    neck_rad: (f64, f64),
    mount: Matrix6<f64>,
}

impl Held {
    /// With this share of the effects' usual sizes.
    pub fn known<'a>(&'a self, rig: &'a Rig, share: f64) -> Known<'a> {
        let Self { screen, neck_rad, mount } = self;
        Known { rig, screen: screen.as_ref(), hands: None, neck_rad: *neck_rad, mount, share }
    }
}
