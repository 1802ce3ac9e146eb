//! Laws of every candidate: zero is nothing, the rest is something, tangents are the slope of the
//! prediction, and parameters are reported as they are.

// What was measured is printed.
#![allow(clippy::print_stdout)]

use std::collections::BTreeSet;
use std::time::Instant;

use nalgebra::{DMatrix, Isometry3, Point3, UnitQuaternion};
use plumbline_model::robot::Rig;

use crate::arm::Arm;
use crate::eyes::Eyes;
use crate::forward::Assumed;
use crate::library::Present;
use crate::library::{Effect, Kind, Surface};
use crate::measurements::{Apparatus, Measurements, Observation, What};

fn row(session: usize, i: usize, what: What) -> Observation {
    Observation { session, row: i, t_secs: Some(40.0 * i as f64), cell: i, ..Observation::imagined(what) }
}

/// A number of its own for every row and joint, −1 to 1.
fn wave(i: usize, j: usize) -> f64 {
    (0.7 + 12.9898 * (i + 1) as f64 + 78.233 * (j + 1) as f64).sin()
}

/// Rows with every column that an effect may depend on: touches from commanded angles and from
/// encoders, held poses, estimates and image points.
fn everything(count: usize) -> Measurements {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let arm = Arm::of_rig(&rig, "right_index_tip").expect("a tip of the rig");
    let eyes = Eyes::of_rig(&rig).expect("the rig has eyes");
    let surface = Surface::of(&rig.touchscreen);
    let moved = Apparatus {
        title: "moved".to_owned(),
        tip: None,
        arm: Some(arm.clone()),
        surface: Some(surface.clone()),
        ..Apparatus::default()
    };
    let seen = Apparatus { title: "seen".to_owned(), eyes: Some(eyes), ..Apparatus::default() };
    let middle = [-0.2, 1.1, 0.5, 1.7, -0.3, 0.2];
    let mut rows = vec![];
    for i in 0..count {
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let angles: Vec<f64> = (0..6).map(|j| middle[j] + 0.35 * wave(i, j)).collect();
        let mut moved = row(0, i, if i % 4 == 3 { What::Pose } else { What::Touch });
        moved.encoder_rad =
            (i % 3 == 0).then(|| angles.iter().enumerate().map(|(j, a)| a - 0.01 * wave(j, i)).collect());
        moved.commanded_rad = Some(angles);
        moved.direction = vec![side; 6];
        moved.payload_kg = 0.25 * f64::from(u8::from(i % 5 == 0));
        moved.screen_height_m = 0.06 * f64::from(u8::from(i % 7 == 0));
        moved.move_secs = Some(1.0 + 0.5 * wave(i, 9));
        moved.hold_secs = Some(240.0 * (i % 4) as f64);
        rows.push(moved);
        let mut seen = row(1, i, if i % 2 == 0 { What::Place } else { What::EyePoints });
        seen.neck_rad = vec![0.1 * wave(i, 3), -0.6 + 0.05 * wave(i, 4)];
        let middle = surface.middle_m();
        seen.truth_m = Some(Point3::new(middle.x + 0.08 * wave(i, 5), middle.y + 0.1 * wave(i, 6), middle.z));
        seen.background_m = Some(1.2 + 0.3 * wave(i, 7));
        seen.set = Some(if i < count / 2 { "first" } else { "second" }.to_owned());
        rows.push(seen);
    }
    Measurements {
        rig: "nico".to_owned(),
        apparatuses: vec![moved, seen],
        rows,
        left_out: vec![],
        present: vec![],
    }
}

