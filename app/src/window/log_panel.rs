//! The log, under the bottom line: levels, filter, copy.

use std::sync::Arc;

use egui::{Panel, RichText, ScrollArea, TextEdit, TextStyle, Ui};
use log::Level;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::log_lines::{LogLine, LogStore};

/// What is shown of the log.
pub struct LogPanel {
    store: Arc<LogStore>,
    lines: Vec<Arc<LogLine>>,
    level: Level,
    filter: String,
}

impl LogPanel {
    pub(super) fn new(store: Arc<LogStore>) -> Self {
        Self { store, lines: Vec::new(), level: Level::Info, filter: String::new() }
    }

    /// Takes the lines that came since the last frame, if they are looked at.
    pub(super) fn refresh(&mut self, open: bool) {
        let shown = self.lines.last().map_or(0, |line| line.number);
        if open && shown != self.store.newest() {
            self.lines = self.store.snapshot();
        }
    }

    pub(super) fn show(&mut self, ui: &mut Ui) {
        let frame = egui::Frame::side_top_panel(ui.style())
            .inner_margin(egui::Margin::symmetric(space::M as i8, space::S as i8));
        Panel::bottom("log").frame(frame).resizable(true).default_size(190.0).min_size(110.0).show(
            ui,
            |ui| {
                let chosen: Vec<Arc<LogLine>> = self.chosen().cloned().collect();
                self.controls(ui, &chosen);
                ui.add_space(space::XS);
                lines(ui, &chosen);
            },
        );
    }

    fn chosen(&self) -> impl Iterator<Item = &Arc<LogLine>> {
        let filter = self.filter.to_lowercase();
        self.lines.iter().filter(move |line| {
            line.level <= self.level && (filter.is_empty() || line.text().to_lowercase().contains(&filter))
        })
    }

    fn controls(&mut self, ui: &mut Ui, chosen: &[Arc<LogLine>]) {
        ui.horizontal(|ui| {
            ui.label(theme::strong(ui, "Log"));
            ui.add_space(space::S);
            for (level, name) in [
                (Level::Error, "Errors"),
                (Level::Warn, "Warnings"),
                (Level::Info, "Info"),
                (Level::Debug, "All"),
            ] {
                ui.selectable_value(&mut self.level, level, name);
            }
            ui.add_space(space::S);
            let edit = TextEdit::singleline(&mut self.filter).hint_text("Filter").desired_width(200.0);
            ui.add(edit)
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Filter the log"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Copy log").clicked() {
                    let text: Vec<String> = chosen.iter().map(|line| line.text()).collect();
                    ui.ctx().copy_text(text.join("\n"));
                }
                ui.label(theme::small(ui, format::count(chosen.len(), "line")));
            });
        });
    }
}

fn lines(ui: &mut Ui, chosen: &[Arc<LogLine>]) {
    let row_height = ui.text_style_height(&TextStyle::Monospace);
    let tokens = theme::tokens(ui);
    ScrollArea::both().auto_shrink(false).stick_to_bottom(true).show_rows(
        ui,
        row_height,
        chosen.len(),
        |ui, rows| {
            for line in &chosen[rows] {
                let color = match line.level {
                    Level::Error | Level::Warn => Role::Warning.color(tokens),
                    Level::Info => tokens.text,
                    Level::Debug | Level::Trace => tokens.text_weak,
                };
                ui.add(egui::Label::new(RichText::new(line.text()).monospace().color(color)).extend());
            }
        },
    );
    if chosen.is_empty() {
        ui.label(theme::weak(ui, "No line of this level matches the filter."));
    }
}
