//! What is trained, proposed, in use.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::CorrectionModel;
use plumbline_model::robot::Rig;

use super::work::{ModelsResult, ModelsWork};
use crate::command::{JobId, ModelsCommand};
use crate::context::Context;
use crate::view::{ModelsView, RobotView};

/// What the workflow can see of the rest.
pub struct Surroundings<'a> {
    /// The robot as its description has it, the screen where it was measured to lie.
    pub rig: &'a Arc<Rig>,
    /// The robot now.
    pub robot: &'a RobotView,
    /// The session that was touched last; offered first.
    pub newest_session: Option<&'a Path>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct ModelsWorkflow {
    folder: PathBuf,
}

impl ModelsWorkflow {
    /// Nothing trained. Sessions are looked for in `folder/sessions`, models and tables are kept in
    /// `folder/models` and `folder/tables`.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// Reads what was accepted before.
    pub fn restore(&self, rig: &Arc<Rig>) -> ModelsWork {
        ModelsWork::Restore { folder: self.folder.clone(), rig: rig.clone() }
    }

    /// The model in use.
    pub fn in_use(&self) -> Option<&Arc<CorrectionModel>> {
        None
    }

    /// Proposals, then the one in use.
    pub fn usable(&self) -> Vec<Arc<CorrectionModel>> {
        Vec::new()
    }

    /// Applies a command of the operator.
    pub fn apply(
        &mut self,
        _command: ModelsCommand,
        _around: &Surroundings<'_>,
        _context: &mut Context<'_>,
    ) {
    }

    /// Work has ended with a result.
    pub fn work_done(
        &mut self,
        _id: JobId,
        _result: ModelsResult,
        _around: &Surroundings<'_>,
        _context: &mut Context<'_>,
    ) {
    }

    /// Work has ended without a result.
    pub fn work_ended(&mut self, _id: JobId) {}

    /// What the window shows.
    pub fn view(&self, _around: &Surroundings<'_>) -> ModelsView {
        ModelsView::default()
    }
}
