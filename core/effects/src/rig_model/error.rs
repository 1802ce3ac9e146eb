//! Why a model cannot be read, written or changed.

use std::path::PathBuf;

use plumbline_model::files::FileError;

/// Why a model cannot be read, written or changed.
#[derive(Debug, thiserror::Error)]
pub enum RigModelError {
    /// The file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Something else.
    #[error(
        "{file} is no model with effects that this program reads: {reason}. Search the gap and write it again"
    )]
    NotModel {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Of another version of the program.
    #[error(
        "{file} has format {found}, this program reads {known}: use the version of the program that wrote it, or \
         search the gap and write it again"
    )]
    OtherVersion {
        /// The file.
        file: PathBuf,
        /// Its format.
        found: i64,
        /// Ours.
        known: u32,
    },
    /// An effect of a file that cannot be used.
    #[error("{file} cannot be used: {reason}")]
    EffectOfFile {
        /// The file.
        file: PathBuf,
        /// Which and why, and what to do.
        reason: String,
    },
    /// An effect that cannot be added.
    #[error("the model cannot be changed so: {0}")]
    Effect(String),
    /// Of another robot.
    #[error(
        "the model with effects belongs to the robot \"{found}\", not to \"{expected}\": give the model that was \
         found on this robot"
    )]
    OtherRig {
        /// The model's.
        found: String,
        /// The one at hand.
        expected: String,
    },
    /// No effect was given.
    #[error("no effect is to be added: choose at least one that was found")]
    NothingToAdd,
    /// Not in force.
    #[error("{name} is not in the model, so it cannot be taken out. In the model: {present}")]
    NotThere {
        /// `id@site`.
        name: String,
        /// What is there instead.
        present: String,
    },
    /// No step left.
    #[error("there is no step left to take back: the model is as it began")]
    NothingToUndo,
    /// Nothing was taken back, or something was changed since.
    #[error("nothing was taken back that could be put back: the model was changed since")]
    NothingToRedo,
}
