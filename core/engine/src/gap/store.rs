//! Findings on disk: one JSON file each, beside the sessions of its world.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_gap::Finding;
use plumbline_gap::finding::ShownUnit;
use plumbline_model::files::{self, FileError, Size};
use serde::{Deserialize, Serialize};

use super::sessions::TableStamp;
use super::view::FindingEntry;
use crate::ground::shelf::Shelf;
use crate::ground::text::sentence;

/// Version of the file.
const FORMAT: u32 = 1;

/// Why a finding cannot be kept, read or deleted.
#[derive(Debug, thiserror::Error)]
pub enum FindingError {
    /// It is no finding, or cannot be read.
    #[error("The finding {} cannot be read ({reason}). Look for the gap again, or delete it.", .file.display())]
    Unreadable {
        /// Which.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The system says no.
    #[error("{} cannot be written ({reason}). Check that the disk has free space and can be written.", .file.display())]
    Unwritable {
        /// Which.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The file itself.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] FileError),
}

impl FindingError {
    fn unreadable<E: std::fmt::Display>(file: &Path) -> impl FnOnce(E) -> Self {
        let file = file.to_owned();
        move |error| Self::Unreadable { file, reason: error.to_string() }
    }

    fn unwritable<E: std::fmt::Display>(file: &Path) -> impl FnOnce(E) -> Self {
        let file = file.to_owned();
        move |error| Self::Unwritable { file, reason: error.to_string() }
    }
}

/// Findings in a folder.
#[derive(Clone, Debug)]
pub struct Store {
    shelf: Shelf,
}

/// A finding with where it comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptFinding {
    format: u32,
    /// When it was made.
    pub made: Timestamp,
    /// The model that was compared, for people.
    pub model: String,
    /// Effects of that model, `id@site` with their values, in words that tell models apart.
    pub model_effects: Vec<String>,
    /// Sessions as they were.
    pub sessions: Vec<KeptSession>,
    /// What was found.
    pub finding: Finding,
}

/// A session as it was compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptSession {
    /// Its folder.
    pub folder: PathBuf,
    /// Its tables.
    pub tables: Vec<TableStamp>,
}

/// A finding and the name of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Name of its file, without extension.
    pub id: String,
    /// The finding.
    pub kept: KeptFinding,
}

impl KeptFinding {
    /// A finding, made at this time.
    pub fn new(
        finding: Finding,
        sessions: Vec<KeptSession>,
        (model, model_effects): (String, Vec<String>),
        made: Timestamp,
    ) -> Self {
        Self { format: FORMAT, made, model, model_effects, sessions, finding }
    }
}

impl Named {
    /// As it stands in the list.
    pub fn entry(&self) -> FindingEntry {
        let KeptFinding { made, model, finding, .. } = &self.kept;
        let shown = &finding.shown;
        FindingEntry {
            id: self.id.clone(),
            made: *made,
            model: model.clone(),
            sessions: finding.sessions.clone(),
            verdict: finding.verdict,
            named: finding.effects.iter().map(|effect| effect.title.clone()).collect(),
            errors: [shown.before, shown.after, shown.floor],
            in_pixels: shown.unit == ShownUnit::Pixel,
        }
    }
}

impl Store {
    /// In this folder, which is made when something is found.
    pub fn new(folder: PathBuf) -> Self {
        Self { shelf: Shelf::new(folder, "json") }
    }

    /// All findings of a robot, newest first, and what cannot be read, a sentence each.
    pub fn read(&self, rig: &str) -> (Vec<Named>, Vec<String>) {
        let (mut found, mut problems) = (vec![], vec![]);
        for name in self.shelf.names().unwrap_or_default() {
            match read(&self.shelf.file(&name)) {
                Ok(named) if named.kept.finding.rig == rig => found.push(named),
                Ok(_) => {}
                Err(problem) => problems.push(problem.to_string()),
            }
        }
        found.sort_by(|a, b| (b.kept.made, &b.id).cmp(&(a.kept.made, &a.id)));
        (found, problems)
    }

    /// Keeps a finding.
    ///
    /// # Errors
    /// A sentence.
    pub fn keep(&self, kept: KeptFinding) -> Result<Named, FindingError> {
        self.shelf.make_folder().map_err(FindingError::unwritable(self.shelf.folder()))?;
        let id = self.shelf.free_name(kept.made, "");
        let file = self.shelf.file(&id);
        let text = serde_json::to_string(&kept).map_err(FindingError::unwritable(&file))?;
        files::write(&file, text)?;
        Ok(Named { id, kept })
    }

    /// Deletes a finding.
    ///
    /// # Errors
    /// A sentence.
    pub fn delete(&self, id: &str) -> Result<(), FindingError> {
        let Some(file) = self.shelf.file_inside(id) else {
            return Err(FindingError::unwritable(&self.shelf.file(id))("its name leads out of the folder"));
        };
        std::fs::remove_file(&file).map_err(FindingError::unwritable(&file))
    }
}

fn read(file: &Path) -> Result<Named, FindingError> {
    let text = files::read_text(file, Size::MODEL).map_err(FindingError::unreadable(file))?;
    let kept: KeptFinding = serde_json::from_str(&text).map_err(FindingError::unreadable(file))?;
    if kept.format != FORMAT {
        let reason = format!("format {}, this program reads {FORMAT}", kept.format);
        return Err(FindingError::unreadable(file)(reason));
    }
    let id = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Named { id, kept })
}
