//! The threads of the live side, and what goes in and out of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender};
use plumbline_model::robot::Rig;
use plumbline_model::{Chessboard, StereoFrame};

use super::Shared;
use crate::bell::Bell;
use crate::command::ProbePoint;
use crate::eyes::Look;
use crate::live::{Skipped, default_rig};
use crate::robot::{
    News, RobotControl, RobotThread, RobotWires, Switches, TouchNews, TwinDesk, TwinEyesPlug, Worker,
};
use crate::slot::{Putter, Taker, newest_value_slot};
use crate::source::{Control, Note, Player, SourceThread, Wires};
use crate::stages::{
    CornersInput, CornersStage, DetectInput, DetectOutput, DetectStage, ProbeInput, ProbeOutput, ProbeStage,
    RectifyInput, RectifyOutput, RectifyStage, StageThread, run_stage,
};
use crate::state::State;
use crate::view::{DetectionSettings, SourceView};
use crate::watched::{Pulse, Trial, Watched, WatchedThread};

/// A point that stays is measured anew at most this often; a new one at once.
pub(super) const PROBE_EVERY: Duration = Duration::from_millis(100);
/// Messages of the source that may wait.
const NOTES_WAITING: usize = 256;

/// The threads of the live side.
pub(super) struct Pipeline {
    bell: Bell,
    trial: Trial,
    switches: Switches,
    data_dir: PathBuf,
    eyes: TwinEyesPlug,
    source: SourceThread,
    frames: Taker<(u64, StereoFrame)>,
    frames_in: Putter<(u64, StereoFrame)>,
    views: Taker<SourceView>,
    notes: Receiver<Note>,
    notes_in: Sender<Note>,
    robot: RobotThread,
    news: Taker<News>,
    touches: Receiver<TouchNews>,
    rectify: StageThread<RectifyInput, RectifyOutput>,
    corners: StageThread<CornersInput, Look>,
    probe: StageThread<ProbeInput, ProbeOutput>,
    detect: StageThread<DetectInput, DetectOutput>,
    fed: Fed,
}

/// What each stage was given last: seq, and what else decides its result.
#[derive(Default)]
struct Fed {
    rectify: Option<(u64, u64, bool)>,
    corners: Option<(u64, Chessboard)>,
    probe: Option<(u64, u64, ProbePoint)>,
    /// Pair, source, detector, setup; settings are told apart by themselves.
    detect: Option<(u64, u64, u64, Option<u64>)>,
    detect_settings: Option<Arc<DetectionSettings>>,
    probed_at: Option<Instant>,
    /// A newer pair waits for its time.
    probe_waits: bool,
}

/// What every thread of the pipeline is started with.
struct Start<'a> {
    bell: &'a Bell,
    trial: &'a Trial,
}

impl Start<'_> {
    fn pulse(&self, thread: WatchedThread) -> Pulse {
        Pulse::new(thread, self.bell.clone(), self.trial.clone())
    }

    fn source(
        &self,
        player: Player,
        frames: Putter<(u64, StereoFrame)>,
        notes: Sender<Note>,
    ) -> std::io::Result<(SourceThread, Taker<SourceView>)> {
        let (views_in, views) = newest_value_slot();
        let wires = Wires { frames, views: views_in, notes, bell: self.bell.clone() };
        Ok((SourceThread::start(player, wires, self.pulse(WatchedThread::Source))?, views))
    }

    fn robot(
        &self,
        worker: Worker,
        notes: Sender<Note>,
    ) -> std::io::Result<(RobotThread, Taker<News>, Receiver<TouchNews>)> {
        let (news_in, news) = newest_value_slot();
        let (touches_in, touches) = crossbeam_channel::bounded(NOTES_WAITING);
        let wires = RobotWires { news: news_in, touches: touches_in, notes, bell: self.bell.clone() };
        Ok((RobotThread::start(worker, wires, self.pulse(WatchedThread::Robot))?, news, touches))
    }

    fn rectify(&self) -> std::io::Result<StageThread<RectifyInput, RectifyOutput>> {
        let make = || {
            let mut stage = RectifyStage::default();
            move |input| stage.process(input)
        };
        let stamp = |input: &RectifyInput| input.frame.stamp;
        run_stage(self.pulse(WatchedThread::Rectify), self.bell.clone(), stamp, make)
    }

    fn corners(&self) -> std::io::Result<StageThread<CornersInput, Look>> {
        let make = || {
            let mut stage = CornersStage::default();
            move |input| stage.process(input)
        };
        let stamp = |input: &CornersInput| input.frame.stamp;
        run_stage(self.pulse(WatchedThread::Corners), self.bell.clone(), stamp, make)
    }

    fn probe(&self) -> std::io::Result<StageThread<ProbeInput, ProbeOutput>> {
        let make = || {
            let mut stage = ProbeStage::default();
            move |input| stage.process(input)
        };
        let stamp = |input: &ProbeInput| input.frame.stamp;
        run_stage(self.pulse(WatchedThread::Probe), self.bell.clone(), stamp, make)
    }

    fn detect(&self) -> std::io::Result<StageThread<DetectInput, DetectOutput>> {
        let make = || {
            let mut stage = DetectStage::default();
            move |input| stage.process(input)
        };
        let stamp = |input: &DetectInput| input.frame.stamp;
        run_stage(self.pulse(WatchedThread::Detect), self.bell.clone(), stamp, make)
    }
}

