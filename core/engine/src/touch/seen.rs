//! Lists for the window that are made only when something has changed.

use std::sync::Arc;

use super::plan::RunPlan;
use super::view::{PlanView, TouchCounts, TouchFigures, TouchState};

/// Lists that are made only when something has changed.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub plan: Option<Arc<PlanView>>,
    pub touches: Arc<[TouchState]>,
    pub counts: TouchCounts,
    pub figures: Option<TouchFigures>,
    pub figures_described: Option<TouchFigures>,
    /// Which plan `plan` was made from.
    pub of: Option<Arc<RunPlan>>,
}
