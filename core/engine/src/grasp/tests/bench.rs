//! An engine with a twin, driven as the window drives it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_grasp::Record;
use plumbline_twin::Toy;
use tempfile::TempDir;

use crate::command::{Command, GraspCommand, HandStep, RobotCommand, TwinCommand};
use crate::engine::Engine;
use crate::engine::settings::EngineSettings;
use crate::view::{GraspOutcome, GraspPhase, GraspRun, GraspStep, LampState, SourceStatus, View};

/// Beside other tests the physics of the twin is slower than its clock.
const PATIENCE: Duration = Duration::from_secs(120);
/// What is higher than this stands on no table and no screen, robot frame, m.
const LIFTED_Z_M: f64 = 0.11;

pub struct Bench {
    engine: Engine,
    pub folder: PathBuf,
    /// Goes after the engine has ended.
    _temporary: Option<TempDir>,
}

impl Bench {
    /// A twin with one toy on its table, whose eyes are open and whose joints hold; `None` where eyes
    /// cannot be rendered.
    pub fn start(scenario: &str, toy: Toy, at_m: [f64; 2]) -> Option<Self> {
        Self::start_in(tempfile::tempdir().expect("a temporary folder"), scenario, toy, at_m)
    }

    /// The same with the data of a folder: what was calibrated in it is known.
    pub fn start_in(folder: TempDir, scenario: &str, toy: Toy, at_m: [f64; 2]) -> Option<Self> {
        let bench = Self::start_at(folder.path(), scenario, toy, at_m)?;
        Some(Self { _temporary: Some(folder), ..bench })
    }

    /// The same with the data of a folder that stays.
    pub fn start_at(folder: &Path, scenario: &str, toy: Toy, at_m: [f64; 2]) -> Option<Self> {
        let settings = EngineSettings {
            data_dir: Some(folder.to_owned()),
            twin: Some(scenario.to_owned()),
            source: None,
        };
        let engine = Engine::start(settings, Arc::new(|| {}));
        let bench = Self { engine, folder: folder.to_owned(), _temporary: None };
        bench.make_ready(toy, at_m).then_some(bench)
    }

    /// Waits for a twin that was started; with one toy on its table it holds and its eyes are open. `false`: they
    /// cannot be rendered.
    pub fn make_ready(&self, toy: Toy, at_m: [f64; 2]) -> bool {
        self.until("the twin is connected", |view| view.robot.measured.is_some() && view.twin.running);
        // A busy machine starts it so slowly that STOP may have been pressed.
        self.send(RobotCommand::ReleaseStop);
        self.send(RobotCommand::Torque { joints: vec![], on: true });
        for other in Toy::ALL.into_iter().filter(|other| *other != toy) {
            self.remove(other);
        }
        self.place(toy, at_m);
        let view = self.until("the eyes are open or lost", |view| {
            matches!(view.source.status, SourceStatus::Running | SourceStatus::Lost { .. })
                && (view.live.raw.is_some() || !matches!(view.source.status, SourceStatus::Running))
        });
        if let SourceStatus::Lost { reason, .. } = &view.source.status {
            println!("skipped: {reason}");
            return false;
        }
        self.until("joints hold", |view| view.robot.joints.iter().all(|joint| joint.torque_on == Some(true)));
        true
    }

    pub fn place(&self, toy: Toy, [x_m, y_m]: [f64; 2]) {
        self.send(TwinCommand::PlaceToy { toy: toy.name().to_owned(), x_m, y_m });
    }

    pub fn remove(&self, toy: Toy) {
        self.send(TwinCommand::RemoveToy { toy: toy.name().to_owned() });
    }

    pub fn send(&self, command: impl Into<Command>) {
        self.engine.send(command.into());
    }

    pub fn stop(&self) {
        self.engine.stop();
    }

