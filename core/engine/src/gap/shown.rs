//! What the window shows of the gap.

use std::sync::Arc;

use super::model;
use super::store::Named;
use super::view::{GapView, ShownFinding};
use super::workflow::{GapAround, GapWorkflow, Seen};
use crate::ground::step::StepState;

impl GapWorkflow {
    /// What the window shows.
    pub(super) fn shown(&self, around: &GapAround) -> GapView {
        GapView {
            step: self.step_state(),
            sessions: Arc::from(self.sessions.as_slice()),
            chosen: Arc::from(self.chosen.as_slice()),
            with: self.with,
            searching: self.searching,
            failed: self.failed.clone(),
            findings: self.seen.entries.clone(),
            shown: self.seen.shown.clone(),
            beside: self.seen.beside.clone(),
            stale: self.stale(),
            model: self.seen.model.clone(),
            rig: Some(around.rig.clone()),
        }
    }

    /// Makes anew what is shown, after a change.
    pub(super) fn look(&mut self) {
        let beside = self.beside.as_ref().and_then(|id| self.named(id));
        self.seen = Seen {
            entries: self.findings.iter().map(|named| named.entry()).collect(),
            shown: self.shown_named().map(|named| Arc::new(self.shown_finding(named))),
            beside: beside.map(|named| Arc::new(self.shown_finding(named))),
            model: self.model.as_ref().map(|model| model::view(model)).unwrap_or_default(),
        };
    }

    fn shown_finding(&self, named: &Named) -> ShownFinding {
        let finding = &named.kept.finding;
        let in_model = |id: &str, site: &str, values: &[f64]| {
            let effects = self.model.iter().flat_map(|model| model.effects());
            effects.into_iter().any(|e| e.id == id && e.site == site && e.values == values)
        };
        ShownFinding {
            entry: named.entry(),
            finding: finding.clone(),
            folders: named.kept.sessions.iter().map(|session| session.folder.clone()).collect(),
            added: finding.effects.iter().map(|e| in_model(&e.id, &e.site, &e.values)).collect(),
        }
    }

    fn step_state(&self) -> StepState {
        if self.searching.is_some() {
            return StepState::Running;
        }
        match (self.shown_named(), self.stale()) {
            (None, _) => StepState::NotDone,
            (Some(_), Some(why)) => StepState::Stale { why },
            (Some(_), None) => StepState::Done,
        }
    }
}
