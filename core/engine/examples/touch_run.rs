//! Touches the twin's screen through the whole workflow, without a window, and prints how far from
//! their targets the touches landed:
//! `cargo run --release -p plumbline-engine --example touch_run -- [NAME=VALUE ...]`.
//!
//! - `scenario=lab`: which twin.
//! - `plan=train`: what is touched: `train` (grid, lines, random targets and repeats, about as many as
//!   the published run), `first`, `quick`, `check` (new random targets).
//! - `count=250`, `seed=1`: of `check`, and of the random targets of `train`.
//! - `area=150,1750,420,1040`: first and last column, first and last row.
//! - `correct=m3`: trains on the newest session of the data folder, and corrects with this model.
//! - `correct=effects`: corrects by the named effects of the model in use alone: inverse kinematics, no
//!   network. `model=FILE` puts that model in use first; without, it is the one of the data folder.
//! - `data=FOLDER`: where sessions are kept; without, they are forgotten.
//! - `resume=yes`: goes on with the newest run of the data folder that was not finished.
//! - `speed=1`: of the arm.
//! - `place=yes`: takes the place of the screen that the touches gave into use at the end.
#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use plumbline_engine::models::Method;
use plumbline_engine::view::{MotionState, TouchOutcome, TouchPhase};
use plumbline_engine::{
    Correction, Engine, EngineSettings, ModelsCommand, RobotCommand, SourceCommand, TouchCommand,
    TwinCommand, View,
};
use plumbline_model::{Pattern, PlanOptions, TouchArea};

const PATIENCE: Duration = Duration::from_secs(120);
/// A run that stops is told to go on so many times.
const RESUMES: usize = 100;

fn main() {
    let arguments: BTreeMap<String, String> = std::env::args()
        .skip(1)
        .filter_map(|argument| argument.split_once('=').map(|(name, value)| (name.into(), value.into())))
        .collect();
    let text = |name: &str, usual: &str| arguments.get(name).cloned().unwrap_or_else(|| usual.to_owned());
    let forgotten = tempfile::tempdir().expect("temporary folder");
    let data_dir = arguments.get("data").map_or_else(|| forgotten.path().to_owned(), PathBuf::from);
    if let Some(model) = arguments.get("model") {
        let twin = data_dir.join("twin");
        std::fs::create_dir_all(&twin).expect("the data folder can be written");
        std::fs::copy(model, plumbline_engine::rig_models::file(&twin)).expect("the model can be read");
    }
    let bench = Bench::start(data_dir, text("scenario", "lab"));
    bench.until("the twin's joints", |view| view.robot.measured.is_some());
    let speed: f64 = text("speed", "1").parse().expect("speed is a number");
    bench.engine.send(RobotCommand::Speed(speed));
    bench.until("the speed", |view| (view.robot.speed - speed).abs() < 1e-9);
    // Nobody looks; drawing what the eyes see takes half a processor.
    bench.engine.send(SourceCommand::Close);
    if arguments.contains_key("resume") {
        bench.resume();
        return;
    }
    if let Some(name) = arguments.get("correct") {
        if name == "effects" {
            bench.engine.send(TouchCommand::CorrectWith(Some(Correction::Effects)));
            bench.until("the correction", |view| view.touch.correct_with == Some(Correction::Effects));
        } else {
            bench.correct(name);
        }
    }
    bench.engine.send(TouchCommand::Plan(options(&text)));
    bench.until("the plan", |view| view.touch.phase == TouchPhase::Planned && view.touch.plan.is_some());
    let view = bench.engine.view();
    let plan = view.touch.plan.as_ref().expect("just seen");
    println!(
        "{} touches planned, {} in reach, estimated {:.0?}; refused: {:?}",
        view.touch.touches.len(),
        plan.reachable,
        plan.duration,
        plan.refusals
    );
    let begun = Instant::now();
    bench.engine.send(TouchCommand::Start);
    bench.run();
    bench.summary(begun.elapsed());
    if arguments.contains_key("place") {
        bench.until("the place of the screen", |view| view.touch.placement_proposal.is_some());
        bench.engine.send(TouchCommand::AcceptPlacement);
        bench.until("it in use", |view| view.touch.placement.is_some());
    }
}

