//! The twin without a clock is watched: what its images and encoders say, and nothing else.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;
use std::time::Instant;

use image::{GrayImage, Rgb, RgbImage};
use nalgebra::Vector3;
use plumbline_drift::{
    Monitor, Mover, Reference, ReferenceKind, Sample, Verdict, Watcher, WatcherSetup, words,
};
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::measured_data::left_out;
use plumbline_model::robot::{Posture, default_rig};
use plumbline_model::{Pixel, Point};
use plumbline_twin::eyes::RenderError;
use plumbline_twin::{Lockstep, Scenario, Toy};

const EVERY_S: f64 = 3.0;
const SEED: u64 = 5;
/// An eye that was turned by half a degree is told of within this, s, and how far it turned to so much.
const NOTICED_WITHIN_S: f64 = 10.0;
const RECOVERED_TO_DEG: f64 = 0.02;
/// So far a thing is seen aside that was moved, px.
const ASIDE_PX: u32 = 4;
/// A toy that is moved by 4 cm changes more pixels of an eye than this.
const MOVED_PX: usize = 200;
const TOYS: [(Toy, [f64; 2]); 2] = [(Toy::Tomato, [0.32, 0.12]), (Toy::Banana, [0.42, -0.18])];

struct Bench {
    twin: Lockstep,
    model: Arc<RobotModel>,
    watcher: Watcher,
    monitor: Monitor,
    busy_s: f64,
    looks: usize,
    /// Name of a reference that a gray sheet lies on.
    covered: Option<&'static str>,
    /// Name of a reference that is seen [`ASIDE_PX`] to the right of where it was, by both eyes.
    aside: Option<&'static str>,
}

impl Bench {
    /// `None`: nothing can be drawn on this machine.
    fn new(scenario: &Scenario) -> Option<Self> {
        let rig = default_rig();
        let mut twin = Lockstep::new(rig.clone(), scenario, SEED).expect("a world");
        for toy in Toy::ALL {
            twin.remove_toy(toy);
        }
        for (toy, [x_m, y_m]) in TOYS {
            twin.place_toy(toy, x_m, y_m).expect("on the table");
        }
        twin.wait(1.0);
        match twin.look() {
            Ok(_) => {}
            Err(RenderError::NoAdapter) => {
                left_out("no Vulkan device on this machine");
                return None;
            }
            Err(error) => panic!("{error}"),
        }
        let model = Arc::new(RobotModel::nominal(rig));
        Some(Self {
            twin,
            model,
            watcher: Watcher::default(),
            monitor: Monitor::default(),
            busy_s: 0.0,
            looks: 0,
            covered: None,
            aside: None,
        })
    }

    fn setup(&self) -> WatcherSetup {
        let posture = self.twin.encoders();
        let references = references(&self.model, &posture);
        let eyes_on_s = Some(self.twin.eyes_on_s());
        WatcherSetup { model: self.model.clone(), posture, eyes_on_s, references }
    }

    fn look(&mut self) {
        let pair = self.twin.look().expect("drawn before");
        let gray = |image| -> GrayImage { image::imageops::grayscale(image) };
        let (mut left, mut right) = (gray(&pair.left), gray(&pair.right));
        let setup = self.setup();
        let under = setup.references.iter().find(|reference| Some(reference.name.as_str()) == self.covered);
        if let Some(under) = under {
            [&mut left, &mut right].into_iter().zip(&under.outlines).for_each(|(image, at)| cover(image, at));
        }
        let aside = setup.references.iter().find(|reference| Some(reference.name.as_str()) == self.aside);
        if let Some(aside) = aside {
            [&mut left, &mut right].into_iter().zip(&aside.outlines).for_each(|(image, at)| shift(image, at));
        }
        let began = Instant::now();
        let look = self.watcher.look(&setup, (&left, &right)).expect("enough to see");
        self.busy_s += began.elapsed().as_secs_f64();
        self.looks += 1;
        self.monitor.add(Sample { at_s: self.twin.eyes_on_s(), look });
    }

    fn watch(&mut self, looks: usize) {
        for _ in 0..looks {
            self.twin.wait(0.02);
            self.twin.advance_warm_up(EVERY_S - 0.02);
            self.look();
        }
    }

    fn newest(&self) -> &Sample {
        self.monitor.samples().last().expect("looked")
    }
}

/// In how many pixels two images differ by more than noise.
fn changed_px(a: &RgbImage, b: &RgbImage) -> usize {
    let differs = |(a, b): (&Rgb<u8>, &Rgb<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 40);
    a.pixels().zip(b.pixels()).filter(|pixels| differs(*pixels)).count()
}

