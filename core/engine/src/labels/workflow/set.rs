//! The open data set: its images, which one is shown, what is not on disk yet.

use std::collections::BTreeSet;
use std::path::PathBuf;

use plumbline_model::ClassNames;
use plumbline_vision::yolo_set::{LabeledImage, YoloSet};

use super::super::images::Image;
use super::super::store::{self, OpenedSet};
use crate::ground::jobs::JobId;
use crate::labels::view::{LabelProblem, LabelState};

/// The open data set.
#[derive(Clone, Debug)]
pub struct Set {
    pub folder: PathBuf,
    pub names: ClassNames,
    pub images: Vec<Image>,
    pub shown: Option<usize>,
    /// What is wrong with the set as a whole.
    pub problems: Vec<String>,
    /// Images whose labels on disk are not those in memory.
    pub(super) dirty: BTreeSet<usize>,
    pub(super) to_check_dirty: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Saving {
    pub(super) job: JobId,
    pub(super) images: BTreeSet<usize>,
    pub(super) to_check: bool,
}

impl Set {
    pub(super) fn new(set: OpenedSet) -> Self {
        let mut opened = Self {
            folder: set.folder,
            names: set.names,
            images: set.entries.into_iter().map(Image::new).collect(),
            shown: None,
            problems: set.problems,
            dirty: BTreeSet::new(),
            to_check_dirty: false,
        };
        (0..opened.images.len()).for_each(|index| opened.check(index));
        opened
    }

    pub(super) fn check(&mut self, index: usize) {
        let image = &mut self.images[index];
        let entry = &image.entry;
        image.problems =
            super::super::checks::problems(&entry.name, image.history.boxes(), entry.size_px, &self.names)
                .into();
    }

    pub fn shown_image(&self) -> Option<&Image> {
        self.images.get(self.shown?)
    }

    pub(super) fn shown_mut(&mut self) -> Option<&mut Image> {
        self.images.get_mut(self.shown?)
    }

    /// Everything wrong with boxes.
    pub fn all_problems(&self) -> impl Iterator<Item = &LabelProblem> {
        self.images.iter().flat_map(|image| image.problems.iter())
    }

    pub(super) fn files_to_write(&self) -> Vec<(PathBuf, Option<String>)> {
        let dirty = self.dirty.iter().filter_map(|index| self.images.get(*index));
        let mut files: Vec<(PathBuf, Option<String>)> =
            dirty.map(|image| (image.entry.label_file.clone(), image.label_text())).collect();
        if self.to_check_dirty {
            let marked = self.images.iter().filter(|image| image.to_check);
            let (file, text) = store::to_check_file(&self.folder, marked.map(|image| &*image.entry.name));
            files.push((file, (!text.is_empty()).then_some(text)));
        }
        files
    }

    /// What a detector can learn from: labeled, readable, not marked to be looked at again.
    pub fn for_training(&self) -> YoloSet {
        let usable = self.images.iter().filter(|image| {
            let entry = &image.entry;
            image.state() == LabelState::Labeled && entry.locked.is_none() && entry.unusable.is_none()
        });
        let labeled = usable.map(|image| LabeledImage {
            path: image.entry.image.clone(),
            size_px: image.entry.size_px,
            scene: image.entry.scene.clone(),
            boxes: image.labeled(),
            split: None,
        });
        YoloSet { names: self.names.clone(), images: labeled.collect() }
    }
}
