//! How large an effect is: its values with their intervals, and what it does on the table.

use egui::{Grid, Label, RichText, TextStyle, Ui};
use plumbline_widgets::theme::{self, space};
use plumbline_widgets::{format, parameter};

use crate::operator::snapshot::gap::{Finding, NamedEffect};
use crate::operator::words::effect as effect_words;
use crate::operator::words::gap as words;

/// Between the lines of two values that stand below each other.
const ROW_GAP: f32 = 4.0;

/// A value: what is said before it, the value, and how well it is known.
type Row = [RichText; 3];

/// Parameters whose intervals exclude zero, the others counted, and what the effect does on the table.
pub fn sizes(ui: &mut Ui, effect: &NamedEffect, finding: &Finding) {
    let (told, zero): (Vec<_>, Vec<_>) = effect.parameters.iter().partition(|found| found.is_told());
    let not_told = effect_words::not_told(told.len(), zero.len());
    // Ranges are those of a model that has what is named, and no more.
    let sure = if words::is_unsure(finding) { "95 % if no more is off" } else { "95 %" };
    let mut rows: Vec<Row> = told
        .into_iter()
        .map(|found| {
            let name = theme::weak(ui, effect_words::before_value(&found.name, &finding.candidates));
            match &found.text {
                Some(text) => {
                    [name, RichText::new(effect_words::choice(text, &finding.candidates)), RichText::new("")]
                }
                None => {
                    let interval = parameter::interval(&found.name, found.low, found.high);
                    let value = theme::strong(ui, parameter::value(&found.name, found.value));
                    [name, value, theme::weak(ui, format!("{interval} ({sure})"))]
                }
            }
        })
        .collect();
    if effect.size_m > 0.0 {
        // With an unknown noise nothing is a multiple of it.
        let noise = if finding.comparison.is_noise_known() {
            format!("rms, {} × the noise", format::significant(effect.size_sigmas, 2))
        } else {
            "rms".to_owned()
        };
        let noise = theme::weak(ui, noise);
        rows.push([
            theme::weak(ui, "does"),
            RichText::new(words::error(&finding.shown, effect.size_m)),
            noise,
        ]);
    }
    if fits(ui, &rows) {
        beside(ui, effect, rows);
    } else {
        below(ui, rows);
    }
    if let Some(said) = not_told {
        ui.label(theme::small(ui, said));
    }
}

/// Whether the columns of all rows stand beside each other in the room that is left.
fn fits(ui: &Ui, rows: &[Row]) -> bool {
    let columns: f32 =
        (0..3).map(|column| rows.iter().map(|row| width(ui, &row[column])).fold(0.0, f32::max)).sum();
    columns + 2.0 * space::M <= ui.available_width()
}

/// Of a text in one line.
fn width(ui: &Ui, text: &RichText) -> f32 {
    let mode = Some(egui::TextWrapMode::Extend);
    let galley = egui::WidgetText::from(text.clone()).into_galley(ui, mode, f32::INFINITY, TextStyle::Body);
    galley.size().x
}

fn beside(ui: &mut Ui, effect: &NamedEffect, rows: Vec<Row>) {
    Grid::new(("size", &effect.id, &effect.site)).num_columns(3).spacing([space::M, 2.0]).show(ui, |ui| {
        for row in rows {
            for text in row {
                ui.label(text);
            }
            ui.end_row();
        }
    });
}

/// Each value in lines of its own, as many as it needs.
fn below(ui: &mut Ui, rows: Vec<Row>) {
    ui.vertical(|ui| {
        // Lines of text, and none as high as a button: what belongs together stands together.
        ui.spacing_mut().item_spacing.y = ROW_GAP;
        ui.spacing_mut().interact_size.y = 0.0;
        let line = ui.available_width();
        for row in rows {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = egui::vec2(space::S, 0.0);
                let [name, value, known] = row;
                // Nothing stands before it, so it may be broken where it is long.
                ui.add(Label::new(name).wrap());
                for text in [value, known].into_iter().filter(|text| !text.text().is_empty()) {
                    if width(ui, &text) > line {
                        // Longer than a line: in lines of its own.
                        ui.end_row();
                        ui.add(Label::new(text).wrap());
                    } else {
                        // As a whole: a text that is broken begins under what stands before it.
                        ui.add(Label::new(text).extend());
                    }
                }
            });
        }
    });
}