impl Pipeline {
    pub(super) fn start(bell: &Bell, data_dir: &Path, shared: &Shared) -> std::io::Result<Self> {
        let start = Start { bell, trial: &shared.trial };
        let (frames_in, frames) = newest_value_slot();
        let (notes_in, notes) = crossbeam_channel::bounded(NOTES_WAITING);
        let eyes = TwinEyesPlug::default();
        let worker =
            Worker::new(default_rig(), data_dir, shared.switches.clone(), TwinDesk::new(eyes.clone()));
        let player = Player::with_opener(eyes.opener());
        let (source, views) = start.source(player, frames_in.clone(), notes_in.clone())?;
        let (robot, news, touches) = start.robot(worker, notes_in.clone())?;
        Ok(Self {
            rectify: start.rectify()?,
            corners: start.corners()?,
            probe: start.probe()?,
            detect: start.detect()?,
            fed: Fed::default(),
            bell: bell.clone(),
            trial: shared.trial.clone(),
            switches: shared.switches.clone(),
            data_dir: data_dir.to_owned(),
            eyes,
            source,
            robot,
            news,
            touches,
            frames,
            frames_in,
            views,
            notes,
            notes_in,
        })
    }

    /// All watched threads.
    pub(super) fn watched(&self) -> [&Watched; 6] {
        [
            self.robot.watched(),
            self.source.watched(),
            self.rectify.watched(),
            self.corners.watched(),
            self.probe.watched(),
            self.detect.watched(),
        ]
    }

    /// Hands a command to the robot's thread; `false` when too many wait.
    pub(super) fn control_robot(&self, control: RobotControl) -> bool {
        self.robot.control(control)
    }

    /// Hands a command to the source thread; `false` when too many wait.
    pub(super) fn control_source(&self, control: Control) -> bool {
        self.source.control(control)
    }

    /// The twin went with the thread that it lived in: nobody looks through its eyes any more.
    pub(super) fn close_twin_eyes(&self) {
        self.eyes.set(None);
    }

    /// Puts another thread in the place of one that has ended.
    pub(super) fn start_again(&mut self, thread: WatchedThread, state: &State) -> std::io::Result<()> {
        let (bell, trial) = (self.bell.clone(), self.trial.clone());
        let start = Start { bell: &bell, trial: &trial };
        match thread {
            WatchedThread::Robot => {
                let worker = self.another_worker(state.rig_in_use(), state.twins_started());
                (self.robot, self.news, self.touches) = start.robot(worker, self.notes_in.clone())?;
            }
            WatchedThread::Source => {
                let next_seq = state.newest_seq().map_or(0, |seq| seq + 1);
                let player =
                    Player::with_opener(self.eyes.opener()).in_place_of_one(next_seq, state.sources_opened());
                (self.source, self.views) =
                    start.source(player, self.frames_in.clone(), self.notes_in.clone())?;
            }
            WatchedThread::Rectify => (self.rectify, self.fed.rectify) = (start.rectify()?, None),
            WatchedThread::Corners => (self.corners, self.fed.corners) = (start.corners()?, None),
            WatchedThread::Probe => (self.probe, self.fed.probe) = (start.probe()?, None),
            WatchedThread::Detect => (self.detect, self.fed.detect) = (start.detect()?, None),
            WatchedThread::Engine | WatchedThread::Journal => {}
        }
        Ok(())
    }

