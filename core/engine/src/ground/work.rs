//! Work that takes longer than a frame.

use plumbline_model::JobContext;

use super::jobs::JobError;

/// Something to do beside the window, as data: an immutable snapshot of what it needs.
pub trait LongWork {
    /// What comes out.
    type Result;

    /// What it does, for people.
    fn title(&self) -> String;

    /// Whether it is over so soon that it needs no line when it is done.
    fn is_quiet(&self) -> bool;

    /// Does it, on the thread of the caller.
    ///
    /// # Errors
    /// A sentence that says what is wrong and what to do, or that it was cancelled.
    fn run(self, context: &dyn JobContext) -> Result<Self::Result, JobError>;
}

/// Work of a workflow that has none, or what one says that tells no thread anything.
pub type Nothing = std::convert::Infallible;

impl LongWork for Nothing {
    type Result = Self;

    fn title(&self) -> String {
        match *self {}
    }

    fn is_quiet(&self) -> bool {
        match *self {}
    }

    fn run(self, _: &dyn JobContext) -> Result<Self, JobError> {
        match self {}
    }
}
