//! The image that is shown: its pixels, its boxes, and what of them is on disk.

use super::super::command::BoxEdit;
use super::super::history::{Bounds, EditError};
use super::super::images::{Image, eye_word};
use super::super::view::LabelBox;
use super::super::work::{Context, LabelsWork};
use super::set::Saving;
use super::{LabelsWorkflow, Set};

impl LabelsWorkflow {
    pub(super) fn choose(&mut self, name: &str, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        if let Some(index) = set.images.iter().position(|image| image.entry.name == name) {
            set.shown = Some(index);
            self.load(context);
        }
    }

    pub(super) fn step(&mut self, by: i64, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        let (Some(shown), Some(last)) = (set.shown, set.images.len().checked_sub(1)) else { return };
        let to = (shown as i64).saturating_add(by).clamp(0, last as i64);
        set.shown = usize::try_from(to).ok();
        self.load(context);
    }

    /// Reads the shown image, then the one after it.
    pub(super) fn load(&mut self, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return };
        let Some(shown) = set.shown else { return };
        let wanted = [shown, shown + 1].into_iter().filter_map(|i| set.images.get(i));
        let usable = wanted.filter(|image| image.entry.unusable.is_none());
        let missing = usable.map(|image| &image.entry).find(|entry| !self.loaded.has(&entry.name));
        if let (Some(entry), false) = (missing, self.loaded.is_reading()) {
            let work = LabelsWork::Load { name: entry.name.clone(), file: entry.image.clone() };
            self.loaded.reading(context.start(work));
        }
    }

    pub(super) fn edit(&mut self, name: &str, edit: BoxEdit, context: &mut Context<'_>) {
        let shown = self.set.as_ref().and_then(Set::shown_image);
        if shown.is_none_or(|image| image.entry.name != name) {
            return context
                .refuse("The image was changed meanwhile. Do that again on the image that is shown.");
        }
        self.change(context, |image, bounds| image.history.apply(edit, bounds));
    }

    /// Changes the shown image and saves it.
    pub(super) fn change(
        &mut self,
        context: &mut Context<'_>,
        change: impl FnOnce(&mut Image, &Bounds) -> Result<bool, EditError>,
    ) {
        let Some(set) = &mut self.set else { return context.refuse("Open a data set first.") };
        let classes = set.names.len();
        let Some((index, image)) = set.shown.and_then(|i| Some((i, set.images.get_mut(i)?))) else {
            return context.refuse("Choose an image first.");
        };
        if let Some(why) = image.entry.locked.as_ref().or(image.entry.unusable.as_ref()) {
            return context.refuse(why);
        }
        let bounds = Bounds { size_px: image.entry.size_px, classes };
        match change(image, &bounds) {
            Err(why) => context.refuse(why),
            Ok(false) => {}
            Ok(true) => {
                image.revision += 1;
                set.dirty.insert(index);
                set.check(index);
                self.save(context);
            }
        }
    }

    /// Boxes of the image before, of the same eye where there is one.
    pub(in crate::labels) fn boxes_before(&self) -> Vec<LabelBox> {
        let before = || {
            let set = self.set.as_ref()?;
            let shown = set.shown?;
            let eye = eye_word(&set.images.get(shown)?.entry.name);
            let mut earlier = set.images[..shown].iter().rev().filter(|i| !i.history.boxes().is_empty());
            let same_eye = earlier.clone().find(|i| eye_word(&i.entry.name) == eye);
            same_eye.or_else(|| earlier.next()).map(|image| image.history.boxes().to_vec())
        };
        before().unwrap_or_default()
    }

    pub(super) fn mark(&mut self, to_check: bool, context: &mut Context<'_>) {
        let Some(image) = self.set.as_mut().and_then(Set::shown_mut) else {
            return context.refuse("Choose an image first.");
        };
        image.to_check = to_check;
        if let Some(set) = &mut self.set {
            set.to_check_dirty = true;
        }
        self.save(context);
    }

    /// Writes what is in memory only. One write at a time, so that a later one is never overtaken.
    pub(super) fn save(&mut self, context: &mut Context<'_>) {
        if self.saving.is_some() {
            return;
        }
        let Some(set) = &mut self.set else { return };
        let files = set.files_to_write();
        if files.is_empty() {
            return;
        }
        let (images, to_check) = (std::mem::take(&mut set.dirty), std::mem::take(&mut set.to_check_dirty));
        let job = context.start(LabelsWork::Save { files });
        self.saving = Some(Saving { job, images, to_check });
    }

    /// What is in memory only, to be written before the program ends.
    pub fn last_write(&self) -> Option<LabelsWork> {
        let mut set = self.set.clone()?;
        if let Some(saving) = &self.saving {
            set.dirty.extend(&saving.images);
            set.to_check_dirty |= saving.to_check;
        }
        let files = set.files_to_write();
        (!files.is_empty()).then_some(LabelsWork::Save { files })
    }
}
