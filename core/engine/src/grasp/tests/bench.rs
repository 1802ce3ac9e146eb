//! An engine with a twin, driven as the window drives it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_twin::Toy;
use tempfile::TempDir;

use crate::command::{Command, GraspCommand, RobotCommand, TwinCommand};
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
        bench.until("the twin is connected", |view| view.robot.measured.is_some() && view.twin.running);
        // A busy machine starts it so slowly that STOP may have been pressed.
        bench.send(RobotCommand::ReleaseStop);
        bench.send(RobotCommand::Torque { joints: vec![], on: true });
        for other in Toy::ALL.into_iter().filter(|other| *other != toy) {
            bench.send(TwinCommand::RemoveToy { toy: other.name().to_owned() });
        }
        bench.place(toy, at_m);
        let view = bench.until("the eyes are open or lost", |view| {
            matches!(view.source.status, SourceStatus::Running | SourceStatus::Lost { .. })
                && (view.live.raw.is_some() || !matches!(view.source.status, SourceStatus::Running))
        });
        if let SourceStatus::Lost { reason, .. } = &view.source.status {
            println!("skipped: {reason}");
            return None;
        }
        bench
            .until("joints hold", |view| view.robot.joints.iter().all(|joint| joint.torque_on == Some(true)));
        Some(bench)
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

    /// Grasps, to its end.
    pub fn grasp(&self) -> Arc<GraspRun> {
        self.send(GraspCommand::Grasp);
        self.until("the beginning", |view| view.grasp.phase.moves());
        let view = self.until_idle();
        view.grasp.run.clone().expect("there was one")
    }
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
