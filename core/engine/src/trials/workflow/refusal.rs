//! Why a command is not done.

/// Why a command is not done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// There is none.
    #[error("No experiment is shown. Begin one, or open an earlier one.")]
    NoExperiment,
    /// One at a time.
    #[error("An attempt of the experiment is under way. Pause it first.")]
    UnderWay,
    /// It is being written.
    #[error("The last attempt is not on disk yet. Wait a moment.")]
    NotOnDisk,
    /// Nothing moves.
    #[error("No robot is connected. Connect it, or start the twin.")]
    NotConnected,
    /// Nothing is asked.
    #[error("The experiment does not wait for a thing to be laid down.")]
    NotAsked,
    /// Everything is made.
    #[error("All attempts of this experiment are made.")]
    AllMade,
    /// Nothing to do.
    #[error("An experiment needs a method, a position and an attempt, at most 2000 in all.")]
    Empty,
    /// The library of things has no such.
    #[error("Nothing is known of a thing called {0}. Choose one that can be held.")]
    NoThing(String),
    /// It is of another robot.
    #[error("This experiment was made with {0}. Connect that, or begin another.")]
    OtherRobot(String),
}