/// What an effect alone changes at most, over all rows.
fn largest_change(measurements: &Measurements, effect: &Effect, values: Vec<f64>) -> f64 {
    let nominal = Assumed::nominal(measurements);
    let with = Assumed { effects: vec![Present { effect: effect.clone(), values }], ..nominal.clone() };
    let change = |row: &Observation| {
        let (a, b) = (measurements.predict(row, &nominal)?, measurements.predict(row, &with)?);
        Some(a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
    };
    measurements.rows.iter().map(|row| change(row).expect("in view")).fold(0.0, f64::max)
}

#[test]
fn a_neck_that_stands_still_shows_no_zeros_and_one_that_moves_does() {
    let mut measurements = everything(24);
    let of_neck = |measurements: &Measurements| -> Vec<String> {
        let all = Effect::candidates(measurements).into_iter();
        all.filter(|effect| effect.kind == Kind::HeadJoint).map(|effect| effect.site).collect()
    };
    assert_eq!(of_neck(&measurements).len(), 2);
    // The first joint stands still, but for the noise of its encoder.
    for (i, row) in measurements.rows.iter_mut().enumerate() {
        if let Some(pan) = row.neck_rad.first_mut() {
            *pan = 0.2 + 0.002 * wave(i, 5);
        }
    }
    assert_eq!(of_neck(&measurements), ["head_y"]);
    let is_mount = |one: &Effect| one.kind == Kind::CameraMount && one.growth().is_none();
    let mounts = Effect::candidates(&measurements).into_iter().filter(is_mount);
    assert_eq!(mounts.count(), 1, "what the zero does is the mount's");
}

#[test]
fn every_kind_is_a_candidate_where_rows_can_show_it() {
    let measurements = everything(60);
    let candidates = Effect::candidates(&measurements);
    let kinds: BTreeSet<Kind> = candidates.iter().map(|effect| effect.kind).collect();
    let never = [Kind::DisparitySteps, Kind::EyeLatency, Kind::LinkMass];
    for kind in Kind::ALL {
        let known_not = never.contains(kind);
        assert_eq!(kinds.contains(kind), !known_not, "{}", kind.id());
    }
    let mut names = BTreeSet::new();
    for effect in &candidates {
        let shape = effect.shape.map(f64::to_bits);
        assert!(names.insert((effect.name(), shape)), "{} {:?} twice", effect.name(), effect.shape);
        if let (Some(shape), Some([low, high])) = (effect.shape, effect.shape_range) {
            assert!(low <= shape && shape <= high, "{} {low} {shape} {high}", effect.name());
        }
    }
    println!("{} candidates in {} shapes", kinds.len(), candidates.len());
}

#[test]
fn a_joint_is_pulled_along_by_any_other_one_and_never_by_itself() {
    let measurements = everything(20);
    let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref()).expect("an arm");
    let of_coupling = |effect: &Effect| effect.kind == Kind::JointCoupling;
    let couplings: Vec<Effect> = Effect::candidates(&measurements).into_iter().filter(of_coupling).collect();
    let joints: Vec<&str> = arm.parts.iter().map(|part| part.joint.as_str()).collect();
    let mut pairs = BTreeSet::new();
    for effect in &couplings {
        let told = effect.report(&[0.02], &DMatrix::from_element(1, 1, 1e-6));
        let from = told.iter().find(|one| one.name == "from_joint").and_then(|one| one.text.clone());
        let from = from.expect("which joint pulls");
        assert!(joints.contains(&from.as_str()) && from != effect.site, "{from} pulls {}", effect.site);
        let title = &arm.parts.iter().find(|part| part.joint == from).expect("of this arm").title;
        assert!(effect.title.ends_with(title.as_str()), "{}", effect.title);
        pairs.insert((effect.site.clone(), from));
    }
    assert_eq!(pairs.len(), joints.len() * (joints.len() - 1), "every joint by every other one");
    let beyond = Some(joints.len() as f64);
    assert!(Effect::find("joint-coupling", joints[1], beyond, Some(arm), None).is_none(), "nobody pulls it");
}

