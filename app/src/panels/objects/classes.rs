//! Thresholds, which classes are shown, and how reliably each is seen.

use egui::{Slider, Ui};
use plumbline_engine::view::{ClassRates, DetectView, DetectorFacts};
use plumbline_engine::{Command, DetectCommand};
use plumbline_widgets::theme::{self, class_words, group_heading, space};
use plumbline_widgets::{class_color, format};

use super::state::ObjectsPanels;
use crate::operator::Outbox;

/// Sliders for the thresholds.
pub fn thresholds(ui: &mut Ui, detect: &DetectView, panels: &mut ObjectsPanels, outbox: &mut Outbox) {
    let settings = &detect.settings;
    if let Some(confidence) = slider(ui, "confidence", settings.confidence) {
        outbox.send(DetectCommand::Confidence(confidence));
    }
    if let Some(iou) = slider(ui, "overlap", settings.iou) {
        outbox.send(DetectCommand::Iou(iou));
    }
    ui.checkbox(&mut panels.own_thresholds, "A threshold per class");
    let Some(facts) = detect.facts().filter(|_| panels.own_thresholds) else { return };
    for (_, name) in facts.names.iter() {
        ui.horizontal(|ui| {
            let own = settings.class_confidence.get(name);
            if let Some(confidence) = slider(ui, class_words(name), settings.confidence_of(name)) {
                let class = name.to_owned();
                outbox.send(DetectCommand::ClassConfidence { class, confidence: Some(confidence) });
            }
            if own.is_some() && ui.small_button("As all").clicked() {
                outbox.send(DetectCommand::ClassConfidence { class: name.to_owned(), confidence: None });
            }
        });
    }
}

/// What it was moved to, if it was: a slider also rounds what it is given, which is no wish.
fn slider(ui: &mut Ui, name: &str, before: f32) -> Option<f32> {
    let mut value = before;
    let slider = Slider::new(&mut value, 0.05..=1.0).text(name).fixed_decimals(2).step_by(0.01);
    let response = ui.add(slider);
    (response.changed() && (value - before).abs() > 0.004).then_some(value)
}

/// A chip per class: pressed in is shown.
pub fn filter(ui: &mut Ui, detect: &DetectView, facts: &DetectorFacts, outbox: &mut Outbox) {
    let settings = &detect.settings;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(space::XS, space::XS);
        for (class, name) in facts.names.iter() {
            let shown = settings.shows(name);
            let tokens = theme::tokens(ui);
            let stroke = egui::Stroke::new(
                if shown { 1.5 } else { 1.0 },
                if shown { class_color(name, class.0) } else { tokens.line },
            );
            let ink = if shown { tokens.text_strong } else { tokens.text_weak };
            let text = egui::RichText::new(class_words(name)).text_style(egui::TextStyle::Small).color(ink);
            let text = if shown { text } else { text.strikethrough() };
            let fill = if shown { tokens.selected } else { tokens.panel };
            let chip = ui.add(egui::Button::new(text).fill(fill).stroke(stroke));
            chip.widget_info(|| {
                egui::WidgetInfo::selected(
                    egui::Role::CheckBox,
                    true,
                    shown,
                    format!("Show {}", class_words(name)),
                )
            });
            if chip.clicked() {
                outbox.send(DetectCommand::Show { class: name.to_owned(), shown: !shown });
            }
        }
    });
    if !settings.hidden.is_empty() && ui.button("Show all classes").clicked() {
        outbox.send(DetectCommand::ShowAll);
    }
}

/// How reliably each class is seen, with the button that begins anew.
pub fn rates(ui: &mut Ui, detect: &DetectView, outbox: &mut Outbox) {
    group_heading(ui, "Seen, by class");
    let seen: Vec<&ClassRates> = detect.rates.iter().filter(|rates| rates.was_seen()).collect();
    if seen.is_empty() {
        ui.label(theme::weak(ui, "Nothing was seen since the last reset."));
        return;
    }
    let grid = egui::Grid::new("rates").num_columns(5).spacing([space::XS, 2.0]).min_col_width(8.0);
    grid.show(ui, |ui| {
        for (title, about) in [
            ("", ""),
            ("L", "Share of the pairs in which the left eye saw one"),
            ("R", "Share of the pairs in which the right eye saw one"),
            ("agree", "Share of its objects that both eyes saw as one and the same"),
            ("lost", "Share of the objects that usually are there and that neither eye saw"),
        ] {
            let label = ui.label(theme::small(ui, title));
            if !about.is_empty() {
                label.on_hover_text(about);
            }
        }
        ui.end_row();
        for rates in seen {
            ui.label(theme::small(ui, &rates.name));
            let share = |share: Option<f64>| share.map_or(format::NONE.to_owned(), format::percent);
            let figures = [Some(rates.left), Some(rates.right), rates.agree, rates.lost];
            for figure in figures {
                ui.label(egui::RichText::new(share(figure)).text_style(egui::TextStyle::Small));
            }
            ui.end_row();
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::small(ui, format!("over the last {}", format::count(detect.counted, "pair"))));
        if ui.small_button("Count anew").clicked() {
            outbox.send(Command::from(DetectCommand::ResetRates));
        }
    });
}
