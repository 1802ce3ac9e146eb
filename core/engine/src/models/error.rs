//! Why something cannot be done with models and tables: sentences that say what to do.

use std::path::{Path, PathBuf};

use plumbline_correction::tables::TableError;
use plumbline_correction::{DataError, FileError as ModelFileError, ScreenSize};
use plumbline_model::SessionError;
use plumbline_model::files::FileError;
use plumbline_model::robot::{DescriptionError, RigError};

use crate::ground::text::sentence;

/// Why something cannot be done with models and tables.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The model's own file.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] ModelFileError),
    /// It was trained elsewhere.
    #[error(
        "The model was trained for the robot \"{trained}\", this one is \"{present}\". Train on touches of this robot."
    )]
    OtherRobot {
        /// For which robot.
        trained: String,
        /// Which is connected.
        present: String,
    },
    /// It was learned on another screen.
    #[error(
        "{whose} belongs to a touchscreen of {}; this robot's has {}. Touch this screen and train again.",
        size(.learned),
        size(.present)
    )]
    OtherScreen {
        /// What, as the beginning of a sentence.
        whose: &'static str,
        /// On which.
        learned: ScreenSize,
        /// Which is here.
        present: ScreenSize,
    },
    /// The session cannot be read.
    #[error("{}", sentence(&.0.to_string()))]
    Session(#[from] SessionError),
    /// Its robot is not known.
    #[error("{}", sentence(&.0.to_string()))]
    Rig(#[from] RigError),
    /// It was recorded elsewhere.
    #[error(
        "The session was recorded with the robot \"{recorded}\", this one is \"{present}\". Choose a session of this robot."
    )]
    OtherRobotsSession {
        /// With which robot.
        recorded: String,
        /// Which is connected.
        present: String,
    },
    /// Nobody knows what touched.
    #[error("The session does not say which tip touched.")]
    NoTip,
    /// It was touched with the other arm.
    #[error(
        "It was touched with the left index finger; M1 to M3 correct the right one. Look at it under Gap: there each \
         joint has its own effects."
    )]
    LeftFinger,
    /// The robot has no such tip.
    #[error("{}", sentence(&.0.to_string()))]
    Description(#[from] DescriptionError),
    /// Nothing can be learned from it.
    #[error("{}", sentence(&.0.to_string()))]
    Data(#[from] DataError),
    /// What was in use cannot be told.
    #[error(
        "{} cannot be used ({reason}). No model is in use; move the file away, train or import one and accept it.",
        .list.display()
    )]
    Unusable {
        /// The list.
        list: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Nothing can be put in use.
    #[error(
        "{} cannot be used ({reason}). Check that the disk has free space and can be written; the model in use stays.",
        .file.display()
    )]
    Cannot {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A small file could not be replaced.
    #[error("{} The model in use stays.", sentence(&.0.to_string()))]
    NotReplaced(#[from] FileError),
    /// Tables cannot be kept.
    #[error(
        "{} cannot be made ({error}). Check the free space and the permissions; the tables are not kept yet.",
        .folder.display()
    )]
    NoFolder {
        /// Where they belong.
        folder: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A table's own file.
    #[error("{}", sentence(&.0.to_string()))]
    Table(#[from] TableError),
    /// A table that is no more is still on disk.
    #[error("{} cannot be removed: {error}. Remove it by hand.", .file.display())]
    NotRemoved {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

impl ModelError {
    /// For `map_err` of what is done with a file.
    pub fn cannot<E: std::fmt::Display>(file: &Path) -> impl FnOnce(E) -> Self {
        let file = file.to_owned();
        move |error| Self::Cannot { file, reason: error.to_string() }
    }
}

fn size(screen: &ScreenSize) -> String {
    let (width_mm, height_mm) = (screen.width_m * 1e3, screen.height_m * 1e3);
    format!("{}×{} px, {width_mm:.0}×{height_mm:.0} mm", screen.width_px, screen.height_px)
}
