//! What goes wrong while it grasps: the arm holds, the record says how far it came, the next one works.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use plumbline_grasp::{Failure, HandChoice, Record, Step};
use plumbline_twin::Toy;

use super::bench::{Bench, tracks_in, words};
use crate::command::{GraspCommand, HandStep, RobotCommand, TwinCommand};
use crate::view::{GateState, GraspOutcome, GraspStep, MotionState, Need};

const EASY_M: [f64; 2] = [0.32, -0.15];
/// Hot enough that it is too hot soon, °C.
const NEARLY_HOT_C: f64 = 66.0;
/// Where the child below works.
const FOLDER: &str = "PLUMBLINE_TEST_GRASP_FOLDER";
/// A child on a busy machine has come to its step after this long.
const PATIENCE: Duration = Duration::from_secs(150);

#[test]
fn a_servo_that_gets_too_hot_ends_it_and_the_next_one_waits_until_it_is_cool() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    // Left the choice, the other hand would grasp.
    bench.send(GraspCommand::Arm(HandChoice::Right));
    bench.send(TwinCommand::Fault { name: "hot-servo".to_owned(), on: true });
    let hottest = |view: &crate::view::View| {
        view.robot.joints.iter().filter_map(|joint| joint.temperature_c).fold(0.0, f64::max)
    };
    let view = bench.until("a hot servo", |view| hottest(view) >= NEARLY_HOT_C);
    let gate = view.grasp.gates.iter().find(|gate| gate.of == Need::Arm).expect("it is looked at");
    assert_eq!(gate.state, GateState::Doubtful, "{gate:?}");
    assert!(gate.text.contains("gets warm"), "{gate:?}");
    let run = bench.grasp();
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("hot"))
            || matches!(&run.outcome, Some(GraspOutcome::Refused { why }) if why.contains("cool down")),
        "{}",
        words(run.outcome.as_ref())
    );
    let view = bench.until("it holds", |view| matches!(view.robot.motion, MotionState::Holding { .. }));
    let gate = view.grasp.gates.iter().find(|gate| gate.of == Need::Arm).expect("it is looked at");
    assert_eq!(gate.state, GateState::Shut, "{gate:?}");
    assert!(gate.text.contains("let it cool down"), "{gate:?}");
    bench.send(TwinCommand::Fault { name: "hot-servo".to_owned(), on: false });
    bench.send(TwinCommand::Reset);
    bench.until("a cool servo", |view| hottest(view) < 50.0 && view.grasp.trouble().is_none());
    // Everything else went back to its place with it.
    Toy::ALL.into_iter().filter(|toy| *toy != Toy::Tomato).for_each(|toy| bench.remove(toy));
    bench.place(Toy::Tomato, EASY_M);
    bench.settle();
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

/// Run as a process of its own by the test below; does nothing otherwise.
#[test]
fn child_that_grasps_until_it_is_killed() {
    let Ok(folder) = std::env::var(FOLDER) else { return };
    let Some(bench) = Bench::start_at(Path::new(&folder), "perfect", Toy::Tomato, EASY_M) else { return };
    bench.grasp();
    // Whoever was to kill it came too late: it says so by what it kept.
}

/// The newest record of a folder, if it can be read.
fn newest(folder: &Path) -> Option<(String, Record)> {
    let grasps = std::fs::read_dir(folder.join("twin/grasps")).ok()?;
    let newest = grasps.flatten().map(|entry| entry.path()).max()?;
    let text = std::fs::read_to_string(newest.join("record.json")).ok()?;
    Some((newest.file_name()?.to_string_lossy().into_owned(), serde_json::from_str(&text).ok()?))
}

fn has_reached(step: Option<Step>, wanted: Step) -> bool {
    let order = |step: Step| Step::ALL.iter().position(|known| *known == step);
    step.is_some_and(|step| order(step) >= order(wanted))
}

fn begin_child(folder: &Path) -> Child {
    Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "grasp::tests::bad::child_that_grasps_until_it_is_killed"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts")
}