#[test]
fn what_no_column_shows_is_no_candidate() {
    let mut measurements = everything(40);
    for row in &mut measurements.rows {
        row.t_secs = None;
        row.hold_secs = None;
        row.background_m = None;
        row.move_secs = None;
        row.encoder_rad = None;
        row.direction.fill(1.0);
    }
    let kinds: BTreeSet<Kind> = Effect::candidates(&measurements).iter().map(|effect| effect.kind).collect();
    let hidden = [
        Kind::Backlash,
        Kind::Stiction,
        Kind::Creep,
        Kind::EarlyLog,
        Kind::ServoWarmUp,
        Kind::SlippedHorn,
        Kind::ScreenBumped,
        Kind::BackgroundBleed,
        Kind::ForegroundFattening,
        Kind::SpeedOvershoot,
    ];
    assert!(hidden.iter().all(|kind| !kinds.contains(kind)), "{kinds:?}");
    assert!(kinds.contains(&Kind::ServoDroop) && kinds.contains(&Kind::EyeYaw));
    measurements.rows.retain(|row| !row.what.is_placed());
    assert!(Effect::candidates(&measurements).iter().all(|effect| effect.kind.is_of_eyes()));
}

#[test]
fn size_zero_is_the_nominal_model_and_usual_size_is_not() {
    let measurements = everything(48);
    for effect in Effect::candidates(&measurements) {
        let parameters = effect.parameters();
        let zero = largest_change(&measurements, &effect, vec![0.0; parameters.len()]);
        assert!(zero == 0.0, "{} {:?}: {zero}", effect.name(), effect.shape);
        for k in 0..parameters.len() {
            let mut values = vec![0.0; parameters.len()];
            values[k] = parameters[k].typical;
            let change = largest_change(&measurements, &effect, values);
            // Gravity does not load an upright axis.
            let upright = effect.site == "r_shoulder_z"
                && matches!(
                    effect.kind,
                    Kind::GravityBacklash
                        | Kind::ServoDroop
                        | Kind::JointSag
                        | Kind::Creep
                        | Kind::TorqueLimit
                );
            assert!(upright || change > 1e-7, "{} {:?}: {change}", effect.name(), effect.shape);
        }
    }
}

/// Whatever gives way under a load lowers it: all mass at the tip, measured from outside.
#[test]
fn what_gives_way_gives_way_downward() {
    let mut measurements = everything(60);
    if let Some(arm) = &mut measurements.apparatuses[0].arm {
        arm.parts.iter_mut().for_each(|part| part.mass_kg = 0.0);
        arm.palm_m = Point3::from(arm.last_from_tip.translation.vector);
    }
    measurements.rows.retain(|row| row.what == What::Pose);
    for row in &mut measurements.rows {
        row.encoder_rad = None;
        row.payload_kg = 0.5;
    }
    let loaded = [
        Kind::ServoDroop,
        Kind::JointSag,
        Kind::SidewaysGive,
        Kind::LinkBending,
        Kind::Creep,
        Kind::TorqueLimit,
        Kind::TorsoLean,
        Kind::PayloadMass,
    ];
    let nominal = Assumed::nominal(&measurements);
    let candidates = Effect::candidates(&measurements);
    for kind in loaded {
        let mut lowest_m = 0.0_f64;
        for effect in candidates.iter().filter(|effect| effect.kind == kind) {
            // Small enough for the load not to swing past its lowest place.
            let values = vec![0.05 * effect.parameters()[0].typical];
            let present = Present { effect: effect.clone(), values };
            let with = Assumed { effects: vec![present], ..nominal.clone() };
            for row in &measurements.rows {
                let place = |model| measurements.predict(row, model).expect("predictable")[2];
                let rise_m = place(&with) - place(&nominal);
                assert!(rise_m < 1e-7, "{} rises by {rise_m} m", effect.name());
                lowest_m = lowest_m.min(rise_m);
            }
        }
        assert!(lowest_m < -1e-6, "{} does not give way: {lowest_m} m", kind.id());
    }
}

