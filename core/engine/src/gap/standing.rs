//! How the search for effects stands, for who waits for it.

use std::sync::Arc;

use super::view::ShownFinding;
use super::workflow::GapWorkflow;

impl GapWorkflow {
    /// The finding that is shown, with what was made of it, and whether something of it could be added and was
    /// not; `None`: nothing was looked for, or what was found does not tell about now.
    pub fn found(&self) -> Option<(&Arc<ShownFinding>, bool)> {
        let shown = self.seen.shown.as_ref().filter(|_| self.stale().is_none())?;
        Some((shown, !shown.addable().is_empty() || self.seen.sizes_arm))
    }

    /// Findings that are kept, newest first.
    pub fn entries(&self) -> Arc<[super::view::FindingEntry]> {
        self.seen.entries.clone()
    }

    /// Titles of the named effects in the model in use.
    pub fn effects_in_use(&self) -> Vec<String> {
        let named = self.seen.model.effects.iter().filter(|effect| effect.is_named);
        named.map(|effect| effect.title.clone()).collect()
    }
}