#[test]
fn killed_in_any_step_the_record_says_how_far_it_came_and_the_next_grasp_works() {
    if Bench::start("perfect", Toy::Tomato, EASY_M).is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut names = vec![];
    for step in [Step::Approach, Step::Align, Step::Lower, Step::Close, Step::Lift, Step::Check] {
        let mut child = begin_child(folder.path());
        let began = Instant::now();
        let (name, record) = loop {
            let kept = newest(folder.path()).filter(|(name, _)| !names.contains(name));
            if let Some((name, record)) = kept
                && (has_reached(record.step, step) || record.outcome.is_some())
            {
                break (name, record);
            }
            assert!(began.elapsed() < PATIENCE, "{step:?} did not come");
            std::thread::sleep(Duration::from_millis(5));
        };
        // As kill -9 does.
        child.kill().expect("it runs");
        child.wait().expect("it ended");
        let (_, after) = newest(folder.path()).expect("it is still there");
        println!("killed in {step:?}: {:?}, then {:?}", record.step, after.step);
        assert!(after.outcome.is_none(), "killed in {step:?}: {:?}", after.outcome);
        assert!(has_reached(after.step, step), "{:?} after {step:?}", after.step);
        // What the joints did until then is there.
        let rows = tracks_in(&folder.path().join("twin/grasps").join(&name));
        assert!(!rows.is_empty(), "killed in {step:?}");
        names.push(name);
    }
    let bench =
        Bench::start_at(folder.path(), "perfect", Toy::Tomato, EASY_M).expect("it was rendered before");
    let view = bench.until("the list", |view| view.grasp.attempts.len() == names.len());
    let said = view.notices.iter().find(|notice| notice.text.contains("The program ended while it grasped"));
    let said = said.expect("the next start says what happened").text.clone();
    assert!(said.contains("tomato (M5, ") && said.contains("press Arm home"), "{said}");
    for attempt in view.grasp.attempts.iter() {
        assert!(
            attempt.outcome.is_none() && has_reached(attempt.reached, GraspStep::Approach),
            "{attempt:?}"
        );
    }
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

/// STOP in a step: the arm holds, and a grasp under STOP moves nothing. Then the hand opens, goes home, and the
/// tomato is where it was.
fn stop_in(bench: &Bench, step: GraspStep) {
    bench.begin();
    bench.until_step(step);
    std::thread::sleep(Duration::from_millis(150));
    bench.stop();
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("STOP")),
        "{step:?}: {}",
        words(run.outcome.as_ref())
    );
    assert_eq!(bench.kept().step, Some(step), "the record says where it came to");
    // A beginning under STOP is refused, and nothing moves.
    bench.send(GraspCommand::Grasp);
    let moved_rad = bench.creeps_rad();
    println!("stopped in {step:?}: moves by {moved_rad:.4} rad after that");
    assert!(moved_rad < 0.02, "{step:?}: it moved by {moved_rad:.3} rad");
    bench.send(RobotCommand::ReleaseStop);
    bench.until("release", |view| !view.robot.stopped);
    for step in [HandStep::Open, HandStep::Home] {
        bench.hand(step);
    }
    bench.place(Toy::Tomato, EASY_M);
    bench.settle();
}

#[test]
fn stopped_while_it_lowers_or_lifts_the_arm_holds_and_the_next_grasp_comes_as_far() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    // The second one is lowered and closes where the first one was stopped.
    for step in [GraspStep::Lower, GraspStep::Lift] {
        stop_in(&bench, step);
    }
}

#[test]
#[ignore = "three minutes of a robot's time: once through every step"]
fn stopped_in_any_step_the_arm_holds_and_the_next_grasp_works() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    for step in [
        GraspStep::Approach,
        GraspStep::Align,
        GraspStep::Lower,
        GraspStep::Close,
        GraspStep::Lift,
        GraspStep::Check,
    ] {
        stop_in(&bench, step);
    }
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

#[test]
fn ended_while_fingers_close_they_stand_and_the_next_one_works() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    bench.send(GraspCommand::Grasp);
    bench.until_step(GraspStep::Close);
    std::thread::sleep(Duration::from_millis(400));
    bench.send(GraspCommand::End);
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("ended by the operator")),
        "{}",
        words(run.outcome.as_ref())
    );
    std::thread::sleep(Duration::from_millis(700));
    let stood = bench.until("angles", |view| view.robot.measured.is_some()).robot.measured.clone();
    std::thread::sleep(Duration::from_millis(700));
    let stands = bench.until("angles", |view| view.robot.measured.is_some()).robot.measured.clone();
    let (stood, stands) = (stood.expect("read"), stands.expect("read"));
    assert!(stood.distance_rad(&stands) < 0.02, "it moved by {:.3} rad", stood.distance_rad(&stands));
    // The hand is before the thing.
    for step in [HandStep::Open, HandStep::Home] {
        bench.send(GraspCommand::Hand(step));
        bench.until("it to begin", |view| view.grasp.phase.moves());
        bench.until_idle();
    }
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}
