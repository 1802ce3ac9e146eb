//! What is computed live, for whom, and what came of it last.

mod gave;
mod setting;
mod shown;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_model::robot::default_rig;
use plumbline_model::{StereoCalibration, StereoFrame};

use super::command::{AimChoice, HeadPose, LiveCommand, ProbePoint, Products};
use super::probe::ProbeInput;
use super::rectify::RectifyInput;
use super::setup::{LiveSetup, NoSetup, OtherSize, fitting};
use super::view::{CornersView, DisparityView, LiveView, ProbeView, RectifiedView};
use crate::ground::jobs::JobId;
use crate::ground::statistics::StageClock;
use crate::ground::watched::WatchedThread;
use crate::ground::{Moment, Nothing, Workflow};

/// This room has no work, and tells no thread anything.
type Context<'a> = crate::ground::Context<'a, Nothing>;

/// The live side of the state.
#[derive(Clone, Debug)]
pub struct LiveWorkflow {
    wanted: Products,
    aim: AimChoice,
    head: HeadPose,
    /// How it stood before a recording said how it had stood then.
    head_before: Option<HeadPose>,
    /// The head angles that the present setup was aimed for.
    aimed_for: HeadPose,
    /// For how long the eyes have been on, s.
    eyes_on_s: Option<f64>,
    apart_rad: f64,
    /// The robot as it is known.
    model: Arc<RobotModel>,
    calibration: Option<Arc<StereoCalibration>>,
    /// Lenses as the rig file has them, for eyes that nobody has calibrated yet.
    nominal: Option<Arc<StereoCalibration>>,
    generation: u64,
    /// Or why there is none.
    setup: Result<Arc<LiveSetup>, NoSetup>,
    probe_asked: Option<ProbePoint>,
    raw: Option<StereoFrame>,
    rectified: Option<RectifiedView>,
    disparity: Option<DisparityView>,
    corners: Option<CornersView>,
    probe: Option<ProbeView>,
    failed: Option<String>,
    /// Why stages give nothing any more.
    down: BTreeMap<WatchedThread, String>,
    clocks: Clocks,
}

#[derive(Clone, Debug, Default)]
struct Clocks {
    source: StageClock,
    rectify: StageClock,
    corners: StageClock,
    probe: StageClock,
}

impl Default for LiveWorkflow {
    fn default() -> Self {
        Self {
            wanted: Products::default(),
            aim: AimChoice::default(),
            head: HeadPose::default(),
            head_before: None,
            aimed_for: HeadPose::default(),
            eyes_on_s: None,
            apart_rad: 0.0,
            model: Arc::new(RobotModel::nominal(default_rig())),
            calibration: None,
            nominal: None,
            generation: 0,
            setup: Err(NoSetup::NotCalibrated),
            probe_asked: None,
            raw: None,
            rectified: None,
            disparity: None,
            corners: None,
            probe: None,
            failed: None,
            down: BTreeMap::new(),
            clocks: Clocks::default(),
        }
    }
}

impl LiveWorkflow {
    /// Applies a command.
    pub fn apply(&mut self, command: LiveCommand, context: &mut Context<'_>) {
        match command {
            LiveCommand::Want(wanted) => self.want(wanted),
            LiveCommand::Probe(point) => {
                self.probe_asked = Some(point);
                if let Some(probe) = &mut self.probe {
                    probe.asked = point;
                }
            }
            LiveCommand::StopProbe => (self.probe_asked, self.probe) = (None, None),
            LiveCommand::Aim(aim) => {
                let before = std::mem::replace(&mut self.aim, aim);
                self.set_up();
                if let (Err(reason), Some(_)) = (&self.setup, &self.calibration) {
                    context.refuse(reason);
                    self.aim = before;
                    self.set_up();
                }
            }
            LiveCommand::Head(head) => {
                if head.head_z_rad.is_finite() && head.head_y_rad.is_finite() {
                    self.set_head(head);
                } else {
                    context.refuse("The angles of the head must be numbers.");
                }
            }
        }
    }

    fn want(&mut self, wanted: Products) {
        self.wanted = wanted;
        if !wanted.rectified && !wanted.disparity {
            self.rectified = None;
        }
        if !wanted.disparity {
            self.disparity = None;
        }
        if !wanted.corners {
            self.corners = None;
        }
    }

    /// Newest pair.
    pub fn newest(&self) -> Option<&StereoFrame> {
        self.raw.as_ref()
    }

    /// The source was closed or another one opened: what is shown belongs to no source any more.
    pub fn clear(&mut self) {
        self.raw = None;
        self.clear_products();
        self.corners = None;
        self.clocks = Clocks::default();
    }

    /// What rectification is to do with the newest pair, if anything.
    pub fn rectify_input(&self) -> Option<RectifyInput> {
        if !(self.wanted.rectified || self.wanted.disparity) {
            return None;
        }
        let (frame, setup) = self.fitting()?;
        Some(RectifyInput { frame, setup, disparity: self.wanted.disparity })
    }

    /// What measuring is to do with the newest pair, if anything.
    pub fn probe_input(&self) -> Option<ProbeInput> {
        let (frame, setup) = self.fitting()?;
        Some(ProbeInput { frame, point: self.probe_asked?, setup })
    }

    /// Whether somebody looks at the chessboard's corners.
    pub fn wants_corners(&self) -> bool {
        self.wanted.corners
    }

    /// Whether somebody looks at objects.
    pub fn wants_detections(&self) -> bool {
        self.wanted.detections
    }

    /// What places rest on, or why there are none.
    pub fn setup(&self) -> Result<Arc<LiveSetup>, NoSetup> {
        self.setup.clone()
    }

    /// The newest pair and the setup, if they fit each other.
    fn fitting(&self) -> Option<(StereoFrame, Arc<LiveSetup>)> {
        let (frame, setup) = (self.raw.clone()?, self.setup.clone().ok()?);
        self.misfit().is_none().then_some((frame, setup))
    }

    /// Why the newest pair does not fit the calibration.
    fn misfit(&self) -> Option<OtherSize> {
        let (frame, setup) = (self.raw.as_ref()?, self.setup.as_ref().ok()?);
        fitting(frame, &setup.pair.cameras).err()
    }

    fn clear_products(&mut self) {
        (self.rectified, self.disparity, self.failed) = (None, None, None);
        self.probe = None;
    }
}

impl Workflow for LiveWorkflow {
    type Command = LiveCommand;
    type Work = Nothing;
    type Control = Nothing;
    type Around = ();
    type View = LiveView;

    fn new(_folder: &Path) -> Self {
        Self::default()
    }

    fn view(&mut self, _around: &(), moment: &Moment) -> Arc<LiveView> {
        Arc::new(self.view(moment.skipped, moment.now))
    }

    fn apply(&mut self, command: LiveCommand, _around: &(), context: &mut Context<'_>) {
        self.apply(command, context);
    }

    fn work_done(&mut self, _id: JobId, result: Nothing, _around: &(), _context: &mut Context<'_>) {
        match result {}
    }

    fn work_ended(&mut self, _id: JobId, _why: Option<&str>, _around: &(), _context: &mut Context<'_>) {}
}
