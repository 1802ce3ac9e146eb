//! All of it on a twin whose errors are hidden from it.

mod bad_inputs;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use jiff::Timestamp;
use nalgebra::{Isometry3, Matrix6, Point3, Vector6};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::What;
use plumbline_effects::robot_model::Mounted;
use plumbline_effects::{Assumed, Effect, Kind, Measurements, Present, RobotModel, Surface};
use plumbline_fit::{ArmTouches, measurements, row};
use plumbline_grasp::Hand;
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::{Cancelled, JobContext, Pixel, StereoCalibration, Unattended};

use crate::twin::TwinBody;
use crate::{Figures, HandEyeError, Part, Seen, Start, Tied, Watch, screen, tie};

const TIP: &str = "right_index_tip";
const NECK_RAD: f64 = 0.015;
/// Of both arms.
const ELBOW_RAD: f64 = 0.03;

fn scenario() -> String {
    format!(
        "format = 1\nname = \"hands\"\ntitle = \"Hands\"\nabout = \"Arms and a head that are off.\"\n\
         [joint.head_z]\nencoder_zero_rad = {NECK_RAD}\n\
         [joint.r_elbow_y]\nencoder_zero_rad = {ELBOW_RAD}\n\
         [joint.l_elbow_y]\nencoder_zero_rad = {ELBOW_RAD}\n"
    )
}

/// Touches all over the screen by an arm whose elbow is off.
fn touches(rig: &Rig) -> Measurements {
    let arm = Arm::of_rig(rig, TIP).expect("an arm");
    let zero = Effect::find(Kind::JointZero.id(), "r_elbow_y", None, Some(&arm), None).expect("known");
    let truth = Assumed {
        effects: vec![Present { effect: zero, values: vec![ELBOW_RAD] }],
        placements: vec![Isometry3::identity()],
        ..Assumed::default()
    };
    let solver = Solver::of_rig(rig, TIP).expect("a tip");
    let pixels =
        (0..24).map(|i| Pixel::new(500.0 + 220.0 * f64::from(i % 6), 150.0 + 240.0 * f64::from(i / 6)));
    let mut rows = vec![];
    for pixel in pixels {
        let target = Target::Position(Point3::from(rig.touchscreen.point_at(pixel).coords.coords).into());
        let Ok(answer) = solver.solve_from(&target, &rig.home(), &Options::default()) else { continue };
        if answer.is_reached() {
            let directions = vec![if rows.len() % 2 == 0 { 1.0 } else { -1.0 }; arm.len()];
            let mut touch = row(What::Touch, answer.best().joints.to_vec(), directions);
            (touch.row, touch.cell) = (rows.len(), rows.len());
            rows.push(touch);
        }
    }
    let mut touches = measurements(rig, arm, Some(Surface::of(&rig.touchscreen)), rows);
    for k in 0..touches.rows.len() {
        touches.rows[k].measured = touches.predict(&touches.rows[k], &truth).expect("predicted");
    }
    touches.apparatuses[0].tip = Some(TIP.to_owned());
    touches
}

fn start(rig: &Rig, mounted: bool) -> Start {
    let described = Arc::new(rig.clone());
    let sd = Vector6::new(1e-3, 1e-3, 1e-3, 5e-4, 5e-4, 5e-4);
    let covariance = Matrix6::from_diagonal(&sd.map(|sd| sd * sd));
    let mounted = mounted.then_some(Mounted { covariance, rest_sigma_rad: [1e-3; 2] });
    Start {
        model: RobotModel::nominal(described.clone()).with_mounted(mounted),
        calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
        described,
    }
}

/// What it was told.
#[derive(Default)]
struct Told {
    looks: Vec<(Part, usize, usize)>,
    saw: Vec<Seen>,
}

impl Watch for Told {
    fn looks(&mut self, part: Part, number: usize, of: usize) {
        self.looks.push((part, number, of));
    }
    fn saw(&mut self, seen: &Seen) {
        self.saw.push(seen.clone());
    }
    fn computes(&mut self, _what: &str) {}
}

fn tied(
    body: &mut dyn plumbline_grasp::Body,
    start: &Start,
    told: &mut dyn Watch,
    context: &dyn JobContext,
) -> Result<Tied, HandEyeError> {
    let measurements = touches(&start.described);
    assert!(measurements.rows.len() >= 20, "{}", measurements.rows.len());
    let arm = measurements.apparatuses[0].arm.clone().expect("an arm");
    let touched_screen = Some(&start.described.touchscreen);
    let touches = ArmTouches { measurements: &measurements, arm: &arm, tip: TIP, touched_screen };
    tie(body, start, &touches, Timestamp::UNIX_EPOCH, told, context)
}

