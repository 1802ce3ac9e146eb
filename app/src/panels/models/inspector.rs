//! What is known of the model that is shown: from what it was trained, and how.

use std::sync::Arc;

use egui::Ui;
use plumbline_engine::View;
use plumbline_engine::view::ModelsView;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, space};

use super::parts::about;
use crate::operator::Outbox;
use crate::operator::snapshot::models::{CorrectionModel, Errors, Recipe};
use crate::operator::words::clock;
use crate::panels::PanelState;

/// What is known of the model that is shown.
pub fn show(ui: &mut Ui, view: &View, _state: &mut PanelState, _outbox: &mut Outbox) {
    let Some((model, proposed)) = shown(&view.models) else {
        ui.label(theme::weak(ui, "Models learn from touches. The one that is shown is described here."));
        return;
    };
    let from = model.provenance();
    ui.label(theme::strong(
        ui,
        format!("{}, {}", model.method().name(), if proposed { "proposed" } else { "in use" }),
    ));
    ui.label(theme::small(ui, about(model.method())));
    ui.add_space(space::S);
    let mut rows = vec![
        KeyValue::text("made", clock(from.made)),
        KeyValue::text("touches", from.touches.len().to_string()),
    ];
    if let Some((shape, members)) = model.network_shape() {
        let text = if members > 1 { format!("{members} × {shape}") } else { shape };
        rows.push(
            KeyValue::text("network", text).help("Layers of each network; their answers are averaged."),
        );
    }
    if let Some(options) = &from.options {
        let recipe = if options.recipe == Recipe::Published { "as published" } else { "Plumbline's" };
        rows.push(KeyValue::text("recipe", recipe));
        rows.push(KeyValue::text("seed", options.seed.to_string()));
    }
    key_value_grid(ui, "model", &rows);
    let errors = |title: &str, errors: Option<&Errors>, ui: &mut Ui| {
        let Some(errors) = errors else { return };
        theme::group_heading(ui, title);
        let rows = [
            KeyValue::quantity("mean in the plane", Quantity::Length, errors.mean_2d_m),
            KeyValue::quantity("rms in the plane", Quantity::Length, errors.rms_2d_m),
            KeyValue::quantity("height rms", Quantity::Length, errors.rms_z_m),
        ];
        key_value_grid(ui, title, &rows);
    };
    errors("Held-out touches", from.cross_validation.as_ref().map(|held_out| &held_out.errors), ui);
    if let Some(held_out) = &from.cross_validation {
        let blocks = format::count(held_out.blocks.len(), "block");
        ui.label(theme::small(ui, format!("{blocks}, each held out as a whole.")));
    }
    errors("Its own touches", from.training.as_ref(), ui);
    theme::group_heading(ui, "From");
    ui.label(theme::small(ui, &from.session));
    for sentence in &from.remarks {
        ui.label(theme::small(ui, sentence));
    }
    for sentence in &from.left_out {
        ui.label(theme::small(ui, format!("Left out: {sentence}.")));
    }
}

/// The model on the map, and whether it is a proposal.
fn shown(models: &ModelsView) -> Option<(&Arc<CorrectionModel>, bool)> {
    let method = models.map.as_ref().and_then(|map| map.method).or(models.shown);
    let proposed = models.proposals.iter().find(|model| Some(model.method()) == method);
    match proposed.or(models.proposals.last().filter(|_| method.is_none())) {
        Some(model) => Some((model, true)),
        None => models.in_use.as_ref().map(|model| (model, false)),
    }
}