#[test]
fn tangents_are_the_slope_of_the_prediction() {
    let mut measurements = everything(24);
    // Half of the poses have orientations, and the marker sits anywhere.
    measurements.apparatuses[0].tip_is_unknown = true;
    let arm = measurements.apparatuses[0].arm.clone().expect("an arm");
    for row in measurements.rows.iter_mut().filter(|row| row.what == What::Pose && row.row % 8 == 7) {
        let tip = arm.robot_from_tip(row.angles_rad(), &crate::arm::Deviation::none(arm.len()));
        row.orientation = Some(UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5) * tip.rotation);
        row.what = What::OrientedPose;
        row.measured = vec![0.0; 6];
    }
    let candidates = Effect::candidates(&measurements);
    // Around a model in which several parts deviate already.
    let present = |id: &str, site: &str, values: &[f64]| {
        let found = candidates.iter().find(|effect| effect.id() == id && effect.site == site);
        Present { effect: found.expect("a candidate").clone(), values: values.to_vec() }
    };
    let mut assumed = Assumed::nominal(&measurements);
    assumed.placements[0] = Isometry3::new([0.01, -0.02, 0.005].into(), [0.02, -0.01, 0.05].into());
    assumed.set_mount(0, Isometry3::new([0.02, -0.01, 0.03].into(), [0.2, -0.4, 0.1].into()));
    assumed.effects = vec![
        present("joint-zero", "r_elbow_y", &[0.05]),
        present("axis-skew", "r_shoulder_y", &[0.04, -0.03]),
        present("base-tilt", "base", &[0.03, -0.02, 0.01, 0.005, 0.0, 0.01]),
        present("tip-offset", "tip", &[0.005, 0.004, -0.003]),
        present("screen-scale", "screen", &[0.05, -0.04]),
        present("camera-mount", "eyes", &[0.01, 0.0, -0.01, 0.02, 0.01, 0.0]),
        present("eye-roll", "right", &[0.002, -0.001]),
    ];
    for row in &measurements.rows {
        let tangents = measurements.tangents(row, &assumed, &candidates).expect("in view");
        let predicted = measurements.predict(row, &assumed).expect("in view");
        assert!(tangents.predicted.iter().zip(&predicted).all(|(a, b)| (a - b).abs() < 1e-12));
        let mut column = 0;
        for effect in &candidates {
            let parameters = effect.parameters();
            for (k, parameter) in parameters.iter().enumerate() {
                let step = 0.003;
                let at = |side: f64| {
                    let mut values = vec![0.0; parameters.len()];
                    values[k] = side * step * parameter.typical;
                    let mut other = assumed.clone();
                    other.effects.push(Present { effect: effect.clone(), values });
                    measurements.predict(row, &other).expect("in view")
                };
                let (ahead, behind) = (at(1.0), at(-1.0));
                for i in 0..predicted.len() {
                    let slope = (ahead[i] - behind[i]) / (2.0 * step);
                    let tangent = tangents.effects[(i, column)];
                    let error = (slope - tangent).abs();
                    assert!(error < 2e-3 * slope.abs() + 2e-6, "{} {k}: {slope} {tangent}", effect.name());
                }
                column += 1;
            }
        }
        for k in 0..6 {
            let at = |side: f64| {
                let mut twist = [0.0; 6];
                twist[k] = side * 1e-4;
                let mut other = assumed.clone();
                other.placements[row.session] =
                    measurements.moved(row.session, &assumed.placements[row.session], &twist);
                measurements.predict(row, &other).expect("in view")
            };
            let (ahead, behind) = (at(1.0), at(-1.0));
            let placed = f64::from(u8::from(row.what.is_placed()));
            for i in 0..predicted.len() {
                let slope = placed * (ahead[i] - behind[i]) / 2e-4;
                assert!((slope - tangents.gauge[(i, k)]).abs() < 1e-5, "twist {k}");
            }
        }
        for nuisance in measurements.nuisances() {
            let at = |side: f64| {
                let mut other = assumed.clone();
                measurements.move_nuisances(&mut other, &[nuisance], &[side * 1e-4], 1.0);
                measurements.predict(row, &other).expect("in view")
            };
            let (ahead, behind) = (at(1.0), at(-1.0));
            for i in 0..predicted.len() {
                let slope = (ahead[i] - behind[i]) / 2e-4;
                let tangent = measurements.nuisance_slope(row, &tangents, i, nuisance);
                assert!((slope - tangent).abs() < 1e-5, "{nuisance:?} {i}: {slope} {tangent}");
            }
        }
    }
}

