//! Everything the engine knows, driven by commands and events; owns no thread.

mod actions;
mod commissioned;
mod looked;
mod measured;
mod neighbors;
mod recorded;
mod results;
mod rooms;
mod stages;
mod threads;
mod tried;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::robot_model::Unmeasured;
use plumbline_effects::{RigModel, RobotModel};
use plumbline_hardware::SourceSpec;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::{EyesThen, StereoFrame};

pub use actions::Action;
use recorded::is_recording;
use rooms::{Keeps, Neighbors, Rooms};
pub use stages::Serves;

use crate::command::{Command, HeadPose};
use crate::commission::CommissionWorkflow;
use crate::detect::{DetectInput, DetectOutput, DetectWorkflow, OpenDetector};
use crate::drift::{DriftInput, DriftOutput, DriftWorkflow};
use crate::eyes::{CornersInput, EyesWorkflow, Look};
use crate::grasp::GraspWorkflow;
use crate::ground::data_folder::KeptView;
use crate::ground::jobs::list::JobList;
use crate::ground::jobs::{JobId, JobState, JobView, Outcome};
use crate::ground::notice::{NoticeLevel, Notices};
use crate::ground::stage::{StagePanic, Timed};
use crate::ground::text::sentence;
use crate::ground::watched::{ThreadFault, WatchedThread};
use crate::ground::{Asked, Clock, Context, Moment, PerWorld, Time, Workflow, World};
use crate::labels::work::LabelsWork;
use crate::live::{ProbeInput, ProbeOutput, RectifyInput, RectifyOutput};
use crate::mount::MountWorkflow;
use crate::recording::{Recorder, RecordingWorkflow};
use crate::rig_models::{Accepted, calibrated_at, mounted, other_eyes};
use crate::robot::view::{Connection, RobotView};
use crate::robot::{News, RobotControl, TouchNews};
use crate::source::view::SourceView;
use crate::source::{Control, Note};
use crate::touch::TouchWorkflow;
use crate::trials::TrialsWorkflow;
use crate::truth::TruthPlug;
use crate::twin::view::TwinView;
use crate::work::{Work, WorkResult};

/// Everything the engine knows.
#[derive(Clone, Debug)]
pub struct State {
    rooms: Rooms,
    robot: Arc<RobotView>,
    /// When its thread told of it last; ages of readings are those of then.
    robot_told_at: Option<Instant>,
    twin: Arc<TwinView>,
    twins_started: u64,
    /// The robot as its description has it.
    rig: Arc<Rig>,
    /// The robot as it is known in each world.
    models: PerWorld<Arc<RobotModel>>,
    /// Effects that do not fit to this robot, told once.
    refused: Option<Arc<RigModel>>,
    /// What the robot's thread was told of it last.
    told_the_arm: Arc<RobotModel>,
    /// Whose eyes the source shows.
    shown: World,
    /// Whose arm: that of the connected robot, else that of the world whose eyes are shown.
    arm_of: World,
    /// The finished session of touches that models were told of last, with its revision.
    learned_from: BTreeMap<World, (PathBuf, u64)>,
    /// Work belongs to the world it was started for, whatever is shown when it ends.
    started_by: BTreeMap<JobId, World>,
    jobs: JobList,
    notices: Notices,
    clock: Clock,
    actions: Vec<Action>,
    /// Which source, counted, the newest pair is of.
    shown_of: u64,
    /// How the eyes were when the newest pair was taken, where it was recorded.
    then: Option<EyesThen>,
    revision: u64,
    faults: BTreeMap<WatchedThread, ThreadFault>,
    /// What was known of robot and twin before their thread fell silent.
    before_silence: Option<(Arc<RobotView>, Arc<TwinView>)>,
    /// The same of the source.
    source_before_silence: Option<Arc<SourceView>>,
    kept: Arc<KeptView>,
    /// What was in use when the timelines looked last.
    results: PerWorld<results::Results>,
}

