//! The images behind a cell of the confusion matrix: a strip, and one of them large.

use egui::{Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use plumbline_engine::ScoresCommand;
use plumbline_engine::view::{CellPicture, OpenedCell};
use plumbline_model::ClassNames;
use plumbline_widgets::box_canvas::{BoxCanvas, CanvasBox, CanvasState, box_frame};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::image_view::ImageTransform;
use plumbline_widgets::texture::{Picture, Sampling};
use plumbline_widgets::{class_color, theme};

use crate::operator::{Action, ScoresAction};
use crate::panels::PanelContext;

const WIDE: f32 = 176.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let scores = &cx.view.scores;
    let (Some(cell), Some(table)) = (scores.cell.clone(), scores.table.clone()) else {
        let text = "Click a cell of the confusion matrix: the images that fell into it are shown here.";
        EmptyState::empty(Message::new("No cell is open", text)).show(ui);
        return;
    };
    egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 4)).show(ui, |ui| {
        ui.horizontal(|ui| {
            if scores.picture.is_some() && ui.button("All images").clicked() {
                cx.outbox.send(ScoresCommand::ShowPicture(None));
            }
            ui.add(egui::Label::new(theme::strong(ui, title(&cell, &table.names))).truncate());
            if ui.button("Close").clicked() {
                cx.outbox.act(Action::Scores(ScoresAction::CloseCell));
            }
        });
        let legend = "Full line: label. Dashed: found, with its confidence. Thick: what fell into the cell.";
        ui.add(egui::Label::new(theme::small(ui, legend)).truncate());
    });
    match scores.picture.and_then(|place| Some((place, cell.pictures.get(place)?))) {
        Some((place, picture)) => large(ui, cx, &table.names, place, picture),
        None => strip(ui, cx, &table.names, &cell),
    }
}

fn title(cell: &OpenedCell, names: &ClassNames) -> String {
    let name = |class: Option<usize>| class.and_then(|class| names.get(plumbline_model::ClassIndex(class)));
    let what = match (name(cell.cell.truth), name(cell.cell.found)) {
        (Some(truth), Some(found)) if truth == found => format!("{truth} found"),
        (Some(truth), Some(found)) => format!("{truth} taken for {found}"),
        (Some(truth), None) => format!("{truth} missed"),
        (None, Some(found)) => format!("{found} found where nothing is"),
        (None, None) => "Nothing".to_owned(),
    };
    match cell.of == cell.pictures.len() {
        true => format!("{what}: {}", plumbline_widgets::format::count(cell.of, "image")),
        false => format!("{what}: {} of {} images", cell.pictures.len(), cell.of),
    }
}

fn texture(cx: &mut PanelContext<'_>, place: usize, picture: &CellPicture) -> Option<Picture> {
    let pixels = picture.pixels.as_ref().ok()?;
    Some(cx.state.textures.rgb_of(&format!("cell {place}"), pixels).clone())
}

fn strip(ui: &mut Ui, cx: &mut PanelContext<'_>, names: &ClassNames, cell: &OpenedCell) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 2)).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (place, picture) in cell.pictures.iter().enumerate() {
                    if small(ui, cx, names, place, picture) {
                        cx.state.scores.view.fit();
                        cx.outbox.send(ScoresCommand::ShowPicture(Some(place)));
                    }
                }
            });
        });
    });
}

fn small(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    names: &ClassNames,
    place: usize,
    picture: &CellPicture,
) -> bool {
    let tokens = theme::tokens(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(WIDE, WIDE * 0.75), Sense::click());
    let label = format!("Image {}", picture.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &label));
    ui.painter().rect_filled(rect, 3.0, tokens.backdrop);
    if ui.is_rect_visible(rect) {
        match texture(cx, place, picture) {
            None => {
                let small = egui::TextStyle::Small.resolve(ui.style());
                ui.painter().text(
                    rect.center(),
                    egui::Align2::CENTER_CENTER,
                    "cannot be read",
                    small,
                    tokens.warning,
                );
            }
            Some(shown) => {
                let transform = ImageTransform::fit(shown.size_px(), rect);
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                let texture = shown.texture(ui.ctx(), Sampling::Smooth);
                ui.painter().image(texture, transform.image_rect(), whole, egui::Color32::WHITE);
                for (drawn, thick) in boxes(picture, names) {
                    if thick {
                        box_frame(&ui.painter_at(rect), &transform, &drawn, 2.0);
                    }
                }
            }
        }
    }
    if response.hovered() || response.has_focus() {
        ui.painter().rect_stroke(rect, 3.0, Stroke::new(2.0, tokens.accent), StrokeKind::Outside);
    }
    let hint = picture.pixels.as_ref().map_or_else(ToString::to_string, |_| picture.name.clone());
    response.on_hover_text(hint).clicked()
}

fn large(ui: &mut Ui, cx: &mut PanelContext<'_>, names: &ClassNames, place: usize, picture: &CellPicture) {
    if let Err(why) = &picture.pixels {
        EmptyState::failed(Message::new("This image cannot be shown", &why.to_string())).show(ui);
        return;
    }
    let Some(shown) = texture(cx, place, picture) else { return };
    let (drawn, thick): (Vec<CanvasBox>, Vec<bool>) = boxes(picture, names).into_iter().unzip();
    let view = cx.state.scores.view;
    let mut state = CanvasState::looking(view, thick.iter().position(|thick| *thick));
    let label = format!("Large picture of {}", picture.name);
    BoxCanvas::new(&label, &shown, &drawn).show(ui, &mut state);
    cx.state.scores.view = state.view;
}

/// What is there and what was found, and whether it fell into the cell.
fn boxes(picture: &CellPicture, names: &ClassNames) -> Vec<(CanvasBox, bool)> {
    let name = |class: plumbline_model::ClassIndex| names.get(class).unwrap_or("?").to_owned();
    let color =
        |class: plumbline_model::ClassIndex| class_color(names.get(class).unwrap_or_default(), class.0);
    let truth = picture.truth.iter().enumerate().map(|(i, label)| {
        let drawn = CanvasBox {
            area: label.area,
            color: color(label.class),
            text: name(label.class),
            dashed: false,
            odd: false,
        };
        (drawn, picture.in_cell.iter().any(|(truth, _)| *truth == Some(i)))
    });
    let found = picture.found.iter().enumerate().map(|(i, found)| {
        let drawn = CanvasBox {
            area: found.label.area,
            color: color(found.label.class),
            text: format!("{} {:.2}", name(found.label.class), found.confidence),
            dashed: true,
            odd: false,
        };
        (drawn, picture.in_cell.iter().any(|(_, found)| *found == Some(i)))
    });
    truth.chain(found).collect()
}
