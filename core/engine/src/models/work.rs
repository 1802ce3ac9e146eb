//! What takes time: reading sessions, training, reading and writing models and tables.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::JobContext;
use plumbline_model::robot::Rig;

use crate::jobs::JobError;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum ModelsWork {
    /// Reads what was accepted before.
    Restore {
        /// Where the world's files are.
        folder: PathBuf,
        /// The robot that they must be of.
        rig: Arc<Rig>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum ModelsResult {
    /// What was accepted before.
    Restored,
}

impl ModelsWork {
    /// What it does, for people.
    pub fn title(&self) -> String {
        "Read the models in use".to_owned()
    }

    /// Whether it is over so soon that it needs no line when it is done.
    pub fn is_quiet(&self) -> bool {
        true
    }

    /// Does it, on the thread of the caller.
    pub fn run(self, _context: &dyn JobContext) -> Result<ModelsResult, JobError> {
        Ok(ModelsResult::Restored)
    }
}

impl ModelsResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        "Read.".to_owned()
    }
}
