//! What is shown, made only when it changes.

use std::sync::Arc;

use super::view::{LabelCounts, LabelImage, LabelProblem, LabelSetView, ShownLabels};

/// What is shown, made only when it changes.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub set: Option<Arc<LabelSetView>>,
    pub images: Arc<[LabelImage]>,
    pub counts: LabelCounts,
    pub problems: Arc<[LabelProblem]>,
    pub shown: Option<ShownLabels>,
}