fn options(text: &dyn Fn(&str, &str) -> String) -> PlanOptions {
    let area: Vec<f64> = text("area", "150,1750,420,1040")
        .split(',')
        .map(|number| number.parse().expect("area is four numbers"))
        .collect();
    let area = TouchArea { u_px: [area[0], area[1]], v_px: [area[2], area[3]] };
    let count = text("count", "250").parse().expect("count is a whole number");
    let seed = text("seed", "1").parse().expect("seed is a whole number");
    match text("plan", "train").as_str() {
        "first" => PlanOptions::first(area),
        "quick" => PlanOptions::quick(area),
        "check" => PlanOptions::check_reach(area, count, seed),
        _ => {
            let patterns = vec![
                Pattern::Grid { columns: 9, rows: 4 },
                Pattern::Lines { horizontal: 2, vertical: 3, diagonal: 2, points: 11 },
                Pattern::Random { count: 120 },
                Pattern::Again { targets: 5, times: 3 },
            ];
            PlanOptions { patterns, seed, ..PlanOptions::first(area) }
        }
    }
}

struct Bench {
    engine: Arc<Engine>,
    woken: crossbeam_channel::Receiver<()>,
    alive: Arc<AtomicBool>,
    heart: Option<std::thread::JoinHandle<()>>,
}

impl Bench {
    fn start(data_dir: PathBuf, scenario: String) -> Self {
        let (wake, woken) = crossbeam_channel::bounded(1);
        let settings =
            EngineSettings { data_dir: Some(data_dir), twin: Some(scenario), ..EngineSettings::default() };
        let ring = move || {
            let _ = wake.try_send(());
        };
        let engine = Arc::new(Engine::start(settings, Arc::new(ring)));
        let alive = Arc::new(AtomicBool::new(true));
        let heart = std::thread::Builder::new().name("heart".into()).spawn({
            let (engine, alive) = (engine.clone(), alive.clone());
            move || {
                while alive.load(Ordering::Relaxed) {
                    engine.heartbeat();
                    std::thread::sleep(Duration::from_millis(50));
                }
            }
        });
        Self { engine, woken, alive, heart: heart.ok() }
    }

    fn until(&self, what: &str, fulfilled: impl Fn(&View) -> bool) {
        let begun = Instant::now();
        while !fulfilled(&self.engine.view()) {
            assert!(begun.elapsed() < PATIENCE, "never: {what}; {:?}", self.engine.view().notices);
            let _ = self.woken.recv_timeout(Duration::from_millis(100));
        }
    }

    /// Goes on with the newest unfinished run, to its end.
    fn resume(&self) {
        self.until("an unfinished run", |view| !view.touch.unfinished.is_empty());
        let run = self.engine.view().touch.unfinished[0].clone();
        println!("goes on after {} of {}", run.touched, run.planned);
        self.engine.send(TouchCommand::Open { session: run.session });
        self.until("the run", |view| matches!(view.touch.phase, TouchPhase::Paused { .. }));
        let begun = Instant::now();
        self.run();
        self.summary(begun.elapsed());
    }

    /// Trains all models on the newest session, says how good they are, and corrects with one.
    fn correct(&self, name: &str) {
        let method = Method::ALL.into_iter().find(|method| method.name().eq_ignore_ascii_case(name));
        let method = method.unwrap_or_else(|| panic!("correct={name}: choose m1, m2, m3 or effects"));
        self.engine.send(ModelsCommand::ListSessions);
        self.until("a session with touches", |view| view.models.sessions.iter().any(|s| s.touches > 3));
        let view = self.engine.view();
        let usable = view.models.sessions.iter().filter(|session| session.problem.is_none());
        let largest = usable.max_by_key(|session| session.touches).expect("just seen").clone();
        println!("learns from {} touches in {}", largest.touches, largest.folder.display());
        self.engine.send(ModelsCommand::ChooseSession { session: largest.folder });
        self.until("its touches", |view| view.models.data.is_some());
        self.engine.send(ModelsCommand::Train {
            methods: Method::ALL.to_vec(),
            seed: 1,
            published_recipe: false,
        });
        self.until("three models", |view| view.models.proposals.len() == Method::ALL.len());
        if let Some(comparison) = &self.engine.view().models.comparison {
            for compared in &comparison.methods {
                let [low, high] = compared.held_out.mean_2d_interval_m.map(|m| m * 1e3);
                let errors = &compared.held_out.errors;
                println!(
                    "{} held out: mean {:.2} mm (95 % {low:.2} to {high:.2}), height rms {:.2} mm",
                    compared.method.name(),
                    errors.mean_2d_m * 1e3,
                    errors.rms_z_m * 1e3
                );
            }
        }
        self.engine.send(TouchCommand::CorrectWith(Some(method.into())));
        self.until("the correction", |view| view.touch.correct_with == Some(method.into()));
    }

