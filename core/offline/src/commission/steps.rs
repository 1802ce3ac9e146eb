//! What was done so far: one file in the lab's folder, written when a step is done, read when the work
//! is started again.

use std::hash::{Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

use plumbline_model::files::{self, Size};
use plumbline_twin::Scenario;
use serde::{Deserialize, Serialize};

use super::error::CommissionError;

/// Version of the file.
const FORMAT: u32 = 1;
const FILE: &str = "steps.json";

/// A step that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// `eyes`, `mount`, `touches`, `screen`, `effects`, `models` or `check`.
    pub name: String,
    /// Robot time that it took, a person's part of it included, min.
    pub minutes: f64,
    /// Error before it on what it did not use, mm; which error is said in `error_of`.
    pub before_mm: Option<f64>,
    /// The same after it.
    pub after_mm: Option<f64>,
    /// What `before_mm` and `after_mm` are.
    pub error_of: String,
    /// Times that the board was looked at.
    pub board_views: usize,
    /// Contacts of the finger.
    pub touches: usize,
    /// What else is to be said, a sentence each.
    pub notes: Vec<String>,
}

impl Step {
    /// Nothing measured yet.
    pub fn new(name: &str, error_of: &str) -> Self {
        Self {
            name: name.to_owned(),
            minutes: 0.0,
            before_mm: None,
            after_mm: None,
            error_of: error_of.to_owned(),
            board_views: 0,
            touches: 0,
            notes: vec![],
        }
    }
}

/// The steps of a commissioning and of whom they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Steps {
    format: u32,
    /// Short name of the scenario.
    twin: String,
    /// Tells scenarios of one name apart.
    fingerprint: String,
    seed: u64,
    /// Done, in their order.
    pub done: Vec<Step>,
}

impl Steps {
    /// What was done in this folder for this twin; nothing where nothing was begun.
    pub fn read(folder: &Path, scenario: &Scenario, seed: u64) -> Result<Self, CommissionError> {
        let fingerprint = fingerprint(scenario);
        let fresh = Self { format: FORMAT, twin: scenario.name.clone(), fingerprint, seed, done: Vec::new() };
        let file = folder.join(FILE);
        if !files::present(&file)? {
            return Ok(fresh);
        }
        let text = files::read_text(&file, Size::TEXT)?;
        let unusable = |reason: String| CommissionError::Steps { file: file.clone(), reason };
        let kept: Self = serde_json::from_str(&text).map_err(|error| unusable(error.to_string()))?;
        if kept.format != FORMAT {
            return Err(unusable(format!("format {}, this program reads {FORMAT}", kept.format)));
        }
        if (&kept.twin, &kept.fingerprint, kept.seed) != (&fresh.twin, &fresh.fingerprint, fresh.seed) {
            let who = |steps: &Self| format!("\"{}\" with seed {}", steps.twin, steps.seed);
            let (found, wanted) = (who(&kept), who(&fresh));
            return Err(CommissionError::OtherTwin { folder: folder.to_owned(), found, wanted });
        }
        Ok(kept)
    }

    /// Adds a step that is done; it is on disk when this returns.
    pub fn add(&mut self, folder: &Path, step: Step) -> Result<(), CommissionError> {
        self.done.push(step);
        let file: PathBuf = folder.join(FILE);
        let unusable = |reason: String| CommissionError::Steps { file: file.clone(), reason };
        let text = serde_json::to_string_pretty(self).map_err(|error| unusable(error.to_string()))?;
        files::make_folder(folder)?;
        Ok(files::write(&file, text)?)
    }

    /// A step by its name, if it is done.
    pub fn of(&self, name: &str) -> Option<&Step> {
        self.done.iter().find(|step| step.name == name)
    }

    /// Robot time so far, s.
    pub fn elapsed_s(&self) -> f64 {
        60.0 * self.done.iter().map(|step| step.minutes).sum::<f64>()
    }
}

/// A number that differs between scenarios. It tells nothing of what they hide.
fn fingerprint(scenario: &Scenario) -> String {
    let mut hasher = std::hash::DefaultHasher::new();
    format!("{scenario:?}").hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}
