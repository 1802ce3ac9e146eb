//! What to do next with data sets and with judging detectors.

use plumbline_engine::View;
use plumbline_engine::view::LabelState;
use plumbline_widgets::format;

use super::sentence::{Guidance, say};
use crate::operator::{Action, LabelsAction, ScoresAction};

pub(super) fn images(view: &View) -> Guidance {
    let labels = &view.labels;
    if let Some(why) = &labels.unsaved {
        return trouble(why).then("Save again", Action::Labels(LabelsAction::SaveAgain));
    }
    if let Some(why) = &labels.failed {
        return trouble(why).then("Open a data set…", Action::Labels(LabelsAction::Open));
    }
    if labels.import.is_some() {
        return say("Check what the import would do; nothing is written before you accept it.")
            .then("Accept the import", Action::Labels(LabelsAction::AcceptImport));
    }
    if labels.set.is_none() {
        return say("Images with boxes teach a detector. Open a data set, or make a new one.")
            .then("Open a data set…", Action::Labels(LabelsAction::Open));
    }
    if labels.images.is_empty() {
        return say("The data set has no images yet. Add what the eyes see now, or import a data set.")
            .then("Add the present pair", Action::Labels(LabelsAction::Capture));
    }
    let Some(shown) = &labels.shown else { return say("Choose an image in the list.") };
    if let Some(why) = &shown.locked {
        return trouble(why);
    }
    if !shown.proposals.is_empty() {
        let boxes = boxes(shown.proposals.len());
        return say(format!("{boxes} proposed, drawn dashed: correct or delete what is wrong, then accept."))
            .then(format!("Accept {boxes}"), Action::Labels(LabelsAction::AcceptProposals));
    }
    let state = labels.images.get(shown.index).map(|image| image.state);
    let left = labels.counts.unlabeled;
    match state {
        Some(LabelState::Unlabeled) if labels.detector.is_some() => {
            say("Drag to draw a box, 1–9 choose its class. The detector can propose boxes (P).")
                .then("Propose boxes", Action::Labels(LabelsAction::Propose))
        }
        Some(LabelState::Unlabeled) => {
            say("Drag to draw a box; 1–9 choose its class. C copies from the image before.")
        }
        _ if left > 0 => say(format!("Saved. {} left without labels.", format::count(left, "image")))
            .then("Next without labels", Action::Labels(LabelsAction::NextUnlabeled)),
        _ => say("All images are labeled. Export the data set to train with it.")
            .then("Export…", Action::Labels(LabelsAction::Export)),
    }
}

/// A sentence as it was written: it may begin with the name of a file.
fn trouble(why: &str) -> Guidance {
    Guidance { sentence: why.to_owned(), warning: true, next: None }
}

/// "1 box", "3 boxes".
fn boxes(n: usize) -> String {
    format::count(n, "box")
}

pub(super) fn scores(view: &View) -> Guidance {
    let scores = &view.scores;
    if scores.evaluating.is_some() {
        return say("The detectors are being judged; the table follows.");
    }
    if let Some(why) = &scores.failed {
        return trouble(why).then("Evaluate", Action::Scores(ScoresAction::Evaluate));
    }
    if scores.set.is_none() {
        return say("Choose a labeled data set that the detectors were not trained on.")
            .then("Choose a data set…", Action::Scores(ScoresAction::ChooseSet));
    }
    let chosen = scores.models.iter().filter(|model| model.chosen).count();
    if chosen == 0 {
        return say("Choose one or more detectors.")
            .then("Add a detector…", Action::Scores(ScoresAction::AddModels));
    }
    match &scores.table {
        None => say(format!("Next: judge {} on the data set.", format::count(chosen, "detector")))
            .then("Evaluate", Action::Scores(ScoresAction::Evaluate)),
        Some(_) if scores.cell.is_some() => {
            say("These images fell into the cell. Click one to see it large.")
        }
        Some(_) => say("Click a cell of the confusion matrix to see its images.")
            .then("Evaluate again", Action::Scores(ScoresAction::Evaluate)),
    }
}
