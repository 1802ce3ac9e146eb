//! Accepted models on disk. Each stays in a file of its own for ever; a small file says in which
//! order they were in use, so that taking back goes to exactly the one before, also after a restart.
//! `in-use.json` is a copy of the one in use, for other programs.

use std::path::PathBuf;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_correction::{CorrectionModel, Method};
use plumbline_model::files::{self as whole_files, Size};
use serde::{Deserialize, Serialize};

use super::error::ModelError;
use super::files;
use super::screen::Corners;
use crate::ground::shelf::{InUse, Shelf};

/// Version of the list.
const FORMAT: u32 = 1;

/// Accepted models in a folder.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    shelf: Shelf,
}

/// What was in use, oldest first; the last one is in use.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    format: u32,
    /// Short name of the robot.
    pub rig: String,
    /// Oldest first.
    pub entries: Vec<Entry>,
}

/// Something that was accepted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The model and its file's name; `None`: no model.
    pub model: Option<Kept>,
    /// When it was accepted.
    pub accepted: Timestamp,
}

/// A model on disk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    /// Name of its file in `history`, without extension.
    pub file: String,
    /// Its kind.
    pub method: Method,
    /// Where the screen was taken to lie when it was trained or imported, robot frame, m.
    pub screen_m: Corners,
}

impl History {
    /// Nothing was accepted yet.
    pub fn new(rig: &str) -> Self {
        Self { format: FORMAT, rig: rig.to_owned(), entries: Vec::new() }
    }

    /// What is in use.
    pub fn in_use(&self) -> Option<&Kept> {
        self.entries.last()?.model.as_ref()
    }
}

impl Store {
    /// In this folder, which is made when something is accepted.
    pub fn new(folder: PathBuf) -> Self {
        Self { shelf: Shelf::new(folder.join("history"), "json"), folder }
    }

    /// What was accepted before, and the model in use.
    ///
    /// # Errors
    /// A sentence, when there is something that cannot be read or is another robot's.
    pub fn read(&self, rig: &str) -> Result<(History, Option<Arc<CorrectionModel>>), ModelError> {
        let list = self.list();
        let unusable = |reason: String| ModelError::Unusable { list: list.clone(), reason };
        if !whole_files::present(&list).map_err(|error| unusable(error.to_string()))? {
            return Ok((History::new(rig), None));
        }
        let text = whole_files::read_text(&list, Size::TEXT).map_err(|error| unusable(error.to_string()))?;
        let history: History = serde_json::from_str(&text).map_err(|error| unusable(error.to_string()))?;
        if history.format != FORMAT {
            return Err(unusable(format!("format {}, this program reads {FORMAT}", history.format)));
        }
        if history.rig != rig {
            return Err(unusable(format!("it belongs to the robot \"{}\", not to \"{rig}\"", history.rig)));
        }
        let model = history.in_use().map(|kept| self.load(kept)).transpose()?;
        // A crash may have left the copy behind.
        self.copy(history.in_use())?;
        Ok((history, model))
    }

    /// Keeps a model (`None`: none) and makes it the one in use.
    ///
    /// # Errors
    /// A sentence; then what was in use stays so.
    pub fn accept(
        &self,
        history: &History,
        model: Option<(&CorrectionModel, Corners)>,
        accepted: Timestamp,
    ) -> Result<History, ModelError> {
        self.shelf.make_folder().map_err(ModelError::cannot(self.shelf.folder()))?;
        let mut next = history.clone();
        if next.entries.is_empty() {
            next.entries.push(Entry { model: None, accepted });
        }
        let kept = model.map(|(model, screen_m)| {
            let ending = format!("_{}", model.method().name().to_lowercase());
            let file = self.shelf.free_name(accepted, &ending);
            files::write(model, &self.shelf.file(&file)).map(|()| Kept {
                file,
                method: model.method(),
                screen_m,
            })
        });
        next.entries.push(Entry { model: kept.transpose()?, accepted });
        self.write(&next)?;
        Ok(next)
    }

    /// Goes back to what was in use before.
    ///
    /// # Errors
    /// A sentence; then what was in use stays so.
    pub fn undo(&self, history: &History) -> Result<(History, Option<Arc<CorrectionModel>>), ModelError> {
        let mut before = history.clone();
        before.entries.pop();
        let model = before.in_use().map(|kept| self.load(kept)).transpose()?;
        self.write(&before)?;
        Ok((before, model))
    }

    fn load(&self, kept: &Kept) -> Result<Arc<CorrectionModel>, ModelError> {
        let Some(file) = self.shelf.file_inside(&kept.file) else {
            let file = self.shelf.file(&kept.file);
            return Err(ModelError::cannot(&file)("its name leads out of the folder"));
        };
        files::read_own(&file).map(Arc::new)
    }

    fn write(&self, history: &History) -> Result<(), ModelError> {
        let list = self.list();
        let text = serde_json::to_string_pretty(history).map_err(ModelError::cannot(&list))?;
        whole_files::write(&list, &text)?;
        self.copy(history.in_use())
    }

    /// `in-use.json` for other programs.
    fn copy(&self, in_use: Option<&Kept>) -> Result<(), ModelError> {
        let copy = self.folder.join("in-use.json");
        let Some(kept) = in_use else {
            return InUse::new(copy.clone()).forget().map_err(ModelError::cannot(&copy));
        };
        let file = self.shelf.file(&kept.file);
        let text = whole_files::read_text(&file, Size::MODEL);
        let text = text.map_err(ModelError::cannot(&file))?;
        if whole_files::read_text(&copy, Size::MODEL).is_ok_and(|present| present == text) {
            return Ok(());
        }
        Ok(whole_files::write(&copy, &text)?)
    }

    fn list(&self) -> PathBuf {
        self.folder.join("history.json")
    }
}
