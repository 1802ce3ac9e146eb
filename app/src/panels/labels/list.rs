//! The images of a data set with their states, and what is done with the set as a whole.

use egui::{ScrollArea, Sense, Ui, vec2};
use plumbline_engine::LabelsCommand;
use plumbline_engine::view::{LabelImage, LabelState};
use plumbline_widgets::buttons::{accent_button, choice};
use plumbline_widgets::theme::{self, Role, space};
use plumbline_widgets::{format, glyph};

use super::parts::{action_button, sign};
use super::state::Filter;
use crate::operator::{Action, LabelsAction};
use crate::panels::PanelContext;

const ROW: f32 = 26.0;

/// Opening and making data sets.
pub fn without_set(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.add_space(space::S);
    action_button(ui, cx, LabelsAction::Open, "Open a data set…");
    action_button(ui, cx, LabelsAction::Create, "New data set…");
    if let Some(recent) = cx.view.labels.recent.clone() {
        ui.add_space(space::M);
        ui.label(theme::weak(ui, "Open last"));
        let name = recent.file_name().unwrap_or(recent.as_os_str()).to_string_lossy().into_owned();
        if ui.button(format!("Open {name}")).on_hover_text(recent.display().to_string()).clicked() {
            cx.outbox.send(LabelsCommand::Open { path: recent });
        }
    }
}

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let Some(set) = &view.labels.set else { return };
    let name = set.folder.file_name().unwrap_or(set.folder.as_os_str()).to_string_lossy().into_owned();
    ui.add(egui::Label::new(theme::strong(ui, name)).truncate())
        .on_hover_text(set.folder.display().to_string());
    let counts = view.labels.counts;
    let mut summary = format!("{} labeled · {} open", counts.labeled, counts.unlabeled);
    if counts.to_check > 0 {
        summary += &format!(" · {} to check", counts.to_check);
    }
    summary += &format!(" · {}", format::count(counts.boxes, "box"));
    ui.label(theme::small(ui, summary));
    ui.add_space(space::XS);
    let why = LabelsAction::Capture.refusal(view);
    let capture = ui.add_enabled(why.is_none(), accent_button(ui, "Add the present pair"));
    let hint = "Writes what both eyes see now into the data set (A)";
    if capture.on_hover_text(hint).on_disabled_hover_text(why.unwrap_or_default()).clicked() {
        cx.outbox.act(Action::Labels(LabelsAction::Capture));
    }
    ui.horizontal_wrapped(|ui| {
        action_button(ui, cx, LabelsAction::Import, "Import…");
        action_button(ui, cx, LabelsAction::Export, "Export…");
        action_button(ui, cx, LabelsAction::Close, "Close");
    });
    ui.add_space(space::S);
    choice(
        ui,
        "Show",
        &mut cx.state.labels.filter,
        &[(Filter::All, "All"), (Filter::Open, "Open"), (Filter::Check, "To check")],
    );
    images(ui, cx);
}

fn images(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let filter = cx.state.labels.filter;
    let listed: Vec<usize> =
        (0..view.labels.images.len()).filter(|i| filter.takes(&view.labels.images[*i])).collect();
    if listed.is_empty() {
        ui.add_space(space::S);
        let text =
            if view.labels.images.is_empty() { "No images yet." } else { "No image is in this state." };
        ui.label(theme::weak(ui, text));
        return;
    }
    if filter != Filter::All {
        ui.label(theme::small(ui, format::count(listed.len(), "image")));
    }
    let shown = view.labels.shown.as_ref();
    let shown_name = shown.map(|shown| shown.name.clone()).unwrap_or_default();
    let place = listed.iter().position(|i| shown.is_some_and(|shown| shown.index == *i));
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::vertical().auto_shrink(false);
    if cx.state.labels.scrolled[0] != shown_name {
        cx.state.labels.scrolled[0] = shown_name;
        if let Some(place) = place {
            let middle = ROW * place as f32 - 0.4 * ui.available_height();
            area = area.vertical_scroll_offset(middle.max(0.0));
        }
    }
    area.show_rows(ui, ROW, listed.len(), |ui, range| {
        for i in range {
            let index = listed[i];
            row(ui, cx, &view.labels.images[index], shown.is_some_and(|shown| shown.index == index));
        }
    });
}

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, image: &LabelImage, shown: bool) {
    let tokens = theme::tokens(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Row, true, shown, &image.name));
    if shown || response.hovered() {
        ui.painter().rect_filled(rect, 4.0, if shown { tokens.selected } else { tokens.raised });
    }
    let (symbol, role) =
        if image.unusable.is_some() { (glyph::Glyph::Cross, Role::Warning) } else { sign(image.state) };
    glyph::paint(ui.painter(), rect.left_center() + vec2(13.0, 0.0), 12.0, symbol, role.color(tokens));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let value = match (&image.unusable, image.problems, image.state) {
        (Some(_), ..) => "!".to_owned(),
        (None, n, _) if n > 0 => format!("{} · {n} !", image.boxes),
        (None, _, LabelState::Unlabeled) => "open".to_owned(),
        _ => image.boxes.to_string(),
    };
    let value = ui.painter().layout_no_wrap(value, small, tokens.text_weak);
    let room = rect.width() - 26.0 - value.size().x - 14.0;
    let color = if shown { tokens.text_strong } else { tokens.text };
    let mut job = egui::text::LayoutJob::simple_singleline(image.name.clone(), font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room);
    let name = ui.painter().layout_job(job);
    let y = rect.center().y;
    ui.painter().galley(egui::pos2(rect.left() + 26.0, y - 0.5 * name.size().y), name, color);
    let at = egui::pos2(rect.right() - 8.0 - value.size().x, y - 0.5 * value.size().y);
    ui.painter().galley(at, value, tokens.text_weak);
    let state = match image.state {
        LabelState::Labeled => "labeled",
        LabelState::Unlabeled => "without labels",
        LabelState::ToCheck => "to be looked at again",
    };
    let hint = image
        .unusable
        .clone()
        .unwrap_or_else(|| format!("{}: {state}, {}", image.name, format::count(image.boxes, "box")));
    if response.on_hover_text(hint).clicked() {
        cx.outbox.send(LabelsCommand::Choose { image: image.name.clone() });
    }
}