impl State {
    /// Nothing opened; what was accepted before is read as the first job.
    pub fn new(data_dir: &Path) -> Self {
        let nominal = RobotModel::nominal(default_rig()).with_not_calibrated(Unmeasured::ALL);
        let nominal = Arc::new(nominal);
        let mut state = Self {
            rooms: Rooms::new(data_dir),
            robot: Arc::default(),
            robot_told_at: None,
            twin: Arc::default(),
            twins_started: 0,
            rig: nominal.rig().clone(),
            models: PerWorld::new(|_| nominal.clone()),
            refused: None,
            told_the_arm: nominal,
            shown: World::default(),
            arm_of: World::default(),
            learned_from: BTreeMap::new(),
            started_by: BTreeMap::new(),
            jobs: JobList::default(),
            notices: Notices::default(),
            clock: Clock::default(),
            actions: Vec::new(),
            shown_of: 0,
            then: None,
            revision: 0,
            faults: BTreeMap::new(),
            before_silence: None,
            source_before_silence: None,
            kept: Arc::default(),
            results: PerWorld::default(),
        };
        state.restore();
        state
    }

    /// Lets a workflow act, hands on what it asks for, and tells its neighbors.
    fn with<W: Workflow>(
        &mut self,
        world: World,
        act: impl FnOnce(&mut W, &W::Around, &mut Context<'_, W::Work, W::Control>),
    ) where
        Self: Neighbors<W>,
        Rooms: Keeps<W>,
        Work: From<W::Work>,
        Action: From<W::Control>,
    {
        let around = Neighbors::<W>::around(self, world);
        let mut asked = Vec::new();
        let Self { rooms, jobs, notices, clock, .. } = self;
        act(rooms.room(world), &around, &mut Context::new(notices, jobs, clock.time(), &mut asked));
        for asked in asked {
            self.actions.push(match asked {
                Asked::Start(id, work) => {
                    self.started_by.insert(id, world);
                    Action::Start(id, work.into())
                }
                Asked::Cancel(id) => Action::Cancel(id),
                Asked::Control(control) => control.into(),
            });
        }
        Neighbors::<W>::after(self, world);
        // What of no world was measured stands on the line of both.
        World::ALL.into_iter().for_each(|world| self.watch_results(world));
    }

    /// Takes it to be this time, until told otherwise; `None`: the time of the system. What happens at
    /// the same times, in the same order, gives the same again.
    pub fn hold_time(&mut self, time: Option<Time>) {
        self.clock.hold(time);
        self.notices.hold_time(time);
    }

    /// Applies a command of the operator that was given at this time.
    pub fn apply_at(&mut self, command: Command, time: Time) {
        self.hold_time(Some(time));
        self.rooms.recording.asked(&command, time);
        self.apply(command);
        self.hold_time(None);
    }

    /// What the window shows of a workflow.
    fn view_of<W: Workflow>(&mut self, world: World, moment: &Moment) -> Arc<W::View>
    where
        Self: Neighbors<W>,
        Rooms: Keeps<W>,
    {
        let around = Neighbors::<W>::around(self, world);
        Workflow::view(Keeps::<W>::room(&mut self.rooms, world), &around, moment)
    }

    /// Opens detectors in another way (tests, fake detectors).
    pub fn set_detector_opener(&mut self, open: OpenDetector) {
        self.rooms.detect.set_opener(open);
    }

    /// Hands something to the recording, with the messages that came before it.
    fn record(&mut self, what: impl FnOnce(&mut RecordingWorkflow, Time)) {
        if !self.rooms.recording.is_on() {
            return;
        }
        let time = self.clock.time();
        self.rooms.recording.told(&self.notices.view());
        what(&mut self.rooms.recording, time);
        self.with::<RecordingWorkflow>(World::default(), |recording, _, context| {
            recording.look_after(context);
        });
    }

    /// What the owner of the twin shows it with, for truth mode.
    pub fn truth_plug(&self) -> TruthPlug {
        self.rooms.truth.plug()
    }

    /// The recording under way, to be finished before the program ends.
    pub fn last_recording(&mut self) -> Option<Recorder> {
        self.rooms.recording.take()
    }

    /// What the operator drew and is not on disk yet, to be written before the program ends.
    pub fn last_write(&self) -> Option<LabelsWork> {
        self.rooms.labels.last_write()
    }

    /// The eyes that the source shows.
    fn shown_eyes(&self) -> &EyesWorkflow {
        self.rooms.eyes.of(self.shown)
    }

    /// Where the eyes are over the table, for the maps of the next assessment.
    fn use_workspace(&mut self) {
        let workspace = self.rooms.live.workspace();
        self.rooms.eyes.iter_mut().for_each(|eyes| eyes.set_workspace(workspace));
    }

    /// The robot of a world, with what was calibrated there.
    fn rig_of(&self, world: World) -> Arc<Rig> {
        self.models.of(world).rig().clone()
    }

    /// Puts together anew what is known of the robot, where something was accepted or taken back, and
    /// hands it to everybody who looks, moves or touches.
    fn use_models(&mut self) {
        World::ALL.into_iter().for_each(|world| self.put_together(world));
        let shown = self.shown;
        self.rooms.live.set_model(self.models.of(shown));
        self.rooms.live.set_calibration(self.rooms.eyes.of(shown).in_use());
        self.use_eyes_clock();
        self.use_workspace();
        let of_arm = self.model_of_the_arm();
        if !Arc::ptr_eq(&self.told_the_arm, &of_arm) {
            self.told_the_arm = of_arm.clone();
            self.actions.push(Action::Robot(RobotControl::UseModel(of_arm)));
        }
    }

    /// How long the eyes of a world have been on, s: a twin knows it, of other eyes the operator does. Of what was
    /// recorded the recording does, whatever runs now.
    fn eyes_on_s(&self, world: World) -> Option<f64> {
        let source = self.rooms.source.view();
        if self.shown == world && is_recording(source.spec.as_ref()) {
            return self.then.and_then(|then| then.on_s);
        }
        match world {
            World::Twin if self.shown == World::Twin && !self.shows_own_eyes() => None,
            World::Twin => self.twin.running.then_some(self.twin.eyes_on_s),
            World::Robot => self.rooms.eyes.of(World::Robot).on_s(source, self.clock.time().instant),
        }
    }

    /// Tells whoever looks live; by whole seconds, because nothing moves in less.
    fn use_eyes_clock(&mut self) {
        let on_s = self.eyes_on_s(self.shown).map(f64::floor);
        self.rooms.live.set_eyes_on(on_s);
    }

    /// The cameras may have been away.
    fn follow_cameras(&mut self, source: &SourceView) {
        let now = self.clock.time();
        if let Some(words) = self.rooms.eyes.of_mut(World::Robot).follow(source, now) {
            self.notices.add(NoticeLevel::Warning, words);
        }
    }

    fn put_together(&mut self, world: World) {
        let Rooms { eyes, mount, touch, gap, .. } = &self.rooms;
        let (eyes, mount) = (eyes.of(world).in_use(), mount.of(world).in_use());
        let accepted = Accepted {
            cameras: eyes.map(|calibration| &calibration.cameras),
            head_from_left: mount.map(|mount| mount.head_from_left),
            calibrated_at: calibrated_at(eyes.map(|eyes| &**eyes), mount.map(|mount| &**mount)),
            mounted: mount.map(|mount| mounted(mount)),
            screen: touch.of(world).screen(),
            effects: gap.of(world).model().filter(|effects| {
                !self.refused.as_ref().is_some_and(|refused| Arc::ptr_eq(refused, effects))
            }),
        };
        let known = self.models.of_mut(world);
        if accepted.is_in(known, &self.rig) {
            return;
        }
        match accepted.robot_model(&self.rig) {
            Ok(model) => {
                // While the program starts the effects may be read before the eyes that they belong to.
                let Rooms { eyes, mount, .. } = &self.rooms;
                let is_read = eyes.of(world).accepted().is_some() && mount.of(world).accepted().is_some();
                let others = accepted.effects.map(|effects| effects.effects_of_other_eyes(model.rig()));
                if let Some(words) = others.as_deref().and_then(other_eyes).filter(|_| is_read) {
                    self.notices.add(NoticeLevel::Warning, words);
                }
                *known = Arc::new(model);
            }
            Err(reason) => {
                self.refused = accepted.effects.cloned();
                self.notices.add(NoticeLevel::Error, sentence(&reason.to_string()));
            }
        }
    }

    /// A pair has come from the source.
    ///
    /// `opened` counts the sources opened; a pair of an earlier source comes too late.
    pub fn frame(&mut self, opened: u64, frame: StereoFrame, now: Instant) {
        if opened < self.rooms.source.view().opened {
            return;
        }
        self.follow_recorded(opened, &frame);
        self.shown_of = opened;
        self.rooms.eyes.of_mut(self.shown).set_image_size(frame.left.dimensions());
        self.rooms.grasp.of(self.arm_of).saw(&frame);
        self.rooms.handeye.of(self.arm_of).saw(&frame);
        self.use_eyes_clock();
        // What a source delivers before it is known of is not of the recording of the one before.
        if opened == self.rooms.source.view().opened {
            let is_on = self.rooms.recording.is_on();
            let at = frame.stamp.captured_at;
            let (eyes, places) = (self.eyes_then(at), is_on.then(|| self.eye_places(at)).flatten());
            self.record(|recording, time| recording.saw(&frame, eyes, places, time));
        }
        self.with::<DriftWorkflow>(World::default(), |drift, around, context| {
            drift.saw(&frame, around, context);
        });
        let eyes = self.rooms.eyes.of(self.shown);
        if eyes.wants_pairs() || eyes.may_give_way() || eyes.may_look(self.clock.time().instant) {
            self.with::<EyesWorkflow>(self.shown, |eyes, around, context| eyes.saw(&frame, around, context));
        }
        self.rooms.live.frame(frame, now);
    }

    /// Time passes, whether pairs come or not: nobody waits for an answer without end. Whether something has changed.
    pub fn time_passes(&mut self) -> bool {
        let now = self.clock.time().instant;
        let overdue = World::ALL.map(|world| self.rooms.eyes.of(world).is_overdue(now).then_some(world));
        for world in overdue.into_iter().flatten() {
            self.with::<EyesWorkflow>(world, |eyes, around, context| eyes.time_passes(around, context));
        }
        overdue.iter().any(Option::is_some)
    }

    /// So many pairs of the source, since the program was started, were replaced before they came here.
    pub fn pairs_replaced(&mut self, replaced: u64) {
        self.rooms.recording.were_replaced(replaced);
    }

    /// The thread that watches drift has looked.
    pub fn drift_looked(&mut self, output: Timed<DriftOutput>) {
        self.with::<DriftWorkflow>(World::default(), |drift, _, context| drift.looked(output, context));
    }

    /// What it is to look at, if anything.
    pub fn drift_input(&self) -> Option<Arc<DriftInput>> {
        self.rooms.drift.input()
    }

    /// The source says how it is doing.
    pub fn source_changed(&mut self, view: SourceView) {
        if view.opened != self.rooms.source.view().opened && view.opened != self.shown_of {
            self.rooms.live.clear();
            self.rooms.detect.clear();
        }
        self.shown = World::of(view.spec.as_ref());
        // A recording was made by these eyes, whose head stood otherwise.
        let is_recorded = is_recording(view.spec.as_ref());
        let own_lenses = is_recorded || is_of_this_robot(view.spec.as_ref());
        self.follow_cameras(&view);
        self.rooms.source.update(view);
        self.source_before_silence = None;
        if !is_recorded {
            self.leave_recorded();
        }
        self.with::<RecordingWorkflow>(World::default(), |recording, around, context| {
            recording.follow_source(around, context);
        });
        for world in World::ALL {
            if self.rooms.eyes.of(world).wants_pairs() {
                self.with::<EyesWorkflow>(world, |eyes, around, context| {
                    eyes.source_changed(around, context)
                });
            }
        }
        self.use_models();
        self.rooms.live.use_nominal_lenses(own_lenses);
    }

    /// The source has a message for the operator.
    pub fn source_note(&mut self, (level, text): Note) {
        self.notices.add(level, text);
    }

    /// The robot or the twin has something new.
    pub fn robot_changed(&mut self, news: News) {
        let eyes_of_this_robot = self.shows_own_eyes();
        let head = |rig: &Rig| news.robot.known(&[rig.eyes.pan, rig.eyes.tilt]).cloned();
        // Where it is not known the view stays aimed as it was; the servos' lamp says which is silent.
        if let Some(rig) = &news.robot.rig
            && let (Some(posture), true) = (head(rig), eyes_of_this_robot)
        {
            let head = HeadPose { head_z_rad: posture[rig.eyes.pan], head_y_rad: posture[rig.eyes.tilt] };
            self.rooms.live.set_head(head);
            self.use_workspace();
        }
        if news.twins_started > self.twins_started {
            self.twins_started = news.twins_started;
            self.actions.push(Action::Source(Control::Open(SourceSpec::Twin)));
        }
        (self.robot, self.twin) = (news.robot, news.twin);
        self.robot_told_at = Some(self.clock.time().instant);
        let robot = self.robot.clone();
        self.record(|recording, time| recording.read(&robot, time));
        self.before_silence = None;
        self.arm_of = match &self.robot.connection {
            Connection::Connected { twin, .. } => World::of_robot(*twin),
            _ => self.arm_of,
        };
        self.use_models();
        self.with::<MountWorkflow>(self.shown, |mount, around, context| mount.step(around, context));
        self.with::<TouchWorkflow>(self.arm_of, |touch, around, context| touch.step(around, context));
        if self.rooms.grasp.of(self.arm_of).is_watching() {
            self.with::<GraspWorkflow>(self.arm_of, |grasp, around, context| grasp.watch(around, context));
        }
        self.with::<TrialsWorkflow>(self.arm_of, |trials, around, context| trials.step(around, context));
        self.with::<CommissionWorkflow>(self.arm_of, |room, around, context| room.look(around, context));
    }

    /// The robot's thread tells how a touch is doing.
    pub fn touch_news(&mut self, news: TouchNews) {
        self.with::<TouchWorkflow>(self.arm_of, |touch, around, context| touch.news(news, around, context));
    }

    /// Rectification has something.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        self.rooms.live.rectified(output, now);
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        self.rooms.live.probed(output, now);
    }

