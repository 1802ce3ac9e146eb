//! The line itself, the newest on top: when, what, error before and after, and how it is taken back.

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align, Button, Layout, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};
use plumbline_engine::view::{EntryKind, Figure, TimelineEntry};
use plumbline_engine::{Command, View};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::actions::timeline::{take_back, use_again};
use crate::operator::words::timeline as words;
use crate::operator::words::{capitalized, clock};
use crate::panels::rest::WHY;
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
    cx.state.timeline.rest.see(ui.ctx(), timeline.entries.last().map(|entry| entry.number));
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
            if let Some(change) = change(cx.view, entry) {
                let layout = Layout::right_to_left(Align::Center);
                ui.allocate_ui_with_layout(vec2(BUTTON, ROW_HEIGHT), layout, |ui| {
                    change_button(ui, cx, entry, change);
                });
            }
            text(ui, cx, entry);
        });
    });
}

/// The line, and a dot on it: filled where it changed what is in use, a ring where it was only measured.
fn dot(ui: &mut Ui, cx: &PanelContext<'_>, entry: &TimelineEntry, (newest, oldest): (bool, bool)) {
    let tokens = theme::tokens(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(RAIL, ROW_HEIGHT), Sense::hover());
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

/// When and of what, with its errors, and below it what it is. A click chooses it.
fn text(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &TimelineEntry) {
    let chosen = cx.state.timeline.chosen.contains(&entry.number);
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT - 4.0), Sense::click());
    let (errors, title) = (words::errors(entry), words::title(entry));
    response.widget_info(|| {
        let label = [title.as_str(), errors.as_str()].join(" ");
        WidgetInfo::selected(egui::Role::Button, true, chosen, label.trim())
    });
    let tokens = theme::tokens(ui);
    if chosen || response.hovered() {
        ui.painter().rect_filled(rect, 4.0, tokens.raised);
    }
    let whole = rect.width() - 2.0 * space::S;
    let line = |text: String, style: TextStyle, color, width: f32| {
        let mut job = LayoutJob::simple_singleline(text, style.resolve(ui.style()), color);
        job.wrap = TextWrapping::truncate_at_width(width.max(1.0));
        ui.painter().layout_job(job)
    };
    let at = rect.left_top() + vec2(space::S, 4.0);
    let color = if is_better(entry) { Role::Accepted.color(tokens) } else { tokens.text_strong };
    // The errors keep their room; when and of what gives way.
    let errors = line(errors, TextStyle::Small, color, whole);
    // Of what it is says the title below as well: it goes where there is no room for both.
    let when = clock(entry.at);
    let room = whole - errors.size().x - space::M;
    let heading = |text: String, width| line(text, TextStyle::Small, tokens.text_weak, width);
    let both = heading(format!("{when} · {}", entry.subject.name()), f32::INFINITY);
    let heading = if both.size().x <= room { both } else { heading(when, room) };
    let beside = at + vec2(heading.size().x + space::M, 0.0);
    ui.painter().galley(at, heading, tokens.text);
    ui.painter().galley(beside, errors, tokens.text);
    let title = line(title, TextStyle::Body, tokens.text, whole);
    ui.painter().galley(at + vec2(0.0, 18.0), title, tokens.text);
    if response.on_hover_text(words::about(entry)).clicked() {
        cx.state.timeline.toggle(entry.number);
    }
}

/// Whether the error got smaller, or the share larger, on figures that can be compared.
fn is_better(entry: &TimelineEntry) -> bool {
    let both = entry.before.zip(entry.after);
    both.is_some_and(|(before, after): (Figure, Figure)| after.is_better_than(before))
}

/// What can be done about an entry.
struct Change {
    command: Command,
    label: &'static str,
    help: String,
}

/// `None`: it was only measured, or something newer stands on it.
fn change(view: &View, entry: &TimelineEntry) -> Option<Change> {
    if let Some(undo) = take_back(view, entry) {
        return Some(Change { help: capitalized(&undo.help()), command: undo.command, label: "Undo" });
    }
    let help = "Puts this in use again. Nothing is deleted.".to_owned();
    use_again(view, entry).map(|command| Change { command, label: "Use again", help })
}

fn change_button(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &TimelineEntry, change: Change) {
    let Change { command, label, help } = change;
    let rests = cx.state.timeline.rest.is_on(ui.ctx());
    let button = Button::new(RichText::new(label).text_style(TextStyle::Small));
    let button = ui.add_enabled(!rests, button);
    // Each says which one it is of to whoever does not see the row.
    button.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Button, !rests, format!("{label}: {}", words::title(entry)))
    });
    if button.on_hover_text(help).on_disabled_hover_text(WHY).clicked() {
        cx.state.timeline.rest.begin(ui.ctx());
        cx.outbox.send(command);
    }
}
