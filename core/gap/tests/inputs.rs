//! What the session format lets poses say: instruments with a figure of their own, frames that sessions share,
//! markers that were mounted anew, several markers at once, orientations, encoders on either side of the gear. Made
//! up by the model itself and read from files, so that what was hidden has to be found again.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

mod common;

use std::fmt::Write as _;
use std::path::Path;

use common::{JOINTS, normal, present, rig};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_effects::{Assumed, Measurements, Present};
use plumbline_gap::finding::{FloorSource, NamedEffect};
use plumbline_gap::{Finding, GapError, Options, Verdict, find};
use plumbline_model::{Session, Unattended};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// Noise of the made-up instrument, m and rad.
const NOISE_M: f64 = 3e-4;
const NOISE_RAD: f64 = 1e-3;

/// A session of poses.
#[derive(Clone)]
struct Plan {
    /// Keys under `[chain]`, and sections after it.
    chain: &'static str,
    sections: &'static str,
    rows: usize,
    oriented: bool,
    sigma: Option<f64>,
    /// Frames of the robot that are measured in turn at every pose; empty: the chain's tip.
    tips: Vec<&'static str>,
    external_from_robot: Isometry3<f64>,
    tip_from_marker: Isometry3<f64>,
    /// What encoders read beside the command, rad; no encoders without it.
    lag_rad: Option<fn(usize, f64) -> f64>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            chain: "",
            sections: "",
            rows: 50,
            oriented: false,
            sigma: None,
            tips: vec![],
            external_from_robot: Isometry3::new(Vector3::new(1.2, -0.7, 0.9), Vector3::new(0.4, -1.1, 2.0)),
            tip_from_marker: Isometry3::identity(),
            lag_rad: None,
        }
    }
}

/// Commands, last directions, and what was measured of each.
struct Rows {
    angles: Vec<[f64; 6]>,
    sides: Vec<f64>,
    measured: Vec<Isometry3<f64>>,
}

