//! Sessions that verbs are given, with the robot that they were recorded with.

use std::path::{Path, PathBuf};

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::is_rig_model;
use plumbline_engine::ground::sessions::rig_of;
use plumbline_model::Session;
use plumbline_model::files::{self, Size};
use plumbline_model::formats::depth;
use plumbline_model::robot::Rig;
use plumbline_model::session::RigReference;
use plumbline_model::touchscreen::ScreenPlacement;

use super::OfflineError;

/// Reads a session folder and the rig that it names.
pub(super) fn open(folder: &Path) -> Result<(Session, Rig), OfflineError> {
    let session = Session::read(folder)?;
    let rig = rig_of(&session, folder)?;
    Ok((session, rig))
}

/// The rig file that a session names, if it is not one that comes with the program.
pub(super) fn rig_file(session: &Session, folder: &Path) -> Option<PathBuf> {
    match &session.manifest.rig {
        RigReference::Named(_) => None,
        RigReference::File(file) => Some(folder.join(file)),
    }
}

/// What `--rig-model` may be.
#[derive(Clone, Debug)]
pub(super) enum ModelFile {
    /// A whole robot.
    Rig(Box<Rig>),
    /// Where the touchscreen was measured to lie.
    Placement(Box<ScreenPlacement>),
    /// The robot with effects that were found.
    Effects(Box<RigModel>),
}

impl ModelFile {
    /// Reads any of them, told apart by their keys; `rig` is the robot that a placement or a model
    /// with effects must belong to.
    pub fn read(file: &Path, rig: &Rig) -> Result<Self, OfflineError> {
        let text = files::read_text(file, Size::TEXT)?;
        let unknown = |reason: String| OfflineError::RigModel { file: PathBuf::from(file), reason };
        if text.trim_start().starts_with('<') {
            return Ok(Self::Rig(Box::new(Rig::read_measured(file)?)));
        }
        depth::check(depth::of_toml(&text)).map_err(unknown)?;
        let keys: toml::Table = toml::from_str(&text)
            .map_err(|error| unknown(format!("it is not TOML ({})", error.message())))?;
        if is_rig_model(&keys) {
            return Ok(Self::Effects(Box::new(RigModel::read(file, rig)?)));
        }
        if keys.contains_key("screen") && keys.contains_key("moved_m") {
            return Ok(Self::Placement(Box::new(ScreenPlacement::read(file, &rig.name)?)));
        }
        if ["description", "urdf"].iter().any(|key| keys.contains_key(*key)) {
            return Ok(Self::Rig(Box::new(Rig::read_measured(file)?)));
        }
        let found: Vec<&str> = keys.keys().map(String::as_str).take(6).collect();
        Err(unknown(if found.is_empty() {
            "it is empty".to_owned()
        } else {
            format!("its keys are {}", found.join(", "))
        }))
    }
}
