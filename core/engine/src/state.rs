//! Everything the engine knows, driven by commands and events; owns no thread.

mod threads;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::SourceSpec;
use plumbline_model::StereoFrame;
use plumbline_model::robot::Rig;
use plumbline_vision::detect::shipped_detector;

use crate::command::{Command, HeadPose, JobCommand, JobId, NoticeCommand};
use crate::context::{Action, Context};
use crate::detect::{Around, DetectState, OpenDetector};
use crate::detector_scores::ScoresWorkflow;
use crate::eyes::work::{EyesWork, Restore};
use crate::eyes::{EyesOfWorlds, EyesState, Look, World};
use crate::gaps::{GapWorkflow, Surroundings as GapSurroundings};
use crate::job_list::JobList;
use crate::jobs::Outcome;
use crate::label_sets::work::LabelsWork;
use crate::label_sets::{LabelsWorkflow, Surroundings as LabelsSurroundings};
use crate::live::{LiveState, Skipped, default_rig};
use crate::models::{ModelsWorkflow, Surroundings as ModelsSurroundings};
use crate::mount::{MountState, Surroundings as MountSurroundings};
use crate::notice::{NoticeLevel, Notices};
use crate::robot::{News, RobotControl, TouchNews};
use crate::source::{Control, Note, SourceState};
use crate::stages::{
    CornersInput, DetectInput, DetectOutput, ProbeInput, ProbeOutput, RectifyInput, RectifyOutput,
    StagePanic, Timed,
};
use crate::touch::{Surroundings as TouchSurroundings, TouchWorkflow};
use crate::view::{
    Connection, GapView, JobState, JobView, KeptView, ModelsView, MountView, RobotView, SourceView,
    ThreadFault, TouchView, TwinView, View,
};
use crate::watched::WatchedThread;
use crate::work::WorkResult;

/// Everything the engine knows.
#[derive(Clone, Debug)]
pub struct State {
    source: SourceState,
    live: LiveState,
    detect: DetectState,
    eyes: EyesOfWorlds,
    robot: Arc<RobotView>,
    twin: Arc<TwinView>,
    twins_started: u64,
    rig: Arc<Rig>,
    mounts: BTreeMap<World, MountState>,
    /// Whose arm: that of the connected robot, else that of the world whose eyes are shown.
    arm_of: World,
    touches: BTreeMap<World, TouchWorkflow>,
    models: BTreeMap<World, ModelsWorkflow>,
    gaps: BTreeMap<World, GapWorkflow>,
    labels: LabelsWorkflow,
    scores: ScoresWorkflow,
    /// The finished session of touches that models were told of last, with its revision.
    learned_from: BTreeMap<World, (PathBuf, u64)>,
    /// Work belongs to the world it was started for, whatever is shown when it ends.
    started_by: BTreeMap<JobId, World>,
    jobs: JobList,
    notices: Notices,
    actions: Vec<Action>,
    /// Which source, counted, the newest pair is of.
    shown_of: u64,
    revision: u64,
    faults: BTreeMap<WatchedThread, ThreadFault>,
    /// What was known of robot and twin before their thread fell silent.
    before_silence: Option<(Arc<RobotView>, Arc<TwinView>)>,
    /// The same of the source.
    source_before_silence: Option<Arc<SourceView>>,
    kept: Arc<KeptView>,
}