/// A gray sheet over what lies in an outline, and a little more.
fn cover(image: &mut GrayImage, outline: &[Pixel<plumbline_model::Raw>]) {
    for (u, v, pixel) in image.enumerate_pixels_mut() {
        if is_around(outline, [u, v]) {
            pixel.0 = [128];
        }
    }
}

/// What lies in an outline, and a little more, is seen farther to the right.
fn shift(image: &mut GrayImage, outline: &[Pixel<plumbline_model::Raw>]) {
    let before = image.clone();
    for (u, v, pixel) in image.enumerate_pixels_mut() {
        let from_px = u.saturating_sub(ASIDE_PX);
        if is_around(outline, [from_px, v]) {
            *pixel = *before.get_pixel(from_px, v);
        }
    }
}

/// Whether a pixel lies in an upright rectangle around an outline.
fn is_around(outline: &[Pixel<plumbline_model::Raw>], [u, v]: [u32; 2]) -> bool {
    const BORDER_PX: f64 = 6.0;
    let holds = |of: fn(&Pixel<plumbline_model::Raw>) -> f64, px: u32| {
        let all = outline.iter().map(of);
        let [low, high] =
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], px| [low.min(px), high.max(px)]);
        (low - BORDER_PX..high + BORDER_PX).contains(&f64::from(px))
    };
    holds(|px| px.u_px, u) && holds(|px| px.v_px, v)
}

/// The touchscreen by the rig, and the toys where they were put, as a detector would find them.
fn references(model: &RobotModel, posture: &Posture) -> Vec<Reference> {
    let around = |name: &str, kind, place: Point<_>, corners: Vec<Point<_>>| {
        let seen = |corner: &Point<_>| model.project(corner, posture, &SeenUnder::default());
        let pairs: Option<Vec<_>> = corners.iter().map(seen).collect();
        let (left, right): (Vec<Pixel<_>>, Vec<Pixel<_>>) = pairs?.into_iter().unzip();
        Some(Reference { name: name.to_owned(), kind, place, outlines: [left, right] })
    };
    let toy = |(toy, [x_m, y_m]): (Toy, [f64; 2])| {
        let z_m = model.rig().table.height_m + 0.03;
        let corner = |[dy, dz]: [f64; 2]| Point::new(x_m, y_m + dy, z_m + dz);
        let corners = [[0.04, -0.04], [0.04, 0.04], [-0.04, 0.04], [-0.04, -0.04]].map(corner).to_vec();
        around(&format!("{toy:?}"), ReferenceKind::Thing, Point::new(x_m, y_m, z_m), corners)
    };
    let screen = &model.rig().touchscreen;
    let corners = screen.corners().to_vec();
    let middle = screen.point_at(screen.middle());
    let screen = around("Touchscreen", ReferenceKind::Screen, middle, corners);
    TOYS.into_iter().filter_map(toy).chain(screen).collect()
}

fn warm(scenario: &Scenario) -> Option<Bench> {
    let mut bench = Bench::new(scenario)?;
    bench.twin.advance_warm_up(3600.0);
    Some(bench)
}

/// The laboratory with its right eye turned in its mount.
fn with_right_eye(turn_rad: [f64; 3]) -> Scenario {
    let [x, y, z] = turn_rad;
    let text = format!(
        "format = 1\nname = \"knocked\"\ntitle = \"Knocked\"\nabout = \"An eye was knocked against.\"\n[eyes]\nright_rotation_rad = [{x}, {y}, {z}]\n"
    );
    Scenario::from_toml("knocked.toml", &text).expect("a scenario")
}

#[test]
fn an_eye_that_is_knocked_is_noticed_and_named() {
    let Some(mut bench) = warm(&with_right_eye([0.0; 3])) else { return };
    bench.watch(20);
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
    let half = bench.monitor.band().expect("learned").half_m;
    println!(
        "band {:.2?} mm, {:.0} ms a look",
        half.map(|m| m * 1e3),
        1e3 * bench.busy_s / bench.looks as f64
    );
    for turn_deg in [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0]] {
        let turn_rad = turn_deg.map(f64::to_radians);
        let mut knocked = warm(&with_right_eye(turn_rad)).expect("drawn before");
        // The same robot a moment later.
        knocked.twin.advance_warm_up(bench.twin.eyes_on_s() - knocked.twin.eyes_on_s());
        std::mem::swap(&mut bench.twin, &mut knocked.twin);
        let knocked_s = bench.twin.eyes_on_s();
        let alarm = loop {
            bench.watch(1);
            let after_s = bench.twin.eyes_on_s() - knocked_s;
            if let Verdict::Moved(alarm) = bench.monitor.verdict() {
                println!("{turn_deg:?}: told after {after_s:.1} s");
                break alarm;
            }
            let seen = bench.newest().look.turns_rad;
            assert!(after_s + EVERY_S <= NOTICED_WITHIN_S, "{turn_deg:?} is not noticed in time: {seen:?}");
        };
        assert_eq!(alarm.what, Mover::RightEye, "{turn_deg:?}");
        let expected_rad = Vector3::from(turn_rad);
        let found_rad = bench.newest().look.turns_rad[1];
        // What was seen turns the other way round than what sees it.
        let off_deg = (found_rad + expected_rad).norm().min((found_rad - expected_rad).norm()).to_degrees();
        println!("{turn_deg:?}: {off_deg:.4}° off; {}", words::alarm(&alarm));
        assert!(off_deg <= RECOVERED_TO_DEG, "{turn_deg:?}: {found_rad:?} is {off_deg}° off");
        std::mem::swap(&mut bench.twin, &mut knocked.twin);
        bench.watch(4);
        assert!(
            matches!(bench.monitor.verdict(), Verdict::Steady { .. }),
            "put back: {:?}",
            bench.monitor.verdict()
        );
    }
    assert_eq!(bench.monitor.alarms().len(), 2);
}

