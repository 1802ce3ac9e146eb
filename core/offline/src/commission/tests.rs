//! A whole commissioning, one that is interrupted, and scenarios that were drawn.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use plumbline_model::{Cancelled, JobContext, Unattended};
use plumbline_twin::Scenario;

use super::*;

/// Draws the errors of a robot that nobody has looked at, evenly from stated ranges.
struct Dice(u64);

impl Dice {
    /// Evenly in 0 to 1 (Steele, Lea and Flood 2014: SplitMix).
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, most: f64) -> f64 {
        most * (2.0 * self.share() - 1.0)
    }

    fn three(&mut self, most: f64) -> String {
        let [x, y, z] = [0; 3].map(|_| self.within(most));
        format!("[{x:.6}, {y:.6}, {z:.6}]")
    }
}

/// A scenario file. Ranges: encoder zeros ±0.03 rad (head ±0.015), slack to 0.008 rad, give to
/// 0.008 rad/Nm, axes ±0.01 rad, joints ±2 mm, table ±8 mm and ±0.01 rad, screen on it ±10 mm, up to 3 mm higher, ±0.02 rad and
/// ±1 %, eyes ±6 mm and ±0.03 rad, right eye ±0.01 rad, warming up ±0.3 mrad/K, fingertip ±4 mm.
fn drawn(seed: u64) -> String {
    let mut dice = Dice(seed);
    let mut text = format!(
        "format = 1\nname = \"drawn-{seed}\"\ntitle = \"Drawn {seed}\"\nabout = \"Errors drawn by chance.\"\n"
    );
    for joint in ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"] {
        text.push_str(&format!(
            "\n[joint.{joint}]\nencoder_zero_rad = {:.6}\nslack_rad = {:.6}\ncompliance_rad_per_nm = {:.6}\n\
             axis_tilt_rad = {}\norigin_shift_m = {}\n",
            dice.within(0.03),
            0.008 * dice.share(),
            0.008 * dice.share(),
            dice.three(0.01),
            dice.three(0.002),
        ));
    }
    for joint in ["head_z", "head_y"] {
        let zero_rad = dice.within(0.015);
        text.push_str(&format!("\n[joint.{joint}]\nencoder_zero_rad = {zero_rad:.6}\n"));
    }
    let (table_rad, table_m) = (dice.three(0.01), dice.three(0.008));
    text.push_str(&format!("\n[table]\nrotation_rad = {table_rad}\ntranslation_m = {table_m}\n"));
    // It lies on the table: it may be turned and shifted there, and stand a little higher, not deeper.
    let turn = format!("[0.0, 0.0, {:.6}]", dice.within(0.02));
    let shift = format!("[{:.6}, {:.6}, {:.6}]", dice.within(0.01), dice.within(0.01), 0.003 * dice.share());
    let scale = [0; 2].map(|_| 1.0 + dice.within(0.01));
    text.push_str(&format!(
        "\n[touchscreen]\nrotation_rad = {turn}\ntranslation_m = {shift}\nscale = [{:.6}, {:.6}]\n",
        scale[0], scale[1]
    ));
    let (turn, shift, right) = (dice.three(0.03), dice.three(0.006), dice.three(0.01));
    text.push_str(&format!(
        "\n[eyes]\nrotation_rad = {turn}\ntranslation_m = {shift}\nright_rotation_rad = {right}\n"
    ));
    let (left, right) = (dice.three(3e-4), dice.three(3e-4));
    text.push_str(&format!("\n[eyes.heat]\nleft_rad_per_k = {left}\nright_rad_per_k = {right}\n"));
    text.push_str(&format!("\n[fingertip.r_indexfinger]\noffset_m = {}\n", dice.three(0.004)));
    text
}

fn drawn_file(seed: u64) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/scenarios/drawn-{seed}.toml"))
}

/// `PLUMBLINE_DRAW=1 cargo test -p plumbline-offline scenarios_that_were_drawn` writes the files anew.
#[test]
fn scenarios_that_were_drawn_are_on_disk_as_they_were_drawn() {
    for seed in [1, 2] {
        let (file, text) = (drawn_file(seed), drawn(seed));
        if std::env::var_os("PLUMBLINE_DRAW").is_some() {
            plumbline_model::files::write(&file, &text).expect("writable");
        }
        let kept = files::read_text(&file, Size::SHORT).expect("in the checkout");
        assert_eq!(kept, text);
        Scenario::from_toml("drawn", &text).expect("a scenario");
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

/// How the tomato is found on the 36 places in the lab commissioned in `PLUMBLINE_LAB` (of the twin
/// `PLUMBLINE_TWIN`), and how well what is stated fits.
#[test]
#[ignore = "a minute; figures for who works on places"]
fn places_in_a_lab() {
    let folder = PathBuf::from(std::env::var("PLUMBLINE_LAB").expect("PLUMBLINE_LAB is a commissioned lab"));
    let twin = std::env::var("PLUMBLINE_TWIN").unwrap_or_else(|_| "lab".to_owned());
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let lab = Lab { folder, rig, scenario: scenario(&twin).expect("a twin"), seed: 1 };
    let steps = Steps::read(&lab.folder, &lab.scenario, lab.seed).expect("commissioned");
    let mut robot = Robot::new(&lab, steps.elapsed_s(), None).expect("a twin");
    let (error, _) = judge::places(&lab, &mut robot, &Unattended).expect("judged");
    println!("{}", serde_json::to_string(&error).expect("text"));
}
