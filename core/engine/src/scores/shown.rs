//! What the window shows of scores.

use super::ScoresWorkflow;
use super::view::ScoresView;

impl ScoresWorkflow {
    /// What the window shows.
    pub(super) fn shown(&self) -> ScoresView {
        ScoresView {
            models: self.models.as_slice().into(),
            set: self.set.clone(),
            part: self.part,
            evaluating: self.evaluating,
            failed: self.failed.clone(),
            table: self.evaluation.as_ref().map(|evaluation| evaluation.table.clone()),
            cell: self.cell.clone(),
            picture: self.picture,
        }
    }
}
