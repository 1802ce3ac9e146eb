//! All methods of the experiment beside the published figures.

use egui::{Grid, Ui};
use plumbline_widgets::theme::{self, space};

use crate::operator::snapshot::trials::{HEADINGS, Page};

pub fn show(ui: &mut Ui, page: &Page) {
    egui::ScrollArea::horizontal().id_salt("experiment table").show(ui, |ui| {
        Grid::new("experiment").num_columns(HEADINGS.len() + 1).spacing([space::M, 2.0]).striped(true).show(
            ui,
            |ui| {
                ui.label("");
                for heading in HEADINGS {
                    ui.label(theme::small(ui, heading));
                }
                ui.end_row();
                for method in &page.methods {
                    ui.label(theme::strong(ui, &method.name));
                    for (heading, cell) in HEADINGS.iter().zip(&method.cells) {
                        match *heading {
                            "published" => ui.label(theme::weak(ui, cell)),
                            _ => ui.label(cell),
                        };
                    }
                    ui.end_row();
                }
            },
        );
    });
}
