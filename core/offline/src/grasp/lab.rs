//! What a commissioned lab knows, for grasps.

use std::path::Path;
use std::sync::Arc;

use plumbline_correction::Method as Correction;
use plumbline_grasp::{Corrections, Knowledge, Method};
use plumbline_model::JobContext;
use plumbline_model::robot::Rig;
use plumbline_twin::Scenario;

use crate::OfflineError;
use crate::commission::CommissionError;
use crate::commission::lab::Lab;
use crate::commission::published::published;

/// What a lab knows; published methods get what they were published with, learned when it is asked for
/// first.
pub(super) fn knowledge(
    folder: &Path,
    rig: &Arc<Rig>,
    scenario: &Scenario,
    methods: &[Method],
    context: &dyn JobContext,
) -> Result<Knowledge, OfflineError> {
    let lab = Lab { folder: folder.to_owned(), rig: rig.clone(), scenario: scenario.clone(), seed: 1 };
    let calibration = lab.calibration()?;
    let model = lab.known()?;
    let mut corrections = Corrections::default();
    if methods.iter().any(|method| *method != Method::M5) {
        let [m1, m2, m3] = <[_; 3]>::try_from(published(&lab, &Correction::ALL, context)?)
            .map_err(|_| CommissionError::room("the published methods are three"))?
            .map(|model| Some(Arc::new(model)));
        corrections = Corrections { m1, m2, m3 };
    }
    Ok(Knowledge { model, described: rig.clone(), calibration: Arc::new(calibration), corrections })
}
