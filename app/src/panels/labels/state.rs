//! How data sets are looked at.

use plumbline_engine::view::{LabelImage, LabelState, LabelsView, ShownLabels};
use plumbline_engine::{BoxEdit, Command, LabelsCommand, View};
use plumbline_model::ClassIndex;
use plumbline_widgets::box_canvas::{CanvasState, Placed};

/// How data sets are looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct LabelsPanels {
    /// Zoom, the chosen box, what the hand is doing.
    pub canvas: CanvasState,
    /// Class of the next box.
    pub class: usize,
    /// Which images are listed.
    pub filter: Filter,
    /// The image that the canvas shows.
    pub(crate) of: String,
    /// Whether an import waited in the last frame.
    pub import_seen: bool,
    /// The image that list and gallery were scrolled to.
    pub(crate) scrolled: [String; 2],
}

impl LabelsPanels {
    /// What deleting the chosen box means.
    pub fn delete_chosen(&mut self, view: &View) -> Option<Command> {
        let shown = view.labels.shown.as_ref()?;
        let chosen = self.canvas.chosen.take()?;
        Some(
            match chosen.checked_sub(shown.boxes.len()) {
                None => edit(shown, BoxEdit::Delete { index: chosen }),
                Some(index) => LabelsCommand::DiscardProposal { index },
            }
            .into(),
        )
    }

    /// New boxes are of this class; so is the chosen box.
    pub fn choose_class(&mut self, view: &View, class: usize) -> Option<Command> {
        if class >= view.labels.set.as_ref()?.names.len() {
            return None;
        }
        self.class = class;
        let (shown, class) = (view.labels.shown.as_ref()?, ClassIndex(class));
        let chosen = self.canvas.chosen?;
        Some(
            match chosen.checked_sub(shown.boxes.len()) {
                None => edit(shown, BoxEdit::Class { index: chosen, class }),
                Some(index) => LabelsCommand::AcceptProposal { index, class: Some(class), area: None },
            }
            .into(),
        )
    }

    /// What the hand did on the canvas.
    pub(super) fn placed(&self, shown: &ShownLabels, placed: Placed) -> LabelsCommand {
        let area = placed.area;
        match placed.index {
            None => edit(shown, BoxEdit::Add { class: ClassIndex(self.class), area }),
            Some(index) => match index.checked_sub(shown.boxes.len()) {
                None => edit(shown, BoxEdit::Place { index, area }),
                Some(index) => LabelsCommand::AcceptProposal { index, class: None, area: Some(area) },
            },
        }
    }

    /// Another image is shown: nothing on it is chosen.
    pub(super) fn follow(&mut self, labels: &LabelsView) {
        let name = labels.shown.as_ref().map(|shown| shown.name.as_str()).unwrap_or_default();
        if self.of != name {
            self.of = name.to_owned();
            self.canvas = CanvasState::default();
        }
        let classes = labels.set.as_ref().map_or(0, |set| set.names.len());
        self.class = self.class.min(classes.saturating_sub(1));
    }
}

fn edit(shown: &ShownLabels, edit: BoxEdit) -> LabelsCommand {
    LabelsCommand::Edit { image: shown.name.clone(), edit }
}

/// Which images are listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// All.
    #[default]
    All,
    /// Those without labels.
    Open,
    /// Those to be looked at again, or with problems.
    Check,
}

impl Filter {
    pub(super) fn takes(self, image: &LabelImage) -> bool {
        match self {
            Self::All => true,
            Self::Open => image.state == LabelState::Unlabeled,
            Self::Check => {
                image.state == LabelState::ToCheck || image.problems > 0 || image.unusable.is_some()
            }
        }
    }
}
