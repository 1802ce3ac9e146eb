//! One thing that stands still, seen once a minute for a quarter of an hour: what is constant is told from
//! what grows, and the eyes that turn are named.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use plumbline_effects::Measurements;
use plumbline_gap::finding::{Finding, Verdict};
use plumbline_gap::{Options, find};
use plumbline_model::robot::Rig;
use plumbline_model::{Session, Unattended};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

const MANIFEST: &str =
    "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\noperator = \"\"\nnotes = \"\"\n";
/// Where the thing stands, robot frame, m.
const THING_M: [f64; 3] = [0.45, -0.12, 0.05];
/// Rigid offset of what is estimated there, m.
const CONSTANT_M: [f64; 3] = [0.009, -0.006, 0.004];

fn normal(random: &mut StdRng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// A log with estimates in the robot's frame only. `turn_rad`: of the right eye about its upright axis at a
/// time (s); `both_rad`: of both eyes about the baseline; `moved_m`: of the thing.
fn log(
    minutes: u32,
    turn_rad: impl Fn(f64) -> f64,
    both_rad: impl Fn(f64) -> f64,
    moved_m: impl Fn(f64) -> [f64; 3],
    noise_m: f64,
    seed: u64,
) -> Measurements {
    let rig = Rig::built_in("nico").expect("comes along");
    let robot_from_left = rig.robot_from_left(&rig.home());
    let cameras = &rig.eyes.cameras;
    let mut random = StdRng::seed_from_u64(seed);
    let mut text = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,t_secs\n".to_owned();
    for minute in 0..=minutes {
        let t_s = 20.0 + 60.0 * f64::from(minute);
        let moved = moved_m(t_s);
        let [x, y, z] = [0, 1, 2].map(|c| THING_M[c] + moved[c]);
        let in_left = robot_from_left.inverse() * plumbline_model::Point::new(x, y, z);
        let together = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), both_rad(t_s));
        let [x, y, z]: [f64; 3] = (together * in_left.coords.coords).into();
        let in_left = plumbline_model::Point::new(x, y, z);
        let in_right = cameras.right_from_left * in_left;
        let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::y_axis(), turn_rad(t_s));
        let left = cameras.left.project(&in_left.coords.coords).expect("in view");
        let right = cameras.right.project(&(turn.inverse() * in_right.coords.coords)).expect("in view");
        let seen = robot_from_left * cameras.triangulate(left, right).expect("in front");
        // Noise of stereo is larger along the view.
        let [ex, ey, ez] = [0, 1, 2].map(|c| {
            let noise = noise_m * if c == 0 { 2.0 } else { 1.0 } * normal(&mut random);
            seen.coords.coords[c] + CONSTANT_M[c] + noise
        });
        let [tx, ty, tz] = THING_M;
        text += &format!("{tx},{ty},{tz},{ex},{ey},{ez},{t_s}\n");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("session.toml"), MANIFEST).expect("writable");
    std::fs::write(folder.path().join("localizations.csv"), text).expect("writable");
    let session = Session::read(folder.path()).expect("well formed");
    Measurements::of_sessions(&[("a log".to_owned(), session)], &rig).expect("usable")
}

fn warm_up(end_rad: f64, constant_s: f64) -> impl Fn(f64) -> f64 {
    move |t_s| end_rad * (1.0 - (-t_s / constant_s).exp())
}

fn still(_: f64) -> [f64; 3] {
    [0.0; 3]
}

fn found(log: &Measurements) -> Finding {
    let finding = find(log, &Options::default(), &Unattended).expect("can be looked at");
    println!("{:?}: {}", finding.verdict, finding.sentence);
    finding
}

fn of_eyes_turning(finding: &Finding) -> bool {
    let turning = |effect: &plumbline_gap::finding::NamedEffect| {
        effect.class.iter().any(|member| member.id == "eye-yaw") && effect.shape.is_some()
    };
    matches!(finding.verdict, Verdict::Named | Verdict::Class) && finding.effects.iter().any(turning)
}

#[test]
fn eyes_that_turn_as_they_warm_up_are_named_with_their_time_constant() {
    for (end_rad, constant_s, seed) in [(0.009, 240.0, 1), (-0.006, 400.0, 2), (0.012, 600.0, 3)] {
        let finding = found(&log(15, warm_up(end_rad, constant_s), |_| 0.0, still, 0.5e-3, seed));
        assert!(of_eyes_turning(&finding), "{}", finding.sentence);
        let turn = finding.effects.iter().find(|effect| effect.shape.is_some()).expect("grows");
        let told = turn.parameters.iter().find(|one| one.name == "time_constant_s").expect("told");
        assert!((told.value / constant_s).ln().abs() < 0.75, "{told:?}");
        assert!(finding.sentence.contains("two thirds of it within"), "{}", finding.sentence);
        // The noise is the noise, not what grows.
        let floor = finding.shown.floor;
        assert!((0.4e-3..3.0e-3).contains(&floor), "{floor}");
        assert!(finding.shown.after < 0.5 * finding.shown.before, "{:?}", finding.shown);
        assert!(finding.warnings.iter().any(|words| words.contains("one place was watched for 15 min")));
        let next = finding.next.as_ref().expect("something is to be told apart");
        assert!(next.what.contains("watch"), "{}", next.what);
    }
}

