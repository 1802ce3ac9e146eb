//! How the run that is under way or shown stands, for who counts touches.

use std::path::PathBuf;

use jiff::Timestamp;
use plumbline_model::touch_plan::Purpose;

use super::run::Phase;
use super::workflow::TouchWorkflow;

/// How a run of touches stands.
#[derive(Clone, Debug, PartialEq)]
pub struct RunStanding {
    /// Its session.
    pub session: PathBuf,
    /// When it was begun.
    pub started: Timestamp,
    /// What for.
    pub purpose: Purpose,
    /// Whether it is finished, and on disk.
    pub is_finished: bool,
    /// Touches that count.
    pub touched: usize,
    /// Contacts, also those that do not count.
    pub contacts: usize,
    /// How far they miss, mean, m; `None` before the second.
    pub mean_m: Option<f64>,
}

impl TouchWorkflow {
    /// How the run stands that is under way or shown; `None`: there is none.
    pub fn run_standing(&self) -> Option<RunStanding> {
        let run = self.run.as_ref()?;
        Some(RunStanding {
            session: run.session.clone(),
            started: run.progress.started,
            purpose: run.progress.purpose,
            is_finished: run.is_over(),
            touched: run.progress.counted().count(),
            contacts: run.progress.records.len(),
            mean_m: self.seen.figures.map(|figures| figures.mean_m),
        })
    }

    /// Whether a run goes on by itself, the arm before, at or on its way to the next target.
    pub fn is_touching(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.phase == Phase::Working)
    }

    /// Whether a run was begun and is not over: it moves the arm, waits or is paused.
    pub fn is_under_way(&self) -> bool {
        self.active_run().is_some()
    }

    /// Why nothing else may use the arm because of a run, and what to do; a sentence.
    pub fn in_the_way(&self) -> Option<&'static str> {
        let run = self.run.as_ref().filter(|run| run.is_active())?;
        match run.phase {
            Phase::Working => Some("A run of touches moves the arm: pause it, or wait until it is over."),
            Phase::Preparing(_) => Some(
                "A run of touches waits until somebody has moved the screen or a weight: say that it is done, or finish the run, first.",
            ),
            _ => run.left_to_put_back().map(|_| {
                "For a run of touches the screen stands on a block, or a weight is in the hand: finish the run first, it asks for them back."
            }),
        }
    }

    /// The place of the screen in use; `None`: not read yet. Inside `None`: the nominal one is.
    pub fn accepted(&self) -> Option<Option<&std::sync::Arc<plumbline_model::touchscreen::ScreenPlacement>>> {
        self.is_known.then_some(self.placement.as_ref())
    }

    /// With what the targets of the run that is under way or shown were corrected, and how far those of it
    /// miss that were sent as the robot is described, m.
    pub fn run_corrected(&self) -> (Option<super::command::Correction>, Option<f64>) {
        let with = self.run.as_ref().and_then(|run| run.plan.corrected_with);
        (with, self.seen.figures_described.map(|figures| figures.mean_m))
    }

    /// The place of the screen in use; `None`: nominal.
    pub fn placement(&self) -> Option<&plumbline_model::touchscreen::ScreenPlacement> {
        self.placement.as_deref()
    }
}