    /// The chessboard search has something.
    pub fn looked(&mut self, output: Timed<Look>, now: Instant) {
        self.rooms.live.corners(&output, now);
        let look = output.result;
        if self.rooms.mount.of(self.shown).wants_corners() || self.rooms.live.wants_corners() {
            let look = look.clone();
            self.with::<MountWorkflow>(self.shown, |mount, around, context| {
                mount.look(look, around, context)
            });
        }
        self.with::<EyesWorkflow>(self.shown, |eyes, around, context| eyes.look(look, around, context));
    }

    /// The detector has something.
    pub fn detected(&mut self, output: Timed<DetectOutput>, now: Instant) {
        let before = self.rooms.detect.found().cloned();
        self.rooms.detect.detected(output, self.shown_of, now);
        // What failed, or came too late, leaves what was found before.
        let found = self.rooms.detect.found().cloned();
        let is_new = |found: &Arc<_>| before.as_ref().is_none_or(|before| !Arc::ptr_eq(before, found));
        if let Some(found) = found.filter(is_new) {
            self.record(|recording, time| recording.found(&found, time));
        }
    }

    /// What the detector is to do with the newest pair, if anything.
    pub fn detect_input(&self) -> Option<DetectInput> {
        self.rooms.detect.input(Neighbors::<DetectWorkflow>::around(self, World::default()))
    }

