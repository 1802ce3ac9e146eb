//! What the window shows of models.

use std::sync::Arc;

use plumbline_correction::Method;
use plumbline_model::counted;

use super::screen::{corners, moved_m};
use super::view::{EarlierModel, ModelMap, ModelsView};
use super::workflow::{ModelsAround, ModelsWorkflow};
use crate::ground::sessions::is_for_training;
use crate::ground::step::StepState;

impl ModelsWorkflow {
    /// What the window shows.
    pub(super) fn shown(&self, around: &ModelsAround) -> ModelsView {
        ModelsView {
            step: self.step_state(around),
            next: self.next(around),
            sessions: Arc::from(self.sessions.as_slice()),
            session: self.session.clone(),
            data: self.data.clone(),
            training: self.training.is_some(),
            losses: self.loss_points(),
            proposals: self.proposals.values().map(|proposal| proposal.model.clone()).collect(),
            comparison: self.comparison.clone(),
            shown: self.shown_method(),
            map: self.map(),
            in_use: self.in_use().cloned(),
            earlier: self.earlier(),
            tables: Arc::new(self.tables.view(&around.rig, around.robot.measured.as_ref())),
            rig: Some(around.rig.clone()),
        }
    }

    fn shown_method(&self) -> Option<Method> {
        let in_use = self.in_use.as_ref().map(|in_use| in_use.model.method());
        self.shown.or(in_use).or_else(|| self.proposals.keys().next_back().copied())
    }

    /// The map of the model that is shown: the proposal, else the one in use.
    fn map(&self) -> Option<Arc<ModelMap>> {
        let shown = self.shown_method()?;
        let in_use = self.in_use.as_ref().filter(|in_use| in_use.model.method() == shown);
        let proposal = self.proposals.get(&shown).map(|proposal| &proposal.map);
        proposal.or(in_use.map(|in_use| &in_use.map)).cloned()
    }

    /// What was in use before, newest first.
    fn earlier(&self) -> Arc<[EarlierModel]> {
        let entries = self.history.as_ref().map_or(&[][..], |history| &history.entries);
        let before = entries.iter().rev().skip(1);
        before
            .map(|entry| EarlierModel {
                method: entry.model.as_ref().map(|kept| kept.method),
                accepted: entry.accepted,
            })
            .collect()
    }

    fn step_state(&self, around: &ModelsAround) -> StepState {
        if self.training.is_some() {
            return StepState::Running;
        }
        match (&self.in_use, self.stale(around)) {
            (None, _) => StepState::NotDone,
            (Some(_), Some(why)) => StepState::Stale { why },
            (Some(_), None) => StepState::Done,
        }
    }

    /// Why the model in use does not fit to the screen any more.
    fn stale(&self, around: &ModelsAround) -> Option<String> {
        let kept = self.history.as_ref()?.in_use()?;
        let moved_m = moved_m(&kept.screen_m, &corners(&around.rig.touchscreen))?;
        Some(format!(
            "The touchscreen was placed anew, {:.1} mm from where it lay when {} was made. Train again; if the screen itself was moved, touch it first.",
            moved_m * 1e3,
            kept.method.name()
        ))
    }

    fn next(&self, around: &ModelsAround) -> String {
        if self.training.is_some() {
            return "Models are being trained. Cancelling leaves everything as it was.".to_owned();
        }
        if let Some(why) = self.stale(around) {
            return why;
        }
        if let Some(method) = self.best_proposal() {
            let others = if self.proposals.len() > 1 { "Compare the models" } else { "Look at the map" };
            let best = if self.proposals.len() > 1 {
                format!(" {} errs least on held-out touches.", method.name())
            } else {
                String::new()
            };
            if self.in_use.is_none() {
                return format!("{others} and accept one.{best}");
            }
        }
        match &self.data {
            _ if self.in_use.is_some() => self.next_with_model(around),
            None if self.session.is_some() => "The touches are being read.".to_owned(),
            None => format!(
                "Touch the screen first, step 3, or choose a session with touches. M2 and M3 need {} of them, M1 fewer.",
                super::FEWEST_FOR_A_NETWORK
            ),
            Some(Err(reason)) => reason.to_string(),
            Some(Ok(data)) => {
                format!("Train models on the {} of this session.", counted(data.len(), "touch"))
            }
        }
    }

    fn next_with_model(&self, around: &ModelsAround) -> String {
        let name = self.in_use.as_ref().map_or("The model", |in_use| in_use.model.method().name());
        let newer = around
            .newest_session
            .as_deref()
            .filter(|newest| self.session.as_deref() != Some(*newest) && is_for_training(newest));
        match newer.and_then(|newest| newest.file_name()) {
            Some(newest) => format!(
                "{name} is in use. The screen was touched since: choose {} to train on it.",
                newest.to_string_lossy()
            ),
            None => format!("{name} is in use. Check it by touching new targets with it: step 3, Touch."),
        }
    }

    /// The proposal with the smallest error on held-out touches; of imported ones any.
    fn best_proposal(&self) -> Option<Method> {
        let error_m = |method: &Method| {
            let held_out = self.proposals.get(method)?.model.provenance().cross_validation.as_ref()?;
            Some(held_out.errors.mean_2d_m)
        };
        let methods = self.proposals.keys().copied();
        methods.min_by(|a, b| {
            let or_worst = |method: &Method| error_m(method).unwrap_or(f64::INFINITY);
            or_worst(a).total_cmp(&or_worst(b))
        })
    }
}