#[test]
fn the_laboratory_warms_up_and_that_is_said() {
    let Some(mut bench) = Bench::new(&Scenario::built_in("lab").expect("a scenario")) else { return };
    bench.watch(20);
    let mut warming = 0;
    while bench.twin.eyes_on_s() < 720.0 {
        bench.twin.advance_warm_up(12.0);
        bench.watch(1);
        warming += usize::from(matches!(bench.monitor.verdict(), Verdict::Warming { .. }));
    }
    let off_m = bench.monitor.off_m(bench.newest());
    println!("after 12 min: {:.1?} mm; {}", off_m.map(|m| m * 1e3), words::verdict(&bench.monitor.verdict()));
    assert!(warming > 20, "{warming} looks");
    assert_eq!(bench.monitor.alarms(), &[], "nobody knocked against them");
    assert!((0.02..0.08).contains(&off_m[2]), "as much as the paper lost: {off_m:?}");
    let turns_deg = bench.newest().look.turns_rad.map(|turn| turn.y.to_degrees());
    assert!(turns_deg[0] * turns_deg[1] < 0.0, "each eye its own way: {turns_deg:?}");
}

#[test]
fn toys_that_are_moved_and_an_arm_that_moves_are_no_fault_of_the_eyes() {
    let Some(mut bench) = warm(&with_right_eye([0.0; 3])) else { return };
    bench.watch(18);
    let before = bench.twin.look().expect("drawn before");
    bench.twin.place_toy(Toy::Tomato, 0.30, 0.16).expect("on the table");
    bench.twin.wait(0.5);
    let after = bench.twin.look().expect("drawn before");
    let [in_left, in_right] =
        [(&before.left, &after.left), (&before.right, &after.right)].map(|(a, b)| changed_px(a, b));
    assert!(in_left > MOVED_PX && in_right > MOVED_PX, "the eyes see it move: {in_left} and {in_right} px");
    bench.watch(3);
    // A smooth toy may have too few corners to be a reference, so that it moved need not be told; the eyes stand
    // still, and so does all else.
    let moved = bench.monitor.own_motions();
    moved.iter().for_each(|motion| println!("{}", words::own_motion(motion)));
    let others: Vec<&str> =
        moved.iter().map(|motion| motion.name.as_str()).filter(|name| *name != "Tomato").collect();
    assert_eq!(others, [""; 0], "only the tomato was moved");
    assert_eq!(bench.monitor.alarms(), &[], "a toy that is moved turns no eye");
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
    let rig = bench.twin.rig().clone();
    let arm = &rig.arms[0].joints;
    for k in 0..20 {
        let posture = rig.home().with(arm, &[0.1 * f64::from(k % 5), 0.3, 0.2 + 0.1 * f64::from(k % 3)]);
        bench.twin.follow(&[posture], 1.0);
        bench.watch(2);
    }
    assert_eq!(bench.monitor.alarms(), &[]);
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
}