    /// A stage met a defect of this program and goes on with the next pair.
    pub fn stage_panicked(&mut self, panic: &StagePanic) {
        let StagePanic { stage, message } = panic;
        let text = format!(
            "Live {}: this program made a mistake ({message}). It goes on; please report it with the journal.",
            stage.name()
        );
        self.stage_gave_nothing(*stage, &text);
        self.notices.add(NoticeLevel::Error, text);
    }

    /// What rectification is to do with the newest pair, if anything.
    pub fn rectify_input(&self) -> Option<RectifyInput> {
        self.rooms.live.rectify_input()
    }

    /// What measuring is to do with the newest pair, if anything.
    pub fn probe_input(&self) -> Option<ProbeInput> {
        self.rooms.live.probe_input()
    }

    /// What the chessboard search is to do with the newest pair, if anything.
    pub fn corners_input(&self) -> Option<CornersInput> {
        let mount_wants = self.rooms.mount.of(self.shown).wants_corners();
        let wanted = self.rooms.live.wants_corners()
            || self.shown_eyes().auto_capture()
            || mount_wants
            || self.rooms.drift.looks_for_board();
        let frame = self.rooms.live.newest().filter(|_| wanted)?.clone();
        Some(CornersInput { frame, board: *self.shown_eyes().board() })
    }

