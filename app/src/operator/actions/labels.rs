//! What can be asked for by name of data sets and of judging detectors.

use std::borrow::Cow;

use egui::{Key, KeyboardShortcut, Modifiers};
use plumbline_engine::{Command, LabelsCommand, ScoresCommand, View};
use serde::Serialize;

/// Of the lab's own data sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelsAction {
    /// Chooses the folder of a data set.
    Open,
    /// Chooses a folder for a new data set.
    Create,
    /// Closes the data set.
    Close,
    /// Adds the newest pair.
    Capture,
    /// The image before.
    Previous,
    /// The image after.
    Next,
    /// The next image without labels.
    NextUnlabeled,
    /// Takes back the last change of the shown image.
    Undo,
    /// Does it again.
    Redo,
    /// Deletes the chosen box.
    DeleteBox,
    /// The chosen box is of this class, and so are new ones.
    Class(usize),
    /// Takes over the boxes of the image before.
    CopyPrevious,
    /// Lets the detector propose.
    Propose,
    /// Takes over what is proposed.
    AcceptProposals,
    /// Forgets it.
    DiscardProposals,
    /// Labeled, without a box.
    NothingHere,
    /// Marks the image to be looked at again, or not.
    ToggleToCheck,
    /// Tries again to write.
    SaveAgain,
    /// Writes a data set to train with.
    Export,
    /// Reads another data set into this one.
    Import,
    /// Does what was shown of it.
    AcceptImport,
    /// Forgets it.
    DiscardImport,
}

impl LabelsAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 21] = [
        Self::Open,
        Self::Create,
        Self::Close,
        Self::Capture,
        Self::Previous,
        Self::Next,
        Self::NextUnlabeled,
        Self::Undo,
        Self::Redo,
        Self::DeleteBox,
        Self::CopyPrevious,
        Self::Propose,
        Self::AcceptProposals,
        Self::DiscardProposals,
        Self::NothingHere,
        Self::ToggleToCheck,
        Self::SaveAgain,
        Self::Export,
        Self::Import,
        Self::AcceptImport,
        Self::DiscardImport,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Open => "Open a data set…",
            Self::Create => "New data set…",
            Self::Close => "Close the data set",
            Self::Capture => "Add the present pair to the data set",
            Self::Previous => "Previous image",
            Self::Next => "Next image",
            Self::NextUnlabeled => "Next image without labels",
            Self::Undo => "Undo the last change of the boxes",
            Self::Redo => "Redo the change of the boxes",
            Self::DeleteBox => "Delete the chosen box",
            Self::Class(_) => "Class of the chosen box",
            Self::CopyPrevious => "Copy the boxes of the image before",
            Self::Propose => "Propose boxes with the detector",
            Self::AcceptProposals => "Accept the proposed boxes",
            Self::DiscardProposals => "Discard the proposed boxes",
            Self::NothingHere => "Nothing is on this image",
            Self::ToggleToCheck => "Mark the image to be checked",
            Self::SaveAgain => "Save the boxes again",
            Self::Export => "Export the data set for training…",
            Self::Import => "Import a YOLO data set…",
            Self::AcceptImport => "Accept the import",
            Self::DiscardImport => "Discard the import",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let labels = &view.labels;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        let open = labels.set.is_some();
        if labels.working.is_some() && matches!(self, Self::Open | Self::Create | Self::Import | Self::Export)
        {
            return Some("a data set is being read or written".into());
        }
        match self {
            Self::Open | Self::Create => None,
            Self::SaveAgain => when(labels.unsaved.is_some(), "everything is on disk"),
            Self::AcceptImport | Self::DiscardImport => when(labels.import.is_some(), "no import is waiting"),
            _ if !open => Some("no data set is open".into()),
            Self::Close | Self::Import => None,
            Self::Capture => when(view.live.raw.is_some(), "there is no image yet"),
            Self::Export => when(labels.counts.labeled + labels.counts.to_check > 0, "no image is labeled"),
            _ => self.refusal_on_image(view),
        }
    }

    /// Keys on the screen of images; elsewhere they mean other things.
    pub fn keys(self) -> Option<KeyboardShortcut> {
        let plain = |key| Some(KeyboardShortcut::new(Modifiers::NONE, key));
        match self {
            Self::Previous => plain(Key::ArrowLeft),
            Self::Next => plain(Key::ArrowRight),
            Self::NextUnlabeled => plain(Key::N),
            Self::Capture => plain(Key::A),
            Self::CopyPrevious => plain(Key::C),
            Self::Propose => plain(Key::P),
            Self::AcceptProposals => plain(Key::Enter),
            Self::DiscardProposals => plain(Key::X),
            Self::NothingHere => plain(Key::B),
            Self::ToggleToCheck => plain(Key::K),
            Self::DeleteBox => plain(Key::Delete),
            Self::Undo => Some(KeyboardShortcut::new(Modifiers::COMMAND, Key::Z)),
            Self::Redo => Some(KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)),
            _ => None,
        }
    }

    fn refusal_on_image(self, view: &View) -> Option<Cow<'static, str>> {
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        let Some(shown) = &view.labels.shown else { return Some("no image is shown".into()) };
        if let (Some(why), false) =
            (&shown.locked, matches!(self, Self::Previous | Self::Next | Self::NextUnlabeled))
        {
            return Some(why.clone().into());
        }
        match self {
            Self::Previous => when(shown.index > 0, "this is the first image"),
            Self::Next => when(shown.index + 1 < view.labels.images.len(), "this is the last image"),
            Self::NextUnlabeled => when(next_unlabeled(view).is_some(), "no other image is without labels"),
            Self::Undo => when(shown.can_undo, "nothing was changed on this image"),
            Self::Redo => when(shown.can_redo, "nothing was taken back on this image"),
            Self::CopyPrevious => when(shown.can_copy, "no image before has boxes"),
            Self::Propose if shown.proposing => Some("the detector is at work".into()),
            Self::Propose => when(view.labels.detector.is_some(), "no detector is chosen"),
            Self::AcceptProposals | Self::DiscardProposals => {
                when(!shown.proposals.is_empty(), "nothing is proposed")
            }
            _ => None,
        }
    }

    /// The command that it stands for; `None` where the window has to ask or to look first.
    pub fn command(self, view: &View) -> Option<Command> {
        let shown = view.labels.shown.as_ref();
        Some(
            match self {
                Self::Close => LabelsCommand::Close,
                Self::Capture => LabelsCommand::Capture,
                Self::Previous => LabelsCommand::Step(-1),
                Self::Next => LabelsCommand::Step(1),
                Self::NextUnlabeled => LabelsCommand::Choose { image: next_unlabeled(view)? },
                Self::Undo => LabelsCommand::Undo,
                Self::Redo => LabelsCommand::Redo,
                Self::CopyPrevious => LabelsCommand::CopyPrevious,
                Self::Propose => LabelsCommand::Propose,
                Self::AcceptProposals => LabelsCommand::AcceptProposals,
                Self::DiscardProposals => LabelsCommand::DiscardProposals,
                Self::NothingHere => LabelsCommand::NothingHere,
                Self::ToggleToCheck => {
                    let state = view.labels.images.get(shown?.index)?.state;
                    LabelsCommand::ToCheck(state != plumbline_engine::view::LabelState::ToCheck)
                }
                Self::SaveAgain => LabelsCommand::SaveAgain,
                Self::AcceptImport => LabelsCommand::AcceptImport,
                Self::DiscardImport => LabelsCommand::DiscardImport,
                Self::Open
                | Self::Create
                | Self::DeleteBox
                | Self::Class(_)
                | Self::Export
                | Self::Import => return None,
            }
            .into(),
        )
    }
}

