//! `mount.toml`: a solved mount with everything that it was made from.

mod parts;
mod read;
mod write;

use std::path::{Path, PathBuf};

use plumbline_model::files::{self, told};
use plumbline_model::formats::{FormatError, depth, read_text};
use plumbline_model::robot::Rig;
use serde::Deserialize;

use super::types::{MountCalibration, mount_numbers};

/// Version of the format.
const FORMAT: u32 = 1;

/// Why a mount file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MountFileError {
    /// Cannot be read or written, or is no text.
    #[error(transparent)]
    File(#[from] FormatError),
    /// Not TOML, a missing or unknown key, a wrong type.
    #[error("{} is not a valid mount file: {reason}", file.display())]
    NotMount {
        /// The file.
        file: PathBuf,
        /// What the parser says, with the line.
        reason: String,
    },
    /// Written by a newer program.
    #[error("{} has the format {found}, this program reads {FORMAT}: use a newer program, or calibrate the mount again", file.display())]
    Version {
        /// The file.
        file: PathBuf,
        /// Its version.
        found: u32,
    },
    /// A value out of its range.
    #[error("{}, {place}: {what}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Where in it.
        place: String,
        /// What is wrong and what is right.
        what: String,
    },
    /// Made for another robot.
    #[error("{} was made for {made_for}, not for {rig}: choose that rig, or calibrate the mount of this one", file.display())]
    OtherRig {
        /// The file.
        file: PathBuf,
        /// What it was made for.
        made_for: String,
        /// What is in use.
        rig: String,
    },
}

impl MountCalibration {
    /// Writes the file in one step: a crash leaves the old file or the new one.
    pub fn write(&self, file: &Path) -> Result<(), MountFileError> {
        let (position, rotation) = mount_numbers(&self.head_from_left);
        let body = toml::to_string(&write::parts(self)).map_err(|error| MountFileError::NotMount {
            file: file.to_path_buf(),
            reason: format!("it cannot be written: {error}"),
        })?;
        let text = format!(
            "# How the eyes sit in the head. Lengths in meters, angles in radians, image positions in pixels\n\
             # from the center of the top-left pixel. As a rig file has it:\n\
             # left_position_m = [{}, {}, {}]\n# left_rotation_rad = [{}, {}, {}]\n{body}",
            position.x, position.y, position.z, rotation.x, rotation.y, rotation.z
        );
        Ok(files::write(file, text).map_err(FormatError::from)?)
    }

    /// Reads a mount that was made for `rig`.
    pub fn read(file: &Path, rig: &Rig) -> Result<Self, MountFileError> {
        let text = read_text(file)?;
        let refused = |error: toml::de::Error| MountFileError::NotMount {
            file: file.to_path_buf(),
            reason: told(error.to_string().trim_end()),
        };
        let too_deep = |reason| MountFileError::NotMount { file: file.to_path_buf(), reason };
        depth::check(depth::of_toml(&text)).map_err(too_deep)?;
        // The version first: what a newer program writes may have other keys.
        #[derive(Deserialize)]
        struct Version {
            format: u32,
        }
        let version: Version = toml::from_str(&text).map_err(refused)?;
        if version.format != FORMAT {
            return Err(MountFileError::Version { file: file.to_path_buf(), found: version.format });
        }
        let parts: parts::File = toml::from_str(&text).map_err(refused)?;
        read::Reader { file }.mount(parts, rig)
    }
}
