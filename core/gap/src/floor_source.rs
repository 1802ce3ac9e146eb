//! What tells how far measurements scatter.

use serde::{Deserialize, Serialize};

/// Where a noise floor comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FloorSource {
    /// Spread of repeats of the same measurement.
    Repeats,
    /// The instrument's own standard deviation, as the session gives it.
    Instrument,
    /// Rows that were measured nearly alike in everything.
    #[default]
    Neighbors,
    /// Nothing tells it: it is what the best model leaves.
    Fitted,
}

impl FloorSource {
    /// In a word, as in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Instrument => "instrument",
            Self::Neighbors => "neighbors",
            Self::Fitted => "fitted",
        }
    }

    /// In a sentence, for people.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Repeats => "The noise is the spread of repeats about their mean.",
            Self::Instrument => {
                "Too little was repeated: the noise is the instrument's own figure, and what the arm adds to it is fitted."
            }
            Self::Neighbors => {
                "Too little was repeated: the noise is estimated from near neighbors and is approximate."
            }
            Self::Fitted => {
                "Too little was repeated: the noise is not known and was taken as what the best model leaves."
            }
        }
    }

    /// The same in a few words, after "noise from".
    pub fn words(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Instrument => "the instrument's own figure",
            Self::Neighbors => "near neighbors, approximate",
            Self::Fitted => "what the best model leaves, since it is not known",
        }
    }
}
