//! Sessions that verbs are given, with the robot that they were recorded with.

use std::path::{Path, PathBuf};

use plumbline_model::Session;
use plumbline_model::robot::Rig;
use plumbline_model::session::RigReference;
use plumbline_model::touchscreen::ScreenPlacement;

use super::OfflineError;

/// Reads a session folder and the rig that it names.
pub(crate) fn open(folder: &Path) -> Result<(Session, Rig), OfflineError> {
    let session = Session::read(folder)?;
    let rig = rig_of(&session, folder)?;
    Ok((session, rig))
}

/// The rig that a session names; a rig file lies in the session's folder.
pub(crate) fn rig_of(session: &Session, folder: &Path) -> Result<Rig, OfflineError> {
    match &session.manifest.rig {
        RigReference::Named(name) => Ok(Rig::built_in(name)?),
        RigReference::File(file) => Ok(Rig::read(&folder.join(file))?),
    }
}

/// What `--rig-model` may be.
#[derive(Clone, Debug)]
pub(super) enum RigModel {
    /// A whole robot.
    Rig(Box<Rig>),
    /// Where the touchscreen was measured to lie.
    Placement(Box<ScreenPlacement>),
}

impl RigModel {
    /// Reads either of the two, told apart by their keys; `rig` is the robot that a placement
    /// must belong to.
    pub fn read(file: &Path, rig: &Rig) -> Result<Self, OfflineError> {
        let text = std::fs::read_to_string(file).map_err(OfflineError::io(file))?;
        let unknown = |reason: String| OfflineError::RigModel { file: PathBuf::from(file), reason };
        let keys: toml::Table = toml::from_str(&text)
            .map_err(|error| unknown(format!("it is not TOML ({})", error.message())))?;
        if keys.contains_key("servo") && keys.contains_key("description") {
            return Ok(Self::Rig(Box::new(Rig::read(file)?)));
        }
        if keys.contains_key("screen") && keys.contains_key("moved_m") {
            return Ok(Self::Placement(Box::new(ScreenPlacement::read(file, &rig.name)?)));
        }
        let found: Vec<&str> = keys.keys().map(String::as_str).take(6).collect();
        Err(unknown(if found.is_empty() {
            "it is empty".to_owned()
        } else {
            format!("its keys are {}", found.join(", "))
        }))
    }
}
