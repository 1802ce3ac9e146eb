//! Laws of the arm and the library.

use nalgebra::Point3;
use plumbline_model::robot::Rig;
use plumbline_model::{Pixel, Point};

use crate::arm::{Arm, Deviation};
use crate::library::{Effect, Kind, Situation, Surface};

const ANGLES: [f64; 6] = [-0.2, 1.1, 0.5, 1.7, -0.3, 0.2];

fn arm() -> (Rig, Arm) {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let arm = Arm::of_rig(&rig, "right_index_tip").expect("a tip of the rig");
    (rig, arm)
}

#[test]
fn nothing_deviating_is_the_nominal_chain() {
    let (rig, arm) = arm();
    let chain = rig.chain("right_index_tip").expect("a tip of the rig");
    let nominal = chain.robot_from_tip(&ANGLES).translation_m();
    let here = arm.tip_m(&ANGLES, &Deviation::none(6));
    assert!((here.coords - nominal).norm() < 1e-12);
    assert!((arm.frames(&ANGLES).robot_from_tip.translation.vector - nominal).norm() < 1e-12);
    assert_eq!(arm.parts.iter().map(|part| part.joint.clone()).collect::<Vec<_>>(), chain.names());
}

#[test]
fn an_effect_of_size_zero_changes_nothing() {
    let (rig, arm) = arm();
    let surface = Surface::of(&rig.touchscreen);
    let situation = Situation::new(&arm, &ANGLES, &[1.0; 6], 0.25, surface.normal());
    let nominal = surface.touch_m(arm.tip_m(&ANGLES, &Deviation::none(6)), 0.0, &Deviation::none(6));
    for effect in Effect::all(&arm) {
        let count = effect.parameters().len();
        let mut deviation = Deviation::none(6);
        effect.deviate(&situation, &vec![0.0; count], &mut deviation);
        let same = surface.touch_m(arm.tip_m(&ANGLES, &deviation), 0.0, &deviation);
        assert!((same - nominal).norm() < 1e-15, "{} at {}", effect.id(), effect.site);
        // And one of usual size changes something.
        let values: Vec<f64> = effect.parameters().iter().map(|parameter| parameter.typical).collect();
        effect.deviate(&situation, &values, &mut deviation);
        let other = surface.touch_m(arm.tip_m(&ANGLES, &deviation), 0.0, &deviation);
        let upright = effect.joint_site_bears_nothing();
        assert!(upright || (other - nominal).norm() > 1e-7, "{} at {}", effect.id(), effect.site);
    }
}

impl Effect {
    /// The first joint turns about the vertical: gravity does not load it.
    fn joint_site_bears_nothing(&self) -> bool {
        let loaded = matches!(self.kind, Kind::GravityBacklash | Kind::ServoDroop | Kind::JointSag);
        loaded && self.site == "r_shoulder_z"
    }
}

