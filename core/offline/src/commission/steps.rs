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

/// The twin that a lab was commissioned on: the one that is asked for, and where none is, the one of which the
/// lab says that it is.
///
/// # Errors
/// When the lab was commissioned on another one, or does not say on which and none is asked for.
pub(crate) fn twin_of(folder: &Path, asked: Option<&str>) -> Result<Scenario, CommissionError> {
    #[derive(Deserialize)]
    struct Whose {
        twin: String,
        fingerprint: String,
    }
    let file = folder.join(FILE);
    if !files::present(&file)? {
        let unsaid = || CommissionError::NoTwin { folder: folder.to_owned() };
        return Ok(Scenario::named_or_file(asked.ok_or_else(unsaid)?)?);
    }
    let text = files::read_text(&file, Size::TEXT)?;
    let whose: Whose = serde_json::from_str(&text)
        .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
    let other = |asked: String| CommissionError::LabOfOther {
        folder: folder.to_owned(),
        of: whose.twin.clone(),
        asked,
    };
    let scenario = match asked {
        Some(asked) => Scenario::named_or_file(asked)?,
        None => Scenario::named_or_file(&whose.twin)
            .map_err(|_| CommissionError::LabOfFile { folder: folder.to_owned(), of: whose.twin.clone() })?,
    };
    match whose.fingerprint == fingerprint(&scenario) {
        true => Ok(scenario),
        // A file may be called as one that comes with the program.
        false if asked.is_none() => {
            Err(CommissionError::LabOfFile { folder: folder.to_owned(), of: whose.twin.clone() })
        }
        false => Err(other(scenario.name)),
    }
}

/// A number that differs between labs: of what is written about their commissioning, and of their twin.
pub(crate) fn identity(folder: &Path, scenario: &Scenario) -> Result<String, CommissionError> {
    let file = folder.join(FILE);
    let steps = if files::present(&file)? { files::read_text(&file, Size::TEXT)? } else { String::new() };
    let mut hasher = std::hash::DefaultHasher::new();
    (fingerprint(scenario), steps).hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}

/// A number that differs between scenarios. It tells nothing of what they hide.
fn fingerprint(scenario: &Scenario) -> String {
    let mut hasher = std::hash::DefaultHasher::new();
    format!("{scenario:?}").hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lab_says_of_which_twin_it_is_and_no_other_one_is_taken_for_it() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let lab = folder.path();
        let said = twin_of(lab, None).expect_err("it says nothing").to_string();
        assert!(said.contains("name it with --twin"), "{said}");
        assert_eq!(twin_of(lab, Some("perfect")).expect("as asked").name, "perfect");

        let perfect = Scenario::named_or_file("perfect").expect("comes with the program");
        let nothing = identity(lab, &perfect).expect("readable");
        let mut steps = Steps::read(lab, &perfect, 1).expect("begun");
        steps.add(lab, Step::new("eyes", "pixels")).expect("written");
        assert_eq!(twin_of(lab, None).expect("its own").name, "perfect");
        assert_eq!(twin_of(lab, Some("perfect")).expect("the same").name, "perfect");
        let said = twin_of(lab, Some("lab")).expect_err("another one").to_string();
        assert!(said.contains("\"perfect\"") && said.contains("\"lab\""), "{said}");
        assert_ne!(identity(lab, &perfect).expect("readable"), nothing, "more was done");

        let text = std::fs::read_to_string(lab.join(FILE)).expect("written");
        std::fs::write(lab.join(FILE), text.replace("\"perfect\"", "\"of a file\"")).expect("written");
        let said = twin_of(lab, None).expect_err("a file").to_string();
        assert!(said.contains("name the file with --twin"), "{said}");
    }
}
