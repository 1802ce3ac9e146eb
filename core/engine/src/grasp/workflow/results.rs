//! What came of it.

use plumbline_grasp::Outcome;

use super::GraspWorkflow;
use crate::grasp::attempt::Proposed;
use crate::grasp::view::AttemptView;
use crate::grasp::work::Context;
use crate::ground::notice::NoticeLevel;

impl GraspWorkflow {
    pub(super) fn planned(&mut self, proposed: Proposed, context: &mut Context<'_>) {
        if let Some(progress) = &self.progress {
            progress.change(|run| (run.seen, run.chosen) = (proposed.seen, proposed.chosen));
        }
        match proposed.plan {
            Ok(plan) => {
                self.closed_at_m = None;
                self.plan = Some(plan);
            }
            Err(why) => {
                self.plan = None;
                context.notices.add(NoticeLevel::Warning, format!("No grasp is planned: {why}."));
            }
        }
    }

    pub(super) fn grasped(&mut self, attempt: AttemptView, summary: &str, context: &mut Context<'_>) {
        let level = match attempt.outcome {
            Some(Outcome::Success) => NoticeLevel::Success,
            _ => NoticeLevel::Warning,
        };
        context.notices.add(level, summary);
        self.plan = None;
        self.closed_at_m = attempt.closed_at_m.or(self.closed_at_m);
        self.attempts.insert(0, attempt);
    }

    pub(super) fn judged(&mut self, attempt: AttemptView) {
        if let Some(progress) = &self.progress {
            progress.change(|run| {
                if run.name == attempt.name {
                    run.told = attempt.told;
                }
            });
        }
        if let Some(known) = self.attempts.iter_mut().find(|known| known.name == attempt.name) {
            *known = attempt;
        }
    }
}
