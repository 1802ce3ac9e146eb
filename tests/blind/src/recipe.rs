//! What a case shall be.

use serde::{Deserialize, Serialize};

use crate::design::Design;
use crate::physics::Generator;
use crate::secret::Kind;

/// What kind of case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Nothing is hidden.
    Null,
    /// One effect.
    Single,
    /// Two.
    Pair,
    /// Three.
    Triple,
    /// Something that the library does not have.
    OffLibrary,
    /// A robot that is a little off everywhere: far more effects than a session tells apart.
    Crowd,
}

impl Family {
    /// How many effects have a size of their own.
    pub(crate) fn drawn(self) -> usize {
        match self {
            Self::Null | Self::Crowd => 0,
            Self::Single | Self::OffLibrary => 1,
            Self::Pair => 2,
            Self::Triple => 3,
        }
    }
}

/// What a case shall be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Its number.
    pub number: usize,
    /// Whose physics.
    pub generator: Generator,
    /// What kind of case.
    pub family: Family,
    /// Which plan of touches.
    pub design: Design,
    /// Whether small things are wrong, too.
    pub dirt: bool,
    /// Wanted size of each effect, in sigmas.
    pub size_sigmas: f64,
    /// The kind that it must be, where that was asked for.
    pub kind: Option<Kind>,
    /// Of everything drawn by chance.
    pub seed: u64,
}
