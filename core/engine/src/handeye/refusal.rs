//! Why something is not done in tying the arms to the eyes.

/// Why something is not done, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// One after the other.
    #[error("The eyes are looking at the hands already: wait until that is done, or end it.")]
    UnderWay,
    /// There is nothing to end.
    #[error("Nothing is under way.")]
    NothingUnderWay,
    /// A gate is shut.
    #[error("{0}")]
    Shut(String),
    /// Nothing was looked at.
    #[error("There is nothing to accept: look at the hands first.")]
    NothingToAccept,
    /// Gap writes the model.
    #[error("The model in use is being changed just now: accept in a moment.")]
    Changing,
    /// What the look began with is not in use any more.
    #[error("The model in use was changed since the look began: look at the hands again.")]
    Changed,
}