    /// A job says how far it is.
    pub fn work_progress(&mut self, view: JobView) {
        self.jobs.progress(view);
    }

    /// A job has ended.
    pub fn work_ended(&mut self, id: JobId, outcome: Outcome<WorkResult>, elapsed: Duration) {
        let title = self.jobs.title(id).unwrap_or_default().to_owned();
        let state = match outcome {
            Outcome::Done(result) => {
                let summary = result.summary();
                if self.jobs.is_worth_telling(id) {
                    self.notices.add(NoticeLevel::Success, &*summary);
                }
                self.work_done(id, result);
                JobState::Done { summary }
            }
            Outcome::Cancelled => {
                self.notices.add(NoticeLevel::Info, format!("{title}: cancelled, nothing was changed."));
                self.work_gave_nothing(id, None);
                JobState::Cancelled
            }
            Outcome::Failed(reason) => {
                self.notices.add(NoticeLevel::Error, &*reason);
                self.work_gave_nothing(id, Some(&reason));
                JobState::Failed { reason }
            }
            Outcome::Panicked(message) => {
                let text = format!(
                    "{title}: this program made a mistake ({message}). Nothing was changed. Please report it with the journal."
                );
                self.work_gave_nothing(id, Some(&text));
                self.notices.add(NoticeLevel::Error, text);
                JobState::Panicked { message }
            }
        };
        // A step back was noted by now, or it was not taken.
        World::ALL.into_iter().for_each(|world| self.rooms.timeline.of_mut(world).stepped_back(id));
        self.jobs.ended(id, state, elapsed);
    }

    /// Whether the source shows what a robot or a twin sees now.
    fn shows_own_eyes(&self) -> bool {
        is_of_this_robot(self.rooms.source.view().spec.as_ref())
    }

    fn world_of(&mut self, id: JobId) -> World {
        self.started_by.remove(&id).unwrap_or(self.shown)
    }

    /// Adds a message.
    pub fn notify(&mut self, level: NoticeLevel, text: impl Into<String>) {
        self.notices.add(level, text);
    }

    /// What the outer world is asked to do, since the last call.
    pub fn take_actions(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.actions)
    }

    /// Number of the newest pair.
    pub fn newest_seq(&self) -> Option<u64> {
        self.rooms.live.newest().map(|frame| frame.stamp.seq)
    }
}

fn is_of_this_robot(source: Option<&SourceSpec>) -> bool {
    matches!(source, Some(SourceSpec::Twin | SourceSpec::Cameras { .. }))
}