impl Plan {
    fn rows(&self, random: &mut StdRng) -> Rows {
        let home = [0.0, 0.3, 0.4, 1.4, 0.0, 0.0];
        let mut draw = || std::array::from_fn(|j: usize| home[j] + random.random_range(-0.6..0.6));
        let each = self.tips.len().max(1);
        let angles: Vec<[f64; 6]> =
            (0..self.rows).map(|_| draw()).flat_map(|pose| std::iter::repeat_n(pose, each)).collect();
        let sides =
            (0..angles.len()).map(|i| if (i / each).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
        Rows { measured: vec![Isometry3::identity(); angles.len()], angles, sides }
    }

    fn write(&self, folder: &Path, rows: &Rows) {
        let manifest = format!(
            "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\noperator = \"\"\nnotes = \"\"\n\
             [chain]\ntip = \"right_index_tip\"\njoints = {JOINTS:?}\n{}\n{}\n",
            self.chain, self.sections
        );
        std::fs::write(folder.join("session.toml"), manifest).expect("writable");
        let of_joints = |prefix: &str| JOINTS.map(|joint| format!("{prefix}_{joint}_rad")).join(",");
        let mut text = format!("group,approach,meas_x_m,meas_y_m,meas_z_m,{}", of_joints("cmd"));
        let more = [
            (self.oriented, "meas_qw,meas_qx,meas_qy,meas_qz".to_owned()),
            (self.sigma.is_some(), "sigma_m".to_owned()),
            (!self.tips.is_empty(), "tip".to_owned()),
            (self.lag_rad.is_some(), of_joints("enc")),
        ];
        more.iter().filter(|(is_there, _)| *is_there).for_each(|(_, columns)| text += &format!(",{columns}"));
        let each = self.tips.len().max(1);
        for (i, (angles, measured)) in rows.angles.iter().zip(&rows.measured).enumerate() {
            let at = measured.translation.vector;
            let side = if rows.sides[i] > 0.0 { "plus" } else { "minus" };
            let _ = write!(text, "\ng{},{side},{},{},{}", i / each, at.x, at.y, at.z);
            angles.iter().for_each(|angle| text += &format!(",{angle}"));
            if self.oriented {
                let turn = measured.rotation;
                let _ = write!(text, ",{},{},{},{}", turn.w, turn.i, turn.j, turn.k);
            }
            self.sigma.iter().for_each(|sigma| text += &format!(",{sigma}"));
            if !self.tips.is_empty() {
                text += &format!(",{}", self.tips[i % each]);
            }
            if let Some(lag_rad) = self.lag_rad {
                angles.iter().enumerate().for_each(|(j, angle)| {
                    text += &format!(",{}", angle + lag_rad(j, rows.sides[i]));
                });
            }
        }
        std::fs::write(folder.join("poses.csv"), text + "\n").expect("writable");
    }
}

/// Sessions as their files say, with effects hidden in what was measured.
fn made(plans: &[Plan], hidden: &[(&str, &str, &[f64])], seed: u64) -> Measurements {
    let mut random = StdRng::seed_from_u64(seed);
    let folders: Vec<_> = plans.iter().map(|_| tempfile::tempdir().expect("a temporary folder")).collect();
    let mut all: Vec<Rows> = plans.iter().map(|plan| plan.rows(&mut random)).collect();
    let read = |all: &[Rows]| {
        let sessions: Vec<(String, Session)> = plans
            .iter()
            .zip(all)
            .zip(&folders)
            .enumerate()
            .map(|(i, ((plan, rows), folder))| {
                plan.write(folder.path(), rows);
                (format!("session {}", i + 1), Session::read(folder.path()).expect("well formed"))
            })
            .collect();
        Measurements::of_sessions(&sessions, &rig()).expect("usable")
    };
    let exact = read(&all);
    let hidden: Vec<Present> =
        hidden.iter().map(|(id, site, values)| present(&exact, id, site, values)).collect();
    let truth = Assumed {
        effects: hidden,
        placements: plans.iter().map(|plan| plan.external_from_robot).collect(),
        mounts: plans.iter().map(|plan| plan.tip_from_marker).collect(),
        ..Assumed::default()
    };
    for row in &exact.rows {
        let mut at = exact.external_from_tip(row, &truth).expect("an arm");
        let mut off = |size: f64| Vector3::from_fn(|_, _| size * normal(&mut random));
        at.translation.vector += off(NOISE_M);
        at.rotation = UnitQuaternion::from_scaled_axis(off(NOISE_RAD)) * at.rotation;
        all[row.session].measured[row.row] = at;
    }
    read(&all)
}

fn looked_at(measurements: &Measurements) -> Result<Finding, GapError> {
    let found =
        find(measurements, &Options { show: false, advise: false, ..Options::default() }, &Unattended);
    if let Ok(finding) = &found {
        println!("{:?} {}", finding.verdict, finding.sentence);
    }
    found
}

fn finding(measurements: &Measurements) -> Finding {
    looked_at(measurements).expect("can be looked at")
}

fn named<'a>(finding: &'a Finding, id: &str, site: &str) -> &'a NamedEffect {
    let found = finding.effects.iter().find(|effect| effect.id == id && effect.site == site);
    found.unwrap_or_else(|| panic!("{id}@{site} was hidden: {}", finding.sentence))
}

fn holds(effect: &NamedEffect, truth: f64) {
    let found = &effect.parameters[0];
    assert!(found.low <= truth && truth <= found.high, "{truth} in {found:?}");
    assert!(found.high - found.low < truth.abs(), "{found:?} says nothing");
}

#[test]
fn sessions_of_one_frame_with_markers_mounted_anew_find_one_zero() {
    let mount = |x: f64, turn: f64| Isometry3::new(Vector3::new(x, 0.01, -x), Vector3::new(0.0, turn, 0.1));
    for oriented in [false, true] {
        let plan = Plan {
            chain: "tip_place = \"unknown\"",
            sections: "[external]\nframe = \"hall\"",
            rows: 30,
            oriented,
            ..Plan::default()
        };
        let plans = [
            Plan { tip_from_marker: mount(0.02, 0.3), ..plan.clone() },
            Plan { tip_from_marker: mount(-0.03, -0.2), ..plan },
        ];
        let finding = finding(&made(&plans, &[("joint-zero", "r_elbow_y", &[0.03])], 1));
        holds(named(&finding, "joint-zero", "r_elbow_y"), 0.03);
        let [a, b] = [0, 1].map(|session| finding.placements[session]);
        assert!((a.translation.vector - b.translation.vector).norm() < 1e-12, "one frame");
        for (plan, mount) in plans.iter().zip(&finding.mounts) {
            let off = mount.translation.vector - plan.tip_from_marker.translation.vector;
            assert!(off.norm() < 3e-3, "{off}");
            let turned_rad = mount.rotation.angle_to(&plan.tip_from_marker.rotation);
            assert!(!oriented || turned_rad < 5e-3, "{turned_rad}");
        }
    }
}

