//! What can go wrong with a twin.

use std::io;

/// Why there is no twin, or why it did not do as it was told.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// No scenario of that name.
    #[error("there is no scenario \"{name}\": choose one of {known}")]
    UnknownScenario {
        /// Asked for.
        name: String,
        /// Names that are known.
        known: String,
    },
    /// A scenario file that cannot be used.
    #[error("scenario {file}: {reason}")]
    Scenario {
        /// The file.
        file: String,
        /// What is wrong and what is right.
        reason: String,
    },
    /// A scenario file that cannot be read.
    #[error(transparent)]
    File(#[from] plumbline_model::files::FileError),
    /// The scenario speaks of a part that the robot does not have.
    #[error(
        "scenario {scenario} speaks of {what} \"{name}\", which the robot {robot} does not have: correct the name"
    )]
    UnknownPart {
        /// The scenario.
        scenario: String,
        /// "joint" or "finger".
        what: &'static str,
        /// Its name.
        name: String,
        /// The robot.
        robot: String,
    },
    /// A servo model without physics.
    #[error("nothing is known about the motor of servo model \"{model}\": known are {known}")]
    UnknownServo {
        /// The model.
        model: String,
        /// Models that are known.
        known: String,
    },
    /// MuJoCo did not accept the world.
    #[error("the physics does not accept this robot: {reason}. Check masses and shapes of its description")]
    Physics {
        /// What MuJoCo said.
        reason: String,
    },
    /// A number given by the caller is not usable.
    #[error("{what} is {value}: {remedy}")]
    Value {
        /// Which.
        what: &'static str,
        /// Its value.
        value: String,
        /// What is right.
        remedy: &'static str,
    },
    /// No pseudo-terminal.
    #[error("no pseudo-terminal for the twin's servos could be opened: {0}. Check that /dev/pts is mounted")]
    Terminal(#[source] io::Error),
    /// No thread.
    #[error("a thread of the twin could not be started: {0}. Close other programs and try again")]
    Thread(#[source] io::Error),
}