    /// Lets the window live until something is so.
    pub fn until(&self, what: &str, is_so: impl Fn(&View) -> bool) -> Arc<View> {
        let began = Instant::now();
        loop {
            self.engine.heartbeat();
            let view = self.engine.view();
            if is_so(&view) {
                return view;
            }
            if began.elapsed() > PATIENCE {
                let notices: Vec<&str> = view.notices.iter().map(|notice| notice.text.as_str()).collect();
                panic!("{what} did not come: {:?} {notices:?}", view.grasp);
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn until_step(&self, step: GraspStep) -> Arc<View> {
        self.until("the step", |view| {
            let run = view.grasp.run.as_ref();
            run.is_some_and(|run| run.lamps.contains(&(step, LampState::Lit)) || run.outcome.is_some())
        })
    }

    /// Lets what was put somewhere come to rest.
    pub fn settle(&self) {
        let began = Instant::now();
        self.until("rest", |_| began.elapsed() > Duration::from_millis(1500));
    }

    /// Until nothing is under way.
    pub fn until_idle(&self) -> Arc<View> {
        self.until("the end", |view| view.grasp.phase == GraspPhase::Idle)
    }

    /// One step of the hand by itself, to its end; a hand that is open already is open at once.
    pub fn hand(&self, step: HandStep) -> Arc<View> {
        let sent = Instant::now();
        self.send(GraspCommand::Hand(step));
        self.until("it to begin", |view| {
            view.grasp.phase.moves() || sent.elapsed() > Duration::from_millis(1500)
        });
        self.until_idle()
    }

    /// How far a joint of an arm that is to hold turns within 0.7 s, once it has come to rest, rad. Where a machine has much
    /// else to do the twin's time goes slower than ours: it has three times as long to come to rest.
    pub fn creeps_rad(&self) -> f64 {
        const STANDS_RAD: f64 = 0.01;
        let posture = || {
            std::thread::sleep(Duration::from_millis(700));
            let view = self.until("angles", |view| view.robot.measured.is_some());
            view.robot.measured.clone().expect("just seen")
        };
        let (mut before, mut turned_rad) = (posture(), f64::INFINITY);
        for _ in 0..3 {
            let now = posture();
            turned_rad = before.distance_rad(&now);
            if turned_rad < STANDS_RAD {
                break;
            }
            before = now;
        }
        turned_rad
    }

    /// What was kept of the newest attempt.
    pub fn kept(&self) -> Record {
        let grasps = std::fs::read_dir(self.folder.join("twin/grasps")).expect("attempts were kept");
        let newest = grasps.flatten().map(|entry| entry.path()).max().expect("one at least");
        let text = std::fs::read_to_string(newest.join("record.json")).expect("readable");
        serde_json::from_str(&text).expect("a record")
    }

    /// The joint tracks that were kept of the newest attempt.
    pub fn kept_tracks(&self) -> Vec<Vec<String>> {
        let grasps = std::fs::read_dir(self.folder.join("twin/grasps")).expect("attempts were kept");
        tracks_in(&grasps.flatten().map(|entry| entry.path()).max().expect("one at least"))
    }

    /// Begins a grasp: from then on the window shows this one, and not the one before.
    pub fn begin(&self) {
        self.send(GraspCommand::Grasp);
        self.until("the beginning", |view| view.grasp.phase.moves());
    }

    /// Grasps, to its end.
    pub fn grasp(&self) -> Arc<GraspRun> {
        self.begin();
        let view = self.until_idle();
        view.grasp.run.clone().expect("there was one")
    }
}

/// The rows of the joint tracks in the folder of an attempt, below their header; all have all cells.
pub fn tracks_in(attempt: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(attempt.join("tracks.csv")).expect("they are kept");
    assert!(text.ends_with('\n'), "half a row is left");
    let mut rows = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let head = rows.next().expect("a header");
    let rows: Vec<_> = rows.collect();
    assert!(rows.iter().all(|row| row.len() == head.len()), "{text}");
    rows
}

/// Where the middle of a toy really is, robot frame, m, for judging; `None`: put away.
pub fn truly_at_m(view: &View, toy: Toy) -> Option<[f64; 3]> {
    let known = view.twin.toys.iter().find(|known| known.name == toy.name())?;
    known.place.map(|place| place.coords.coords.into())
}

/// Whether a toy is really off the table by more than its size: what stands on it does not get there.
pub fn is_truly_lifted(view: &View, toy: Toy) -> bool {
    truly_at_m(view, toy).is_some_and(|[.., z_m]| z_m > LIFTED_Z_M)
}

pub fn words(outcome: Option<&GraspOutcome>) -> String {
    match outcome {
        None => "none".to_owned(),
        Some(GraspOutcome::Success) => "success".to_owned(),
        Some(GraspOutcome::Failed { failure, why }) => format!("{failure:?}: {why}"),
        Some(GraspOutcome::Refused { why }) => format!("refused: {why}"),
    }
}
