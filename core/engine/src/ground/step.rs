//! How far a workflow is.

/// How far a step of the rail is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum StepState {
    /// Nothing has been done yet.
    #[default]
    NotDone,
    /// Work is under way.
    Running,
    /// Done, and what it depends on has not changed.
    Done,
    /// Done, but something it depends on changed since.
    Stale {
        /// What changed, as a sentence.
        why: String,
    },
}
