//! What is known of the shown image: its boxes, what is proposed, what can be done.

use egui::{Button, Label, Sense, Ui, vec2};
use plumbline_engine::View;
use plumbline_engine::view::{LabelState, ShownLabels};
use plumbline_model::{ClassNames, PixelBox};
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::parts::{color, drawn};
use crate::operator::{Action, LabelsAction, Outbox};
use crate::panels::PanelState;

/// What is known of the shown image.
pub fn show(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    let labels = &view.labels;
    let (Some(set), Some(shown)) = (&labels.set, &labels.shown) else {
        group_heading(ui, "Image");
        ui.label(theme::weak(ui, "None is shown."));
        return keys(ui);
    };
    group_heading(ui, "Image");
    ui.add(Label::new(theme::strong(ui, &*shown.name)).truncate()).on_hover_text(&*shown.name);
    let place = format!("{} of {}", shown.index + 1, labels.images.len());
    let saved = if labels.unsaved.is_some() { " · not saved" } else { " · saved" };
    let image_state = labels.images.get(shown.index).map(|image| image.state).unwrap_or_default();
    let word = match image_state {
        LabelState::Labeled => "labeled",
        LabelState::Unlabeled => "open",
        LabelState::ToCheck => "to check",
    };
    let saved = if image_state == LabelState::Unlabeled { "" } else { saved };
    ui.label(theme::weak(ui, format!("{place} · {word}{saved}")));
    if let Some(why) = &shown.locked {
        ui.add(Label::new(egui::RichText::new(why).color(Role::Warning.color(theme::tokens(ui)))).wrap());
    }
    ui.horizontal_wrapped(|ui| {
        button(ui, view, outbox, LabelsAction::Previous, "◀ Previous");
        button(ui, view, outbox, LabelsAction::Next, "Next ▶");
    });
    boxes(ui, shown, &set.names, state);
    group_heading(ui, "Fill");
    let detector = labels.detector.clone().unwrap_or_else(|| "no detector".to_owned());
    button(ui, view, outbox, LabelsAction::Propose, "Propose boxes")
        .on_hover_text(format!("With {detector}; what it proposes is drawn dashed until you accept it"));
    if shown.proposing {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(theme::weak(ui, "The detector looks."));
        });
    }
    if !shown.proposals.is_empty() {
        ui.horizontal_wrapped(|ui| {
            button(ui, view, outbox, LabelsAction::AcceptProposals, "Accept all");
            button(ui, view, outbox, LabelsAction::DiscardProposals, "Discard all");
        });
    }
    button(ui, view, outbox, LabelsAction::CopyPrevious, "Copy from the image before");
    button(ui, view, outbox, LabelsAction::NothingHere, "Nothing is on it");
    let text =
        if image_state == LabelState::ToCheck { "Checked: take off the mark" } else { "Mark to be checked" };
    button(ui, view, outbox, LabelsAction::ToggleToCheck, text);
    button(ui, view, outbox, LabelsAction::NextUnlabeled, "Next without labels");
    keys(ui);
}

fn button(ui: &mut Ui, view: &View, outbox: &mut Outbox, action: LabelsAction, text: &str) -> egui::Response {
    let why = action.refusal(view);
    let response = ui.add_enabled(why.is_none(), Button::new(text));
    let response = response.on_disabled_hover_text(why.unwrap_or_default());
    if response.clicked() {
        outbox.act(Action::Labels(action));
    }
    match action.keys() {
        Some(keys) => {
            let keys = ui.ctx().format_shortcut(&keys);
            response.on_hover_text(format!("{} ({keys})", action.label()))
        }
        None => response.on_hover_text(action.label()),
    }
}

fn boxes(ui: &mut Ui, shown: &ShownLabels, names: &ClassNames, state: &mut PanelState) {
    group_heading(ui, "Boxes");
    let all = drawn(shown, names);
    if all.is_empty() {
        ui.label(theme::weak(ui, "None. Drag on the image to draw one."));
    }
    let classes = shown.boxes.iter().map(|label| label.class);
    let classes = classes.chain(shown.proposals.iter().map(|proposed| proposed.label.class));
    for (index, (drawn, class)) in all.iter().zip(classes).enumerate() {
        let chosen = state.labels.canvas.chosen == Some(index);
        let name = format!("Box {}: {}", index + 1, drawn.text);
        if row(ui, &name, &drawn.text, &drawn.area, color(names, class), chosen).clicked() {
            state.labels.canvas.chosen = (!chosen).then_some(index);
        }
        for problem in shown.problems.iter().filter(|problem| problem.index == Some(index)) {
            let color = Role::Warning.color(theme::tokens(ui));
            ui.add(Label::new(egui::RichText::new(&problem.text).small().color(color)).wrap());
        }
    }
}

fn row(
    ui: &mut Ui,
    label: &str,
    text: &str,
    area: &PixelBox,
    color: egui::Color32,
    chosen: bool,
) -> egui::Response {
    let tokens = theme::tokens(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Row, true, chosen, label));
    if chosen || response.hovered() {
        ui.painter().rect_filled(rect, 4.0, if chosen { tokens.selected } else { tokens.raised });
    }
    let swatch = egui::Rect::from_center_size(rect.left_center() + vec2(10.0, 0.0), vec2(10.0, 10.0));
    plumbline_widgets::class_swatch(ui.painter(), swatch, color, tokens.text_weak);
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let left = rect.left_center() + vec2(22.0, 0.0);
    ui.painter().text(left, egui::Align2::LEFT_CENTER, text, body, tokens.text);
    let size = format!("{:.0} × {:.0} px", area.width_px(), area.height_px());
    let right = rect.right_center() - vec2(6.0, 0.0);
    ui.painter().text(right, egui::Align2::RIGHT_CENTER, size, small, tokens.text_weak);
    response
}

/// What the keys do, so that nobody has to look it up.
fn keys(ui: &mut Ui) {
    group_heading(ui, "Keys");
    // Nothing here is pressed, so rows may be as low as their text.
    ui.spacing_mut().interact_size.y = 16.0;
    let most = (ui.available_width() - space::M) * 0.55;
    let grid = egui::Grid::new("label keys").num_columns(2).min_row_height(16.0).max_col_width(most);
    grid.spacing([space::M, 2.0]).show(ui, |ui| {
        for (key, what) in [
            ("1–9", "class"),
            ("Shift+drag", "draw over a box"),
            ("Delete", "delete the box"),
            ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo"),
            ("← →", "image before, after"),
            ("C", "copy from the image before"),
            ("P, Enter", "propose, accept"),
            ("N", "next without labels"),
            ("wheel, right drag", "zoom, move"),
        ] {
            ui.add(egui::Label::new(theme::small(ui, key)).wrap());
            ui.add(egui::Label::new(theme::small(ui, what)).wrap());
            ui.end_row();
        }
    });
}