#[test]
fn an_effect_is_found_again_by_its_name_and_shape() {
    let measurements = everything(40);
    let arm = measurements.apparatuses[0].arm.as_ref();
    let eyes = measurements.apparatuses[1].eyes.as_ref();
    for effect in Effect::candidates(&measurements) {
        let found = Effect::find(effect.id(), &effect.site, effect.shape, arm, eyes).expect("known");
        let mut same = found;
        same.shape_range = effect.shape_range;
        assert_eq!(same, effect);
        let refined = effect.refined(&measurements);
        assert!(!refined.is_empty() && refined.iter().all(|other| other.name() == effect.name()));
    }
    assert!(Effect::find("joint-zero", "no_such_joint", None, arm, eyes).is_none());
    assert!(Effect::find("no-such-kind", "", None, arm, eyes).is_none());
}

fn reported(id: &str, shape: Option<f64>, values: &[f64], sds: &[f64]) -> Vec<(String, f64, f64, f64)> {
    let measurements = everything(40);
    let effect = Effect::candidates(&measurements)
        .into_iter()
        .find(|effect| effect.id() == id && !effect.site.is_empty())
        .expect("a candidate");
    let effect = if shape.is_some() { effect.with_shape(shape) } else { effect };
    let covariance =
        DMatrix::from_fn(sds.len(), sds.len(), |i, j| if i == j { sds[i] * sds[i] } else { 0.0 });
    effect
        .report(values, &covariance)
        .into_iter()
        .map(|one| (one.name, one.value, one.low, one.high))
        .collect()
}

#[test]
fn parameters_are_reported_as_the_command_line_names_them() {
    let (amplitude, phase): (f64, f64) = (0.008, 0.7);
    let wave = reported(
        "joint-eccentricity",
        Some(2.0),
        &[amplitude * phase.cos(), amplitude * phase.sin()],
        &[0.001, 0.001],
    );
    assert!(wave[0].0 == "amplitude_rad" && (wave[0].1 - amplitude).abs() < 1e-12);
    assert!((wave[0].3 - wave[0].2 - 2.0 * 1.96 * 0.001).abs() < 1e-9);
    assert!(wave[1].0 == "phase_rad" && (wave[1].1 - phase).abs() < 1e-12);
    assert!((wave[1].3 - wave[1].1 - 1.96 * 0.001 / amplitude).abs() < 1e-9);
    assert!(wave[2].0 == "order" && wave[2].1 == 2.0);
    let droop = reported("servo-droop", None, &[0.04], &[0.002]);
    assert!(droop[0].0 == "stiffness_nm_per_rad" && (droop[0].1 - 25.0).abs() < 1e-9);
    assert!(droop[0].2 < 25.0 && droop[0].3 > 25.0 && droop[0].3 < 28.0);
    let play = reported("backlash", None, &[-0.006], &[0.001]);
    assert!(play[0].0 == "width_rad" && play[0].1 == 0.006 && play[0].2 > 0.0 && play[0].3 > 0.006);
    let warm = reported("servo-warm-up", Some(300.0), &[0.004], &[0.001]);
    assert_eq!(
        warm.iter().map(|one| one.0.as_str()).collect::<Vec<_>>(),
        ["amplitude_rad", "time_constant_s"]
    );
    assert_eq!(warm[1].1, 300.0);
    let yaw = reported("eye-yaw", Some(Effect::yaw_growth(240.0, 90.0)), &[0.01], &[0.001]);
    let values: Vec<(&str, f64)> = yaw.iter().map(|one| (one.0.as_str(), one.1)).collect();
    assert_eq!(values, [("amplitude_rad", 0.01), ("time_constant_s", 240.0), ("delay_s", 90.0)]);
    let late = reported("eye-yaw", Some(Effect::late_growth(240.0, 60.0)), &[0.01], &[0.001]);
    let values: Vec<(&str, f64)> = late.iter().map(|one| (one.0.as_str(), one.1)).collect();
    assert_eq!(values, [("amplitude_rad", 0.01), ("time_constant_s", 240.0), ("late_s", 60.0)]);
    let slip = reported("slipped-horn", Some(610.0), &[0.05], &[0.001]);
    assert!(slip[0].0 == "step_rad" && slip[1].0 == "t_secs" && slip[1].1 == 610.0);
    let pulled = reported("joint-coupling", None, &[0.02], &[0.001]);
    assert!(pulled[0].0 == "ratio" && pulled[1].0 == "from_joint");
    let limit = reported("torque-limit", Some(0.8), &[0.05], &[0.001]);
    assert!(limit[0].0 == "torque_nm" && limit[0].1 == 0.8);
}

