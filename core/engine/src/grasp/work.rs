//! What takes long in grasping.

use std::path::PathBuf;
use std::time::Duration;

use plumbline_grasp::Outcome;
use plumbline_model::JobContext;

use super::attempt::{Attempt, CarriedOut, Proposed};
use super::command::HandStep;
use super::keeping::{self, Keeping};
use super::steps::{HandWork, NoStep};
use super::view::{AttemptView, is_halted, is_unseen};
use crate::ground::jobs::JobError;
use crate::ground::{self, LongWork};
use crate::robot::RobotControl;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum GraspWork {
    /// Reads what became of attempts.
    Restore {
        /// Where they are kept.
        grasps: PathBuf,
    },
    /// Looks and plans.
    Plan(Box<Attempt>),
    /// Grasps.
    Grasp(Box<Attempt>),
    /// A step of the hand by itself.
    Hand(Box<HandWork>),
    /// Keeps what the operator saw.
    Judge {
        /// Folder of the attempt.
        folder: PathBuf,
        /// Whether the object was held.
        held: bool,
    },
    /// Keeps that what was held has slipped out of the hand.
    Slipped {
        /// Folder of the attempt.
        folder: PathBuf,
        /// So long after the grasp had ended.
        after: Duration,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum GraspResult {
    /// Attempts, newest first, and what is wrong with others.
    Restored(Vec<AttemptView>, Vec<String>),
    /// What would be sent.
    Planned(Box<Proposed>),
    /// What became of an attempt.
    Grasped(Box<CarriedOut>),
    /// A step was made, or why not.
    HandDone(HandStep, Result<(), NoStep>),
    /// What the operator saw is kept.
    Judged(Box<AttemptView>),
    /// That it has slipped out of the hand is kept.
    SlipKept(Box<AttemptView>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, GraspWork, RobotControl>;

impl LongWork for GraspWork {
    type Result = GraspResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read earlier grasps".to_owned(),
            Self::Plan(_) => "Plan a grasp".to_owned(),
            Self::Grasp(attempt) => format!("Grasp by {}", attempt.method.name().to_uppercase()),
            Self::Hand(work) => work.step.title().to_owned(),
            Self::Judge { .. } => "Keep what was seen".to_owned(),
            Self::Slipped { .. } => "Keep that it slipped out".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        // What became of it is told by the workflow, in words of its own.
        true
    }

    fn run(self, context: &dyn JobContext) -> Result<GraspResult, JobError> {
        match self {
            Self::Restore { grasps } => {
                let (attempts, problems) = keeping::list(&grasps);
                Ok(GraspResult::Restored(attempts, problems.iter().map(ToString::to_string).collect()))
            }
            Self::Plan(attempt) => Ok(GraspResult::Planned(Box::new(attempt.propose(context)?))),
            Self::Grasp(attempt) => Ok(GraspResult::Grasped(Box::new(attempt.carry_out(context)?))),
            Self::Hand(work) => Ok(GraspResult::HandDone(work.step, work.carry_out(context)?)),
            Self::Judge { folder, held } => {
                let keeping = Keeping::of(folder);
                let mut record = keeping.read().map_err(JobError::told)?;
                record.told_by_operator = Some(held);
                keeping.record(&record).map_err(JobError::told)?;
                Ok(GraspResult::Judged(Box::new(keeping.view(&record))))
            }
            Self::Slipped { folder, after } => {
                let keeping = Keeping::of(folder);
                let mut record = keeping.read().map_err(JobError::told)?;
                record.slipped_after_s = Some(after.as_secs_f64());
                keeping.record(&record).map_err(JobError::told)?;
                Ok(GraspResult::SlipKept(Box::new(keeping.view(&record))))
            }
        }
    }
}

impl GraspResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(attempts, _) => format!("{} earlier grasps.", attempts.len()),
            Self::Planned(proposed) => match &proposed.plan {
                Ok(_) => "A grasp is planned.".to_owned(),
                Err(why) => format!("No grasp is planned: {why}."),
            },
            Self::Grasped(done) => match &done.attempt.outcome {
                Some(Outcome::Success) => {
                    format!("Fingers and eyes say: the {} is held.", done.attempt.object.to_lowercase())
                }
                Some(outcome @ Outcome::Failed { why, .. }) => {
                    let what = match outcome {
                        outcome if is_halted(outcome) => "Broken off",
                        outcome if is_unseen(outcome) => "Not grasped",
                        _ => "Not held",
                    };
                    format!("{what}: {why}.")
                }
                Some(Outcome::Refused { why }) => format!("Not grasped: {why}."),
                None => "The grasp ended without a word.".to_owned(),
            },
            Self::HandDone(step, Ok(())) => format!("{}: done.", step.title()),
            Self::HandDone(step, Err(why)) => {
                format!("{}: {}.", step.title(), why.to_string().trim_end_matches('.'))
            }
            Self::Judged(attempt) => match attempt.told {
                Some(true) => "Kept: it was held.".to_owned(),
                _ => "Kept: it was not held.".to_owned(),
            },
            Self::SlipKept(_) => "Kept: it was held, and slipped out of the hand.".to_owned(),
        }
    }
}
