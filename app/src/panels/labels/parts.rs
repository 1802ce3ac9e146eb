//! What the panes of this folder share.

use egui::{Button, Color32, Response, Ui};
use plumbline_engine::view::{LabelState, ShownLabels};
use plumbline_model::{ClassIndex, ClassNames};
use plumbline_widgets::box_canvas::CanvasBox;
use plumbline_widgets::class_color;
use plumbline_widgets::glyph::Glyph;
use plumbline_widgets::theme::Role;

use crate::operator::{Action, LabelsAction};
use crate::panels::PanelContext;

/// A button of one of the actions, with its keys and its reason where it cannot be pressed.
pub fn action_button(ui: &mut Ui, cx: &mut PanelContext<'_>, action: LabelsAction, text: &str) -> Response {
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
pub fn sign(state: LabelState) -> (Glyph, Role) {
    match state {
        LabelState::Labeled => (Glyph::Check, Role::Accepted),
        LabelState::Unlabeled => (Glyph::Ring, Role::Weak),
        LabelState::ToCheck => (Glyph::Warning, Role::Warning),
    }
}

/// The color of a class of a data set.
pub fn color(names: &ClassNames, class: ClassIndex) -> Color32 {
    class_color(names.get(class).unwrap_or_default(), class.0)
}

/// Boxes and proposals of an image, in this order, as they are drawn.
pub fn drawn(shown: &ShownLabels, names: &ClassNames) -> Vec<CanvasBox> {
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
