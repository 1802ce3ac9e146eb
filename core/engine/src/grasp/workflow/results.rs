//! What came of it.

use plumbline_grasp::Outcome;

use super::GraspWorkflow;
use crate::grasp::around::GraspAround;
use crate::grasp::attempt::{CarriedOut, Proposed};
use crate::grasp::held::HeldWatch;
use crate::grasp::view::{AttemptView, SinceHeld};
use crate::grasp::waits::Waits;
use crate::grasp::work::{Context, GraspWork};
use crate::ground::notice::NoticeLevel;

impl GraspWorkflow {
    pub(super) fn planned(&mut self, proposed: Proposed, around: &GraspAround, context: &mut Context<'_>) {
        if let Some(progress) = &self.progress {
            progress.change(|run| (run.seen, run.chosen) = (proposed.seen, proposed.chosen));
        }
        match proposed.plan {
            Ok(plan) => {
                self.closed_at_m = None;
                (self.plan, self.planned_with) = (Some(plan), Some(around.model.clone()));
            }
            Err(why) => {
                self.plan = None;
                context.notices.add(NoticeLevel::Warning, format!("No grasp is planned: {why}."));
            }
        }
    }

    pub(super) fn grasped(
        &mut self,
        done: CarriedOut,
        summary: &str,
        around: &GraspAround,
        context: &mut Context<'_>,
    ) {
        let CarriedOut { attempt, not_kept } = done;
        let level = match attempt.outcome {
            Some(Outcome::Success) => NoticeLevel::Success,
            _ => NoticeLevel::Warning,
        };
        context.notices.add(level, summary);
        if let Some(why) = not_kept {
            let text = format!("How the joints moved at its end is not kept: {why}.");
            context.notices.add(NoticeLevel::Warning, text);
        }
        self.plan = None;
        self.hand_moved = false;
        self.waits = Waits::after_attempt(&attempt, self.waits.as_ref(), &around.robot);
        self.closed_at_m = attempt.closed_at_m.or(self.closed_at_m);
        self.held = match attempt.outcome {
            Some(Outcome::Success) => {
                HeldWatch::of(&attempt, &around.described, &around.robot, context.time.instant)
            }
            _ => None,
        };
        self.attempts.insert(0, attempt);
    }

    /// Whether something is in the hand, or may be, so that it has to be looked at.
    pub fn is_watching(&self) -> bool {
        let may_hold = self.waits.as_ref().is_some_and(|waits| waits.may_hold().is_some());
        (self.held.is_some() || may_hold) && self.running.is_none()
    }

    /// The robot has something new: is what was grasped still in the hand?
    pub fn watch(&mut self, around: &GraspAround, context: &mut Context<'_>) {
        if self.running.is_some() {
            return;
        }
        self.waits = self.waits.take().map(|waits| waits.seen(&around.described, &around.robot));
        let Some(watch) = &mut self.held else { return };
        match watch.look(&around.robot, context.time.instant) {
            SinceHeld::Held => {}
            since => self.is_not_held_any_more(since, context),
        }
    }

    /// What was in the hand is not, or nobody knows.
    fn is_not_held_any_more(&mut self, since: SinceHeld, context: &mut Context<'_>) {
        let Some(watch) = self.held.take() else { return };
        if let Some(progress) = &self.progress {
            progress.change(|run| {
                if run.name == watch.attempt {
                    run.since = since;
                }
            });
        }
        if let SinceHeld::Slipped(after) = since {
            let text = format!(
                "The {} was held and has slipped out of the {} hand {} s later.",
                watch.object.to_lowercase(),
                watch.hand.name(),
                after.as_secs()
            );
            context.notices.add(NoticeLevel::Warning, text);
            context.start(GraspWork::Slipped { folder: watch.folder, after });
        }
    }

    pub(super) fn judged(&mut self, attempt: AttemptView) {
        if attempt.told == Some(false) {
            // A person sees more than the fingers feel.
            self.held = self.held.take().filter(|held| held.attempt != attempt.name);
        }
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
