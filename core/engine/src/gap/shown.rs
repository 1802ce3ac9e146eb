//! What the window shows of the gap.

use std::sync::Arc;

use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{RigModel, What};
use plumbline_fit::LEAST_TOUCHES;
use plumbline_gap::Finding;
use plumbline_model::robot::Rig;

use super::model;
use super::store::Named;
use super::view::{GapModelView, GapView, ShownFinding};
use super::workflow::{GapAround, GapWorkflow, LeftOut, Seen};
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
            model: self.seen_with(&around.rig),
            sizes_arm: self.seen.sizes_arm,
            rig: Some(around.rig.clone()),
        }
    }

    /// The model in use, with what of it is not in force with the eyes of this robot.
    fn seen_with(&self, rig: &Rig) -> GapModelView {
        let mut seen = self.seen.model.clone();
        let others = self.model.iter().flat_map(|model| model.effects_of_other_eyes(rig));
        let names: Vec<String> = others.map(ModelEffect::name).collect();
        for effect in &mut seen.effects {
            effect.is_left_out = names.contains(&effect.name);
        }
        seen
    }

    /// Makes anew what is shown, after a change.
    pub(super) fn look(&mut self) {
        if self.left_out.of != self.shown {
            self.left_out = LeftOut { of: self.shown.clone(), effects: vec![] };
        }
        let beside = self.beside.as_ref().and_then(|id| self.named(id));
        self.seen = Seen {
            entries: self.findings.iter().map(|named| named.entry()).collect(),
            shown: self.shown_named().map(|named| {
                Arc::new(ShownFinding {
                    left_out: self.left_out.effects.clone(),
                    ..self.shown_finding(named)
                })
            }),
            beside: beside.map(|named| Arc::new(self.shown_finding(named))),
            model: self.model.as_ref().map(|model| model::view(model, &self.moved_m)).unwrap_or_default(),
            sizes_arm: self.sizes_arm(),
        };
    }

    /// Whether the arm can be corrected by what was shown although it has no name: touches of one session,
    /// compared with the robot as described, and not tried yet.
    fn sizes_arm(&self) -> bool {
        let Some(named) = self.shown_named().filter(|_| self.stale().is_none()) else { return false };
        let finding = &named.kept.finding;
        let [kind] = finding.comparison.kinds.as_slice() else { return false };
        let of_touches = kind.what == What::Touch && finding.comparison.rows >= LEAST_TOUCHES;
        let of_touches = of_touches && finding.sessions.len() == 1;
        let is_open = named.kept.model_effects.is_empty() && !self.not_sized.contains(&named.id);
        let is_in_use = self.model.as_ref().is_some_and(|model| is_of(model, finding));
        of_touches && is_open && !is_in_use && finding.comparison.is_gap
    }

    fn shown_finding(&self, named: &Named) -> ShownFinding {
        let finding = &named.kept.finding;
        let in_model = |id: &str, site: &str, values: &[f64]| {
            let Some(model) = &self.model else { return false };
            // With small shares of others beside it, an effect of the same search has another size, and a
            // family of joints stands there joint by joint.
            let of_search = is_of(model, finding);
            let is_it = |e: &&ModelEffect| e.id == id && (e.site == site || of_search && site.is_empty());
            let is_same = |e: &ModelEffect| e.values == values || (of_search && model.is_named(e));
            model.effects().iter().filter(is_it).any(is_same)
        };
        ShownFinding {
            entry: named.entry(),
            finding: finding.clone(),
            folders: named.kept.sessions.iter().map(|session| session.folder.clone()).collect(),
            added: finding.effects.iter().map(|e| in_model(&e.id, &e.site, &e.values)).collect(),
            left_out: vec![],
        }
    }

    fn step_state(&self) -> StepState {
        if self.searching.is_some() {
            return StepState::Running;
        }
        match (self.shown_named(), self.stale()) {
            (None, _) => StepState::NotDone,
            (Some(_), Some(why)) => StepState::Stale { why },
            // What was found and is not in the model is work that is left.
            (Some(_), None) => match self.found() {
                Some((_, true)) => StepState::NotDone,
                _ => StepState::Done,
            },
        }
    }
}

/// Whether the last that was added to a model came of this finding; a look at the hands keeps its names.
fn is_of(model: &RigModel, finding: &Finding) -> bool {
    let mut added = model.history.iter().filter(|step| step.can_be_undone());
    let last = added.rfind(|step| step.sentence != plumbline_handeye::SENTENCE);
    last.is_some_and(|last| last.sentence == finding.sentence && last.sessions == finding.sessions)
}