/// Name of the next image without labels, from the start again at the end.
fn next_unlabeled(view: &View) -> Option<String> {
    let images = &view.labels.images;
    let shown = view.labels.shown.as_ref()?.index;
    let free = |i: &usize| {
        let image = &images[*i];
        image.state == plumbline_engine::view::LabelState::Unlabeled && image.unusable.is_none()
    };
    let next = (shown + 1..images.len()).find(free).or_else(|| (0..shown.min(images.len())).find(free))?;
    Some(images[next].name.clone())
}

/// Of judging detectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScoresAction {
    /// Chooses ONNX files.
    AddModels,
    /// Chooses the data set.
    ChooseSet,
    /// Judges on the data set that is open for labeling.
    UseOpenSet,
    /// Judges.
    Evaluate,
    /// Writes the table.
    ExportCsv,
    /// Closes the cell of the confusion matrix.
    CloseCell,
}

impl ScoresAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 6] = [
        Self::AddModels,
        Self::ChooseSet,
        Self::UseOpenSet,
        Self::Evaluate,
        Self::ExportCsv,
        Self::CloseCell,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::AddModels => "Add a detector to judge…",
            Self::ChooseSet => "Choose the data set to judge on…",
            Self::UseOpenSet => "Judge on the open data set",
            Self::Evaluate => "Evaluate",
            Self::ExportCsv => "Export the scores (CSV)…",
            Self::CloseCell => "Close the cell of the confusion matrix",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let scores = &view.scores;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::AddModels | Self::ChooseSet => None,
            Self::UseOpenSet => when(view.labels.set.is_some(), "no data set is open for labeling"),
            Self::Evaluate if scores.evaluating.is_some() => Some("detectors are being judged".into()),
            Self::Evaluate if scores.set.is_none() => Some("no data set is chosen".into()),
            Self::Evaluate => when(scores.models.iter().any(|model| model.chosen), "no detector is chosen"),
            Self::ExportCsv => when(scores.table.is_some(), "nothing was judged yet"),
            Self::CloseCell => when(scores.cell.is_some(), "no cell is open"),
        }
    }

    /// The command that it stands for; `None` where the window has to ask first.
    pub fn command(self, view: &View) -> Option<Command> {
        Some(
            match self {
                Self::UseOpenSet => {
                    ScoresCommand::ChooseSet { path: view.labels.set.as_ref()?.folder.clone() }
                }
                Self::Evaluate => ScoresCommand::Evaluate,
                Self::CloseCell => ScoresCommand::CloseCell,
                Self::AddModels | Self::ChooseSet | Self::ExportCsv => return None,
            }
            .into(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_data_set_the_reasons_are_said() {
        let view = View::default();
        assert_eq!(LabelsAction::Open.refusal(&view), None);
        assert_eq!(LabelsAction::Undo.refusal(&view).as_deref(), Some("no data set is open"));
        assert_eq!(LabelsAction::AcceptImport.refusal(&view).as_deref(), Some("no import is waiting"));
        assert_eq!(ScoresAction::Evaluate.refusal(&view).as_deref(), Some("no data set is chosen"));
    }
}