#[test]
fn torques_are_the_slope_of_the_potential_energy() {
    let (_, arm) = arm();
    let energy_j = |angles: &[f64], payload_kg: f64| {
        let frames = arm.frames(angles);
        let parts = arm.parts.iter().zip(&frames.robot_from_joint);
        let own: f64 = parts.map(|(part, place)| part.mass_kg * (place * part.center_m).z).sum();
        let held = payload_kg * (frames.robot_from_joint[5] * arm.palm_m).z;
        9.80665 * (own + held)
    };
    for payload_kg in [0.0, 0.25] {
        let situation = Situation::new(&arm, &ANGLES, &[0.0; 6], payload_kg, &nalgebra::Vector3::z());
        for (j, torque_nm) in situation.torques_nm().iter().enumerate() {
            let at = |step: f64| {
                let mut angles = ANGLES;
                angles[j] += step;
                energy_j(&angles, payload_kg)
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((torque_nm + slope).abs() < 1e-8, "joint {j}: {torque_nm} against {slope}");
        }
        assert!(situation.torques_nm()[0].abs() < 1e-12, "the first axis is upright");
    }
}

#[test]
fn the_masses_of_the_arm_are_those_of_the_description() {
    let (rig, arm) = arm();
    let own: f64 = arm.parts.iter().map(|part| part.mass_kg).sum();
    let all: f64 =
        rig.description.links().iter().filter_map(|link| link.inertia).map(|inertia| inertia.mass_kg).sum();
    assert!(own > 0.2 && own < 0.5 * all, "{own} of {all} kg");
}

#[test]
fn a_touch_is_where_the_screen_says() {
    let (rig, _) = arm();
    let screen = &rig.touchscreen;
    let surface = Surface::of(screen);
    let [u_m, v_m] = screen.pitch_m();
    let (middle, pixel) = (screen.middle(), Pixel::new(1200.0, 300.0));
    let at = screen.raised(0.06).point_at(pixel);
    let touch = surface.touch_m(at.coords, 0.06, &Deviation::none(6));
    assert!((touch.x - (pixel.u_px - middle.u_px) * u_m).abs() < 1e-12);
    assert!((touch.y - (pixel.v_px - middle.v_px) * v_m).abs() < 1e-12);
    assert!(touch.z.abs() < 1e-12);
}

#[test]
fn the_gauge_is_the_motion_of_the_screen() {
    let (rig, _) = arm();
    let surface = Surface::of(&rig.touchscreen);
    let tip = Point3::new(0.4, -0.1, 0.08);
    let middle = rig.touchscreen.point_at(rig.touchscreen.middle()).coords.coords;
    let gauge = surface.gauge(tip);
    let none = Deviation::none(0);
    let axes = [rig.touchscreen.u_axis, rig.touchscreen.v_axis, rig.touchscreen.normal()];
    for (k, axis) in axes.iter().enumerate() {
        let step = 1e-6;
        let moved = tip + axis.vector() * step;
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(axis.vector() * step);
        let turned = Point3::from(middle + turn * (tip.coords - middle));
        for (column, other) in [(k, moved), (k + 3, turned)] {
            let slope = (surface.touch_m(other, 0.0, &none) - surface.touch_m(tip, 0.0, &none)) / step;
            assert!((slope - gauge.column(column)).norm() < 1e-6, "column {column}");
        }
    }
    assert!(rig.touchscreen.height_above_m(Point::from(tip)) > 0.0);
}

#[test]
fn names_are_those_of_the_command_line() {
    let known = "joint-zero joint-scale joint-eccentricity tooth-ripple backlash gravity-backlash stiction \
        servo-droop joint-sag sideways-give link-bending creep early-log torque-limit servo-warm-up slipped-horn \
        joint-coupling axis-skew link-length tip-offset finger-bend finger-roll touch-drag base-tilt torso-lean \
        payload-mass link-mass screen-bumped screen-scale screen-tilt screen-bow panel-edge camera-mount head-joint eye-yaw \
        image-shift focal-or-baseline eye-roll eye-knock lens-distortion disparity-steps background-bleed \
        foreground-fattening seen-surface box-bias eye-latency speed-overshoot";
    let known: Vec<&str> = known.split_whitespace().collect();
    assert_eq!(Kind::ALL.iter().map(|kind| kind.id()).collect::<Vec<_>>(), known);
    for kind in Kind::ALL {
        assert_eq!(Kind::of_id(kind.id()), Some(*kind));
        assert!(kind.parameters().iter().all(|parameter| parameter.typical > 0.0));
    }
}

#[test]
fn every_effect_of_the_library_has_words() {
    for kind in Kind::ALL {
        assert!(kind.meaning().ends_with('.') && kind.remedy().ends_with('.'), "{}", kind.id());
    }
    assert_eq!(Kind::of_id("no-such-effect"), None);
}

#[test]
fn a_round_pad_touches_with_its_lowest_point() {
    let (rig, arm) = arm();
    let normal = rig.touchscreen.normal().vector();
    let situation = Situation::new(&arm, &ANGLES, &[0.0; 6], 0.0, &normal);
    let radius_m = 0.006;
    let mut deviation = Deviation::none(6);
    let all = Effect::all(&arm);
    let roll = all.iter().find(|effect| effect.kind == Kind::FingerRoll).expect("a candidate");
    roll.deviate(&situation, &[radius_m], &mut deviation);
    // The pad's center lies one radius before the tip, on the line from the knuckle. The index
    // finger's joint is where the rig says, whatever its angle.
    let mut posture = rig.home();
    for (part, angle_rad) in arm.parts.iter().zip(ANGLES) {
        posture[part.index.expect("it turns")] = angle_rad;
    }
    let joint = rig.description.find_joint("r_indexfinger_x").expect("a joint of the hand");
    let knuckle = rig.description.forward(&posture).of(rig.description.joint(joint).child).translation_m();
    let tip = arm.tip_m(&ANGLES, &Deviation::none(6));
    let center = tip.coords - (tip.coords - knuckle).normalize() * radius_m;
    let lowest = center - normal * radius_m;
    assert!((arm.tip_m(&ANGLES, &deviation).coords - lowest).norm() < 1e-12);
}

/// Joints that are driven on by a depth and yield as springs of one stiffness until the tip is no lower than before.
#[test]
fn a_finger_that_is_pressed_on_slides_as_its_joints_yield() {
    let (_, arm) = arm();
    let (normal, direction, depth_m) = (nalgebra::Vector3::z(), [1.0; 6], 1e-6);
    let situation = Situation::new(&arm, &ANGLES, &direction, 0.0, &normal);
    let effects = Effect::all(&arm);
    let drag = effects.iter().find(|effect| effect.kind == Kind::TouchDrag).expect("a touch has it");
    let mut deviation = Deviation::none(6);
    drag.clone().with_shape(Some(2.0)).deviate(&situation, &[depth_m], &mut deviation);
    let tip = arm.tip_m(&ANGLES, &Deviation::none(6));
    let moved = |turned: &[f64]| {
        let angles: Vec<f64> = ANGLES.iter().zip(turned).map(|(angle, turn)| angle + turn).collect();
        arm.tip_m(&angles, &Deviation::none(6)) - tip
    };
    let lifts: Vec<f64> = (0..6)
        .map(|j| moved(&std::array::from_fn::<f64, 6, _>(|k| if k == j { 1e-6 } else { 0.0 })).z / 1e-6)
        .collect();
    // Half of the depth by joints that turn alike, half by those that lower the tip; each to that depth by itself.
    let alike = 0.5 * depth_m / lifts.iter().sum::<f64>().abs();
    let lowering: Vec<f64> = lifts.iter().map(|lift| (-lift).max(0.0)).collect();
    let lowered = lifts.iter().zip(&lowering).map(|(lift, rate)| lift * rate).sum::<f64>().abs();
    let driven: Vec<f64> = lowering.iter().map(|rate| alike + 0.5 * depth_m * rate / lowered).collect();
    let along = |shift: nalgebra::Vector3<f64>| nalgebra::Vector3::new(shift.x, shift.y, 0.0);
    let square: f64 = lifts.iter().map(|lift| lift * lift).sum();
    let yields: Vec<f64> = lifts.iter().map(|lift| depth_m * lift / square).collect();
    let expected = along(moved(&driven)) + along(moved(&yields));
    assert!((moved(&yields).z - depth_m).abs() < 1e-3 * depth_m, "they yield by all of the depth");
    assert!(deviation.contact_m.z.abs() < 1e-12 && expected.norm() > 0.1 * depth_m);
    assert!((deviation.contact_m - expected).norm() < 1e-3 * depth_m, "{} {expected}", deviation.contact_m);
    let unknown = Situation::new(&arm, &ANGLES, &[0.0; 6], 0.0, &normal);
    let mut none = Deviation::none(6);
    drag.clone().with_shape(Some(2.0)).deviate(&unknown, &[depth_m], &mut none);
    assert_eq!(none, Deviation::none(6), "nothing says that it came from a side");
}
