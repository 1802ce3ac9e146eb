//! `plumbline lerobot`: a recording as a LeRobot data set.

use std::collections::BTreeMap;
use std::path::PathBuf;

use plumbline_lerobot::{Options, export};
use plumbline_model::JobContext;
use plumbline_recording::FILE;
use plumbline_vision::calibration_file;
use serde::Serialize;

use super::OfflineError;

/// Which recording, and where to.
#[derive(Clone, Debug)]
pub struct LerobotArgs {
    /// Session with a recording `log.mcap`.
    pub session: PathBuf,
    /// Folder that receives the data set; empty or new.
    pub out: PathBuf,
    /// What was being done, a sentence.
    pub task: String,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LerobotReport {
    /// The folder.
    pub out: PathBuf,
    /// Pairs of images in it.
    pub frames: usize,
    /// Pairs from before angles were read: not in it.
    pub left_out: usize,
    /// Pairs a second, by the median of the times between them.
    pub rate_hz: f64,
    /// Joints whose angles are in it.
    pub joints: Vec<String>,
    /// Those of them whose commanded angles are in it as `action`.
    pub actions: Vec<String>,
    /// The others, and in how many pairs each was told nothing.
    pub not_commanded: BTreeMap<String, usize>,
    /// Whether lenses and how the eyes sit to each other are in it: the recording has a calibration.
    pub has_cameras: bool,
    /// Whether it says where the left eye was in the robot: the recording says how the head stood.
    pub has_places: bool,
    /// Pairs of which that is not known.
    pub without_place: usize,
    /// The same in sentences for people.
    #[serde(skip)]
    pub said: Vec<String>,
}

/// Writes the data set.
pub fn lerobot(args: &LerobotArgs, context: &dyn JobContext) -> Result<LerobotReport, OfflineError> {
    let beside = args.session.join("rig-cameras.yaml");
    let calibration = if beside.is_file() { Some(calibration_file::load(&[beside])?) } else { None };
    let cameras = calibration.as_ref().map(|calibration| &calibration.cameras);
    let options = Options { task: &args.task, cameras };
    let exported = export(&args.session.join(FILE), &args.out, &options, context)?;
    Ok(LerobotReport {
        said: exported.said(),
        out: args.out.clone(),
        frames: exported.frames,
        left_out: exported.left_out,
        rate_hz: exported.rate_hz,
        joints: exported.joints,
        actions: exported.actions,
        not_commanded: exported.not_commanded.into_iter().map(|joint| (joint.joint, joint.frames)).collect(),
        has_cameras: exported.has_cameras,
        has_places: exported.has_places,
        without_place: exported.without_place,
    })
}
