//! The answer to a case, which only the scorer reads.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use strum::{EnumString, IntoStaticStr};

use crate::design::Design;
use crate::error::BlindError;
use crate::physics::Generator;
use crate::recipe::Family;

/// Whose case it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, EnumString, IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Source {
    /// Touches of [`Generator::Lean`].
    Lean,
    /// Touches of [`Generator::Worn`].
    Worn,
    /// Arms drawn by chance, measured from outside ([`crate::arms`]).
    Arms,
    /// Eyes in a head ([`crate::eyes`]).
    Eyes,
}

impl From<Generator> for Source {
    fn from(generator: Generator) -> Self {
        match generator {
            Generator::Lean => Self::Lean,
            Generator::Worn => Self::Worn,
        }
    }
}

/// How much a session varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plan {
    /// As labs measure: one side, one height, no weight, one posture of the head.
    Plain,
    /// Two sides, heights or orientations, weights, turned heads.
    Rich,
    /// One thing watched over time.
    Watched,
}

impl From<Design> for Plan {
    fn from(design: Design) -> Self {
        match design {
            Design::Plain => Self::Plain,
            Design::Rich => Self::Rich,
        }
    }
}

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
    pub generator: Source,
    /// Which plan.
    pub design: Plan,
    /// What is to be found.
    pub hidden: Vec<Hidden>,
    /// What is there and need not be found, as `id@site`.
    pub dirt: Vec<String>,
    /// Names that are true of every case of this generator, whatever is hidden, as `id@site`.
    pub also: Vec<String>,
    /// Spread of repeats per coordinate. Touches: along u, along v, out of the glass, m. Arms: x, y, z, m, and
    /// turns about them where they were measured, rad. Eyes: image points, px, or bearings and disparity (1).
    pub sigma: Vec<f64>,
    /// Rows of the session.
    pub rows: usize,
    /// Distinct poses, sides, heights, weights, places.
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
    /// Root mean square of what it does, less what a moved screen or another frame would do, in sigmas.
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