#[test]
fn sessions_without_a_label_have_a_frame_each() {
    let moved = Isometry3::new(Vector3::new(-0.4, 0.3, 0.1), Vector3::new(0.0, 0.5, 0.0));
    let plans = [Plan::default(), Plan { external_from_robot: moved, ..Plan::default() }];
    let truth: &[(&str, &str, &[f64])] = &[("joint-zero", "r_elbow_y", &[0.03])];
    let found = finding(&made(&plans, truth, 2));
    holds(named(&found, "joint-zero", "r_elbow_y"), 0.03);
    // Said to share a frame that they do not share, nothing of it is a name that is known.
    let shared = plans.map(|plan| Plan { sections: "[external]\nframe = \"hall\"", ..plan });
    match looked_at(&made(&shared, truth, 2)) {
        Ok(finding) => assert_eq!(finding.verdict, Verdict::NotInLibrary, "{}", finding.sentence),
        Err(error) => println!("{error}"),
    }
}

#[test]
fn a_frame_that_is_shared_tells_a_base_that_moved_no_frame_of_its_own() {
    // Six rows of the second session are too few for a frame and a zero of their own.
    let plan = Plan { sections: "[external]\nframe = \"hall\"", ..Plan::default() };
    let plans = [plan.clone(), Plan { rows: 6, ..plan }];
    let found = finding(&made(&plans, &[("joint-zero", "r_wrist_x", &[0.08])], 3));
    holds(named(&found, "joint-zero", "r_wrist_x"), 0.08);
}

#[test]
fn several_markers_of_one_pose_are_each_where_they_are() {
    let plan = Plan { tips: vec!["right_index_tip", "right_palm_center"], ..Plan::default() };
    let made_up = made(std::slice::from_ref(&plan), &[("joint-zero", "r_elbow_y", &[0.03])], 4);
    assert_eq!(made_up.rows.len(), 100);
    assert_eq!(made_up.rows.iter().filter(|row| row.marker == 1).count(), 50);
    holds(named(&finding(&made_up), "joint-zero", "r_elbow_y"), 0.03);
    // The finger is bent: the palm has no part in that.
    let offset: &[(&str, &str, &[f64])] = &[("tip-offset", "tip", &[0.01, 0.0, -0.006])];
    let found = finding(&made(&[plan], offset, 5));
    holds(named(&found, "tip-offset", "tip"), 0.01);
}

#[test]
fn markers_that_do_not_hang_on_the_chain_are_left_out_in_words() {
    let plan = Plan { tips: vec!["right_index_tip", "left_palm_center"], rows: 20, ..Plan::default() };
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (tip, words) in [("left_palm_center", "does not hang on the joints"), ("toe", "toe")] {
        let plan = Plan { tips: vec!["right_index_tip", tip], ..plan.clone() };
        plan.write(folder.path(), &plan.rows(&mut StdRng::seed_from_u64(6)));
        let session = Session::read(folder.path()).expect("well formed");
        let made = Measurements::of_sessions(&[("s".to_owned(), session)], &rig()).expect("the tip's rows");
        assert_eq!((made.rows.len(), made.left_out.len()), (20, 20));
        assert!(made.left_out.iter().all(|row| row.why.contains(words)), "{:?}", made.left_out[0]);
    }
}

#[test]
fn an_instrument_with_a_figure_tells_the_noise_where_nothing_was_repeated() {
    let plan = Plan { sigma: Some(NOISE_M), ..Plan::default() };
    let quiet = finding(&made(std::slice::from_ref(&plan), &[], 7));
    assert_eq!((quiet.verdict, quiet.comparison.floor_source), (Verdict::NoGap, FloorSource::Instrument));
    let floors = &quiet.comparison.kinds[0].coordinates;
    assert!(floors.iter().all(|coordinate| (coordinate.floor / NOISE_M - 1.0).abs() < 0.01));
    let found = finding(&made(std::slice::from_ref(&plan), &[("joint-zero", "r_elbow_y", &[0.02])], 8));
    holds(named(&found, "joint-zero", "r_elbow_y"), 0.02);
    // A figure in millimeters would hide any gap.
    let millimeters = Plan { sigma: Some(1e3 * NOISE_M), ..plan };
    let error = looked_at(&made(&[millimeters], &[("joint-zero", "r_elbow_y", &[0.02])], 8));
    match error {
        Err(GapError::WrongUnit { column, seems, .. }) => {
            assert_eq!((&*column, &*seems), ("sigma_m", "millimeters"))
        }
        other => panic!("a wrong unit was to be seen, not {:?}", other.map(|finding| finding.sentence)),
    }
}

