//! What was done so far: one file in the lab's folder, written when a step is done, read when the work
//! is started again.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
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
        let fingerprint = scenario.fingerprint();
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
        let is_same = is_of(&kept.fingerprint, scenario) && kept.seed == seed;
        if kept.twin != fresh.twin || !is_same {
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
    match is_of(&whose.fingerprint, &scenario) {
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
    // An experiment that was begun with a lab of before goes on with it.
    let before = fingerprint_before(scenario);
    let fingerprint = if steps.contains(&before) { before } else { scenario.fingerprint() };
    let mut hasher = DefaultHasher::new();
    (fingerprint, steps).hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}

/// Whether what a lab keeps of its twin is that of a scenario.
fn is_of(kept: &str, scenario: &Scenario) -> bool {
    kept == scenario.fingerprint() || kept == fingerprint_before(scenario)
}

/// What labs kept that were commissioned before scenarios had a fingerprint of their values: a number of how this
/// program prints them.
fn fingerprint_before(scenario: &Scenario) -> String {
    let mut hasher = DefaultHasher::new();
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

    #[test]
    fn a_lab_of_before_is_known_and_what_it_was_experimented_with_goes_on() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (lab, perfect) = (folder.path(), Scenario::named_or_file("perfect").expect("comes along"));
        let mut steps = Steps::read(lab, &perfect, 1).expect("begun");
        assert_eq!(steps.fingerprint, perfect.fingerprint());
        steps.add(lab, Step::new("eyes", "pixels")).expect("written");
        let fresh = identity(lab, &perfect).expect("readable");

        let text = std::fs::read_to_string(lab.join(FILE)).expect("written");
        let before = text.replace(&perfect.fingerprint(), &fingerprint_before(&perfect));
        assert_ne!(before, text);
        std::fs::write(lab.join(FILE), &before).expect("written");
        assert_eq!(twin_of(lab, None).expect("its own").name, "perfect");
        let again = Steps::read(lab, &perfect, 1).expect("the same twin");
        assert_eq!(again.fingerprint, fingerprint_before(&perfect), "it stays as it was written");
        let mut hasher = DefaultHasher::new();
        (fingerprint_before(&perfect), before).hash(&mut hasher);
        let as_before = format!("{:016x}", hasher.finish());
        assert_eq!(identity(lab, &perfect).expect("readable"), as_before);
        assert_ne!(as_before, fresh);
        assert!(Steps::read(lab, &perfect, 2).is_err(), "another seed");
    }

    #[test]
    fn a_lab_of_a_file_is_known_however_the_file_is_written_and_not_when_a_value_is_another() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let text =
            "format = 1\nname = \"mine\"\ntitle = \"Mine\"\nabout = \"Mine.\"\n[contact]\ntoy_mass = 2.0\n";
        let (file, lab) = (folder.path().join("mine.toml"), folder.path().join("lab"));
        let written = |text: &str| {
            std::fs::write(&file, text).expect("written");
            file.display().to_string()
        };
        let first = Scenario::named_or_file(&written(text)).expect("a file");
        let mut steps = Steps::read(&lab, &first, 1).expect("begun");
        steps.add(&lab, Step::new("eyes", "pixels")).expect("written");
        let identity_of = |scenario: &Scenario| identity(&lab, scenario).expect("readable");
        let reformatted = text.replace("toy_mass = 2.0", "# Twice as heavy.\n  toy_mass=2e0");
        let same = twin_of(&lab, Some(&written(&reformatted))).expect("the same twin");
        assert_eq!(identity_of(&same), identity_of(&first));
        let other = text.replace("toy_mass = 2.0", "toy_mass = 2.5");
        let said = twin_of(&lab, Some(&written(&other))).expect_err("another twin").to_string();
        assert!(said.contains("mine"), "{said}");
    }
}
