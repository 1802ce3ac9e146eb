//! Accepted calibrations on disk. Each stays in a file of its own for ever; a small file says
//! which one is in use. Every write goes to a temporary name first.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_model::files::{self, FileError, Size};
use plumbline_model::formats::native;
use plumbline_model::{FormatError, StereoCalibration, counted};
use serde::{Deserialize, Serialize};

use super::view::EarlierCalibration;
use crate::ground::shelf::Shelf;
use crate::ground::text::sentence;

/// Accepted calibrations in a folder.
#[derive(Clone, Debug)]
pub struct Store {
    shelf: Shelf,
}

/// Why something accepted cannot be kept or found.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file system says no.
    #[error(
        "{path} cannot be used ({error}). Check that the disk is connected, has free space and can be written; the calibration in use stays."
    )]
    Io {
        /// What was tried to use.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A file itself.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] FileError),
    /// The calibration's own file.
    #[error("{0}")]
    Calibration(#[from] FormatError),
    /// There is none of that id.
    #[error("There is no accepted calibration {0}; choose one from the list.")]
    NoSuchCalibration(String),
}

/// What is written beside each calibration, so that a list needs not read them all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Name of its files.
    #[serde(skip)]
    pub id: String,
    /// When it was accepted.
    pub accepted: Timestamp,
    /// For people.
    pub description: String,
}

const IN_USE: &str = "in-use.txt";
/// What stands there when none is in use, although there are some; no id begins like this.
const NONE: &str = "none";
const ENTRY: &str = "toml";

impl Store {
    /// In this folder, which is made when something is accepted.
    pub fn new(folder: PathBuf) -> Self {
        Self { shelf: Shelf::new(folder, "yaml") }
    }

    /// Those of the world with this folder.
    pub fn of_world(folder: &Path) -> Self {
        Self::new(folder.join("calibrations"))
    }

    /// Keeps a calibration and makes it the one in use.
    pub fn accept(&self, calibration: &StereoCalibration, accepted: Timestamp) -> Result<Entry, StoreError> {
        self.shelf.make_folder().map_err(self.io())?;
        let id = self.shelf.free_name(accepted, "");
        let entry = Entry { id: id.clone(), accepted, description: describe(calibration) };
        native::write(calibration, &self.shelf.file(&id))?;
        let text = toml::to_string(&entry).unwrap_or_default();
        files::write(&self.entry_file(&id), &text)?;
        files::write(&self.shelf.folder().join(IN_USE), &id)?;
        Ok(entry)
    }

    /// Puts one of those that are kept in use; `None`: none.
    ///
    /// # Errors
    /// When there is none of that id, or it cannot be read or written; then what was in use stays.
    pub fn use_earlier(&self, id: Option<&str>) -> Result<(), StoreError> {
        if let Some(id) = id {
            self.load(id)?;
        }
        self.shelf.make_folder().map_err(self.io())?;
        Ok(files::write(&self.shelf.folder().join(IN_USE), id.unwrap_or(NONE))?)
    }

    /// Whether it was said that none is in use.
    ///
    /// # Errors
    /// When there is a file that cannot be read.
    pub fn is_none_in_use(&self) -> Result<bool, StoreError> {
        Ok(self.said()?.trim() == NONE)
    }

    /// What is said to be in use; empty where nothing is said.
    fn said(&self) -> Result<String, StoreError> {
        match files::read_text(&self.shelf.folder().join(IN_USE), Size::SHORT) {
            Err(error) if !error.is_absent() => Err(error.into()),
            read => Ok(read.unwrap_or_default()),
        }
    }

    /// All that were accepted, newest first.
    pub fn list(&self) -> Result<Vec<EarlierCalibration>, StoreError> {
        let ids = self.shelf.names().map_err(self.io())?;
        let in_use = self.said()?;
        let mut found: Vec<EarlierCalibration> = ids
            .into_iter()
            .map(|id| {
                let entry = self.entry(&id);
                let in_use = id == in_use.trim();
                EarlierCalibration { id, accepted: entry.accepted, description: entry.description, in_use }
            })
            .collect();
        // Ids begin with the time, so they decide where two were accepted in the same moment.
        found.sort_by(|a, b| (b.accepted, &b.id).cmp(&(a.accepted, &a.id)));
        Ok(found)
    }

    /// Reads one.
    pub fn load(&self, id: &str) -> Result<(StereoCalibration, Timestamp), StoreError> {
        let file = self.shelf.file_inside(id).filter(|file| file.is_file());
        let file = file.ok_or_else(|| StoreError::NoSuchCalibration(id.to_owned()))?;
        Ok((native::read(&file)?, self.entry(id).accepted))
    }

