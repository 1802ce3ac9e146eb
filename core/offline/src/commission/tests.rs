//! A whole commissioning, one that is interrupted, and scenarios that were drawn.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use plumbline_model::{Cancelled, JobContext, Unattended};
use plumbline_twin::{Scenario, Toy};

use super::*;

fn drawn_file(seed: u64) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/scenarios/drawn-{seed}.toml"))
}

/// What was measured with these files is of the robots that are drawn by their names today.
#[test]
fn robots_that_are_drawn_by_name_are_those_on_disk() {
    for seed in [1, 2] {
        let kept = files::read_text(&drawn_file(seed), Size::SHORT).expect("in the checkout");
        assert_eq!(plumbline_twin::scenario::drawn::named(&format!("drawn-{seed}")), Some(kept));
    }
}

#[test]
fn a_scenario_is_found_by_name_and_in_a_file() {
    assert_eq!(scenario("perfect").expect("known").name, "perfect");
    let file = drawn_file(1);
    assert_eq!(scenario(&file.display().to_string()).expect("a file").name, "drawn-1");
    let error = scenario("moon").expect_err("neither").to_string();
    assert!(error.contains("moon") && error.contains("lab"), "{error}");
}

/// Ends the work before a step begins, as a kill there would.
struct Until<'a> {
    folder: &'a Path,
    steps: usize,
}

impl JobContext for Until<'_> {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        let scenario = Scenario::built_in("perfect").expect("known");
        let done = Steps::read(self.folder, &scenario, 1).map_or(0, |steps| steps.done.len());
        if done >= self.steps { Err(Cancelled) } else { Ok(()) }
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}

/// Counts what the work says that it does.
#[derive(Default)]
struct Told(Mutex<Vec<String>>);

impl JobContext for Told {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        Ok(())
    }
    fn report(&self, _fraction: f64, doing: &str) {
        self.0.lock().expect("not poisoned").push(doing.to_owned());
    }
}

/// The touches and the eyes, interrupted in between: the file of steps says what is
/// done, what is done is not done again, and another twin is refused the folder.
#[test]
fn a_work_that_was_ended_between_two_steps_goes_on_after_the_first() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let args = |seed| CommissionArgs { twin: "perfect".into(), seed, out: folder.path().to_owned() };
    let ended = commission(&args(1), &Until { folder: folder.path(), steps: 1 });
    assert!(matches!(ended, Err(OfflineError::Cancelled(_))), "{ended:?}");
    let scenario = Scenario::built_in("perfect").expect("known");
    let first = Steps::read(folder.path(), &scenario, 1).expect("kept");
    assert_eq!(first.done.iter().map(|step| step.name.as_str()).collect::<Vec<_>>(), ["touches"]);
    assert!(first.done[0].touches >= 20 && first.done[0].touches <= 25, "{:?}", first.done[0]);
    assert!(first.done[0].minutes < 12.0, "{:?}", first.done[0]);

    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let lab = Lab { folder: folder.path().to_owned(), rig, scenario, seed: 1 };
    let told = Told::default();
    let eyes = one(&lab, "eyes", &first, &mut None, &told).expect("calibrated");
    assert!(told.0.lock().expect("not poisoned").iter().all(|doing| !doing.contains("touching")));
    assert!(eyes.board_views == 20 && eyes.after_mm.expect("judged") < 1.5, "{eyes:?}");
    // The eyes were on while the finger touched.
    assert!((first.done[0].minutes + eyes.minutes) > 20.0, "{eyes:?}");
    let mut steps = first.clone();
    steps.add(&lab.folder, eyes).expect("kept");
    assert_eq!(Steps::read(&lab.folder, &lab.scenario, 1).expect("kept"), steps);
    assert!(lab.calibration().is_ok());

    let other = commission(&args(2), &Unattended).expect_err("another twin's folder");
    assert!(other.to_string().contains("seed 1") && other.to_string().contains("--out"), "{other}");
}

/// The whole way on the twin that is as described. Takes minutes:
/// `cargo test --release -p plumbline-offline --  --ignored a_perfect_twin`.
#[test]
#[ignore = "takes minutes"]
fn a_perfect_twin_is_commissioned_within_its_targets() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let args = CommissionArgs { twin: "perfect".into(), seed: 1, out: folder.path().to_owned() };
    let report = commission(&args, &Unattended).expect("commissioned");
    assert!(report.robot_minutes <= 30.0, "{report:#?}");
    assert!(report.touches <= 25 && report.board_views <= 20, "{report:#?}");
    assert!(report.place_error_mm.median.expect("judged") <= 3.0, "{report:#?}");
    assert!(report.place_error_mm.p95.expect("judged") <= 8.0, "{report:#?}");
    assert!(report.touch_error_mm.inside.expect("judged") <= 3.0, "{report:#?}");
}

/// How a toy (`PLUMBLINE_TOY`, else the tomato) is found on the 36 places in the lab commissioned in `PLUMBLINE_LAB`
/// (of the twin `PLUMBLINE_TWIN`), and how well what is stated fits.
#[test]
#[ignore = "a minute; figures for who works on places"]
fn places_in_a_lab() {
    let folder = PathBuf::from(std::env::var("PLUMBLINE_LAB").expect("PLUMBLINE_LAB is a commissioned lab"));
    let twin = std::env::var("PLUMBLINE_TWIN").unwrap_or_else(|_| "lab".to_owned());
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let lab = Lab { folder, rig, scenario: scenario(&twin).expect("a twin"), seed: 1 };
    let steps = Steps::read(&lab.folder, &lab.scenario, lab.seed).expect("commissioned");
    let mut robot = Robot::new(&lab, steps.elapsed_s(), None).expect("a twin");
    let class = std::env::var("PLUMBLINE_TOY").unwrap_or_else(|_| "tomato".to_owned());
    let toy = Toy::from_name(&class).expect("a toy");
    let (error, _) = judge::places(toy, &lab, &mut robot, &Unattended).expect("judged");
    println!("{}", serde_json::to_string(&error).expect("text"));
}
