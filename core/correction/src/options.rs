//! What can be chosen about training.

use plumbline_model::session::Touchscreen;
use serde::{Deserialize, Serialize};

use crate::blocks::BlockBy;
use crate::network::Activation;
use crate::placement::PlacementFrom;

/// How networks are trained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Recipe {
    /// Output layer solved, shrinkage from the evidence, a few quasi-Newton steps of the hidden
    /// layer, an ensemble.
    #[default]
    Evidence,
    /// As published: Adam, 1e-3, batches of 16, 200 epochs, one network.
    Published,
}

/// What can be chosen about training. The same options and touches give the same model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TrainOptions {
    /// Of every random draw.
    pub seed: u64,
    /// How networks are trained.
    pub recipe: Recipe,
    /// Blocks of cross-validation at most.
    pub folds: usize,
    /// By what touches are held out together.
    pub block_by: BlockBy,
    /// Networks that are averaged (recipe `evidence`).
    pub members: usize,
    /// Steps of the hidden layer (recipe `evidence`).
    pub iterations: usize,
    /// Of the hidden units (recipe `evidence`; the published one is ReLU).
    pub activation: Activation,
    /// How M1 gets the placement of the screen.
    pub placement: PlacementFrom,
    /// Name of the session, for the provenance.
    pub session: String,
    /// Name and version of the program, for the provenance.
    pub software: String,
    /// Short name of the robot, for the provenance; empty when not known.
    pub rig: String,
    /// Size of the touchscreen, for the provenance.
    pub screen: Option<ScreenSize>,
}

/// Size of a touchscreen that a model belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScreenSize {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Visible width, m.
    pub width_m: f64,
    /// Visible height, m.
    pub height_m: f64,
}

impl From<&Touchscreen> for ScreenSize {
    fn from(screen: &Touchscreen) -> Self {
        Self {
            width_px: screen.width_px,
            height_px: screen.height_px,
            width_m: screen.width_m,
            height_m: screen.height_m,
        }
    }
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            recipe: Recipe::default(),
            folds: 12,
            block_by: BlockBy::default(),
            members: 3,
            iterations: 4,
            activation: Activation::Tanh,
            placement: PlacementFrom::default(),
            session: String::new(),
            software: String::new(),
            rig: String::new(),
            screen: None,
        }
    }
}
