//! What a commissioned lab knows, for grasps.

use std::path::Path;
use std::sync::Arc;

use plumbline_grasp::{Corrections, Knowledge, Method};
use plumbline_model::JobContext;
use plumbline_model::robot::Rig;
use plumbline_twin::Scenario;

use crate::OfflineError;
use crate::commission::lab::Lab;
use crate::commission::published::corrections;

/// What a lab knows; published methods get what they were published with, made when it is asked for first.
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
    let corrections = match methods.iter().any(|method| *method != Method::M5) {
        true => corrections(&lab, context)?,
        false => Corrections::default(),
    };
    Ok(Knowledge { model, described: rig.clone(), calibration: Arc::new(calibration), corrections })
}