#[test]
fn a_skewed_axis_is_reported_as_it_turns_the_joint() {
    let measurements = everything(12);
    let candidates = Effect::candidates(&measurements);
    let skews = candidates.iter().filter(|effect| effect.kind == Kind::AxisSkew);
    for effect in skews.filter(|effect| !effect.is_of_every_site()) {
        let [a, b] = effect.across.expect("an axis");
        let turn = a * 0.02 - b * 0.03;
        let zero = DMatrix::zeros(2, 2);
        for one in effect.report(&[0.02, -0.03], &zero) {
            let k = ["rot_x_rad", "rot_y_rad", "rot_z_rad"].iter().position(|name| *name == one.name);
            assert!((one.value - turn[k.expect("a turn")]).abs() < 1e-12);
        }
    }
}

#[test]
fn an_effect_at_every_site_is_its_members_together() {
    let measurements = everything(12);
    let candidates = Effect::candidates(&measurements);
    let many: Vec<&Effect> = candidates.iter().filter(|effect| effect.is_of_every_site()).collect();
    assert_eq!(many.len(), 3, "zeros, axes and links");
    for effect in many {
        let single: Vec<&Effect> =
            candidates.iter().filter(|one| one.kind == effect.kind && !one.site.is_empty()).collect();
        let count = effect.parameters().len();
        let values: Vec<f64> =
            effect.parameters().iter().enumerate().map(|(k, p)| p.typical * (0.3 + 0.1 * k as f64)).collect();
        let mut at = 0;
        let each = single.iter().map(|one| {
            let own = values[at..at + one.parameters().len()].to_vec();
            at += own.len();
            Present { effect: (*one).clone(), values: own }
        });
        let nominal = Assumed::nominal(&measurements);
        let together = Assumed { effects: each.collect(), ..nominal.clone() };
        assert_eq!(at, count);
        let present = Present { effect: effect.clone(), values: values.clone() };
        let at_once = Assumed { effects: vec![present], ..nominal };
        for row in &measurements.rows {
            assert_eq!(measurements.predict(row, &together), measurements.predict(row, &at_once));
        }
        let names: std::collections::HashSet<String> =
            effect.report(&values, &DMatrix::zeros(count, count)).into_iter().map(|one| one.name).collect();
        assert!(names.len() >= count, "every parameter has its own name: {names:?}");
    }
}

#[test]
fn a_stiffness_that_may_be_infinite_has_an_open_end() {
    let droop = reported("servo-droop", None, &[0.002], &[0.002]);
    assert!(droop[0].3 >= 1e6 && droop[0].2 > 0.0 && droop[0].2 < droop[0].1);
}