    /// Follows the run to its end, and says how each touch ended.
    fn run(&self) {
        let (mut told, mut resumed, mut moved) = (0, 0, Instant::now());
        loop {
            let view = self.engine.view();
            let touch = &view.touch;
            let done = touch.counts.touched + touch.counts.missed;
            if done > told {
                (told, moved) = (done, Instant::now());
                if done.is_multiple_of(10) {
                    let mean_mm = touch.figures.map_or(f64::NAN, |figures| figures.mean_m * 1e3);
                    println!(
                        "{done:4} touches, mean {mean_mm:.2} mm, {:.0?} left",
                        touch.remaining.unwrap_or_default()
                    );
                }
            }
            match &touch.phase {
                TouchPhase::Finished => return,
                TouchPhase::Waiting { what, prepare: Some((screen_height_m, payload_kg)) } => {
                    println!("{what}");
                    let (screen_height_m, payload_kg) = (*screen_height_m, *payload_kg);
                    self.engine.send(TwinCommand::PrepareTouch { screen_height_m, payload_kg });
                    self.engine.send(TouchCommand::Prepared { screen_height_m, payload_kg });
                }
                TouchPhase::Paused { why } => {
                    resumed += 1;
                    println!("paused: {}", why.clone().unwrap_or_default());
                    assert!(resumed <= RESUMES, "it stops again and again");
                    std::thread::sleep(Duration::from_millis(500));
                    self.engine.send(TouchCommand::Resume);
                    std::thread::sleep(Duration::from_millis(500));
                }
                _ => {}
            }
            let motion = matches!(view.robot.motion, MotionState::Moving { .. });
            assert!(moved.elapsed() < PATIENCE, "it stands still (moving: {motion}); {:?}", view.notices);
            let _ = self.woken.recv_timeout(Duration::from_millis(200));
        }
    }

    fn summary(&self, took: Duration) {
        let view = self.engine.view();
        let touch = &view.touch;
        for state in touch.touches.iter() {
            if let TouchOutcome::Missed(why) = &state.outcome {
                println!(
                    "missed {} at ({:.0}, {:.0}): {why}",
                    state.number, state.target.u_px, state.target.v_px
                );
            }
        }
        let length = |error: [f64; 2]| error[0].hypot(error[1]) * 1e3;
        let touched = touch.touches.iter().filter(|state| state.outcome == TouchOutcome::Touched);
        let mut errors: Vec<f64> = touched.clone().filter_map(|state| state.error_m.map(length)).collect();
        errors.sort_by(f64::total_cmp);
        let of_rank =
            |rank: f64| errors.get((rank * errors.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        let outside = touched.filter(|state| !state.inside).count();
        println!("counts: {:?}, {outside} outside the border of the model", touch.counts);
        if let Some(figures) = &touch.figures {
            let [low, high] = figures.mean_interval_m.map(|m| m * 1e3);
            println!(
                "{} touches: mean {:.2} mm (95 % {low:.2} to {high:.2}), median {:.2}, 95 of 100 below {:.2}, largest {:.2}; bias {:.2} {:.2} mm; repeats {} differ by {:.2} mm",
                figures.count,
                figures.mean_m * 1e3,
                of_rank(0.5),
                of_rank(0.95),
                figures.largest_m * 1e3,
                figures.bias_m[0] * 1e3,
                figures.bias_m[1] * 1e3,
                figures.repeats,
                figures.noise_m.unwrap_or(f64::NAN) * 1e3
            );
        }
        let per_touch_s = took.as_secs_f64() / touch.counts.touched.max(1) as f64;
        println!("{took:.0?}, {per_touch_s:.2} s per touch; session {:?}", touch.session);
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.alive.store(false, Ordering::Relaxed);
        if let Some(heart) = self.heart.take() {
            let _ = heart.join();
        }
    }
}