impl State {
    /// Nothing opened; what was accepted before is read as the first job.
    pub fn new(data_dir: &Path) -> Self {
        let live = LiveState::default();
        let mut state = Self {
            eyes: EyesOfWorlds::new(data_dir, live.workspace()),
            live,
            detect: DetectState::new(data_dir),
            source: SourceState::default(),
            robot: Arc::default(),
            twin: Arc::default(),
            twins_started: 0,
            rig: default_rig(),
            mounts: WORLDS
                .into_iter()
                .map(|world| (world, MountState::new(&world.folder(data_dir))))
                .collect(),
            arm_of: World::default(),
            touches: WORLDS
                .into_iter()
                .map(|world| (world, TouchWorkflow::new(&world.folder(data_dir))))
                .collect(),
            models: WORLDS
                .into_iter()
                .map(|world| (world, ModelsWorkflow::new(&world.folder(data_dir))))
                .collect(),
            gaps: WORLDS
                .into_iter()
                .map(|world| (world, GapWorkflow::new(&world.folder(data_dir))))
                .collect(),
            labels: LabelsWorkflow::new(data_dir),
            scores: ScoresWorkflow::new(shipped_detector().map(|shipped| shipped.file)),
            learned_from: BTreeMap::new(),
            started_by: BTreeMap::new(),
            jobs: JobList::default(),
            notices: Notices::default(),
            actions: Vec::new(),
            shown_of: 0,
            revision: 0,
            faults: BTreeMap::new(),
            before_silence: None,
            source_before_silence: None,
            kept: Arc::default(),
        };
        state.with_labels(|labels, _, context| labels.restore(context));
        let restore = state.detect.restore();
        state.with_detect(|_, context| {
            context.start(restore);
        });
        let workspace = state.live.workspace();
        for world in WORLDS {
            let store = state.eyes.of(world).store().clone();
            state.with_eyes_of(world, |_, context| {
                context.start(EyesWork::Restore(Restore { store, workspace }));
            });
            state.with_mount_of(world, |mount, around, context| {
                let work = mount.restore(around.rig);
                context.start(work);
            });
            state.with_touch_of(world, |touch, around, context| {
                let work = touch.restore(around.rig);
                context.start(work);
            });
            state.with_models_of(world, |models, around, context| {
                let work = models.restore(around.rig);
                context.start(work);
            });
            state.with_gap_of(world, |gap, around, context| {
                let work = gap.restore(around.rig);
                context.start(work);
            });
        }
        state
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Source(command) => {
                let Self { source, live, jobs, notices, actions, .. } = self;
                let view = source.view().clone();
                source.apply(
                    command,
                    &mut Context { notices, newest: live.newest(), source: &view, jobs, actions },
                );
            }
            Command::Live(command) => self.apply_live(command),
            Command::Detect(command) => {
                self.with_detect(|detect, context| detect.apply(command, context));
            }
            Command::Eyes(command) => self.with_eyes(|eyes, context| eyes.apply(command, context)),
            Command::Robot(command) => self.actions.push(Action::Robot(command.into())),
            Command::Twin(command) => self.actions.push(Action::Robot(command.into())),
            Command::Mount(command) => {
                self.with_mount(|mount, around, context| mount.apply(command, around, context));
            }
            Command::Touch(command) => {
                self.with_touch(|touch, around, context| touch.apply(command, around, context));
            }
            Command::Models(command) => {
                self.with_models(|models, around, context| models.apply(command, around, context));
            }
            Command::Gap(command) => {
                self.with_gap_of(self.arm_of, |gap, around, context| gap.apply(command, around, context));
            }
            Command::Labels(command) => {
                self.with_labels(|labels, around, context| labels.apply(command, around, context));
            }
            Command::Scores(command) => {
                let provider = self.detect.chosen().1;
                self.with_scores(|scores, context| scores.apply(command, provider, context));
            }
            Command::Job(JobCommand::Cancel(id)) if self.jobs.is_running(id) => {
                self.actions.push(Action::Cancel(id));
            }
            Command::Job(JobCommand::Cancel(id) | JobCommand::Dismiss(id)) => self.jobs.dismiss(id),
            // Whoever owns the threads has done it.
            Command::Watch(_) => {}
            Command::Notice(NoticeCommand::Add { level, text }) => self.notices.add(level, text),
            Command::Notice(NoticeCommand::Clear) => self.notices.clear(),
        }
    }

    fn apply_live(&mut self, command: crate::command::LiveCommand) {
        let Self { source, live, jobs, notices, actions, .. } = self;
        let mut context = Context { notices, newest: None, source: source.view(), jobs, actions };
        live.apply(command, &mut context);
        self.eyes.set_workspace(self.live.workspace());
        let wanted = self.live.wants_detections();
        self.with_detect(|detect, context| detect.want(wanted, context));
    }

    fn with_detect(&mut self, act: impl FnOnce(&mut DetectState, &mut Context<'_>)) {
        let Self { source, live, detect, jobs, notices, actions, .. } = self;
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        act(detect, &mut context);
    }

    /// Opens detectors in another way (tests, fake detectors).
    pub fn set_detector_opener(&mut self, open: OpenDetector) {
        self.detect.set_opener(open);
    }

    fn around_detection(&self) -> Around<'_> {
        Around {
            newest: self.live.newest(),
            opened: self.shown_of,
            photographs: self.source.view().photographs,
            setup: self.live.setup(),
        }
    }

    fn with_eyes(&mut self, act: impl FnOnce(&mut EyesState, &mut Context<'_>)) {
        self.with_eyes_of(self.eyes.shown, act);
    }

    fn with_eyes_of(&mut self, world: World, act: impl FnOnce(&mut EyesState, &mut Context<'_>)) {
        let Self { source, live, eyes, jobs, notices, actions, .. } = self;
        let before = actions.len();
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        act(eyes.of_mut(world), &mut context);
        for action in &actions[before..] {
            if let Action::Start(id, _) = action {
                self.started_by.insert(*id, world);
            }
        }
        self.live.set_calibration(self.eyes.shown().in_use());
    }

    fn with_mount(&mut self, act: impl FnOnce(&mut MountState, &MountSurroundings<'_>, &mut Context<'_>)) {
        self.with_mount_of(self.eyes.shown, act);
    }

    fn with_mount_of(
        &mut self,
        world: World,
        act: impl FnOnce(&mut MountState, &MountSurroundings<'_>, &mut Context<'_>),
    ) {
        let Self { source, live, eyes, jobs, notices, actions, robot, rig, mounts, .. } = self;
        let Some(mount) = mounts.get_mut(&world) else { return };
        let before = actions.len();
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        act(mount, &surroundings(rig, robot, eyes.of(world)), &mut context);
        for action in &actions[before..] {
            if let Action::Start(id, _) = action {
                self.started_by.insert(*id, world);
            }
        }
        self.use_mount();
    }

    fn with_touch(&mut self, act: impl FnOnce(&mut TouchWorkflow, &TouchSurroundings<'_>, &mut Context<'_>)) {
        self.with_touch_of(self.arm_of, act);
    }

    fn with_touch_of(
        &mut self,
        world: World,
        act: impl FnOnce(&mut TouchWorkflow, &TouchSurroundings<'_>, &mut Context<'_>),
    ) {
        let Self { source, live, jobs, notices, actions, robot, rig, touches, models, .. } = self;
        let (Some(touch), Some(models)) = (touches.get_mut(&world), models.get(&world)) else { return };
        let before = actions.len();
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        let usable = models.usable();
        act(touch, &TouchSurroundings { rig, robot, models: &usable }, &mut context);
        let finished = touch.finished_session().map(|(session, revision)| (session.to_owned(), revision));
        self.note_world(world, before);
        self.use_screen();
        if let Some(finished) = finished
            && self.learned_from.get(&world) != Some(&finished)
        {
            self.with_models_of(world, |models, around, context| {
                models.touched(&finished.0, around, context);
            });
            self.with_gap_of(world, |gap, _, context| gap.touched(&finished.0, context));
            self.learned_from.insert(world, finished);
        }
    }

    fn with_models(
        &mut self,
        act: impl FnOnce(&mut ModelsWorkflow, &ModelsSurroundings<'_>, &mut Context<'_>),
    ) {
        self.with_models_of(self.arm_of, act);
    }

    fn with_models_of(
        &mut self,
        world: World,
        act: impl FnOnce(&mut ModelsWorkflow, &ModelsSurroundings<'_>, &mut Context<'_>),
    ) {
        let rig = self.rig_of(world);
        let Self { source, live, jobs, notices, actions, robot, touches, models, .. } = self;
        let Some(models) = models.get_mut(&world) else { return };
        let before = actions.len();
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        let newest_session = touches.get(&world).and_then(TouchWorkflow::session);
        act(models, &ModelsSurroundings { rig: &rig, robot, newest_session }, &mut context);
        self.note_world(world, before);
    }

    fn with_gap_of(
        &mut self,
        world: World,
        act: impl FnOnce(&mut GapWorkflow, &GapSurroundings<'_>, &mut Context<'_>),
    ) {
        let rig = self.rig_of(world);
        let Self { source, live, jobs, notices, actions, touches, gaps, .. } = self;
        let Some(gap) = gaps.get_mut(&world) else { return };
        let before = actions.len();
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        let newest_session = touches.get(&world).and_then(TouchWorkflow::session);
        act(gap, &GapSurroundings { rig: &rig, newest_session }, &mut context);
        self.note_world(world, before);
    }

    /// Data sets belong to no world: images of both may be labeled together.
    fn with_labels(&mut self, act: impl FnOnce(&mut LabelsWorkflow, &LabelsSurroundings, &mut Context<'_>)) {
        let Self { source, live, detect, jobs, notices, actions, labels, .. } = self;
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        let (detector, provider) = detect.chosen();
        let around = LabelsSurroundings {
            open: detect.opener().clone(),
            detector: detector.clone(),
            provider,
            confidence: detect.settings().confidence,
        };
        act(labels, &around, &mut context);
    }

    /// What the operator drew and is not on disk yet, to be written before the program ends.
    pub fn last_write(&self) -> Option<LabelsWork> {
        self.labels.last_write()
    }

    fn with_scores(&mut self, act: impl FnOnce(&mut ScoresWorkflow, &mut Context<'_>)) {
        let Self { source, live, jobs, notices, actions, scores, .. } = self;
        let mut context = Context { notices, newest: live.newest(), source: source.view(), jobs, actions };
        act(scores, &mut context);
    }

    /// Work that was just asked for belongs to this world.
    fn note_world(&mut self, world: World, before: usize) {
        for action in &self.actions[before..] {
            if let Action::Start(id, _) = action {
                self.started_by.insert(*id, world);
            }
        }
    }

    /// The robot of a world, its touchscreen where it was measured to lie.
    fn rig_of(&self, world: World) -> Arc<Rig> {
        match self.touches.get(&world).and_then(TouchWorkflow::screen) {
            None => self.rig.clone(),
            Some(screen) => {
                let mut rig = (*self.rig).clone();
                rig.touchscreen = screen.clone();
                Arc::new(rig)
            }
        }
    }

    /// The screen lies where it was measured, for everything that draws or touches it.
    fn use_screen(&mut self) {
        let shown = self.touches.get(&self.arm_of).and_then(TouchWorkflow::screen);
        let screen = shown.unwrap_or(&self.rig.touchscreen).clone();
        if self.live.rig().touchscreen == screen {
            return;
        }
        let mut rig = Rig::clone(self.live.rig());
        rig.touchscreen = screen.clone();
        self.live.set_rig(Arc::new(rig));
        self.eyes.set_workspace(self.live.workspace());
        self.actions.push(Action::Robot(RobotControl::PlaceScreen(screen)));
    }

    /// The eyes sit where the mount in use says, for everything that looks or turns the head.
    fn use_mount(&mut self) {
        let shown = self.mounts.get(&self.eyes.shown);
        let head_from_left = shown
            .and_then(|mount| mount.in_use())
            .map_or(self.rig.eyes.head_from_left, |mount| mount.head_from_left);
        if self.live.rig().eyes.head_from_left == head_from_left {
            return;
        }
        let mut rig = Rig::clone(self.live.rig());
        rig.eyes.head_from_left = head_from_left;
        self.live.set_rig(Arc::new(rig));
        self.eyes.set_workspace(self.live.workspace());
        self.actions.push(Action::Robot(RobotControl::PlaceEyes { head_from_left }));
    }

    /// A pair has come from the source.
    ///
    /// `opened` counts the sources opened; a pair of an earlier source comes too late.
    pub fn frame(&mut self, opened: u64, frame: StereoFrame, now: Instant) {
        if opened < self.source.view().opened {
            return;
        }
        self.shown_of = opened;
        self.eyes.of_mut(self.eyes.shown).set_image_size(frame.left.dimensions());
        self.live.frame(frame, now);
    }

    /// The source says how it is doing.
    pub fn source_changed(&mut self, view: SourceView) {
        if view.opened != self.source.view().opened && view.opened != self.shown_of {
            self.live.clear();
            self.detect.clear();
        }
        self.eyes.shown = World::of(view.spec.as_ref());
        self.use_mount();
        let own_eyes = matches!(view.spec, Some(SourceSpec::Twin | SourceSpec::Cameras { .. }));
        self.live.use_nominal_lenses(own_eyes);
        self.source.update(view);
        self.source_before_silence = None;
        self.live.set_calibration(self.eyes.shown().in_use());
    }

    /// The source has a message for the operator.
    pub fn source_note(&mut self, (level, text): Note) {
        self.notices.add(level, text);
    }

    /// The robot or the twin has something new.
    pub fn robot_changed(&mut self, news: News) {
        let eyes_of_this_robot =
            matches!(self.source.view().spec, Some(SourceSpec::Twin | SourceSpec::Cameras { .. }));
        let head = |rig: &Rig| news.robot.known(&[rig.eyes.pan, rig.eyes.tilt]).cloned();
        // Where it is not known the view stays aimed as it was; the servos' lamp says which is silent.
        if let Some(rig) = &news.robot.rig
            && let (Some(posture), true) = (head(rig), eyes_of_this_robot)
        {
            let head = HeadPose { head_z_rad: posture[rig.eyes.pan], head_y_rad: posture[rig.eyes.tilt] };
            self.live.set_head(head);
            self.eyes.set_workspace(self.live.workspace());
        }
        if news.twins_started > self.twins_started {
            self.twins_started = news.twins_started;
            self.actions.push(Action::Source(Control::Open(SourceSpec::Twin)));
        }
        (self.robot, self.twin) = (news.robot, news.twin);
        self.before_silence = None;
        self.arm_of = match &self.robot.connection {
            Connection::Connected { twin, .. } => World::of_robot(*twin),
            _ => self.arm_of,
        };
        self.use_screen();
        self.with_mount(|mount, around, context| mount.step(around, Instant::now(), context));
        self.with_touch(|touch, around, context| touch.step(around, Instant::now(), context));
    }

    /// The robot's thread tells how a touch is doing.
    pub fn touch_news(&mut self, news: TouchNews) {
        self.with_touch(|touch, around, context| touch.news(news, around, context));
    }

    /// Rectification has something.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        self.live.rectified(output, now);
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        self.live.probed(output, now);
    }

    /// The chessboard search has something.
    pub fn looked(&mut self, output: Timed<Look>, now: Instant) {
        self.live.corners(&output, now);
        let look = output.result;
        if self.mounts.get(&self.eyes.shown).is_some_and(MountState::wants_corners)
            || self.live.wants_corners()
        {
            let look = look.clone();
            self.with_mount(|mount, around, context| mount.look(look, around, context));
        }
        self.with_eyes(|eyes, context| eyes.look(look, context));
    }

    /// The detector has something.
    pub fn detected(&mut self, output: Timed<DetectOutput>, now: Instant) {
        self.detect.detected(output, self.shown_of, now);
    }

    /// What the detector is to do with the newest pair, if anything.
    pub fn detect_input(&self) -> Option<DetectInput> {
        self.detect.input(self.around_detection())
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
        self.live.rectify_input()
    }

    /// What measuring is to do with the newest pair, if anything.
    pub fn probe_input(&self) -> Option<ProbeInput> {
        self.live.probe_input()
    }

    /// What the chessboard search is to do with the newest pair, if anything.
    pub fn corners_input(&self) -> Option<CornersInput> {
        let mount_wants = self.mounts.get(&self.eyes.shown).is_some_and(MountState::wants_corners);
        let wanted = self.live.wants_corners() || self.eyes.shown().auto_capture() || mount_wants;
        let frame = self.live.newest().filter(|_| wanted)?.clone();
        Some(CornersInput { frame, board: *self.eyes.shown().board() })
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
        self.jobs.ended(id, state, elapsed);
    }

    fn work_done(&mut self, id: JobId, result: WorkResult) {
        match result {
            WorkResult::Cameras(cameras) => self.source.set_cameras(cameras),
            WorkResult::Detect(result) => {
                self.with_detect(|detect, context| detect.work_done(id, *result, context));
            }
            WorkResult::Eyes(result) => {
                let world = self.world_of(id);
                self.with_eyes_of(world, |eyes, context| eyes.work_done(id, *result, context));
            }
            WorkResult::Mount(result) => {
                let world = self.world_of(id);
                self.with_mount_of(world, |mount, _, _| mount.work_done(id, *result));
            }
            WorkResult::Touch(result) => {
                let world = self.world_of(id);
                self.with_touch_of(world, |touch, around, context| {
                    touch.work_done(id, *result, around, context);
                });
            }
            WorkResult::Models(result) => {
                let world = self.world_of(id);
                self.with_models_of(world, |models, around, context| {
                    models.work_done(id, *result, around, context);
                });
            }
            WorkResult::Labels(result) => {
                self.with_labels(|labels, _, context| labels.work_done(id, *result, context));
            }
            WorkResult::Scores(result) => {
                self.scores.work_done(id, *result);
            }
            WorkResult::Gap(result) => {
                let world = self.world_of(id);
                self.with_gap_of(world, |gap, around, context| gap.work_done(id, *result, around, context));
            }
        }
    }

    fn world_of(&mut self, id: JobId) -> World {
        self.started_by.remove(&id).unwrap_or(self.eyes.shown)
    }

    fn work_gave_nothing(&mut self, id: JobId, why: Option<&str>) {
        self.with_labels(|labels, _, context| labels.work_ended(id, why, context));
        self.scores.work_ended(id, why);
        self.with_detect(|detect, context| detect.work_ended(id, why, context));
        let world = self.world_of(id);
        self.eyes.of_mut(world).work_ended(id);
        if let Some(mount) = self.mounts.get_mut(&world) {
            mount.work_ended(id);
        }
        if let Some(touch) = self.touches.get_mut(&world) {
            touch.work_ended(id);
        }
        if let Some(models) = self.models.get_mut(&world) {
            models.work_ended(id);
        }
        if let Some(gap) = self.gaps.get_mut(&world) {
            gap.work_ended(id, why);
        }
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
        self.live.newest().map(|frame| frame.stamp.seq)
    }

    fn mount_view(&self) -> MountView {
        let around = surroundings(&self.rig, &self.robot, self.eyes.shown());
        self.mounts.get(&self.eyes.shown).map(|mount| mount.view(&around)).unwrap_or_default()
    }

    fn touch_view(&self) -> TouchView {
        let (Some(touch), Some(models)) = (self.touches.get(&self.arm_of), self.models.get(&self.arm_of))
        else {
            return TouchView::default();
        };
        touch.view(&TouchSurroundings { rig: &self.rig, robot: &self.robot, models: &models.usable() })
    }

    fn models_view(&self) -> ModelsView {
        let newest_session = self.touches.get(&self.arm_of).and_then(TouchWorkflow::session);
        let rig = self.rig_of(self.arm_of);
        let around = ModelsSurroundings { rig: &rig, robot: &self.robot, newest_session };
        self.models.get(&self.arm_of).map(|models| models.view(&around)).unwrap_or_default()
    }

    fn gap_view(&self) -> GapView {
        let newest_session = self.touches.get(&self.arm_of).and_then(TouchWorkflow::session);
        let rig = self.rig_of(self.arm_of);
        let around = GapSurroundings { rig: &rig, newest_session };
        self.gaps.get(&self.arm_of).map(|gap| gap.view(&around)).unwrap_or_default()
    }

    /// What the window shows.
    pub fn view(&mut self, skipped: Skipped, lost_commands: u64, now: Instant) -> View {
        self.revision += 1;
        let around = Around {
            newest: self.live.newest(),
            opened: self.shown_of,
            photographs: self.source.view().photographs,
            setup: self.live.setup(),
        };
        let detect = Arc::new(self.detect.view(skipped.detect, &around, now));
        View {
            revision: self.revision,
            source: self.source.view().clone(),
            live: Arc::new(self.live.view(skipped, now)),
            detect,
            eyes: Arc::new(self.eyes.of_mut(self.eyes.shown).view()),
            robot: self.robot.clone(),
            twin: self.twin.clone(),
            mount: Arc::new(self.mount_view()),
            touch: Arc::new(self.touch_view()),
            models: Arc::new(self.models_view()),
            gap: Arc::new(self.gap_view()),
            labels: Arc::new(self.labels.view(self.detect.chosen().0)),
            scores: Arc::new(self.scores.view()),
            jobs: self.jobs.view(),
            notices: self.notices.view(),
            threads: self.faults.values().cloned().collect(),
            kept: self.kept.clone(),
            lost_commands,
        }
    }
}

const WORLDS: [World; 2] = [World::Robot, World::Twin];

/// What the mount's workflow can see of the rest.
fn surroundings<'a>(rig: &'a Arc<Rig>, robot: &'a RobotView, eyes: &EyesState) -> MountSurroundings<'a> {
    MountSurroundings { rig, robot, calibration: eyes.in_use().cloned(), board: *eyes.board() }
}
