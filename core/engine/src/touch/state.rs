//! What was planned, what was touched, where the screen lies.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use plumbline_correction::CorrectionModel;
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use super::work::{TouchResult, TouchWork};
use crate::command::{JobId, TouchCommand};
use crate::context::Context;
use crate::robot::TouchNews;
use crate::view::{RobotView, TouchView};

/// What the workflow can see of the rest.
pub struct Surroundings<'a> {
    /// The robot as its description has it, the screen where it is nominally.
    pub rig: &'a Arc<Rig>,
    /// The robot now.
    pub robot: &'a RobotView,
    /// Models that targets can be corrected with: proposals, then the one in use.
    pub models: &'a [Arc<CorrectionModel>],
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct TouchWorkflow {
    folder: PathBuf,
}

impl TouchWorkflow {
    /// Nothing planned. Sessions are kept in `folder/sessions`, the place of the screen in
    /// `folder/screen.toml`.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// Reads the place of the screen that was accepted before, and which runs were not finished.
    pub fn restore(&self, rig: &Arc<Rig>) -> TouchWork {
        TouchWork::Restore { folder: self.folder.clone(), rig: rig.clone() }
    }

    /// The session that is written or shown.
    pub fn session(&self) -> Option<&Path> {
        None
    }

    /// The screen where it was measured to lie; `None`: nominal.
    pub fn screen(&self) -> Option<&Touchscreen> {
        None
    }

    /// Applies a command of the operator.
    pub fn apply(
        &mut self,
        _command: TouchCommand,
        _around: &Surroundings<'_>,
        _context: &mut Context<'_>,
    ) {
    }

    /// The robot's thread tells how a touch is doing.
    pub fn news(&mut self, _news: TouchNews, _around: &Surroundings<'_>, _context: &mut Context<'_>) {}

    /// The robot has something new, or time has passed.
    pub fn step(&mut self, _around: &Surroundings<'_>, _now: Instant, _context: &mut Context<'_>) {}

    /// Work has ended with a result.
    pub fn work_done(
        &mut self,
        _id: JobId,
        _result: TouchResult,
        _around: &Surroundings<'_>,
        _context: &mut Context<'_>,
    ) {
    }

    /// Work has ended without a result.
    pub fn work_ended(&mut self, _id: JobId) {}

    /// What the window shows.
    pub fn view(&self, _around: &Surroundings<'_>) -> TouchView {
        TouchView::default()
    }
}
