//! The stages of an attempt: laid down, grasped, judged, kept, cleared.

use std::time::{Duration, Instant};

use plumbline_grasp::{Failure, Outcome};

use super::{TrialsAround, TrialsWorkflow};
use crate::grasp::command::{GraspCommand, GraspTarget, HandStep};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::trials::plan::Trial;
use crate::trials::view::{ShownTrials, TrialStage, TrialsPhase};
use crate::trials::work::{Context, TrialsWork};
use crate::twin::command::TwinCommand;

/// A thing that was laid down comes to rest within this.
pub(super) const SETTLES: Duration = Duration::from_millis(1500);
/// What is still in the hand so long after the attempt is held, as the command line judges it.
const HOLDS: Duration = Duration::from_secs(10);
/// The eyes have seen it lie there within this, or they are blind, which grasping says.
const SEEN_WITHIN: Duration = Duration::from_secs(10);
/// A thing that is this much higher than before is lifted, m.
const LIFTED_M: f64 = 0.04;
/// The pace is that of so many attempts.
const PACE_OF: usize = 10;

/// Where the attempt under way is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stage {
    /// A person lays the thing down.
    Asks,
    /// It was laid down, and comes to rest until then.
    Laying(Instant),
    /// Grasping was told to begin; the name of the attempt before, and how high the thing stood.
    Grasping { before: Option<String>, height_m: Option<f64> },
    /// It has ended; how high the thing stood before, and since when it is looked at.
    Judging { height_m: Option<f64>, since: Instant },
    /// The attempt is being written.
    Keeping(JobId),
    /// What the hand still has to do.
    Clearing(Vec<HandStep>),
}

/// The attempt under way.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnderWay {
    pub trial: Trial,
    pub placed_m: [f64; 2],
    pub stage: Stage,
    pub began: Instant,
}

impl TrialsWorkflow {
    /// The robot has something new, or time has passed.
    pub fn step(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        let (Some(attempt), Some(shown)) = (&mut self.under_way, self.shown.clone()) else { return };
        let object = &shown.experiment.object;
        let now = context.time.instant;
        match attempt.stage.clone() {
            // The robot and its eyes may be busy: what is not seen yet is waited for.
            Stage::Laying(until)
                if now >= until + SEEN_WITHIN
                    || now >= until && around.is_seen_at(object, attempt.placed_m, until) =>
            {
                let target = GraspTarget { class: Some(object.clone()), near_m: Some(attempt.placed_m) };
                self.wishes = vec![
                    GraspCommand::Method(attempt.trial.method),
                    GraspCommand::Arm(shown.experiment.hand),
                    GraspCommand::Target(target),
                    GraspCommand::Grasp,
                ];
                let before = around.grasp.newest.as_ref().map(|newest| newest.name.clone());
                attempt.stage = Stage::Grasping { before, height_m: around.height_m(object) };
            }
            // What was wished for is handed over at the end of this call.
            Stage::Grasping { before, height_m } if around.grasp.is_idle && self.wishes.is_empty() => {
                match &around.grasp.newest {
                    Some(newest) if Some(&newest.name) != before.as_ref() => {
                        attempt.stage = Stage::Judging { height_m, since: now };
                    }
                    _ => {
                        self.hold("The attempt could not begin; the messages say why. Mend that, then go on.")
                    }
                }
            }
            Stage::Judging { height_m, since } => self.judge(height_m, since, around, &shown, context),
            Stage::Clearing(steps) if around.grasp.is_idle && self.wishes.is_empty() => {
                match steps.split_first() {
                    Some((first, rest)) => {
                        self.wishes = vec![GraspCommand::Hand(*first)];
                        attempt.stage = Stage::Clearing(rest.to_vec());
                    }
                    None => self.cleared(around, context),
                }
            }
            _ => {}
        }
    }

