//! The threads of the live side, and what goes in and out of them.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender};
use plumbline_model::StereoFrame;
use plumbline_model::robot::default_rig;

use super::Shared;
use super::journal::Happened;
use crate::detect::DetectStage;
use crate::drift::DriftStage;
use crate::eyes::CornersStage;
use crate::ground::bell::Bell;
use crate::ground::slot::{Putter, Taker, newest_value_slot};
use crate::ground::stage::{Skipped, Stage, StageThread, start_stage};
use crate::ground::watched::{Pulse, Trial, Watched, WatchedThread};
use crate::live::{ProbeStage, RectifyStage};
use crate::robot::view::Connection;
use crate::robot::{News, RobotControl, RobotThread, RobotWires, Switches, TouchNews, Worker};
use crate::source::view::SourceView;
use crate::source::{Control, Note, Player, SourceThread, Wires};
use crate::state::{Serves, State};
use crate::truth::TruthPlug;
use crate::twin::{TwinDesk, TwinEyesPlug};

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
    rectify: Line<RectifyStage>,
    corners: Line<CornersStage>,
    probe: Line<ProbeStage>,
    detect: Line<DetectStage>,
    drift: Line<DriftStage>,
    probed: Probed,
}

/// When a point was measured last.
#[derive(Default)]
struct Probed {
    at: Option<Instant>,
    /// A newer pair waits for its time.
    waits: bool,
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

    fn stage<S: Stage>(&self) -> std::io::Result<Line<S>> {
        let thread = start_stage::<S>(self.pulse(S::THREAD), self.bell.clone())?;
        Ok(Line { thread, given: None })
    }
}

/// A stage on its thread, and what it was given last.
struct Line<S: Stage> {
    thread: StageThread<S::Input, S::Output>,
    given: Option<S::Key>,
}

impl<S: Stage> Line<S> {
    /// Gives the state what has come; whether there was anything.
    fn collect(&self, state: &mut State, now: Instant) -> bool
    where
        State: Serves<S>,
    {
        match self.thread.take() {
            None => return false,
            Some(Ok(output)) => Serves::<S>::output(state, output, now),
            Some(Err(panic)) => state.stage_panicked(&panic),
        }
        true
    }

    /// Gives the stage what it was not given yet: a new pair, or the same one anew when what is
    /// wanted of it changed.
    fn feed(&mut self, state: &State)
    where
        State: Serves<S>,
    {
        if let Some(input) = Serves::<S>::input(state) {
            let key = Some(S::key(&input));
            if self.given != key {
                self.given = key;
                self.thread.put(input);
            }
        }
    }
}

