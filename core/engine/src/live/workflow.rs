//! What is computed live, for whom, and what came of it last.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use plumbline_effects::RobotModel;
use plumbline_model::aim::DEFAULT_SIZE_PX;
use plumbline_model::robot::{Posture, default_rig};
use plumbline_model::{AimError, AimedPair, StereoCalibration, StereoFrame, Workspace};

use super::command::{AimChoice, HeadPose, LiveCommand, ProbePoint, Products};
use super::probe::{ProbeInput, ProbeOutput};
use super::rectify::{RectifyInput, RectifyOutput};
use super::setup::{LiveSetup, NoSetup, OtherSize, aimed, fitting, max_disparity_px};
use super::view::{
    AimView, CornersView, DisparityView, LiveView, NotMeasured, ProbeView, RectifiedView, Statistics,
};
use crate::eyes::Look;
use crate::ground::jobs::JobId;
use crate::ground::stage::{Skipped, Timed};
use crate::ground::statistics::StageClock;
use crate::ground::text::sentence;
use crate::ground::watched::WatchedThread;
use crate::ground::{Moment, Nothing, Workflow};

/// This room has no work, and tells no thread anything.
type Context<'a> = crate::ground::Context<'a, Nothing>;

/// Turns of the head from which the virtual pair is aimed anew, rad.
const AIM_ANEW_RAD: f64 = 0.02;

/// The live side of the state.
#[derive(Clone, Debug)]
pub struct LiveWorkflow {
    wanted: Products,
    aim: AimChoice,
    head: HeadPose,
    /// The head angles that the present setup was aimed for.
    aimed_for: HeadPose,
    /// For how long the eyes have been on, s.
    eyes_on_s: Option<f64>,
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
            aimed_for: HeadPose::default(),
            eyes_on_s: None,
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

    /// Takes over the calibration in use; does nothing if it is the one already known.
    pub fn set_calibration(&mut self, calibration: Option<&Arc<StereoCalibration>>) {
        let same = match (&self.calibration, calibration) {
            (Some(known), Some(new)) => Arc::ptr_eq(known, new),
            (None, None) => true,
            _ => false,
        };
        if !same {
            self.calibration = calibration.cloned();
            self.set_up();
        }
    }

    /// The head has turned. A small turn only moves the eyes; a larger one aims the virtual pair
    /// anew.
    pub fn set_head(&mut self, head: HeadPose) {
        self.head = head;
        let turned_rad = (head.head_z_rad - self.aimed_for.head_z_rad)
            .abs()
            .max((head.head_y_rad - self.aimed_for.head_y_rad).abs());
        if turned_rad > AIM_ANEW_RAD {
            self.set_up();
            return;
        }
        let posture = self.posture();
        if let Ok(setup) = &mut self.setup {
            Arc::make_mut(setup).posture = posture;
        }
    }

    /// For how long the eyes have been on, s; `None`: nobody knows.
    pub fn set_eyes_on(&mut self, eyes_on_s: Option<f64>) {
        if eyes_on_s != self.eyes_on_s {
            self.eyes_on_s = eyes_on_s;
            if let Ok(setup) = &mut self.setup {
                Arc::make_mut(setup).eyes_on_s = eyes_on_s;
            }
        }
    }

    /// Takes over what is known of the robot; places rest on it from now on.
    pub fn set_model(&mut self, model: &Arc<RobotModel>) {
        if Arc::ptr_eq(&self.model, model) {
            return;
        }
        let before = std::mem::replace(&mut self.model, model.clone());
        if before.rig().eyes != model.rig().eyes || !Arc::ptr_eq(before.added(), model.added()) {
            self.nominal = self.nominal.as_ref().map(|_| lenses_of(model));
            self.set_up();
        } else if let Ok(setup) = &mut self.setup {
            Arc::make_mut(setup).model = model.clone();
        }
    }

    /// Whether the rig's lenses stand in as long as nobody has calibrated these eyes.
    pub fn use_nominal_lenses(&mut self, wanted: bool) {
        if wanted != self.nominal.is_some() {
            self.nominal = wanted.then(|| lenses_of(&self.model));
            self.set_up();
        }
    }

    /// The part of the table that the eyes look at, and from where.
    pub fn workspace(&self) -> Workspace {
        let posture = self.posture();
        let robot_from_left = self.model.robot_from_left(&posture);
        Workspace { robot_from_left, ..self.model.rig().workspace(&posture) }
    }

