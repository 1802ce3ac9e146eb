//! The lab's own data sets: the list of images, the image with its boxes, what is wrong.

mod canvas;
mod checks;
mod gallery;
mod inspector;
mod list;

pub use inspector::show as show_inspector;

use egui::{Button, Color32, Response, Ui};
use plumbline_engine::view::{LabelState, LabelsView, ShownLabels};
use plumbline_engine::{BoxEdit, Command, LabelsCommand, View};
use plumbline_model::{ClassIndex, ClassNames};
use plumbline_widgets::box_canvas::{CanvasBox, CanvasState, Placed};
use plumbline_widgets::class_color;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::glyph::Glyph;
use plumbline_widgets::theme::Role;

use super::{PanelContext, padded};
use crate::operator::{Action, LabelsAction, Pane};

/// How data sets are looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct LabelsPanels {
    /// Zoom, the chosen box, what the hand is doing.
    pub canvas: CanvasState,
    /// Class of the next box.
    pub class: usize,
    /// Which images are listed.
    pub filter: list::Filter,
    /// The image that the canvas shows.
    of: String,
    /// Whether an import waited in the last frame.
    pub import_seen: bool,
    /// The image that list and gallery were scrolled to.
    scrolled: [String; 2],
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
    fn placed(&self, shown: &ShownLabels, placed: Placed) -> LabelsCommand {
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
    fn follow(&mut self, labels: &LabelsView) {
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

/// Draws one of the panes of this screen.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    cx.state.labels.follow(&cx.view.labels);
    if cx.view.labels.set.is_none() {
        return match pane {
            Pane::LabelCanvas => no_set(ui, cx),
            Pane::LabelList => padded(ui, |ui| list::without_set(ui, cx)),
            _ => {}
        };
    }
    match pane {
        Pane::LabelList => padded(ui, |ui| list::show(ui, cx)),
        Pane::LabelGallery => gallery::show(ui, cx),
        Pane::LabelChecks => padded(ui, |ui| checks::show(ui, cx)),
        _ => canvas::show(ui, cx),
    }
}

/// What there is to do without a data set.
fn no_set(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let labels = &cx.view.labels;
    if labels.working.is_some() {
        EmptyState::loading("Reading the data set.").show(ui);
        return;
    }
    if let Some(why) = &labels.failed {
        let message = Message::new("The data set could not be opened", why).button("Open a data set…");
        if EmptyState::failed(message).show(ui) {
            cx.outbox.act(Action::Labels(LabelsAction::Open));
        }
        return;
    }
    let message = Message::new(
        "Teach a detector what your eyes see",
        "Open a data set in the YOLO layout, drop its folder here, or make a new one and capture pairs into it.",
    );
    if EmptyState::empty(message.button("Open a data set…")).show(ui) {
        cx.outbox.act(Action::Labels(LabelsAction::Open));
    }
}

/// A button of one of the actions, with its keys and its reason where it cannot be pressed.
fn action_button(ui: &mut Ui, cx: &mut PanelContext<'_>, action: LabelsAction, text: &str) -> Response {
    let why = action.refusal(cx.view);
    let keys = action.keys().map(|keys| format!(" ({})", ui.ctx().format_shortcut(&keys)));
    let button = ui.add_enabled(why.is_none(), Button::new(text));
    let button = button.on_hover_text(format!("{}{}", action.label(), keys.unwrap_or_default()));
    let button = button.on_disabled_hover_text(why.unwrap_or_default());
    if button.clicked() {
        cx.outbox.act(Action::Labels(action));
    }
    button
}

/// Sign and color of a state.
fn sign(state: LabelState) -> (Glyph, Role) {
    match state {
        LabelState::Labeled => (Glyph::Check, Role::Accepted),
        LabelState::Unlabeled => (Glyph::Ring, Role::Weak),
        LabelState::ToCheck => (Glyph::Warning, Role::Warning),
    }
}

/// The color of a class of a data set.
fn color(names: &ClassNames, class: ClassIndex) -> Color32 {
    class_color(names.get(class).unwrap_or_default(), class.0)
}

/// Boxes and proposals of an image, in this order, as they are drawn.
fn drawn(shown: &ShownLabels, names: &ClassNames) -> Vec<CanvasBox> {
    let name = |class: ClassIndex| names.get(class).unwrap_or("?").to_owned();
    let boxes = shown.boxes.iter().enumerate().map(|(i, label)| CanvasBox {
        area: label.area,
        color: color(names, label.class),
        text: name(label.class),
        dashed: false,
        odd: shown.problems.iter().any(|problem| problem.index == Some(i)),
    });
    let proposals = shown.proposals.iter().map(|proposed| CanvasBox {
        area: proposed.label.area,
        color: color(names, proposed.label.class),
        text: format!("{} {:.2}?", name(proposed.label.class), proposed.confidence),
        dashed: true,
        odd: false,
    });
    boxes.chain(proposals).collect()
}
