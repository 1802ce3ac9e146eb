//! The band of truth mode: on every screen, in a color that nothing else has, for as long as it is on.

use egui::{Color32, Grid, Panel, RichText, ScrollArea, Ui};
use plumbline_engine::TruthCommand;
use plumbline_engine::view::{TruthOf, TruthView};
use plumbline_widgets::theme::space;

use super::PlumblineWindow;
use crate::operator::Outbox;
use crate::operator::words::truth::{axes, off, summary};

/// Nothing else in the window has this ground.
const GROUND: Color32 = Color32::from_rgb(0x6B, 0x1F, 0x7A);
const TEXT: Color32 = Color32::from_rgb(0xFF, 0xF3, 0xFF);
const HEIGHT: f32 = 38.0;
/// Room that the buttons at the right take, pt.
const BUTTONS: f32 = 180.0;
const TITLE: &str = "TRUTH of the simulation";

pub(super) fn show(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let truth = &window.view.truth;
    if !truth.is_on {
        return;
    }
    let margin = egui::Margin { left: 16, right: 8, top: 3, bottom: 3 };
    let frame = egui::Frame::NONE.fill(GROUND).inner_margin(margin);
    let panel = Panel::top("truth").frame(frame).exact_size(HEIGHT).show_separator_line(false);
    panel.show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            ui.spacing_mut().item_spacing.x = space::M;
            ui.label(RichText::new(TITLE).color(TEXT).strong());
            let room = ui.available_width() - BUTTONS;
            figures(ui, truth, room);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Hide the truth").clicked() {
                    outbox.send(TruthCommand::Show(false));
                }
                ui.menu_button("All", |ui| all(ui, truth));
            });
        });
    });
}

/// As many of the worst figures as there is room for; all of them stand under "All".
fn figures(ui: &mut Ui, truth: &TruthView, room: f32) {
    if let Some(why) = &truth.waits_because {
        ui.add(egui::Label::new(RichText::new(why).color(TEXT)).truncate());
        return;
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut left = room;
    let words = TruthOf::ALL.into_iter().filter_map(|of| summary(truth, of));
    for (k, text) in words.enumerate() {
        let text = if k == 0 { format!("measured − true: {text}") } else { text };
        let width = ui.painter().layout_no_wrap(text.clone(), font.clone(), TEXT).size().x + space::M;
        if width > left {
            break;
        }
        left -= width;
        ui.label(RichText::new(text).color(TEXT));
    }
}

/// What stands between a kind and its truth, where that is not plain.
fn compared(of: TruthOf) -> Option<&'static str> {
    match of {
        TruthOf::Mount => Some(
            "A board tells the neck's nod only together with that of the eyes: in the robot is what places rest on.",
        ),
        TruthOf::Zero | TruthOf::Axis => Some("What is left with the effects in use, play and sag among it."),
        TruthOf::Toy | TruthOf::Finger => None,
    }
}

/// Every difference.
fn all(ui: &mut Ui, truth: &TruthView) {
    ui.set_min_width(320.0);
    ui.label(
        "Measured − true, from the simulation. Nothing that calibrates, searches, touches or grasps sees it.",
    );
    ScrollArea::vertical().max_height(360.0).show(ui, |ui| {
        for of in TruthOf::ALL {
            let rows: Vec<_> = truth.rows.iter().filter(|row| row.of == of).collect();
            if rows.is_empty() {
                continue;
            }
            ui.add_space(space::XS);
            ui.strong(of.name());
            if let Some(compared) = compared(of) {
                ui.label(compared);
            }
            Grid::new(("truth", of.name())).num_columns(3).spacing([space::M, 2.0]).show(ui, |ui| {
                for row in rows {
                    ui.label(&row.name);
                    ui.label(off(row));
                    ui.label(axes(row).unwrap_or_default());
                    ui.end_row();
                }
            });
        }
        if truth.rows.is_empty() {
            ui.label(truth.waits_because.as_deref().unwrap_or("Nothing can be compared yet."));
        }
    });
}