#[test]
fn eyes_that_stay_where_they_are_have_no_gap_however_far_off_the_place_is() {
    for seed in 10..30 {
        let finding = found(&log(15, |_| 0.0, |_| 0.0, still, 0.5e-3, seed));
        assert_eq!(finding.verdict, Verdict::NoGap, "{}", finding.sentence);
        assert!(finding.effects.is_empty());
        assert!((0.3e-3..2.0e-3).contains(&finding.shown.floor), "{}", finding.shown.floor);
    }
}

#[test]
fn a_thing_that_was_moved_by_hand_is_told_and_no_eye_is_blamed() {
    for seed in 40..45 {
        let moved = |t_s: f64| if t_s > 7.0 * 60.0 { [0.012, -0.02, 0.0] } else { [0.0; 3] };
        let finding = found(&log(15, |_| 0.0, |_| 0.0, moved, 0.5e-3, seed));
        assert_eq!(finding.verdict, Verdict::NoGap, "{}", finding.sentence);
        let told = finding.warnings.iter().find(|words| words.contains("jumped by")).expect("told");
        assert!(told.contains("between 6.3 and 7.3 min") && told.contains("moved by hand"), "{told}");
    }
    // Eyes that warm up meanwhile are named all the same.
    let moved = |t_s: f64| if t_s > 7.0 * 60.0 { [0.012, -0.02, 0.0] } else { [0.0; 3] };
    let finding = found(&log(15, warm_up(0.009, 300.0), |_| 0.0, moved, 0.5e-3, 50));
    assert!(of_eyes_turning(&finding), "{}", finding.sentence);
    assert!(finding.warnings.iter().any(|words| words.contains("jumped by")), "{:?}", finding.warnings);
}

/// A centimeter is no more than what the noise does to a look or two, and a mount that turns as it warms would explain
/// most of it.
#[test]
fn a_centimeter_by_hand_in_the_noise_of_a_toy_is_no_mount_that_turns() {
    let told = (0..12_u32).filter(|seed| {
        let at_rad = 0.5 * f64::from(*seed);
        let moved = move |t_s: f64| {
            let is_after = f64::from(u8::from(t_s > 11.0 * 60.0));
            [0.01 * at_rad.cos() * is_after, 0.01 * at_rad.sin() * is_after, 0.0]
        };
        let finding = found(&log(27, |_| 0.0, |_| 0.0, moved, 2e-3, 300 + u64::from(*seed)));
        assert_eq!(finding.verdict, Verdict::NoGap, "{seed}: {}", finding.sentence);
        finding.warnings.iter().any(|words| words.contains("jumped by"))
    });
    let told = told.count();
    println!("{told} of 12 told");
    assert!(told >= 11, "{told}");
}

#[test]
fn an_eye_that_is_loose_and_wobbles_over_minutes_is_told_without_a_name() {
    for (period_s, seed) in [(260.0, 70), (400.0, 71), (600.0, 72)] {
        let wobble = move |t_s: f64| 0.004 * (std::f64::consts::TAU * t_s / period_s).sin();
        let finding = found(&log(27, wobble, |_| 0.0, still, 1e-3, seed));
        assert_eq!(finding.verdict, Verdict::NotInLibrary, "{period_s} s: {}", finding.sentence);
        let time = finding.unexplained.depends_on.iter().any(|known| known.on == "time");
        assert!(time, "{:?}", finding.unexplained);
    }
}

/// No law of the library: two times.
#[test]
fn a_course_that_is_not_quite_the_librarys_is_still_told() {
    let two = |t_s: f64| warm_up(0.006, 150.0)(t_s) + warm_up(0.004, 900.0)(t_s);
    let finding = found(&log(15, two, |_| 0.0, still, 0.3e-3, 60));
    assert!(of_eyes_turning(&finding), "{}", finding.sentence);
}

/// Both eyes turn together as well, with another time: the eyes are named, if only as a class.
#[test]
fn eyes_that_turn_together_and_against_each_other_are_named() {
    let (mut named, mut off) = (0, 0);
    for seed in 0..20 {
        let mut random = StdRng::seed_from_u64(1000 + seed);
        let turn = warm_up(random.random_range(0.004..0.012), random.random_range(150.0..700.0));
        let both = warm_up(random.random_range(-0.006..0.006), random.random_range(150.0..700.0));
        let noise_m = random.random_range(0.2e-3..1.0e-3);
        let finding = found(&log(15, turn, both, still, noise_m, seed));
        let of_eyes = matches!(finding.verdict, Verdict::Named | Verdict::Class)
            && finding.effects.iter().any(|effect| effect.shape.is_some());
        named += u32::from(of_eyes);
        off += u32::from(finding.verdict == Verdict::NotInLibrary);
    }
    println!("{named} of 20 named, {off} not in the library");
    assert!(named >= 17, "{named}");
}
