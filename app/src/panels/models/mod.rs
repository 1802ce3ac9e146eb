//! Correction models: training, comparison, maps, and the tables of grasp height and yaw.

mod comparison;
mod inspector;
mod map;
mod sessions;
mod tables;
mod training;
mod verdict;

pub use inspector::show as show_inspector;

use std::sync::Arc;

use egui::Ui;
use plumbline_engine::view::ModelMap;
use plumbline_widgets::{Memo, Seen};

use super::PanelContext;
use super::arrows::Errors;
use crate::operator::Pane;
use crate::operator::snapshot::models::Method;

/// How models are looked at: kept from frame to frame, never saved.
#[derive(Debug)]
pub struct ModelsPanels {
    /// Methods to train.
    pub methods: [bool; 3],
    /// Seed of the training.
    pub seed: u64,
    /// Whether the published recipe is followed.
    pub published_recipe: bool,
    /// Which errors the map shows.
    pub errors: Errors,
    /// Which field the map shows.
    pub field: map::Shown,
    /// How the tables are looked at.
    pub tables: tables::TablesPanel,
    /// Whether training ran in the last frame.
    pub training_seen: bool,
    map: Memo<Seen<ModelMap>, map::Drawn>,
    standing: Memo<verdict::Basis, verdict::Facts>,
}

impl Default for ModelsPanels {
    fn default() -> Self {
        Self {
            methods: [true; 3],
            seed: 1,
            published_recipe: false,
            errors: Errors::Both,
            field: map::Shown::Uncertainty,
            tables: tables::TablesPanel::default(),
            training_seen: false,
            map: Memo::default(),
            standing: Memo::default(),
        }
    }
}

/// Draws one of the panes of this step.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    match pane {
        Pane::ModelComparison => comparison::show(ui, cx),
        Pane::ModelMap => map::show(ui, cx),
        Pane::GraspTables => tables::show(ui, cx),
        _ => training::show(ui, cx),
    }
}

/// What is told about all methods.
fn facts(cx: &mut PanelContext<'_>) -> Arc<verdict::Facts> {
    let models = &cx.view.models;
    cx.state.models.standing.get(verdict::Basis::of(models), || verdict::Facts::of(models))
}

/// What the network of a method looks like as published, or what it is instead.
fn about(method: Method) -> &'static str {
    match method {
        Method::M1 => "screen placement, measured height between grid points",
        Method::M2 => "network 2–16–2 for x and y, height of M1",
        Method::M3 => "network 2–64–3 for x, y and z",
    }
}
