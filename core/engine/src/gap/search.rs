//! Rows of sessions of one robot, and the search among them.

use std::path::PathBuf;

use plumbline_effects::{Measurements, MeasurementsError, RigModel};
use plumbline_gap::{Finding, GapError, Options, find};
use plumbline_model::robot::{Rig, RigError};
use plumbline_model::{JobContext, Session, SessionError};

use crate::ground::sessions::{rig_of, title_of};

/// Why no gap can be looked for.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// A session cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The robot of a session is not known, or its file cannot be used.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A session is of another robot than the one that is looked at.
    #[error(
        "{session} is of the robot {of}, and {open} is open here: take it out of the choice. Another robot's \
         sessions are searched by themselves, with ./plumbline gap"
    )]
    OtherRobot {
        /// Its title.
        session: String,
        /// Whose it is.
        of: String,
        /// The robot that is looked at.
        open: String,
    },
    /// The sessions cannot be looked at together.
    #[error(transparent)]
    Measurements(#[from] MeasurementsError),
    /// The search itself.
    #[error(transparent)]
    Gap(#[from] GapError),
}

/// Rows of all sessions, which must be of this robot.
///
/// # Errors
/// When a session cannot be read or is of another robot.
pub fn measured(folders: &[PathBuf], rig: &Rig) -> Result<Measurements, SearchError> {
    let sessions: Vec<(String, Session)> = folders
        .iter()
        .map(|folder| {
            let session = Session::read(folder)?;
            let (title, of) = (title_of(folder), rig_of(&session, folder)?);
            if of.name != rig.name {
                return Err(SearchError::OtherRobot { session: title, of: of.name, open: rig.name.clone() });
            }
            Ok((title, session))
        })
        .collect::<Result<_, SearchError>>()?;
    Ok(Measurements::of_sessions(&sessions, rig)?)
}

/// Looks for the gap of a model.
///
/// # Errors
/// When there is too little to look at, or it was cancelled.
pub fn search(
    measurements: &Measurements,
    model: &RigModel,
    options: &Options,
    context: &dyn JobContext,
) -> Result<Finding, SearchError> {
    Ok(find(&model.put_into(measurements.clone()), options, context)?)
}

/// Whether two sessions are of one robot.
///
/// # Errors
/// When they are not.
pub fn same_rig(first: &Rig, other: &Rig, whose: &str) -> Result<(), MeasurementsError> {
    if first.name == other.name {
        return Ok(());
    }
    Err(MeasurementsError::DifferentRigs {
        first: first.name.clone(),
        other: format!("{} of {whose}", other.name),
    })
}