    fn posture(&self) -> Posture {
        let HeadPose { head_z_rad, head_y_rad } = self.head;
        let rig = self.model.rig();
        rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[head_z_rad, head_y_rad])
    }

    /// Newest pair.
    pub fn newest(&self) -> Option<&StereoFrame> {
        self.raw.as_ref()
    }

    /// A pair has come from the source.
    pub fn frame(&mut self, frame: StereoFrame, now: Instant) {
        self.clocks.source.note(now, frame.stamp.captured_at, std::time::Duration::ZERO);
        self.raw = Some(frame);
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

    /// Rectification has something. What belongs to an older setup is not shown.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        if output.result.generation != self.generation || !(self.wanted.rectified || self.wanted.disparity) {
            return;
        }
        self.clocks.rectify.note(now, output.stamp.captured_at, output.busy);
        match output.result.products {
            Ok((rectified, disparity)) => {
                self.rectified = Some(rectified);
                if self.wanted.disparity && disparity.is_some() {
                    self.disparity = disparity;
                }
                self.failed = None;
            }
            Err(reason) => {
                (self.rectified, self.disparity) = (None, None);
                self.failed = Some(sentence(&reason.to_string()));
            }
        }
    }

    /// A stage gives nothing any more, or does again.
    pub fn stage_is_down(&mut self, stage: WatchedThread, why: Option<String>) {
        match why {
            Some(why) => {
                self.gave_nothing(stage, &why);
                self.down.insert(stage, why);
            }
            None => {
                self.down.remove(&stage);
                self.failed = None;
            }
        }
    }

    /// A stage gave nothing of the newest pair: what it gave before must not be taken for it.
    pub fn gave_nothing(&mut self, stage: WatchedThread, why: &str) {
        match stage {
            WatchedThread::Rectify => {
                (self.rectified, self.disparity) = (None, None);
                self.failed = Some(why.to_owned());
            }
            WatchedThread::Corners => self.corners = None,
            WatchedThread::Probe => {
                let asked = self.probe_asked;
                let failed = |asked| ProbeView {
                    asked,
                    stamp: None,
                    reading: Err(NotMeasured::Nothing(why.to_owned())),
                };
                self.probe = asked.map(failed);
            }
            _ => {}
        }
    }

    /// The chessboard search has something.
    pub fn corners(&mut self, output: &Timed<Look>, now: Instant) {
        self.clocks.corners.note(now, output.stamp.captured_at, output.busy);
        if self.wanted.corners {
            let shown = |corners: &Option<plumbline_model::Corners>| {
                corners.as_ref().map(|corners| corners.iter().flatten().copied().collect())
            };
            let look = &output.result;
            self.corners =
                Some(CornersView { stamp: output.stamp, left: shown(&look.left), right: shown(&look.right) });
        }
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        let ProbeOutput { point, generation, reading } = output.result;
        if generation != self.generation || self.probe_asked.is_none() {
            return;
        }
        self.clocks.probe.note(now, output.stamp.captured_at, output.busy);
        let reading = reading.map_err(NotMeasured::from);
        self.probe = Some(ProbeView { asked: point, stamp: Some(output.stamp), reading });
    }

    /// What the window shows.
    pub fn view(&mut self, skipped: Skipped, now: Instant) -> LiveView {
        self.clocks.source.set_skipped(skipped.source);
        self.clocks.rectify.set_skipped(skipped.rectify);
        self.clocks.corners.set_skipped(skipped.corners);
        self.clocks.probe.set_skipped(skipped.probe);
        let statistics = Statistics {
            source: self.clocks.source.figures(now),
            rectify: self.clocks.rectify.figures(now),
            corners: self.clocks.corners.figures(now),
            probe: self.clocks.probe.figures(now),
            time_difference_s: self.raw.as_ref().and_then(|frame| frame.time_difference_s),
        };
        let no_setup = self.setup.as_ref().err().map(NoSetup::to_string);
        let down = self.down.get(&WatchedThread::Rectify).cloned();
        let no_rectified_because = no_setup
            .or_else(|| self.misfit().map(|misfit| misfit.to_string()))
            .or(down)
            .or_else(|| self.failed.clone());
        LiveView {
            wanted: self.wanted,
            raw: self.raw.clone(),
            rectified: self.rectified.clone(),
            disparity: self.disparity.clone(),
            corners: self.corners.clone(),
            probe: self.probe_view(no_rectified_because.as_deref()),
            aim: self.setup.as_ref().ok().map(|setup| aim_view(self.aim, &setup.pair)),
            no_rectified_because,
            head: self.head,
            nominal_lenses: self.calibration.is_none() && self.nominal.is_some(),
            statistics,
        }
    }

    fn probe_view(&self, nothing_because: Option<&str>) -> Option<ProbeView> {
        let asked = self.probe_asked?;
        let nothing_because = self.down.get(&WatchedThread::Probe).map(String::as_str).or(nothing_because);
        match (nothing_because, &self.probe) {
            (Some(reason), _) => {
                let reading = Err(NotMeasured::Nothing(reason.to_owned()));
                Some(ProbeView { asked, stamp: None, reading })
            }
            (None, probe) => probe.clone(),
        }
    }

    /// Makes a new setup from calibration, aim and head.
    fn set_up(&mut self) {
        self.generation += 1;
        self.clear_products();
        self.aimed_for = self.head;
        self.setup = match self.calibration.as_ref().or(self.nominal.as_ref()) {
            None => Err(NoSetup::NotCalibrated),
            Some(calibration) => {
                let workspace = self.workspace();
                aimed(self.aim, &calibration.cameras, &workspace)
                    // A head that looks away from the table still shows what is in front of it.
                    .or_else(|error| match (self.aim, error) {
                        (AimChoice::Table, AimError::TooWide { .. }) => {
                            AimedPair::turned_down(&calibration.cameras, 0.0, 2.0, DEFAULT_SIZE_PX)
                        }
                        (_, error) => Err(error),
                    })
                    .map(|pair| {
                        Arc::new(LiveSetup {
                            generation: self.generation,
                            calibration: calibration.clone(),
                            max_disparity_px: max_disparity_px(&pair, &workspace),
                            pair,
                            model: self.model.clone(),
                            title: self.model.title().into(),
                            posture: self.posture(),
                            eyes_on_s: self.eyes_on_s,
                        })
                    })
                    .map_err(NoSetup::from)
            }
        };
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

/// Lenses that nobody calibrated, as they are in a model.
fn lenses_of(model: &RobotModel) -> Arc<StereoCalibration> {
    Arc::new(StereoCalibration::bare(model.rig().eyes.cameras))
}

fn aim_view(choice: AimChoice, pair: &AimedPair) -> AimView {
    let across = |pixels: u32| 2.0 * (0.5 * (f64::from(pixels) - 1.0) / pair.f_px).atan();
    AimView {
        choice,
        pitch_rad: pair.down_rad(),
        size_px: pair.size_px(),
        focal_px: pair.f_px,
        field_of_view_rad: (across(pair.width_px), across(pair.height_px)),
        baseline_m: pair.baseline_m,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;
    use plumbline_effects::rig_model::ModelEffect;
    use plumbline_effects::{Effect, Kind, RigModel};
    use plumbline_model::Point;

    use super::*;

    #[test]
    fn eyes_that_turn_as_they_warm_up_are_undone_by_their_clock() {
        let rig = default_rig();
        let mut added = RigModel::nominal(&rig);
        added.contents.effects.push(ModelEffect {
            id: Kind::EyeYaw.id().to_owned(),
            site: "right".to_owned(),
            title: String::new(),
            tip: None,
            shape: Some(Effect::yaw_growth(240.0, 0.0)),
            reference_s: 0.0,
            values: vec![0.01],
            covariance: vec![],
            probability: None,
            parameters: vec![],
        });
        let model = RobotModel::new(rig, Arc::new(added)).expect("fits");
        let mut live = LiveWorkflow::default();
        live.set_model(&Arc::new(model));
        live.use_nominal_lenses(true);
        let mut place = |eyes_on_s: Option<f64>| {
            live.set_eyes_on(eyes_on_s);
            let setup = live.setup().expect("nominal lenses");
            setup.place(&Point::new(0.0, 0.0, 0.5), &(Matrix3::identity() * 1e-8)).expect("a place").point
        };
        let [unknown, cold, warm] = [None, Some(0.0), Some(1200.0)].map(&mut place);
        assert!(cold.distance_m(&unknown) < 1e-9);
        assert!(warm.distance_m(&cold) > 0.01, "{warm:?} {cold:?}");
    }
}
