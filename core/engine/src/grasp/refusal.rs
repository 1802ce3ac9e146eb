//! Why something is not done in grasping.

/// Why something is not done, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// One after the other.
    #[error("Something is under way ({0}): wait until it is done, or end it.")]
    UnderWay(&'static str),
    /// There is nothing to pause, resume or end.
    #[error("Nothing is under way.")]
    NothingUnderWay,
    /// A gate is shut.
    #[error("{0}")]
    Shut(String),
    /// The rig has others.
    #[error("The robot has no arm called {0}.")]
    NoArm(String),
    /// Nothing is known of it.
    #[error("Nothing is known of a thing called {0}: choose one of the list.")]
    NoThing(String),
    /// The image shows nothing there.
    #[error("Nothing that can be held was detected there: click on a box.")]
    NothingThere,
    /// It is not in the list.
    #[error("There is no attempt called {0} any more.")]
    NoAttempt(String),
}
