//! The images of an open data set: their boxes, and the few whose pixels are in memory.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::files::{self, FileError};
use plumbline_vision::yolo_set::{LabeledBox, label_text};

use super::history::BoxHistory;
use super::store::Entry;
use super::view::{LabelProblem, LabelState, ProposedBox};
use crate::ground::jobs::JobId;

/// An image of the open data set.
#[derive(Clone, Debug)]
pub struct Image {
    /// As it was read.
    pub entry: Entry,
    /// Its boxes.
    pub history: BoxHistory,
    /// Counts up with every change.
    pub revision: u64,
    /// Whether it is marked to be looked at again.
    pub to_check: bool,
    /// What a detector proposes.
    pub proposals: Vec<ProposedBox>,
    /// What should be looked at.
    pub problems: Arc<[LabelProblem]>,
}

impl Image {
    /// As it was read.
    pub fn new(entry: Entry) -> Self {
        Self {
            history: BoxHistory::new(entry.boxes.clone(), entry.labeled),
            revision: 0,
            to_check: entry.to_check,
            proposals: Vec::new(),
            problems: Arc::default(),
            entry,
        }
    }

    /// How far it is.
    pub fn state(&self) -> LabelState {
        match (self.to_check, self.history.is_labeled()) {
            (true, _) => LabelState::ToCheck,
            (false, true) => LabelState::Labeled,
            (false, false) => LabelState::Unlabeled,
        }
    }

    pub fn labeled(&self) -> Vec<LabeledBox> {
        let boxes = self.history.boxes().iter();
        boxes.map(|label| LabeledBox { class: label.class, area: label.area }).collect()
    }

    /// The text of its label file; `None`: it has none.
    pub fn label_text(&self) -> Option<String> {
        self.history.is_labeled().then(|| label_text(&self.labeled(), self.entry.size_px))
    }
}

/// Which eye a name speaks of.
pub fn eye_word(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    ["left", "right"].into_iter().find(|eye| name.contains(eye))
}

/// Why an image of a data set cannot be shown.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be read ({why}). Restore the file or take it out of the data set.", .file.display())]
pub struct Unreadable {
    /// Which image.
    file: PathBuf,
    /// What is wrong with it.
    why: FileError,
}

/// The pixels of an image, or why there are none.
pub type Pixels = Result<Arc<RgbImage>, Arc<Unreadable>>;

/// Reads an image.
///
/// # Errors
/// When there is no image in the file.
pub fn read_image(file: &Path) -> Result<RgbImage, Unreadable> {
    let image = files::read_image(file).map(image::DynamicImage::into_rgb8);
    image.map_err(|why| Unreadable { file: file.to_owned(), why })
}

/// Images whose pixels are kept.
const KEPT: usize = 12;

/// Pixels of the images looked at last.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    images: VecDeque<(String, Pixels)>,
    reading: Option<JobId>,
}

impl Loaded {
    /// The pixels of an image, or why there are none.
    pub fn get(&self, name: &str) -> Option<&Pixels> {
        self.images.iter().find(|(known, _)| known == name).map(|(_, pixels)| pixels)
    }

    /// Whether an image was read.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// Whether an image is being read.
    pub fn is_reading(&self) -> bool {
        self.reading.is_some()
    }

    /// An image is being read.
    pub fn reading(&mut self, job: JobId) {
        self.reading = Some(job);
    }

    /// It was read.
    pub fn read(&mut self, job: JobId, name: String, pixels: Pixels) {
        self.reading.take_if(|reading| *reading == job);
        if !self.has(&name) {
            self.images.push_back((name, pixels));
        }
        if self.images.len() > KEPT {
            self.images.pop_front();
        }
    }

    /// It was not read.
    pub fn gave_nothing(&mut self, job: JobId) {
        self.reading.take_if(|reading| *reading == job);
    }
}
