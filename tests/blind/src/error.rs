//! Why no case was made.

use plumbline_model::robot::ik::SolverError;
use plumbline_model::robot::{DescriptionError, RigError};
use plumbline_model::session::SessionError;

/// Why no case was made.
#[derive(Debug, thiserror::Error)]
pub enum BlindError {
    /// The rig cannot be read.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The rig has no such tip.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// The rig's arm cannot be solved.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The eyes are of another sort.
    #[error("the rig's lenses are no fisheyes with four powers: give one whose eyes are")]
    Lens,
    /// MuJoCo refuses the world.
    #[error("MuJoCo does not accept the world that was written for a case: {reason}")]
    Physics {
        /// In its words.
        reason: String,
    },
    /// The plan has too few poses.
    #[error(
        "only {found} of {wanted} poses of the plan can be reached: give a rig whose arm reaches its screen"
    )]
    Plan {
        /// There are.
        found: usize,
        /// Wanted.
        wanted: usize,
    },
    /// Nothing can be made so large.
    #[error(
        "no effect that was tried becomes as large as {size_sigmas} sigma on this robot: ask for a smaller one"
    )]
    TooLarge {
        /// Wanted.
        size_sigmas: f64,
    },
    /// Too few fingers met the glass.
    #[error("only {met} of {tried} touches met the image: the arm misses the screen")]
    Missed {
        /// Met it.
        met: usize,
        /// Tried.
        tried: usize,
    },
    /// The session cannot be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The keys of a manifest are no TOML.
    #[error("the keys of a manifest that was made up are wrong: {0}")]
    Keys(toml::de::Error),
    /// A file cannot be read or written.
    #[error(
        "{file} cannot be read or written ({source}): check that the folder exists and may be written to"
    )]
    File {
        /// Which.
        file: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file does not hold what it should.
    #[error("{file} does not hold an answer ({source}): make the cases anew")]
    Content {
        /// Which.
        file: std::path::PathBuf,
        /// Why.
        source: serde_json::Error,
    },
}
