//! Solves the collected pairs.

use std::sync::Arc;

use plumbline_model::{
    CalibrationOptions, Chessboard, JobContext, PairObservation, StereoCalibration, Workspace, counted,
};
use plumbline_vision::calibrate::{self, SolveError};

use crate::eyes::assess::{Assessment, assess};
use crate::ground::jobs::{JobError, Part};

/// Solve the collected pairs.
#[derive(Clone, Debug)]
pub struct Solve {
    /// The board.
    pub board: Chessboard,
    /// All pairs.
    pub observations: Vec<PairObservation>,
    /// Size (width, height) of both images.
    pub sizes_px: [(u32, u32); 2],
    /// Which of them are left out.
    pub dropped: Vec<String>,
    /// How.
    pub options: CalibrationOptions,
    /// Minutes since the cameras were switched on.
    pub minutes_since_on: Option<f64>,
    /// Where the images come from, for people.
    pub source: String,
    /// For comparison.
    pub in_use: Option<Arc<StereoCalibration>>,
    /// Where the eyes are over the table.
    pub workspace: Workspace,
    /// State of the collection that is solved.
    pub revision: u64,
}

/// A calibration solved from pairs.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The calibration, with its evidence.
    pub calibration: Arc<StereoCalibration>,
    /// What it means on the table.
    pub assessment: Assessment,
    /// State of the collection that was solved.
    pub revision: u64,
    /// How it was solved.
    pub options: CalibrationOptions,
}

impl Solve {
    /// Pairs that are not dropped.
    pub fn pair_count(&self) -> usize {
        self.observations.iter().filter(|pair| !self.dropped.contains(&pair.name)).count()
    }

    /// Solves and looks at the result from all sides.
    pub fn run(self, context: &dyn JobContext) -> Result<Solved, JobError> {
        let solving = Part { whole: context, begin: 0.0, end: 0.95 };
        let solved = calibrate::solve(
            &self.board,
            &self.observations,
            self.sizes_px,
            &self.options,
            &self.dropped,
            &solving,
        );
        let mut calibration = solved.map_err(|error| match error {
            SolveError::Cancelled(cancelled) => JobError::Cancelled(cancelled),
            other => JobError::failed(crate::ground::text::sentence(&other.to_string())),
        })?;
        if let Some(evidence) = &mut calibration.evidence {
            evidence.minutes_since_on = self.minutes_since_on;
            evidence.source = self.source;
        }
        context.report(0.95, "looking what it means on the table");
        let assessment = assess(&calibration, self.in_use.as_deref(), &self.workspace, context)?;
        Ok(Solved {
            calibration: Arc::new(calibration),
            assessment,
            revision: self.revision,
            options: self.options,
        })
    }
}

impl Solved {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        let pairs = self.calibration.per_pair.len();
        match &self.calibration.summary {
            Some(summary) => format!("Solved {}: {:.3} px.", counted(pairs, "pair"), summary.rms_stereo_px),
            None => format!("Solved {}.", counted(pairs, "pair")),
        }
    }
}
