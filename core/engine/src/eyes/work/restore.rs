//! Reads what was accepted before, when the program starts.

use plumbline_model::{JobContext, Workspace};

use super::accept::in_use;
use crate::eyes::assess::assess;
use crate::eyes::store::Store;
use crate::eyes::view::{AcceptedCalibration, EarlierCalibration};
use crate::ground::jobs::JobError;

/// Put what was accepted earlier in use again.
#[derive(Clone, Debug)]
pub struct UseEarlier {
    /// Which; `None`: none.
    pub id: Option<String>,
    /// Where it is kept.
    pub store: Store,
    /// Where the eyes are over the table.
    pub workspace: Workspace,
}

impl UseEarlier {
    /// What is in use afterwards.
    pub fn run(self, context: &dyn JobContext) -> Result<Restored, JobError> {
        self.store.use_earlier(self.id.as_deref()).map_err(JobError::failed)?;
        Restore { store: self.store, workspace: self.workspace }.run(context)
    }
}

/// Read what was accepted before.
#[derive(Clone, Debug)]
pub struct Restore {
    /// Where it is kept.
    pub store: Store,
    /// Where the eyes are over the table.
    pub workspace: Workspace,
}

/// What was accepted before.
#[derive(Clone, Debug)]
pub struct Restored {
    /// The one in use; `None` when none was ever accepted, or none is to be used.
    pub in_use: Option<AcceptedCalibration>,
    /// All that are kept, newest first.
    pub earlier: Vec<EarlierCalibration>,
    /// What could not be read, in sentences.
    pub problems: Vec<String>,
}

impl Restore {
    /// Reads the one that was in use; if its file is damaged, the newest that is not.
    pub fn run(self, context: &dyn JobContext) -> Result<Restored, JobError> {
        let mut earlier = self.store.list().map_err(JobError::failed)?;
        let mut problems = Vec::new();
        if self.store.is_none_in_use().map_err(JobError::failed)? {
            return Ok(Restored { in_use: None, earlier, problems });
        }
        let wished = earlier.iter().find(|entry| entry.in_use).map(|entry| entry.id.clone());
        let others = earlier.iter().map(|entry| entry.id.clone());
        let mut found = None;
        for id in wished.iter().cloned().chain(others.filter(|id| Some(id) != wished.as_ref())) {
            match self.store.load(&id) {
                Ok((calibration, accepted)) => {
                    let assessment = assess(&calibration, None, &self.workspace, context)?;
                    found = Some(in_use(id, accepted, calibration, assessment));
                    break;
                }
                Err(error) => problems.push(error.to_string()),
            }
        }
        if let Some(found) = &found {
            for entry in &mut earlier {
                entry.in_use = entry.id == found.id;
            }
            if !problems.is_empty() {
                problems.push(format!("The calibration accepted at {} is used instead.", found.accepted));
            }
        }
        Ok(Restored { in_use: found, earlier, problems })
    }
}
