//! How models are looked at.

use plumbline_engine::view::ModelMap;
use plumbline_widgets::{Memo, Seen};

use super::drawn::{Drawn, Shown};
use super::tables::TablesPanel;
use crate::panels::arrows::Errors;

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
    pub field: Shown,
    /// How the tables are looked at.
    pub tables: TablesPanel,
    /// Whether training ran in the last frame.
    pub training_seen: bool,
    pub(crate) map: Memo<Seen<ModelMap>, Drawn>,
    pub(crate) standing: Memo<super::verdict::Basis, super::verdict::Facts>,
}

impl Default for ModelsPanels {
    fn default() -> Self {
        Self {
            methods: [true; 3],
            seed: 1,
            published_recipe: false,
            errors: Errors::Both,
            field: Shown::Uncertainty,
            tables: TablesPanel::default(),
            training_seen: false,
            map: Memo::default(),
            standing: Memo::default(),
        }
    }
}