#[test]
fn both_hands_meet_what_the_eyes_see_and_the_neck_is_told() {
    let rig = Rig::built_in("nico").expect("valid");
    let (mut body, start, mut told) = (TwinBody::new(&rig, &scenario()), start(&rig, true), Told::default());
    let tied = tied(&mut body, &start, &mut told, &Unattended).expect("everything is in sight");
    let neck = tied.model.effects().iter().find(|effect| effect.id == Kind::HeadJoint.id());
    let neck = neck.expect("the neck is told");
    let sd_rad = neck.covariance[0].sqrt();
    assert!((neck.values[0] - NECK_RAD).abs() < 3.0 * sd_rad && sd_rad < 0.004, "{neck:?}");
    let shrinks = |figures: &Figures| {
        let (before_m, after_m) = (figures.before_m.expect("found"), figures.after_m.expect("found"));
        assert!(figures.found >= 10, "{figures:?}");
        assert!(after_m < 0.0035 && before_m > 2.0 * after_m, "{before_m} {after_m}");
    };
    assert_eq!(tied.touched.0, Hand::Right);
    shrinks(&tied.touched.1);
    let (hand, other) = tied.other.expect("a left arm");
    assert_eq!(hand, Hand::Left);
    shrinks(other.figures().expect("found"));
    // It was told all along, part by part.
    assert_eq!(told.saw.len(), 5, "{:?}", told.saw);
    assert!(told.looks.iter().all(|(_, number, of)| number < of), "{:?}", told.looks);
    // Arms and head are at home again.
    use plumbline_grasp::Body as _;
    let stands = body.commanded().expect("known");
    let arms = rig.arms.iter().flat_map(|arm| arm.joints.clone());
    let joints: Vec<_> = arms.chain([rig.eyes.pan, rig.eyes.tilt]).collect();
    for (stands, home) in stands.of(&joints).iter().zip(rig.home().of(&joints)) {
        assert!((stands - home).abs() < 0.06, "{stands} {home}");
    }
}

#[test]
fn without_a_mount_nothing_moves() {
    let rig = Rig::built_in("nico").expect("valid");
    let (mut body, start, mut told) = (TwinBody::new(&rig, &scenario()), start(&rig, false), Told::default());
    let error = tied(&mut body, &start, &mut told, &Unattended).expect_err("no mount");
    assert!(matches!(error, HandEyeError::NoMount), "{error}");
    assert!(told.looks.is_empty());
}

/// Cancelled after so many questions.
struct After(AtomicUsize);

impl JobContext for After {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        left.map(drop).map_err(|_| Cancelled)
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}

#[test]
fn cancelled_on_the_way_it_ends_there() {
    let rig = Rig::built_in("nico").expect("valid");
    let (mut body, start, mut told) = (TwinBody::new(&rig, &scenario()), start(&rig, true), Told::default());
    let error = tied(&mut body, &start, &mut told, &After(AtomicUsize::new(2))).expect_err("cancelled");
    assert!(matches!(error, HandEyeError::Cancelled(_)), "{error}");
    assert_eq!(told.looks.len(), 2, "{:?}", told.looks);
}

/// The screen of a robot that has it this far beside (x and y, m), looked for so far beside that.
fn screen_placed_beside(
    body: &mut dyn plumbline_grasp::Body,
    rig: &Rig,
    placed_m: [f64; 2],
    beside_m: &[f64],
) -> Option<screen::SeenScreen> {
    let mut wrong = rig.clone();
    wrong.touchscreen.origin.coords.x += placed_m[0];
    wrong.touchscreen.origin.coords.y += placed_m[1];
    let placed = wrong.touchscreen.clone();
    screen::see_beside(body, &wrong, [1e-3; 2], (&placed, beside_m), &mut |_| {}, &Unattended).expect("done")
}

/// How far a screen is from where another one is, m and rad.
fn apart(found: &screen::SeenScreen, there: &screen::SeenScreen) -> (f64, f64) {
    let off = found.robot_from_screen * there.robot_from_screen.inverse();
    let middle = there.robot_from_screen.translation.vector;
    ((found.robot_from_screen.translation.vector - middle).norm(), off.rotation.angle())
}

#[test]
fn a_screen_that_was_placed_centimeters_beside_is_found_where_it_is() {
    let rig = Rig::built_in("nico").expect("valid");
    let mut body = TwinBody::new(&rig, &scenario());
    let around = [0.0, -0.03, 0.03];
    let there = screen_placed_beside(&mut body, &rig, [0.0, 0.0], &around).expect("seen");
    let mut lost = 0;
    for placed_m in [[-0.005, 0.035], [0.03, -0.03], [-0.03, -0.02]] {
        let found = screen_placed_beside(&mut body, &rig, placed_m, &around).expect("seen");
        let (off_m, off_rad) = apart(&found, &there);
        assert!(off_m < 0.001 && off_rad < 0.003, "{placed_m:?}: {off_m} {off_rad}");
        // Looked for only where it was placed, other edges are taken for it, or none.
        let only_there = screen_placed_beside(&mut body, &rig, placed_m, &[0.0]);
        lost += usize::from(only_there.is_none_or(|found| apart(&found, &there).0 > 0.005));
    }
    assert!(lost > 0, "looking around was of no use");
}
