//! The image with its boxes.

use egui::{Sense, Ui, vec2};
use plumbline_model::ClassIndex;
use plumbline_widgets::box_canvas::BoxCanvas;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme::{self, space};

use super::parts::{action_button, color, drawn};
use crate::operator::{Action, LabelsAction};
use crate::panels::PanelContext;

/// Height of the row of classes.
const CLASSES_HEIGHT: f32 = 30.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let (Some(set), Some(shown)) = (&view.labels.set, &view.labels.shown) else { return no_image(ui, cx) };
    egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 4)).show(ui, |ui| classes(ui, cx));
    let pixels = match &shown.pixels {
        None => {
            EmptyState::loading(&format!("Reading {}.", shown.name)).show(ui);
            return;
        }
        Some(Err(why)) => {
            let why = why.to_string();
            EmptyState::failed(Message::new("This image cannot be shown", &why)).show(ui);
            return;
        }
        Some(Ok(pixels)) => pixels,
    };
    let picture = cx.state.textures.rgb_of("labels", pixels).clone();
    let boxes = drawn(shown, &set.names);
    let label = format!("Boxes of {}", shown.name);
    let canvas = BoxCanvas::new(&label, &picture, &boxes);
    let panels = &mut cx.state.labels;
    let canvas = match shown.locked {
        Some(_) => canvas,
        None => canvas.editable(color(&set.names, ClassIndex(panels.class)), shown.revision),
    };
    let did = canvas.show(ui, &mut panels.canvas);
    if let Some(placed) = did.placed {
        let command = panels.placed(shown, placed);
        cx.outbox.send(command);
    }
}

fn no_image(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let possible = LabelsAction::Capture.refusal(cx.view).is_none();
    let message = Message::new(
        "The data set has no images yet",
        "Add what both eyes see now, or import a data set in the YOLO layout.",
    );
    let message = if possible { message.button("Add the present pair") } else { message };
    if EmptyState::empty(message).show(ui) {
        cx.outbox.act(Action::Labels(LabelsAction::Capture));
    }
}

/// The classes with their keys: the one of the next box is marked. Undo and zoom at the right.
fn classes(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(set) = &cx.view.labels.set else { return };
    let chosen = cx.state.labels.class;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        for (class, name) in set.names.iter() {
            if class_button(ui, class, name, chosen == class.0, color(&set.names, class)).clicked() {
                cx.outbox.act(Action::Labels(LabelsAction::Class(class.0)));
            }
        }
        ui.add_space(space::S);
        action_button(ui, cx, LabelsAction::Undo, "Undo");
        action_button(ui, cx, LabelsAction::Redo, "Redo");
        let fit = cx.state.labels.canvas.view.is_fit();
        let hint = "The wheel zooms, the right button moves the image";
        if ui
            .add_enabled(!fit, egui::Button::new("Fit"))
            .on_hover_text(hint)
            .on_disabled_hover_text(hint)
            .clicked()
        {
            cx.state.labels.canvas.view.fit();
        }
    });
}

fn class_button(
    ui: &mut Ui,
    class: ClassIndex,
    name: &str,
    chosen: bool,
    color: egui::Color32,
) -> egui::Response {
    let tokens = theme::tokens(ui);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let key = if class.0 < 9 { format!("{}", class.0 + 1) } else { String::new() };
    let small = egui::TextStyle::Small.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, tokens.text);
    let key = ui.painter().layout_no_wrap(key, small, tokens.text_weak);
    let width = 24.0 + text.size().x + 4.0 + key.size().x + 8.0;
    let (rect, response) = ui.allocate_exact_size(vec2(width, CLASSES_HEIGHT - 4.0), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::RadioButton, true, chosen, format!("Class {name}"))
    });
    let fill = if chosen { tokens.selected } else { tokens.raised };
    ui.painter().rect_filled(rect, 4.0, if response.hovered() { tokens.raised_hover } else { fill });
    if chosen || response.has_focus() {
        let stroke = egui::Stroke::new(1.5, tokens.accent);
        ui.painter().rect_stroke(rect, 4.0, stroke, egui::StrokeKind::Inside);
    }
    let swatch = egui::Rect::from_center_size(rect.left_center() + vec2(13.0, 0.0), vec2(11.0, 11.0));
    plumbline_widgets::class_swatch(ui.painter(), swatch, color, tokens.text_weak);
    let y = rect.center().y;
    ui.painter().galley(egui::pos2(rect.left() + 24.0, y - 0.5 * text.size().y), text.clone(), tokens.text);
    let key_at = egui::pos2(rect.left() + 28.0 + text.size().x, y - 0.5 * key.size().y + 1.0);
    ui.painter().galley(key_at, key, tokens.text_weak);
    response.on_hover_text("Class of the chosen box and of the next one")
}