impl Pipeline {
    pub(super) fn start(
        bell: &Bell,
        data_dir: &Path,
        shared: &Shared,
        truth: TruthPlug,
    ) -> std::io::Result<Self> {
        let start = Start { bell, trial: &shared.trial };
        let (frames_in, frames) = newest_value_slot();
        let (notes_in, notes) = crossbeam_channel::bounded(NOTES_WAITING);
        let eyes = TwinEyesPlug::new(shared.trial.eyes().cloned());
        let desk = TwinDesk::new(eyes.clone()).with_truth(truth);
        let worker = Worker::new(default_rig(), data_dir, shared.switches.clone(), desk);
        let player = Player::with_opener(eyes.opener());
        let (source, views) = start.source(player, frames_in.clone(), notes_in.clone())?;
        let (robot, news, touches) = start.robot(worker, notes_in.clone())?;
        Ok(Self {
            rectify: start.stage()?,
            corners: start.stage()?,
            probe: start.stage()?,
            detect: start.stage()?,
            drift: start.stage()?,
            probed: Probed::default(),
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
    pub(super) fn watched(&self) -> [&Watched; 7] {
        [
            self.robot.watched(),
            self.source.watched(),
            self.rectify.thread.watched(),
            self.corners.thread.watched(),
            self.probe.thread.watched(),
            self.detect.thread.watched(),
            self.drift.thread.watched(),
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
                let worker = self.another_worker(state);
                (self.robot, self.news, self.touches) = start.robot(worker, self.notes_in.clone())?;
            }
            WatchedThread::Source => {
                let next_seq = state.newest_seq().map_or(0, |seq| seq + 1);
                let player =
                    Player::with_opener(self.eyes.opener()).in_place_of_one(next_seq, state.sources_opened());
                (self.source, self.views) =
                    start.source(player, self.frames_in.clone(), self.notes_in.clone())?;
            }
            WatchedThread::Rectify => self.rectify = start.stage()?,
            WatchedThread::Corners => self.corners = start.stage()?,
            WatchedThread::Probe => self.probe = start.stage()?,
            WatchedThread::Detect => self.detect = start.stage()?,
            WatchedThread::Drift => self.drift = start.stage()?,
            WatchedThread::Engine | WatchedThread::Journal => {}
        }
        Ok(())
    }

    /// Not connected; it knows where eyes and screen lie, and counts on.
    fn another_worker(&self, state: &State) -> Worker {
        let (model, twins_started) = (state.model_of_the_arm(), state.twins_started());
        let desk = TwinDesk::new(self.eyes.clone()).with_truth(state.truth_plug());
        let rig = model.rig().clone();
        let mut worker = Worker::new(rig, &self.data_dir, self.switches.clone(), desk)
            .in_place_of_one_that_started(twins_started);
        worker.use_model(model);
        worker
    }

    /// Gives the state what has come; whether there was anything. What of it the journal keeps is added
    /// to `happened`.
    pub(super) fn collect(&self, state: &mut State, now: Instant, happened: &mut Vec<Happened>) -> bool {
        let mut any = false;
        // What a thread said before it failed is not true any more.
        let failed = |watched: &Watched| watched.pulse().has_failed();
        let source_failed = failed(self.source.watched());
        if let Some(view) = self.views.try_take().filter(|_| !source_failed) {
            state.source_changed(view);
            any = true;
        }
        for note in self.notes.try_iter() {
            happened.push(Happened::Noted { level: note.0, text: note.1.clone() });
            state.source_note(note);
            any = true;
        }
        let robot_failed = failed(self.robot.watched());
        if let Some(news) = self.news.try_take().filter(|_| !robot_failed) {
            // What moves tells it many times a second, and nobody could make it move so again.
            if news.robot.connection == Connection::None {
                happened.push(Happened::RobotTold);
            }
            state.robot_changed(news);
            any = true;
        }
        for news in self.touches.try_iter() {
            state.touch_news(news);
            any = true;
        }
        if let Some((opened, frame)) = self.frames.try_take() {
            state.pairs_replaced(self.frames_in.skipped());
            state.frame(opened, frame, now);
            any = true;
        }
        any |= self.rectify.collect(state, now);
        any |= self.corners.collect(state, now);
        any |= self.detect.collect(state, now);
        any |= self.probe.collect(state, now);
        any |= self.drift.collect(state, now);
        any
    }

    /// Gives each stage what it was not given yet: a new pair, or the same one anew when what
    /// is wanted of it changed.
    pub(super) fn feed(&mut self, state: &State) {
        self.rectify.feed(state);
        self.corners.feed(state);
        self.detect.feed(state);
        self.drift.feed(state);
        self.feed_probe(state);
    }

    /// A point that stays is measured now and then only.
    fn feed_probe(&mut self, state: &State) {
        let Some(input) = state.probe_input() else { return };
        let key = ProbeStage::key(&input);
        let given = &self.probe.given;
        let same_point = given.is_some_and(|(_, generation, point)| (generation, point) == (key.1, key.2));
        let lately = self.probed.at.is_some_and(|at| at.elapsed() < PROBE_EVERY);
        let is_new = *given != Some(key);
        self.probed.waits = is_new && same_point && lately;
        if is_new && !self.probed.waits {
            (self.probe.given, self.probed.at) = (Some(key), Some(Instant::now()));
            self.probe.thread.put(input);
        }
    }

    /// Whether a newer pair waits for its time to be measured.
    pub(super) fn probe_waits(&self) -> bool {
        self.probed.waits
    }

    pub(super) fn skipped(&self) -> Skipped {
        Skipped {
            source: self.frames_in.skipped(),
            rectify: self.rectify.thread.skipped(),
            corners: self.corners.thread.skipped(),
            probe: self.probe.thread.skipped(),
            detect: self.detect.thread.skipped(),
        }
    }
}
