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