    /// Whether it was lifted: the twin's scene shows it; on the robot a person says it.
    fn judge(
        &mut self,
        height_m: Option<f64>,
        since: Instant,
        around: &TrialsAround,
        shown: &ShownTrials,
        context: &mut Context<'_>,
    ) {
        let (Some(attempt), Some(newest)) = (&mut self.under_way, &around.grasp.newest) else { return };
        if let Some(Outcome::Failed { failure: Failure::Halted | Failure::EyesLost, why }) = &newest.outcome {
            let why = format!(
                "It was broken off ({}), and is made again when you go on.",
                why.trim_end_matches('.')
            );
            return self.hold(&why);
        }
        let lifted = match around.is_twin {
            // The hand comes to rest first, or what slips would count.
            true if context.time.instant < since + looked_at_for(newest.outcome.as_ref()) => return,
            true => {
                let now_m = around.height_m(&shown.experiment.object);
                now_m.zip(height_m).is_some_and(|(now_m, before_m)| now_m - before_m > LIFTED_M)
            }
            false => match (newest.told, &newest.outcome) {
                (Some(told), _) => told,
                // Nothing moved at last, so there is nothing to be seen.
                (None, Some(Outcome::Refused { .. })) => false,
                (None, _) => return,
            },
        };
        let job = context.start(TrialsWork::Keep {
            folder: shown.folder.clone(),
            experiment: Box::new(shown.experiment.clone()),
            trial: attempt.trial,
            placed_m: attempt.placed_m,
            grasp: newest.folder.clone(),
            lifted,
            rig: around.rig.clone(),
        });
        attempt.stage = Stage::Keeping(job);
    }

    /// An attempt is on disk: the hand is emptied, and the arm goes home.
    pub(super) fn kept(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        let object = self.shown.as_ref().map(|shown| shown.experiment.object.to_lowercase());
        let (Some(attempt), Some(toy)) = (&mut self.under_way, object) else { return };
        self.paces.push(context.time.instant.saturating_duration_since(attempt.began));
        let first = match around.is_twin {
            true => {
                context.control(TwinCommand::RemoveToy { toy }.into());
                HandStep::Open
            }
            // What a person saw held is put down; a hand that holds nothing only opens.
            false if around.grasp.newest.as_ref().is_some_and(|newest| newest.told == Some(true)) => {
                HandStep::Place
            }
            false => HandStep::Open,
        };
        attempt.stage = Stage::Clearing(vec![first, HandStep::Home]);
    }

    fn cleared(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        self.under_way = None;
        if std::mem::take(&mut self.pausing) {
            return;
        }
        if self.open.is_empty() {
            context.notices.add(NoticeLevel::Success, "All attempts of the experiment are made.");
        } else if let Err(why) = self.next(around, context) {
            context.refuse(why);
        }
    }

    pub(super) fn hold(&mut self, why: &str) {
        (self.under_way, self.pausing) = (None, false);
        self.paused = Some(why.to_owned());
    }

    pub(super) fn phase(&self) -> TrialsPhase {
        let Some(attempt) = &self.under_way else {
            return match &self.paused {
                Some(why) => TrialsPhase::Paused { why: why.clone() },
                None => TrialsPhase::Idle,
            };
        };
        let trial = attempt.trial;
        let running = |doing| TrialsPhase::Running { trial, doing, pausing: self.pausing };
        match &attempt.stage {
            Stage::Asks => TrialsPhase::Asks { trial, at_m: attempt.placed_m },
            Stage::Laying(_) => running(TrialStage::Laying),
            Stage::Grasping { .. } => running(TrialStage::Grasping),
            Stage::Judging { .. } => running(TrialStage::Judging),
            Stage::Keeping(_) | Stage::Clearing(_) => running(TrialStage::Clearing),
        }
    }

    /// At the pace of the last attempts.
    pub(super) fn remaining(&self) -> Option<Duration> {
        let last = &self.paces[self.paces.len().saturating_sub(PACE_OF)..];
        let left = u32::try_from(self.open.len()).ok()?;
        let count = u32::try_from(last.len()).ok().filter(|count| *count > 0)?;
        Some(last.iter().sum::<Duration>() / count * left)
    }
}

/// For how long a thing is looked at before it counts.
fn looked_at_for(outcome: Option<&Outcome>) -> Duration {
    if outcome == Some(&Outcome::Success) { HOLDS } else { SETTLES }
}
