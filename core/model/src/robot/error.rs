//! What can be wrong with a robot description or a rig file, and what to do about it.

use crate::files::FileError;
use crate::plausible::Implausible;

/// Why a description (URDF) cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescriptionError {
    /// Not XML, or not URDF.
    #[error("the robot description is not valid URDF: {reason}")]
    NotUrdf {
        /// What the parser says.
        reason: String,
    },
    /// A joint names a link that does not exist.
    #[error(
        "joint {joint} connects to a link {link} that the description does not have: add the link or correct the name"
    )]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The missing link.
        link: String,
    },
    /// A name was not found.
    #[error("there is no {what} called {name}; there are: {known}")]
    Unknown {
        /// "joint" or "link".
        what: &'static str,
        /// The name asked for.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// Two things share a name.
    #[error("there are two {what}s called {name}: rename one")]
    Twice {
        /// "joint" or "link".
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A link has two parents, so links form a loop.
    #[error(
        "link {link} hangs on both {first} and {second}: links must form a tree, a loop cannot be moved by this program"
    )]
    Loop {
        /// The link.
        link: String,
        /// A joint that carries it.
        first: String,
        /// Another.
        second: String,
    },
    /// Not exactly one link without a parent.
    #[error("the links must hang together from one base, but these have no parent: {roots}")]
    Roots {
        /// Their names; "none" when all links form loops.
        roots: String,
    },
    /// A turning joint without limits.
    #[error(
        "joint {joint} has no usable limits (lower {lower}, upper {upper}): give a lower limit below the upper one, both finite"
    )]
    Limits {
        /// The joint.
        joint: String,
        /// As read, rad.
        lower: f64,
        /// As read, rad.
        upper: f64,
    },
    /// A kind of joint that is not supported.
    #[error("joint {joint} is of the kind {kind}, but only revolute and fixed joints are known")]
    Kind {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: String,
    },
    /// Not a number, or an axis of no length.
    #[error("{place} holds a value that is not a usable number: {what}")]
    Number {
        /// Which joint or link.
        place: String,
        /// What is wrong.
        what: String,
    },
    /// A number that cannot be.
    #[error("{place}: {what}. Correct it in the description")]
    Implausible {
        /// Which joint or link.
        place: String,
        /// What cannot be, and why.
        what: Box<Implausible>,
    },
    /// A joint that copies another which does not move by itself.
    #[error("joint {joint} copies {source_joint}, which is not a joint that moves by itself")]
    Mimic {
        /// The joint.
        joint: String,
        /// The joint it copies.
        source_joint: String,
    },
}

/// Why a rig file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RigError {
    /// The file itself cannot be read: what [`FileError`] says.
    #[error("{0}")]
    File(String),
    /// There is no such rig.
    #[error("{file} cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        reason: String,
    },
    /// Not TOML, a missing or unknown key, a wrong type.
    #[error("{file} is not a valid rig file: {reason}")]
    NotRig {
        /// The file.
        file: String,
        /// What the parser says, with the line.
        reason: String,
    },
    /// The description it names is wrong.
    #[error("{file}: {error}")]
    Description {
        /// The description's file.
        file: String,
        /// What is wrong.
        error: Box<DescriptionError>,
    },
    /// The rig speaks of a joint or link that the description does not have.
    #[error("{file}, {place}: {error}")]
    Unknown {
        /// The rig file.
        file: String,
        /// Where in it.
        place: String,
        /// What is not known.
        error: Box<DescriptionError>,
    },
    /// Two servos with one id, or two servos for one joint.
    #[error("{file}: {what}: give each servo its own id and its own joint")]
    Twice {
        /// The rig file.
        file: String,
        /// What occurs twice.
        what: String,
    },
    /// A value out of its range.
    #[error("{file}, {place}: {what}")]
    Value {
        /// The rig file.
        file: String,
        /// Where in it.
        place: String,
        /// What is wrong and what is right.
        what: String,
    },
    /// Work that needs a part which the file of a robot that was only measured does not give.
    #[error(
        "the rig {rig} was read for its measurements only: its file gives no {part}, which this needs. Use a complete rig file"
    )]
    Lacks {
        /// Name of the rig.
        rig: String,
        /// What is lacking, for people.
        part: &'static str,
    },
    /// A rig file that names no description.
    #[error(
        "{file} names no description of the robot, and no single .urdf file lies beside it: add description = \"robot.urdf\""
    )]
    NoDescription {
        /// The rig file.
        file: String,
    },
}

impl From<FileError> for RigError {
    fn from(error: FileError) -> Self {
        Self::File(error.to_string())
    }
}
