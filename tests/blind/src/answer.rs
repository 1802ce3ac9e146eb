//! The answer to a case, which only the scorer reads.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::design::Design;
use crate::error::BlindError;
use crate::physics::Generator;
use crate::recipe::Family;

/// What was hidden in a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Its number.
    pub case: usize,
    /// Of everything drawn by chance.
    pub seed: u64,
    /// What kind of case.
    pub family: Family,
    /// Whose physics.
    pub generator: Generator,
    /// Which plan.
    pub design: Design,
    /// What is to be found.
    pub hidden: Vec<Hidden>,
    /// What is there and need not be found, as `id@site`.
    pub dirt: Vec<String>,
    /// Names that are true of every case of this generator, whatever is hidden, as `id@site`.
    pub also: Vec<String>,
    /// Spread of repeats: along u, along v, out of the glass, m.
    pub sigma_m: [f64; 3],
    /// Touches.
    pub rows: usize,
    /// Distinct poses, sides, heights and weights.
    pub cells: usize,
}

/// An effect that was hidden.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Its name on the command line; in brackets what the library does not have.
    pub id: String,
    /// Where.
    pub site: String,
    /// Its parameters as the command line names them, where physics has such a number.
    pub parameters: BTreeMap<String, f64>,
    /// Root mean square of what it does, less what a moved screen would do, in sigmas.
    pub size_sigmas: f64,
}

impl Hidden {
    /// `id@site`.
    pub fn named(&self) -> String {
        format!("{}@{}", self.id, self.site)
    }
}

impl Answer {
    /// Writes it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), BlindError> {
        let unwritable = |source| BlindError::File { file: file.to_path_buf(), source };
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(unwritable)?;
        }
        let text = serde_json::to_string_pretty(self)
            .map_err(|source| BlindError::Content { file: file.to_path_buf(), source })?;
        std::fs::write(file, text).map_err(unwritable)
    }

    /// Reads it.
    ///
    /// # Errors
    /// When there is none, or it is something else.
    pub fn read(file: &Path) -> Result<Self, BlindError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| BlindError::File { file: file.to_path_buf(), source })?;
        serde_json::from_str(&text).map_err(|source| BlindError::Content { file: file.to_path_buf(), source })
    }
}
