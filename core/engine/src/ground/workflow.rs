//! What every workflow is: commands in, work out, results back in.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::context::Context;
use super::jobs::JobId;
use super::stage::Skipped;
use super::work::LongWork;

/// When a view is made, and what was skipped until then.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Now.
    pub now: Instant,
    /// Pairs skipped in front of each stage.
    pub skipped: Skipped,
}

/// A workflow: it owns no thread and does nothing long itself.
pub trait Workflow {
    /// What the operator can ask of it.
    type Command;
    /// What it does beside the window.
    type Work: LongWork;
    /// What it tells a thread.
    type Control;
    /// What it can see of the rest.
    type Around;
    /// What the window shows of it.
    type View;

    /// Nothing done yet. What is accepted is kept in `folder`, which nobody else writes to.
    fn new(folder: &Path) -> Self;

    /// Reads what was accepted before; called once, at the start.
    fn restore(&mut self, _around: &Self::Around, _context: &mut Context<'_, Self::Work, Self::Control>) {}

    /// What the window shows.
    fn view(&mut self, around: &Self::Around, moment: &Moment) -> Arc<Self::View>;

    /// Applies a command of the operator.
    fn apply(
        &mut self,
        command: Self::Command,
        around: &Self::Around,
        context: &mut Context<'_, Self::Work, Self::Control>,
    );

    /// Work has ended with a result.
    fn work_done(
        &mut self,
        id: JobId,
        result: <Self::Work as LongWork>::Result,
        around: &Self::Around,
        context: &mut Context<'_, Self::Work, Self::Control>,
    );

    /// Work has ended without a result, perhaps that of another workflow: nothing was changed.
    /// `why` is `None` when it was cancelled.
    fn work_ended(
        &mut self,
        id: JobId,
        why: Option<&str>,
        around: &Self::Around,
        context: &mut Context<'_, Self::Work, Self::Control>,
    );
}
