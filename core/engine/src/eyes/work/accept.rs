//! Keeps a calibration and makes it the one in use.

use std::sync::Arc;

use plumbline_model::StereoCalibration;

use crate::eyes::assess::{Assessment, STATED_AT_M};
use crate::eyes::map::TableMap;
use crate::eyes::store::Store;
use crate::eyes::view::{AcceptedCalibration, EarlierCalibration};
use crate::ground::jobs::JobError;

/// Keep a calibration and make it the one in use.
#[derive(Clone, Debug)]
pub struct Accept {
    /// The calibration.
    pub calibration: Arc<StereoCalibration>,
    /// Its uncertainty on the table.
    pub uncertainty: Option<TableMap>,
    /// Depth of one pixel at the stated distance.
    pub depth_per_px_m: Option<f64>,
    /// Where accepted ones are kept.
    pub store: Store,
    /// When it was accepted.
    pub accepted: jiff::Timestamp,
}

/// A calibration that is kept.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The one in use now.
    pub in_use: AcceptedCalibration,
    /// All that are kept, newest first.
    pub earlier: Vec<EarlierCalibration>,
}

impl Accept {
    /// Writes it; only when that succeeded does it become the one in use.
    pub fn run(self) -> Result<Accepted, JobError> {
        let entry = self.store.accept(&self.calibration, self.accepted).map_err(JobError::failed)?;
        let earlier = self.store.list().map_err(JobError::failed)?;
        let in_use = AcceptedCalibration {
            id: entry.id,
            accepted: entry.accepted,
            calibration: self.calibration,
            uncertainty: self.uncertainty,
            stated_at_m: STATED_AT_M,
            depth_per_px_m: self.depth_per_px_m,
        };
        Ok(Accepted { in_use, earlier })
    }
}

/// What the window shows of a calibration in use.
pub fn in_use(
    id: String,
    accepted: jiff::Timestamp,
    calibration: StereoCalibration,
    assessment: Assessment,
) -> AcceptedCalibration {
    AcceptedCalibration {
        id,
        calibration: Arc::new(calibration),
        accepted,
        uncertainty: assessment.uncertainty,
        stated_at_m: STATED_AT_M,
        depth_per_px_m: assessment.depth_per_px_m,
    }
}
