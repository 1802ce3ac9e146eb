//! What the window shows of data sets.

use std::sync::Arc;

use super::seen::Seen;
use super::view::{
    LabelCounts, LabelImage, LabelProblem, LabelSetView, LabelState, LabelsView, NotShown, ShownLabels,
};
use super::workflow::{LabelsWorkflow, Set};
use crate::detect::command::DetectorChoice;

impl LabelsWorkflow {
    /// What the window shows.
    pub(super) fn shown(&self, detector: &DetectorChoice) -> LabelsView {
        LabelsView {
            set: self.seen.set.clone(),
            working: self.working,
            failed: self.failed.clone(),
            images: self.seen.images.clone(),
            counts: self.seen.counts,
            thumbnails: self.thumbnails.clone(),
            shown: self.seen.shown.clone(),
            problems: self.seen.problems.clone(),
            unsaved: self.unsaved.clone(),
            detector: (*detector != DetectorChoice::Off).then(|| detector.name()),
            import: self.import.as_ref().map(|plan| Arc::new(plan.view.clone())),
            recent: self.recent.clone(),
        }
    }

    /// Makes anew what is shown, after a change.
    pub(super) fn look(&mut self) {
        self.seen = match &self.set {
            None => Seen::default(),
            Some(set) => {
                let images: Arc<[LabelImage]> = set.images.iter().map(listed).collect();
                Seen {
                    set: Some(Arc::new(LabelSetView {
                        folder: set.folder.clone(),
                        names: set.names.clone(),
                    })),
                    counts: counts(&images),
                    images,
                    problems: problems(set),
                    shown: self.shown_image(set),
                }
            }
        };
    }

    fn shown_image(&self, set: &Set) -> Option<ShownLabels> {
        let index = set.shown?;
        let image = set.images.get(index)?;
        let entry = &image.entry;
        let unusable = entry.unusable.clone().map(|why| Err(NotShown::Unusable(why)));
        Some(ShownLabels {
            name: entry.name.clone(),
            index,
            pixels: unusable.or_else(|| Some(self.loaded.get(&entry.name)?.clone().map_err(NotShown::from))),
            boxes: image.history.boxes().into(),
            revision: image.revision,
            proposals: image.proposals.as_slice().into(),
            proposing: self.proposing.as_ref().is_some_and(|(_, name)| *name == entry.name),
            locked: entry.locked.clone().or_else(|| entry.unusable.clone()),
            can_undo: image.history.can_undo(),
            can_redo: image.history.can_redo(),
            can_copy: !self.boxes_before().is_empty(),
            problems: image.problems.clone(),
        })
    }
}

fn listed(image: &super::images::Image) -> LabelImage {
    let entry = &image.entry;
    LabelImage {
        name: entry.name.clone(),
        state: image.state(),
        boxes: image.history.boxes().len(),
        unusable: entry.unusable.clone().or_else(|| entry.locked.clone()),
        problems: image.problems.len(),
    }
}

fn counts(images: &[LabelImage]) -> LabelCounts {
    let in_state = |state| images.iter().filter(|image| image.state == state).count();
    LabelCounts {
        labeled: in_state(LabelState::Labeled),
        unlabeled: in_state(LabelState::Unlabeled),
        to_check: in_state(LabelState::ToCheck),
        boxes: images.iter().map(|image| image.boxes).sum(),
    }
}

/// Of the set as a whole, of images that cannot be used, of boxes.
fn problems(set: &Set) -> Arc<[LabelProblem]> {
    let whole = set.problems.iter().map(|text| LabelProblem {
        image: String::new(),
        index: None,
        text: text.clone(),
    });
    let unusable = set.images.iter().filter_map(|image| {
        let entry = &image.entry;
        let text = entry.unusable.clone().or_else(|| entry.locked.clone())?;
        Some(LabelProblem { image: entry.name.clone(), index: None, text })
    });
    whole.chain(unusable).chain(set.all_problems().cloned()).collect()
}
