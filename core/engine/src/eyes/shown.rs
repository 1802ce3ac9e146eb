//! What the window shows while the eyes are being calibrated.

use std::sync::Arc;
use std::time::Instant;

use super::clock::is_live;
use super::view::EyesView;
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::step::StepState;

impl EyesWorkflow {
    /// For how long the eyes that are looked through have been on, min; `None`: nobody knows.
    pub(super) fn minutes_since_on(&self, around: &EyesAround, now: Instant) -> Option<f64> {
        if is_live(&around.source) {
            return self.clock.shown_min(now);
        }
        let recorded = around.newest.as_ref().and_then(|newest| newest.beside.then?.on_s);
        // By whole seconds, as of a clock that runs.
        recorded.map(|on_s| on_s.floor() / 60.0).or(self.minutes_of_pairs)
    }

    /// What the window shows.
    pub(super) fn shown(&self, around: &EyesAround, now: Instant) -> EyesView {
        EyesView {
            step: self.step(),
            board: *self.board(),
            board_chosen: self.board_chosen,
            options: self.options.clone(),
            minutes_since_on: self.minutes_since_on(around, now),
            board_seen: self.board_seen.clone(),
            auto_capture: self.auto_capture,
            capture_ended: self.capture_ended,
            hint: self.shown_hint(around, now),
            collected: self.derived.collected.clone(),
            minutes_on: self.minutes_of_each(),
            dropped: Arc::new(self.collection.dropped().clone()),
            not_collected: self.not_collected.clone(),
            can_undo: self.collection.can_undo(),
            pairs_changed: self.pairs_changed(),
            coverage: self.derived.coverage.clone(),
            ghost: self.derived.ghost.clone(),
            solving: self.busy.solving,
            proposal: self.proposal.clone(),
            in_use: self.in_use.clone(),
            is_solved_in_use: self.is_solved_in_use(),
            earlier: self.earlier.clone(),
            health: self.shown_health(around, now),
        }
    }

    fn step(&self) -> StepState {
        if self.busy.any() {
            return StepState::Running;
        }
        let Some(in_use) = self.in_use() else { return StepState::NotDone };
        let (calibrated, now) = (in_use.cameras.left.size_px(), self.image_size_px);
        match now {
            Some(now) if now != calibrated => StepState::Stale {
                why: format!(
                    "The images are {}×{} px now, the calibration in use is for {}×{} px. Calibrate again with these images.",
                    now.0, now.1, calibrated.0, calibrated.1
                ),
            },
            _ => match self.does_not_hold() {
                Some(said) => StepState::Stale { why: said.to_owned() },
                None => StepState::Done,
            },
        }
    }
}