#[test]
fn orientations_tell_a_wrist_that_places_do_not() {
    // The last wrist turns about an axis near the fingertip: its place hardly moves.
    let truth: &[(&str, &str, &[f64])] = &[("joint-zero", "r_wrist_z", &[0.02])];
    let width = |oriented: bool| {
        let found = finding(&made(&[Plan { oriented, ..Plan::default() }], truth, 9));
        let effect =
            found.effects.iter().find(|effect| (&*effect.id, &*effect.site) == ("joint-zero", "r_wrist_z"));
        effect.map(|effect| {
            let one = &effect.parameters[0];
            assert!(one.low <= 0.02 && 0.02 <= one.high, "{one:?}");
            one.high - one.low
        })
    };
    let (with, without) = (width(true).expect("orientations name it"), width(false));
    assert!(without.is_none_or(|without| with < without), "{with} {without:?}");
}

/// The elbow's play, rad.
const PLAY_RAD: f64 = 0.012;

#[test]
fn play_is_beside_the_reading_of_a_motor_and_inside_that_of_a_joint() {
    let play: &[(&str, &str, &[f64])] = &[("backlash", "r_elbow_y", &[PLAY_RAD])];
    // The motor stands where it was sent, and reads that but for its last digits.
    let at_motor = Plan { lag_rad: Some(|j, side| 1e-6 * side * j as f64), ..Plan::default() };
    let found = finding(&made(std::slice::from_ref(&at_motor), play, 10));
    holds(named(&found, "backlash", "r_elbow_y"), PLAY_RAD);
    // Behind the gear the reading holds the play, and what was measured agrees with it. Friction would stop the joint
    // short of its goal as well.
    let behind = Plan {
        chain: "encoders = \"joint\"",
        lag_rad: Some(|j, side| if j == 3 { -0.5 * PLAY_RAD * side } else { 1e-6 * side * j as f64 }),
        ..Plan::default()
    };
    let made_up = made(&[behind], &[], 11);
    let found = finding(&made_up);
    let lags = named(&found, "stiction", "r_elbow_y");
    let width_rad = lags.parameters[0].value;
    assert!((width_rad / PLAY_RAD - 1.0).abs() < 0.01, "{width_rad}: these readings have no noise");
    let class: Vec<&str> = lags.class.iter().map(|member| &*member.id).collect();
    assert_eq!(class, ["stiction", "backlash"]);
    assert!(lags.split_by.is_some() && found.verdict == Verdict::Class, "{}", found.sentence);
    assert!(found.warnings.iter().any(|words| words.contains("behind the gears")), "{:?}", found.warnings);
    // What the gear does changes no prediction that starts from such a reading.
    let nominal = Assumed::nominal(&made_up);
    let effects = vec![present(&made_up, "backlash", "r_elbow_y", &[PLAY_RAD])];
    let with = Assumed { effects, ..nominal.clone() };
    assert!(made_up.rows.iter().all(|row| made_up.predict(row, &with) == made_up.predict(row, &nominal)));
}

#[test]
fn a_servo_that_gives_way_shows_beside_encoders_that_are_copies() {
    let droop: &[(&str, &str, &[f64])] = &[("servo-droop", "r_shoulder_y", &[0.02])];
    let copied = Plan { lag_rad: Some(|_, _| 0.0), ..Plan::default() };
    let made_up = made(&[copied], droop, 13);
    assert!(made_up.rows.iter().all(|row| row.encoder_copies == [true; 6]));
    let found = finding(&made_up);
    assert!(found.warnings.iter().any(|words| words.contains("copies of the commands")));
    // From one side and without a weight the bracket could give way as well; an encoder would tell.
    let classes = found.effects.iter().flat_map(|effect| &effect.class);
    let has = |id: &str| classes.clone().any(|member| member.id == id && member.site == "r_shoulder_y");
    assert!(has("servo-droop"), "{}", found.sentence);
}