#[test]
fn a_reference_that_was_moved_is_told_with_how_far_and_turns_no_eye() {
    let Some(mut bench) = warm(&with_right_eye([0.0; 3])) else { return };
    bench.watch(18);
    bench.aside = Some("Touchscreen");
    let setup = bench.setup();
    let screen = setup.references.iter().find(|reference| reference.name == "Touchscreen");
    let place = screen.expect("it is on the table").place;
    let (left, right) = bench.model.project(&place, &setup.posture, &SeenUnder::default()).expect("seen");
    let cameras = &bench.model.rig().eyes.cameras;
    let seen = |by_px: f64| {
        let [left, right] = [left, right].map(|at| Pixel::new(at.u_px + by_px, at.v_px));
        cameras.triangulate(left, right).expect("before the eyes")
    };
    let by_m = seen(f64::from(ASIDE_PX)).distance_m(&seen(0.0));
    bench.watch(2);
    let own = bench.monitor.own_motions();
    println!("{:.1} mm: {:?}", by_m * 1e3, own.iter().map(words::own_motion).collect::<Vec<_>>());
    let told = own.iter().find(|motion| motion.name == "Touchscreen").expect("it is told");
    let told_m = told.by_m.expect("it is still seen").norm();
    assert!((told_m - by_m).abs() < 0.25 * by_m, "{told_m} m, and it was {by_m} m");
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
    assert_eq!(bench.monitor.alarms(), &[]);
}

#[test]
fn a_reference_that_is_covered_is_told_as_such_and_turns_no_eye() {
    let Some(mut bench) = warm(&with_right_eye([0.0; 3])) else { return };
    bench.watch(18);
    let lost = |bench: &Bench| {
        let seen = &bench.newest().look.references;
        seen.iter().filter(|seen| seen.is_lost).map(|seen| seen.name.clone()).collect::<Vec<_>>()
    };
    let known: Vec<String> = bench.newest().look.references.iter().map(|seen| seen.name.clone()).collect();
    assert!(known.iter().any(|name| name == "Touchscreen") && lost(&bench).is_empty(), "{known:?}");
    bench.covered = Some("Touchscreen");
    bench.watch(2);
    assert_eq!(lost(&bench), ["Touchscreen"]);
    let own = bench.monitor.own_motions();
    let told: Vec<String> = own.iter().map(words::own_motion).collect();
    println!("{told:?}");
    assert!(
        told.iter().any(|told| told.starts_with("Touchscreen: gone or covered since minute")),
        "{told:?}"
    );
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
    bench.watch(4);
    bench.covered = None;
    bench.watch(6);
    assert!(lost(&bench).is_empty(), "it is remembered anew: {:?}", lost(&bench));
    assert!(matches!(bench.monitor.verdict(), Verdict::Steady { .. }), "{:?}", bench.monitor.verdict());
    assert_eq!(bench.monitor.alarms(), &[]);
}

/// Hours, and time between motions, s: it looks right before each, and twice right after it, as often as the window
/// does, for only what changes between such looks can be taken for a knock.
const HOURS: f64 = 8.0;
const BETWEEN_S: f64 = 240.0;
/// Looks that are no farther apart than this show a sudden change, s.
const SUDDEN_S: f64 = 30.0;

#[test]
fn in_eight_hours_of_an_arm_and_toys_that_move_there_is_at_most_one_alarm() {
    let Some(mut bench) = warm(&with_right_eye([0.0; 3])) else { return };
    bench.watch(18);
    let rig = bench.twin.rig().clone();
    let arm = &rig.arms[0].joints;
    let motions = (HOURS * 3600.0 / BETWEEN_S) as usize;
    let mut worst_m = [0.0_f64; 3];
    for k in 0..motions {
        bench.twin.advance_warm_up(BETWEEN_S - 3.0 * EVERY_S);
        bench.look();
        let share = |step: usize| (k * step % 17) as f64 / 17.0;
        let posture = rig.home().with(arm, &[0.5 * share(3), 0.3 * share(5), 0.2 + 0.4 * share(7)]);
        bench.twin.follow(&[posture], 1.5);
        if k % 10 == 0 {
            let (toy, [x_m, y_m]) = TOYS[k / 10 % 2];
            let put = bench.twin.place_toy(toy, x_m + 0.05 * share(11), y_m + 0.04 * share(13));
            put.expect("on the table");
        }
        bench.watch(2);
        let off_m = bench.monitor.off_m(bench.newest());
        worst_m = [0, 1, 2].map(|row: usize| worst_m[row].max(off_m[row]));
    }
    let told = bench.monitor.alarms();
    let soon = |three: &&[Sample]| three.windows(2).all(|two| two[1].at_s - two[0].at_s <= SUDDEN_S);
    let sudden = bench.monitor.samples().windows(3).filter(soon).count();
    assert!(sudden >= motions, "only {sudden} times a sudden change could have shown");
    println!(
        "{motions} motions in {HOURS} h: at most {:.1?} mm off, band {:.1?} mm, {} alarms, {:.0} ms a look",
        worst_m.map(|m| m * 1e3),
        bench.monitor.band().expect("learned").half_m.map(|m| m * 1e3),
        told.len(),
        1e3 * bench.busy_s / bench.looks as f64
    );
    assert!(told.len() <= 1, "{told:?}");
}