    /// The calibration in use; if its file is damaged, the newest that is not. `None` when none was
    /// ever accepted, or none is to be used.
    ///
    /// # Errors
    /// When none of those that were accepted can be read.
    pub fn in_use(&self) -> Result<Option<StereoCalibration>, StoreError> {
        if self.is_none_in_use()? {
            return Ok(None);
        }
        let mut entries = self.list()?;
        entries.sort_by_key(|entry| !entry.in_use);
        let mut first_error = None;
        for entry in entries {
            match self.load(&entry.id) {
                Ok((calibration, _)) => return Ok(Some(calibration)),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        first_error.map_or(Ok(None), Err)
    }

    fn entry_file(&self, id: &str) -> PathBuf {
        self.shelf.file(id).with_extension(ENTRY)
    }

    /// What is written beside a calibration; from its file if that was lost.
    fn entry(&self, id: &str) -> Entry {
        let text = files::read_text(&self.entry_file(id), Size::SHORT).unwrap_or_default();
        match toml::from_str::<Entry>(&text) {
            Ok(entry) => Entry { id: id.to_owned(), ..entry },
            Err(_) => {
                let changed = std::fs::metadata(self.shelf.file(id)).and_then(|data| data.modified());
                let accepted =
                    changed.ok().and_then(|time| Timestamp::try_from(time).ok()).unwrap_or_default();
                Entry { id: id.to_owned(), accepted, description: id.to_owned() }
            }
        }
    }

    fn io(&self) -> impl FnOnce(std::io::Error) -> StoreError {
        let path = self.shelf.folder().to_owned();
        move |error| StoreError::Io { path, error }
    }
}

/// For the list: "30 pairs, 0.094 px".
pub fn describe(calibration: &StereoCalibration) -> String {
    let baseline = format!("eyes {:.2} mm apart", calibration.cameras.baseline_m() * 1000.0);
    match &calibration.summary {
        Some(summary) => {
            let pairs = counted(calibration.per_pair.len(), "pair");
            format!("{pairs}, {:.3} px, {baseline}", summary.rms_stereo_px)
        }
        None => baseline,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eyes::place::nominal_cameras;
    use plumbline_model::ModelKind;

    fn calibration(width_px: u32) -> StereoCalibration {
        StereoCalibration::bare(nominal_cameras((width_px, 480), ModelKind::Fisheye))
    }

    #[test]
    fn what_was_accepted_stays_and_the_last_one_is_in_use() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let store = Store::new(folder.path().join("calibrations"));
        assert_eq!(store.list().expect("an empty list"), []);
        let ids: Vec<String> = [640, 800, 1280]
            .map(|width_px| store.accept(&calibration(width_px), Timestamp::now()).expect("kept").id)
            .to_vec();
        let list = store.list().expect("a list");
        let newest_first: Vec<&String> = ids.iter().rev().collect();
        assert_eq!(list.iter().map(|entry| &entry.id).collect::<Vec<_>>(), newest_first);
        assert_eq!(list.iter().map(|entry| entry.in_use).collect::<Vec<_>>(), [true, false, false]);
        let (first, _) = store.load(&ids[0]).expect("still there");
        assert_eq!(first.cameras, calibration(640).cameras);
    }

    #[test]
    fn an_earlier_one_and_none_can_be_used_again_and_nothing_is_deleted() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let store = Store::new(folder.path().join("calibrations"));
        let ids = [640, 800]
            .map(|width_px| store.accept(&calibration(width_px), Timestamp::now()).expect("kept").id);
        store.use_earlier(Some(&ids[0])).expect("there");
        assert_eq!(store.in_use().expect("read").map(|c| c.cameras.left.width_px), Some(640));
        store.use_earlier(None).expect("written");
        assert_eq!(store.in_use().expect("read"), None);
        assert!(store.list().expect("a list").iter().all(|entry| !entry.in_use));
        assert!(matches!(store.use_earlier(Some("../x")), Err(StoreError::NoSuchCalibration(_))));
        store.use_earlier(Some(&ids[1])).expect("still there");
        assert_eq!(store.in_use().expect("read").map(|c| c.cameras.left.width_px), Some(800));
    }

    #[test]
    fn a_calibration_that_cannot_be_written_leaves_everything_as_it_was() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let store = Store::new(folder.path().to_path_buf());
        let id = store.accept(&calibration(640), Timestamp::now()).expect("kept").id;
        let mut broken = calibration(640);
        broken.cameras.left = plumbline_model::Camera { width_px: 0, ..broken.cameras.left };
        assert!(store.accept(&broken, Timestamp::now()).is_err(), "it would not read back");
        let list = store.list().expect("a list");
        assert_eq!(list.len(), 1);
        assert!(list[0].in_use && list[0].id == id);
    }

    #[test]
    fn an_id_does_not_lead_out_of_the_folder() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let inside = folder.path().join("inside");
        Store::new(inside.clone()).accept(&calibration(640), Timestamp::now()).expect("kept");
        native::write(&calibration(640), &folder.path().join("outside.yaml")).expect("writable");
        assert!(matches!(Store::new(inside).load("../outside"), Err(StoreError::NoSuchCalibration(_))));
    }
}
