//! An engine with a twin, driven as the window drives it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_twin::Toy;

use crate::command::{Command, GraspCommand, RobotCommand, TwinCommand};
use crate::engine::Engine;
use crate::engine::settings::EngineSettings;
use crate::view::{GraspOutcome, GraspPhase, GraspRun, GraspStep, LampState, SourceStatus, View};

/// Beside other tests the physics of the twin is slower than its clock.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Bench {
    engine: Engine,
    pub folder: tempfile::TempDir,
}

impl Bench {
    /// A twin with one toy on its table, whose eyes are open and whose joints hold; `None` where eyes
    /// cannot be rendered.
    pub fn start(scenario: &str, toy: Toy, at_m: [f64; 2]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let settings = EngineSettings {
            data_dir: Some(folder.path().to_owned()),
            twin: Some(scenario.to_owned()),
            source: None,
        };
        let bench = Self { engine: Engine::start(settings, Arc::new(|| {})), folder };
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

pub fn words(outcome: Option<&GraspOutcome>) -> String {
    match outcome {
        None => "none".to_owned(),
        Some(GraspOutcome::Success) => "success".to_owned(),
        Some(GraspOutcome::Failed { failure, why }) => format!("{failure:?}: {why}"),
        Some(GraspOutcome::Refused { why }) => format!("refused: {why}"),
    }
}
