//! What is kept of a look that was accepted, in the folder of its world.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{Kind, RigModel};
use plumbline_grasp::Hand;
use plumbline_handeye::{Outcome, Tie, Tied};
use plumbline_model::files::{FileError, Size};
use serde::{Deserialize, Serialize};

use super::view::HandEyeSummary;
use crate::ground::own_file::{self, NotOwn, Own};

/// The file, in the folder of a world.
pub const FILE: &str = "hand-eye.json";
/// Version of the file.
const FORMAT: u32 = 1;

/// Why it cannot be kept, or read. Reads as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum KeptError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is something else.
    #[error("{} does not say how arms and eyes were tied ({why}): move it away and look again", .file.display())]
    NoLook {
        /// Which.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

impl KeptError {
    fn of(file: &Path, why: NotOwn) -> Self {
        match why {
            NotOwn::File(error) => Self::File(error),
            NotOwn::Other(why) => Self::NoLook { file: file.to_owned(), why },
        }
    }
}

/// A look that was accepted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    format: u32,
    /// When it was begun.
    pub at: Timestamp,
    /// What was seen of what does not move.
    tie: Tie,
    /// Hands, the one that touched first.
    hands: Vec<(Hand, Outcome)>,
    /// Every effect of the arms and of the neck that it gave, with its values.
    gave: Vec<String>,
}

impl Own for Kept {
    const FORMAT: u32 = FORMAT;
    const LONGEST: Size = Size::SHORT;

    fn format(&self) -> u32 {
        self.format
    }
}

impl Kept {
    /// Of a look that was begun then.
    pub fn of(tied: &Tied, at: Timestamp) -> Self {
        let (hand, figures) = tied.touched.clone();
        let hands = std::iter::once((hand, Outcome::Sized(figures))).chain(tied.other.clone()).collect();
        Self { format: FORMAT, at, tie: tied.tie.clone(), hands, gave: gave(&tied.model) }
    }

    /// Whether a model still has what it gave.
    pub fn is_in(&self, model: &RigModel) -> bool {
        let has = gave(model);
        !self.gave.is_empty() && self.gave.iter().all(|effect| has.contains(effect))
    }

    /// For people.
    pub fn summary(&self) -> HandEyeSummary {
        let Tie { body, screen, table } = self.tie.clone();
        HandEyeSummary { at: self.at, body, screen, table, hands: self.hands.clone() }
    }

    /// Reads it; `None` where nothing was ever accepted.
    ///
    /// # Errors
    /// When there is a file that does not say what it should.
    pub fn read(file: &Path) -> Result<Option<Self>, KeptError> {
        own_file::read(file).map_err(|why| KeptError::of(file, why))
    }

    /// Writes it in place of what was.
    ///
    /// # Errors
    /// When it cannot be written; then the old one is there.
    pub fn write(&self, file: &Path) -> Result<(), KeptError> {
        own_file::write(file, self).map_err(|why| KeptError::of(file, why))
    }
}

/// Effects of arms and neck in a model, with their values.
fn gave(model: &RigModel) -> Vec<String> {
    let is_of_it = |effect: &&ModelEffect| effect.tip.is_some() || effect.id == Kind::HeadJoint.id();
    let told = |effect: &ModelEffect| {
        format!("{} {} {:?}", effect.tip.as_deref().unwrap_or("neck"), effect.name(), effect.values)
    };
    model.effects().iter().filter(is_of_it).map(told).collect()
}
