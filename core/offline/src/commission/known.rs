//! What is known besides the touches: what the eyes saw, and how far this robot is from what is described.

use std::sync::Arc;

use plumbline_engine::gap::search::measured;
use plumbline_fit::ArmTouches;
use plumbline_handeye::{Start, Tie};
use plumbline_model::Session;
use plumbline_model::files::{self, Size};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::CommissionError;
use super::lab::Lab;
use super::touches::session;

/// What the eyes saw of body and screen.
const TIE: &str = "seen.json";
/// Of the effects' usual sizes, the share that this robot has.
const SHARE: &str = "share-of-usual.json";

fn write(lab: &Lab, name: &str, what: &impl Serialize) -> Result<(), CommissionError> {
    let file = lab.folder.join(name);
    let text = serde_json::to_string(what)
        .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
    Ok(files::write(&file, text)?)
}

fn read<T: DeserializeOwned>(lab: &Lab, name: &str) -> Result<T, CommissionError> {
    let file = lab.folder.join(name);
    let text = files::read_text(&file, Size::SHORT)?;
    serde_json::from_str(&text).map_err(|error| CommissionError::Steps { file, reason: error.to_string() })
}

impl Lab {
    /// What the eyes saw of body and screen.
    pub fn tie(&self) -> Result<Tie, CommissionError> {
        read(self, TIE)
    }

    /// Keeps it for the steps that follow.
    pub fn keep_tie(&self, tie: &Tie) -> Result<(), CommissionError> {
        write(self, TIE, tie)
    }

    /// Of the effects' usual sizes, the share that this robot has.
    pub fn share(&self) -> Result<f64, CommissionError> {
        read(self, SHARE)
    }

    /// Keeps it for the steps that follow.
    pub fn keep_share(&self, share: f64) -> Result<(), CommissionError> {
        write(self, SHARE, &share)
    }

    /// The robot as it is known now.
    pub fn start(&self) -> Result<Start, CommissionError> {
        let calibration = Arc::new(self.calibration()?);
        Ok(Start { described: self.rig.clone(), model: self.known()?, calibration })
    }

    /// Does something with the touches.
    pub fn with_touches<T>(
        &self,
        work: impl FnOnce(&ArmTouches<'_>) -> Result<T, CommissionError>,
    ) -> Result<T, CommissionError> {
        let folder = session(self);
        let measurements = measured(std::slice::from_ref(&folder), &self.rig)?;
        let sessions = [Session::read(&folder)?];
        let touches = ArmTouches::of(&sessions, &measurements);
        work(&touches.ok_or_else(|| CommissionError::room("the touches are too few to size an arm"))?)
    }
}
