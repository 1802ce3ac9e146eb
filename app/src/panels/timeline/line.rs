//! The line itself, the newest on top: when, what, error before and after, and how it is taken back.

use egui::{Align, Button, Layout, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::view::{EntryKind, Figure, TimelineEntry};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::actions::timeline::{take_back, use_again};
use crate::operator::words::clock;
use crate::operator::words::timeline as words;
use crate::panels::{PanelContext, padded};

const ROW_HEIGHT: f32 = 46.0;
/// Room for the line with its dots.
const RAIL: f32 = 22.0;
const BUTTON: f32 = 92.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let timeline = cx.view.timeline.clone();
    if !timeline.is_known {
        EmptyState::loading("The timeline is being read.").show(ui);
        return;
    }
    if timeline.entries.is_empty() {
        let text = "Each calibration, model and finding that is put in use, and each check, is listed here with its \
            error before and after, and can be taken back.";
        EmptyState::empty(Message::new("Nothing was put in use yet", text)).show(ui);
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (i, entry) in timeline.entries.iter().rev().enumerate() {
                row(ui, cx, entry, (i == 0, i + 1 == timeline.entries.len()));
            }
        });
    });
}

/// `ends`: whether it is the newest, and whether the oldest.
fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &TimelineEntry, ends: (bool, bool)) {
    let size = vec2(ui.available_width(), ROW_HEIGHT);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_height(ROW_HEIGHT);
        dot(ui, cx, entry, ends);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let button = ui.allocate_ui_with_layout(
                vec2(BUTTON, ROW_HEIGHT),
                Layout::right_to_left(Align::Center),
                |ui| undo_button(ui, cx, entry),
            );
            let _ = button;
            text(ui, cx, entry);
        });
    });
}

/// The line, and a dot on it: filled where it changed what is in use, a ring where it was only measured.
fn dot(ui: &mut Ui, cx: &PanelContext<'_>, entry: &TimelineEntry, (newest, oldest): (bool, bool)) {
    let tokens = theme::tokens(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(RAIL, ROW_HEIGHT), egui::Sense::hover());
    let x = rect.left() + 7.0;
    let from = if newest { rect.center().y } else { rect.top() };
    let to = if oldest { rect.center().y } else { rect.bottom() };
    ui.painter().vline(x, from..=to, egui::Stroke::new(1.5, tokens.text_weak));
    let center = egui::pos2(x, rect.center().y);
    let is_in_use = cx.view.timeline.is_newest(entry);
    let role = match entry.kind {
        _ if is_in_use => Role::Accepted,
        EntryKind::Measured => Role::Measured,
        EntryKind::PutInUse | EntryKind::TakenBack | EntryKind::Found => Role::Weak,
    };
    let color = role.color(tokens);
    if entry.kind == EntryKind::Measured {
        ui.painter().circle(center, 4.5, ui.visuals().panel_fill, egui::Stroke::new(1.5, color));
    } else {
        ui.painter().circle_filled(center, 5.0, color);
    }
}

fn text(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &TimelineEntry) {
    let chosen = cx.state.timeline.chosen.contains(&entry.number);
    let tokens = theme::tokens(ui);
    let weak = Role::Weak.color(tokens);
    let mut job = egui::text::LayoutJob::default();
    let small = egui::TextStyle::Small.resolve(ui.style());
    let body = egui::TextStyle::Body.resolve(ui.style());
    let format = |font: &egui::FontId, color| egui::TextFormat::simple(font.clone(), color);
    let errors = words::errors(entry);
    let heading = format!("{} · {}", clock(entry.at), entry.subject.name());
    job.append(&heading, 0.0, format(&small, weak));
    if !errors.is_empty() {
        let color = if is_better(entry) { Role::Accepted.color(tokens) } else { tokens.text_strong };
        job.append(&errors, space::M, format(&small, color));
    }
    job.append(&format!("\n{}", words::title(entry)), 0.0, format(&body, tokens.text));
    job.wrap.max_rows = 2;
    let button = Button::selectable(chosen, job).truncate();
    let button = button.min_size(vec2(ui.available_width(), ROW_HEIGHT - 4.0));
    let response = ui.add(button).on_hover_text(words::about(entry));
    if response.clicked() {
        cx.state.timeline.toggle(entry.number);
    }
}

/// Whether the error got smaller, on figures that can be compared.
fn is_better(entry: &TimelineEntry) -> bool {
    let both = entry.before.zip(entry.after);
    both.is_some_and(|(before, after): (Figure, Figure)| {
        before.is_like(after) && after.value() < before.value()
    })
}

fn undo_button(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &TimelineEntry) {
    let (command, label, help) = match (take_back(cx.view, entry), use_again(cx.view, entry)) {
        (Some(command), _) => {
            (command, "Take back", "What was in use before is in use again. Nothing is deleted.")
        }
        (None, Some(command)) => (command, "Use again", "Puts this in use again. Nothing is deleted."),
        (None, None) => return,
    };
    let button = Button::new(RichText::new(label).text_style(egui::TextStyle::Small));
    if ui.add(button).on_hover_text(help).clicked() {
        cx.outbox.send(command);
    }
}
