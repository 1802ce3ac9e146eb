//! What comes of work: sets that were read, pictures, proposals, files that were written.

use std::path::PathBuf;
use std::sync::Arc;

use super::super::images::{Image, Pixels};
use super::super::store::{Entry, OpenedSet};
use super::super::work::LabelsWork;
use super::{LabelsWorkflow, Set};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::labels::view::ProposedBox;
use crate::labels::work::Context;

/// Small pictures that are read at once.
const THUMBNAILS_AT_ONCE: usize = 24;

impl LabelsWorkflow {
    pub(super) fn opened(&mut self, set: OpenedSet, context: &mut Context<'_>) {
        // A changed set that is read again stays at the image that was shown.
        let shown = self.set.as_ref().and_then(Set::shown_image).map(|image| image.entry.name.clone());
        self.forget_set();
        self.recent = None;
        let mut set = Set::new(set);
        set.shown = shown
            .and_then(|name| set.images.iter().position(|image| image.entry.name == name))
            .or((!set.images.is_empty()).then_some(0));
        self.set = Some(set);
        self.load(context);
        self.read_thumbnails(context);
    }

    pub(super) fn read_thumbnails(&mut self, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return };
        let readable = set.images.iter().map(|image| &image.entry).filter(|entry| entry.unusable.is_none());
        let missing = readable.filter(|entry| !self.thumbnails.contains_key(&entry.name));
        let files: Vec<(String, PathBuf)> =
            missing.take(THUMBNAILS_AT_ONCE).map(|entry| (entry.name.clone(), entry.image.clone())).collect();
        if !files.is_empty() && self.reading_thumbnails.is_none() {
            self.reading_thumbnails = Some(context.start(LabelsWork::Thumbnails { files }));
        }
    }

    pub(super) fn take_thumbnails(&mut self, pictures: Vec<(String, Pixels)>) {
        let Some(set) = &mut self.set else { return };
        let small = Arc::make_mut(&mut self.thumbnails);
        for (name, picture) in pictures {
            match picture {
                Ok(picture) => drop(small.insert(name, picture)),
                Err(why) => {
                    if let Some(image) = set.images.iter_mut().find(|image| image.entry.name == name) {
                        image.entry.unusable = Some(why.to_string());
                    }
                }
            }
        }
    }

    pub(super) fn saved(&mut self, id: JobId, context: &mut Context<'_>) {
        if self.saving.take_if(|saving| saving.job == id).is_some() {
            self.unsaved = None;
        }
        self.save(context);
    }

    pub(super) fn captured(&mut self, entries: Vec<Entry>, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        let first = entries.first().map(|entry| entry.name.clone());
        // Places of images are kept while labels are being written; they are sorted when it is opened again.
        set.images.extend(entries.into_iter().map(Image::new));
        set.shown = first.and_then(|name| set.images.iter().position(|image| image.entry.name == name));
        self.load(context);
        self.read_thumbnails(context);
    }

    pub(super) fn proposed(
        &mut self,
        name: &str,
        boxes: Vec<ProposedBox>,
        unknown: &[String],
        context: &mut Context<'_>,
    ) {
        if !unknown.is_empty() {
            context.notices.add(
                NoticeLevel::Warning,
                format!(
                    "The detector knows classes that the data set does not have ({}); what it finds of them is left out.",
                    unknown.join(", ")
                ),
            );
        }
        let Some(set) = &mut self.set else { return };
        let Some(image) = set.images.iter_mut().find(|image| image.entry.name == name) else { return };
        let there = image.history.boxes();
        let is_new = |proposed: &ProposedBox| {
            !there.iter().any(|label| {
                label.class == proposed.label.class && label.area.iou(&proposed.label.area) > 0.5
            })
        };
        image.proposals = boxes.into_iter().filter(is_new).collect();
        if image.proposals.is_empty() {
            context.notices.add(NoticeLevel::Info, format!("The detector proposes nothing new for {name}."));
        }
    }
}