#[test]
fn a_step_comes_after_its_moment_and_growth_after_its_delay() {
    let measurements = everything(30);
    let candidates = Effect::candidates(&measurements);
    let slip = candidates.iter().find(|e| e.kind == Kind::SlippedHorn).expect("a candidate").clone();
    let slip = slip.with_shape(Some(500.0));
    let nominal = Assumed::nominal(&measurements);
    let with = |effect: Effect, value: f64| Assumed {
        effects: vec![Present { effect, values: vec![value] }],
        ..nominal.clone()
    };
    let (slipped, turned) = (with(slip, 0.1), {
        let yaw = candidates.iter().find(|e| e.kind == Kind::EyeYaw).expect("a candidate").clone();
        with(yaw.with_shape(Some(Effect::yaw_growth(240.0, 90.0))), 0.01)
    });
    for row in &measurements.rows {
        let t_secs = row.t_secs.expect("every row has its time");
        let (model, late) =
            if row.what.is_placed() { (&slipped, t_secs > 500.0) } else { (&turned, t_secs > 90.0) };
        let changed = measurements.predict(row, model) != measurements.predict(row, &nominal);
        assert_eq!(changed, late, "{:?} at {t_secs} s", row.what);
    }
}

#[test]
fn speed_of_tangents() {
    for (rows, label) in [(245, "245 rows"), (5000, "5000 rows")] {
        let mut measurements = everything(rows);
        measurements.rows.retain(|row| row.what.is_placed());
        let mut candidates = Effect::candidates(&measurements);
        candidates.retain(|effect| effect.kind != Kind::ToothRipple);
        for (of, count) in [("150", 150), ("all", usize::MAX)] {
            let mut columns = 0;
            let some: Vec<Effect> = candidates
                .iter()
                .take_while(|effect| {
                    columns += effect.parameters().len();
                    columns <= count
                })
                .cloned()
                .collect();
            let assumed = Assumed::nominal(&measurements);
            let start = Instant::now();
            let sum: f64 = measurements
                .rows
                .iter()
                .filter_map(|row| measurements.tangents(row, &assumed, &some))
                .map(|tangents| tangents.effects.sum())
                .sum();
            assert!(sum.is_finite());
            println!(
                "{label}, {of} columns ({} effects): {:.1} ms on one core",
                some.len(),
                start.elapsed().as_secs_f64() * 1e3
            );
        }
    }
}

#[test]
fn a_choice_has_a_key_of_its_own_beside_the_number() {
    let rig = Rig::built_in("nico").expect("comes along");
    let eyes = Eyes::of_rig(&rig).expect("calibrated eyes");
    for (shape, which) in [(None, "focal length"), (Some(1.0), "distance of the eyes")] {
        let effect =
            Effect::find("focal-or-baseline", "eyes", shape, None, Some(&eyes)).expect("in the library");
        let reported = effect.report(&[0.03], &DMatrix::from_element(1, 1, 1e-6));
        let [size, choice] = &reported[..] else { panic!("{reported:?}") };
        assert_eq!((size.name.as_str(), size.value, size.text.clone()), ("scale", 0.03, None));
        assert!(size.low < 0.03 && 0.03 < size.high);
        assert_eq!((choice.name.as_str(), choice.text.as_deref()), ("which", Some(which)));
    }
}

#[test]
fn what_grows_as_eyes_warm_up_says_so_and_what_is_constant_does_not() {
    let measurements = everything(24);
    let eyes = measurements.apparatuses.iter().find_map(|apparatus| apparatus.eyes.as_ref());
    for kind in [Kind::EyeYaw, Kind::EyeRoll, Kind::ImageShift, Kind::CameraMount] {
        let constant = Effect::sites(kind, None, eyes).swap_remove(0);
        let growing = constant.clone().with_shape(Some(Effect::late_growth(300.0, 60.0)));
        assert_eq!(growing.title, format!("{}, more so as the cameras warm up", constant.title));
        // Told once, and no more where it does not grow.
        assert_eq!(growing.clone().with_shape(Some(Effect::late_growth(200.0, 0.0))).title, growing.title);
        assert_eq!(growing.with_shape(None), constant);
    }
}
