//! What can be chosen about training.

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
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            recipe: Recipe::default(),
            folds: 12,
            block_by: BlockBy::default(),
            members: 3,
            iterations: 8,
            activation: Activation::default(),
            placement: PlacementFrom::default(),
            session: String::new(),
            software: String::new(),
        }
    }
}
