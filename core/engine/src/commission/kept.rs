//! What is kept of commissioning, in the folder of its world.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_model::files::{FileError, Size};
use serde::{Deserialize, Serialize};

use crate::ground::own_file::{self, NotOwn, Own};

/// The file, in the folder of a world.
pub const FILE: &str = "commission.json";
/// Version of the file.
const FORMAT: u32 = 1;
/// More than ten years: the file was damaged.
const LONGEST_S: f64 = 3.2e8;

/// Why it cannot be kept, or read. Reads as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum CommissionError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is something else.
    #[error("{} does not say how far commissioning is ({why}): move it away and begin again", .file.display())]
    NoCommission {
        /// Which.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

impl CommissionError {
    fn of(file: &Path, why: NotOwn) -> Self {
        match why {
            NotOwn::File(error) => Self::File(error),
            NotOwn::Other(why) => Self::NoCommission { file: file.to_owned(), why },
        }
    }
}

/// What is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    format: u32,
    /// When it was begun.
    pub began: Timestamp,
    /// Whether what was done before that counts.
    pub is_anew: bool,
    /// Whether the operator is led.
    pub is_on: bool,
    /// While the program was open and all was not done yet, s.
    pub spent_s: f64,
    /// Contacts.
    pub touches: usize,
    /// Views of the board.
    pub views: usize,
    /// Contacts of each session of touches that were counted.
    pub counted: BTreeMap<PathBuf, usize>,
    /// The touches that the rest is learned from.
    pub touched: Option<KeptRun>,
    /// What was learned of them; `None`: not yet.
    #[serde(default)]
    pub learned: Option<Learned>,
    /// The touches that checked it.
    pub checked: Option<KeptRun>,
}

/// What a search for effects made of the touches, once it left nothing open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learned {
    /// Session of the touches.
    pub session: PathBuf,
    /// Names of the effects that the model in use had then.
    pub effects: Vec<String>,
    /// Whether the touches show something that no effect of the library explains.
    pub is_not_in_library: bool,
    /// When that was found; `None` where nobody wrote it down.
    pub at: Option<Timestamp>,
}

/// A finished run of touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptRun {
    /// Folder of its session.
    pub session: PathBuf,
    /// Touches that count.
    pub touched: usize,
    /// How far they missed, mean, m.
    pub mean_m: Option<f64>,
    /// When it was seen to be finished.
    pub at: Timestamp,
}

impl Own for Kept {
    const FORMAT: u32 = FORMAT;
    const LONGEST: Size = Size::SHORT;

    fn format(&self) -> u32 {
        self.format
    }
}

impl Kept {
    /// Just begun.
    pub fn begun(at: Timestamp, anew: bool) -> Self {
        Self {
            format: FORMAT,
            began: at,
            is_anew: anew,
            is_on: true,
            spent_s: 0.0,
            touches: 0,
            views: 0,
            counted: BTreeMap::new(),
            touched: None,
            learned: None,
            checked: None,
        }
    }

    /// Reads it; `None` where commissioning was never begun.
    ///
    /// # Errors
    /// When there is a file that does not say what it should.
    pub fn read(file: &Path) -> Result<Option<Self>, CommissionError> {
        let Some(kept) = own_file::read::<Self>(file).map_err(|why| CommissionError::of(file, why))? else {
            return Ok(None);
        };
        let wrong = |why: String| CommissionError::NoCommission { file: file.to_owned(), why };
        if !(0.0..=LONGEST_S).contains(&kept.spent_s) {
            return Err(wrong(format!("it took {} s", kept.spent_s)));
        }
        let lengths = [&kept.touched, &kept.checked].into_iter().flatten().filter_map(|run| run.mean_m);
        if let Some(length_m) = lengths.into_iter().find(|length_m| !(0.0..=1.0).contains(length_m)) {
            return Err(wrong(format!("touches missed by {length_m} m")));
        }
        Ok(Some(kept))
    }

    /// Writes it in place of what was.
    ///
    /// # Errors
    /// When it cannot be written; then the old one is there.
    pub fn write(&self, file: &Path) -> Result<(), CommissionError> {
        own_file::write(file, self).map_err(|why| CommissionError::of(file, why))
    }
}
