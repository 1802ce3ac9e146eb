//! What is asked of others: a pair of the eyes, the detector, folders elsewhere.

use std::path::PathBuf;

use plumbline_vision::yolo_set::SplitOptions;

use super::super::work::LabelsWork;
use super::{LabelsAround, LabelsWorkflow, Set};
use crate::detect::command::DetectorChoice;
use crate::labels::work::Context;

impl LabelsWorkflow {
    pub(super) fn capture(&mut self, around: &LabelsAround, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return context.refuse("Open a data set first, or make a new one.") };
        let Some(frame) = around.newest.clone() else {
            return context.refuse("There is no image yet. Open a source on Live first.");
        };
        let seq = (around.opened, frame.stamp.seq);
        if self.captured_seq == Some(seq) {
            return context
                .refuse("This pair is in the data set already. Wait for the next one, or step to it.");
        }
        if self.capturing.is_some() {
            return context.refuse("The pair before is being written. Capture again in a moment.");
        }
        self.captured_seq = Some(seq);
        let (folder, captured) = (set.folder.clone(), context.time.day_at(frame.stamp.captured_at));
        self.capturing = Some(context.start(LabelsWork::Capture { frame, captured, folder }));
    }

    pub(super) fn propose(&mut self, around: &LabelsAround, context: &mut Context<'_>) {
        if self.proposing.is_some() {
            return context.refuse("The detector is at work. Wait for it.");
        }
        let Some(image) = self.set.as_ref().and_then(Set::shown_image) else {
            return context.refuse("Choose an image first.");
        };
        if let Some(why) = &image.entry.locked {
            return context.refuse(why);
        }
        if around.detector == DetectorChoice::Off {
            return context.refuse("The detector is switched off. Choose one on Live first.");
        }
        let name = image.entry.name.clone();
        let Some(Ok(pixels)) = self.loaded.get(&name).cloned() else {
            return context.refuse("The image is not read yet. Try again in a moment.");
        };
        let ready = self.proposer.as_ref().filter(|(choice, _)| *choice == around.detector);
        let work = LabelsWork::Propose {
            open: around.open.clone(),
            choice: around.detector.clone(),
            provider: around.provider,
            ready: ready.map(|(_, detector)| detector.clone()),
            name: name.clone(),
            image: pixels,
            names: self.set.as_ref().map(|set| set.names.clone()).unwrap_or_default(),
            confidence: around.confidence,
        };
        self.proposing = Some((context.start(work), name));
    }

    pub(super) fn export(
        &mut self,
        folder: PathBuf,
        train_percent: u8,
        seed: u64,
        context: &mut Context<'_>,
    ) {
        let Some(set) = &self.set else { return context.refuse("Open a data set first.") };
        let labeled = set.for_training();
        if labeled.images.is_empty() {
            return context
                .refuse("No image is labeled. Draw boxes first, or say that nothing is on an image.");
        }
        let val_fraction = 1.0 - f64::from(train_percent) / 100.0;
        let options = SplitOptions { val_fraction, seed, ..SplitOptions::default() };
        self.begin(LabelsWork::Export { set: Box::new(labeled), folder, options }, context);
    }

    pub(super) fn plan_import(&mut self, path: PathBuf, context: &mut Context<'_>) {
        let Some(set) = &self.set else {
            return context.refuse("Open a data set to import into first, or make a new one.");
        };
        let there = set.images.iter().map(|image| image.entry.name.clone()).collect();
        let work = LabelsWork::PlanImport { path, names: set.names.clone(), there };
        self.import = None;
        self.begin(work, context);
    }

    pub(super) fn accept_import(&mut self, context: &mut Context<'_>) {
        let (Some(plan), Some(set)) = (self.import.clone(), &self.set) else {
            return context.refuse("No import is waiting.");
        };
        let work = LabelsWork::Import { plan, folder: set.folder.clone(), memory: self.memory.clone() };
        self.begin(work, context);
        self.import = None;
    }
}
