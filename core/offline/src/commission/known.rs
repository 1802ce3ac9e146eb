//! What is known besides the touches: what the eyes saw, and how far this robot is from what is described.

use nalgebra::Matrix6;
use plumbline_fit::{Known, NECK_SD_RAD, SeenScreen as ByEyes};
use plumbline_model::files::{self, Size};
use plumbline_model::robot::Rig;
use serde::{Deserialize, Serialize};

use super::body::SeenBody;
use super::error::CommissionError;
use super::glass::SeenScreen;
use super::lab::Lab;

/// What the eyes saw of body and screen, and how well they sit.
pub(super) struct Seen {
    screen: Option<ByEyes>,
    neck_rad: (f64, f64),
    mount: Matrix6<f64>,
}

impl Seen {
    pub fn read(lab: &Lab) -> Result<Self, CommissionError> {
        let body = SeenBody::read(lab)?;
        Ok(Self {
            screen: SeenScreen::read(lab)?.map(|seen| seen.by_eyes()),
            neck_rad: body.map_or((0.0, NECK_SD_RAD), |body| (body.neck_rad, body.neck_sd_rad)),
            mount: lab.mount()?.covariance,
        })
    }

    pub fn known<'a>(&'a self, rig: &'a Rig, share: f64) -> Known<'a> {
        let Self { screen, neck_rad, mount } = self;
        Known { rig, screen: screen.as_ref(), hands: None, neck_rad: *neck_rad, mount, share }
    }
}

/// Of the effects' usual sizes, the share that this robot has; in the lab's folder.
#[derive(Serialize, Deserialize)]
pub(super) struct Share(pub f64);

impl Share {
    const FILE: &str = "share-of-usual.json";

    pub fn write(&self, lab: &Lab) -> Result<(), CommissionError> {
        let file = lab.folder.join(Self::FILE);
        let text = serde_json::to_string(self)
            .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
        Ok(files::write(&file, text)?)
    }

    pub fn read(lab: &Lab) -> Result<Self, CommissionError> {
        let file = lab.folder.join(Self::FILE);
        let text = files::read_text(&file, Size::SHORT)?;
        serde_json::from_str(&text)
            .map_err(|error| CommissionError::Steps { file, reason: error.to_string() })
    }
}