    /// Not connected; it knows where eyes and screen lie, and counts on.
    fn another_worker(&self, rig: Arc<Rig>, twins_started: u64) -> Worker {
        let desk = TwinDesk::new(self.eyes.clone());
        Worker::new(rig, &self.data_dir, self.switches.clone(), desk)
            .in_place_of_one_that_started(twins_started)
    }

    /// Gives the state what has come; whether there was anything.
    pub(super) fn collect(&self, state: &mut State, now: Instant) -> bool {
        let mut any = false;
        // What a thread said before it failed is not true any more.
        let failed = |watched: &Watched| watched.pulse().has_failed();
        let source_failed = failed(self.source.watched());
        if let Some(view) = self.views.try_take().filter(|_| !source_failed) {
            state.source_changed(view);
            any = true;
        }
        for note in self.notes.try_iter() {
            state.source_note(note);
            any = true;
        }
        let robot_failed = failed(self.robot.watched());
        if let Some(news) = self.news.try_take().filter(|_| !robot_failed) {
            state.robot_changed(news);
            any = true;
        }
        for news in self.touches.try_iter() {
            state.touch_news(news);
            any = true;
        }
        if let Some((opened, frame)) = self.frames.try_take() {
            state.frame(opened, frame, now);
            any = true;
        }
        if let Some(output) = self.rectify.take() {
            any = true;
            match output {
                Ok(output) => state.rectified(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.corners.take() {
            any = true;
            match output {
                Ok(output) => state.looked(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.detect.take() {
            any = true;
            match output {
                Ok(output) => state.detected(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.probe.take() {
            any = true;
            match output {
                Ok(output) => state.probed(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        any
    }

    /// Gives each stage what it was not given yet: a new pair, or the same one anew when what
    /// is wanted of it changed.
    pub(super) fn feed(&mut self, state: &State) {
        if let Some(input) = state.rectify_input() {
            let key = (input.frame.stamp.seq, input.setup.generation, input.disparity);
            if self.fed.rectify.replace(key) != Some(key) {
                self.rectify.put(input);
            }
        }
        if let Some(input) = state.corners_input() {
            let key = (input.frame.stamp.seq, input.board);
            if self.fed.corners.replace(key) != Some(key) {
                self.corners.put(input);
            }
        }
        if let Some(input) = state.detect_input() {
            let generation = input.setup.as_ref().ok().map(|setup| setup.generation);
            let key = (input.frame.stamp.seq, input.opened, input.detector.id, generation);
            let settings = Some(input.settings.clone());
            if self.fed.detect.replace(key) != Some(key) || self.fed.detect_settings != settings {
                self.fed.detect_settings = settings;
                self.detect.put(input);
            }
        }
        if let Some(input) = state.probe_input() {
            let key = (input.frame.stamp.seq, input.setup.generation, input.point);
            let fed = &mut self.fed;
            let same_point =
                fed.probe.is_some_and(|(_, generation, point)| (generation, point) == (key.1, key.2));
            let lately = fed.probed_at.is_some_and(|at| at.elapsed() < PROBE_EVERY);
            let is_new = fed.probe != Some(key);
            fed.probe_waits = is_new && same_point && lately;
            if is_new && !fed.probe_waits {
                (fed.probe, fed.probed_at) = (Some(key), Some(Instant::now()));
                self.probe.put(input);
            }
        }
    }

    /// Whether a newer pair waits for its time to be measured.
    pub(super) fn probe_waits(&self) -> bool {
        self.fed.probe_waits
    }

    pub(super) fn skipped(&self) -> Skipped {
        Skipped {
            source: self.frames_in.skipped(),
            rectify: self.rectify.skipped(),
            corners: self.corners.skipped(),
            probe: self.probe.skipped(),
            detect: self.detect.skipped(),
        }
    }
}
