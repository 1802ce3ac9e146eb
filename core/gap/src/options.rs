//! What a search is started with.

use serde::{Deserialize, Serialize};

/// What a search is started with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Of everything that is drawn by chance: folds, bootstraps.
    pub seed: u64,
    /// At most this many effects are named.
    pub most_effects: usize,
    /// Effects that the lab rules out, as `id` or `id@site`.
    pub ruled_out: Vec<String>,
    /// Whether to show the gap on held-out blocks (five more searches).
    pub show: bool,
    /// Whether to look for the next experiment.
    pub advise: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1, most_effects: 6, ruled_out: vec![], show: true, advise: true }
    }
}
