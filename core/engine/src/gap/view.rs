//! The gap between model and measurement: what was compared, what was found, what is in the model.

use std::path::PathBuf;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_gap::{Finding, Verdict};
use plumbline_model::robot::Rig;

use super::at_tip::SMALL_M;
use super::command::GapModel;
use crate::ground::jobs::JobId;
use crate::ground::step::StepState;

/// Looking for the gap.
#[derive(Clone, Debug, Default)]
pub struct GapView {
    /// For the rail.
    pub step: StepState,
    /// Sessions of this world that measured something, newest first.
    pub sessions: Arc<[GapSession]>,
    /// Folders of those that are looked at together.
    pub chosen: Arc<[PathBuf]>,
    /// With which model they are compared.
    pub with: GapModel,
    /// The search that is under way.
    pub searching: Option<JobId>,
    /// Why the last search gave nothing, until the next one; a sentence.
    pub failed: Option<String>,
    /// What was found, newest first.
    pub findings: Arc<[FindingEntry]>,
    /// The finding that is shown.
    pub shown: Option<Arc<ShownFinding>>,
    /// Another one beside it.
    pub beside: Option<Arc<ShownFinding>>,
    /// Why the shown finding should not be trusted any more.
    pub stale: Option<String>,
    /// What is in the model in use.
    pub model: GapModelView,
    /// Whether the arm can be corrected by the shown finding although it names nothing that could be added.
    pub sizes_arm: bool,
    /// The rig that all of it belongs to.
    pub rig: Option<Arc<Rig>>,
}

/// A session that can be compared with the model.
#[derive(Clone, Debug, PartialEq)]
pub struct GapSession {
    /// Its folder.
    pub folder: PathBuf,
    /// Its name for people.
    pub name: String,
    /// When it was begun.
    pub started: Option<Timestamp>,
    /// Whether it was touched to check what had been learned.
    pub is_check: bool,
    /// Rows of its tables.
    pub touches: usize,
    /// Poses measured from outside.
    pub poses: usize,
    /// Places that the eyes estimated or saw.
    pub localizations: usize,
    /// Why it cannot be used.
    pub problem: Option<String>,
}

/// A finding in the list.
#[derive(Clone, Debug, PartialEq)]
pub struct FindingEntry {
    /// Name of its file.
    pub id: String,
    /// When it was made.
    pub made: Timestamp,
    /// The model that was compared: "nominal", "nominal + 2 effects".
    pub model: String,
    /// Names of the sessions.
    pub sessions: Vec<String>,
    /// The answer in a word.
    pub verdict: Verdict,
    /// What was named, for people.
    pub named: Vec<String>,
    /// Mean held-out errors: before, after, floor; in m or px.
    pub errors: [f64; 3],
    /// Whether that is in pixels.
    pub in_pixels: bool,
}

/// A finding with what was made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownFinding {
    /// As it stands in the list.
    pub entry: FindingEntry,
    /// The finding.
    pub finding: Finding,
    /// Folders of its sessions.
    pub folders: Vec<PathBuf>,
    /// Per effect, whether the model in use has it.
    pub added: Vec<bool>,
    /// Effects that shall not be added, by place.
    pub left_out: Vec<usize>,
}

/// What is in the model in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GapModelView {
    /// "nominal", "nominal + 2 effects".
    pub name: String,
    /// Its effects.
    pub effects: Vec<AddedEffect>,
    /// The models so far, oldest first; the last one is in use.
    pub history: Vec<ModelStep>,
    /// Whether there is something to go back to.
    pub can_undo: bool,
    /// Whether what was taken back last can be put back.
    pub can_redo: bool,
}

/// An effect in the model.
#[derive(Clone, Debug, PartialEq)]
pub struct AddedEffect {
    /// Its name, `id@site`.
    pub name: String,
    /// Whether a search has given it a name; others have small shares, for the arm's sake.
    pub is_named: bool,
    /// What it is and where, for people.
    pub title: String,
    /// Parameters with their 95 % intervals, as the command line names them.
    pub parameters: Vec<(String, f64, [f64; 2])>,
    /// Whether it is one of the eyes.
    pub is_of_eyes: bool,
    /// Whether it is not in force, for it was found with other eyes than those in use.
    pub is_left_out: bool,
    /// How far it moves the fingertip on the glass, or, of the eyes, where they see things there, rms, m; `None`:
    /// nothing there shows it.
    pub moved_m: Option<f64>,
}

/// A model that was in use, with what was known of its gap.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelStep {
    /// When it was made.
    pub at: Timestamp,
    /// What was done, for people: "joint zero of the elbow added".
    pub title: String,
    /// Whether it was taken back since.
    pub undone: bool,
    /// Mean held-out errors where they are known: before, after, floor; m or px.
    pub errors: Option<[f64; 3]>,
    /// Whether these are in pixels.
    pub in_pixels: bool,
    /// Whether these are rms along the glass and in height, with no floor that is known; else means along the glass.
    pub is_rms: bool,
    /// Names of the sessions that it rests on.
    pub sessions: Vec<String>,
}

impl AddedEffect {
    /// Whether it moves things by so little that nobody would see it.
    pub fn is_small(&self) -> bool {
        self.moved_m.is_some_and(|moved_m| moved_m < SMALL_M)
    }
}

impl GapView {
    /// The finding that is shown.
    pub fn finding(&self) -> Option<&Finding> {
        self.shown.as_ref().map(|shown| &shown.finding)
    }

    /// Effects of the shown finding that can be added and are not in the model yet, by place.
    pub fn addable(&self) -> Vec<usize> {
        match &self.shown {
            Some(shown) if self.stale.is_none() => shown.addable(),
            _ => vec![],
        }
    }

    /// Those of them that are not left out: what is added.
    pub fn wanted(&self) -> Vec<usize> {
        let Some(shown) = &self.shown else { return vec![] };
        self.addable().into_iter().filter(|effect| !shown.left_out.contains(effect)).collect()
    }
}

impl ShownFinding {
    /// Effects that can be added and are not in the model yet, by place.
    pub fn addable(&self) -> Vec<usize> {
        let is_new = |i: &usize| !self.added.get(*i).copied().unwrap_or(false);
        self.finding.addable().into_iter().filter(is_new).collect()
    }
}
