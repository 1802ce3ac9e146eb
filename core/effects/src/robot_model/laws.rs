//! Laws of the robot as it is known: nominal to the last bit without effects, there and back with
//! every one of them, and an uncertainty that is true.

use nalgebra::{DMatrix, Matrix3, Vector3};
use plumbline_model::robot::ik::{Options, Target};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{LeftCamera, Point};

use super::*;
use crate::library::{Effect, Kind};
use crate::rig_model::{Conditions, ModelEffect, Together};

const TIPS: [&str; 2] = ["right_index_tip", "right_palm_center"];

fn nico() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

fn effect(id: &str, site: &str, shape: Option<f64>, values: &[f64]) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: Some(TIPS[0].to_owned()),
        shape,
        reference_s: 0.0,
        values: values.to_vec(),
        covariance: vec![],
        probability: None,
        parameters: vec![],
    }
}

fn model(rig: &Arc<Rig>, effects: Vec<ModelEffect>) -> RobotModel {
    let mut added = RigModel::nominal(rig);
    added.contents.effects = effects;
    RobotModel::new(rig.clone(), Arc::new(added)).expect("they fit")
}

/// Every effect on the eyes in its usual size, in each of its shapes, both ways.
fn of_the_eyes(rig: &Rig) -> Vec<ModelEffect> {
    let eyes = Eyes::of_rig(rig).expect("there are eyes");
    let mut all = vec![];
    for of_library in Kind::ALL.iter().flat_map(|kind| Effect::sites(*kind, None, Some(&eyes))) {
        let shapes: &[Option<f64>] = match of_library.kind {
            Kind::FocalOrBaseline => &[None, Some(1.0)],
            Kind::EyeYaw => &[None, Some(240.06)],
            _ => &[None],
        };
        for shape in shapes {
            let of_library = of_library.clone().with_shape(*shape);
            for sign in [1.0, -1.0] {
                let values: Vec<f64> =
                    of_library.parameters().iter().map(|parameter| sign * parameter.typical).collect();
                all.push(effect(of_library.id(), &of_library.site, *shape, &values));
            }
        }
    }
    all
}

fn places() -> Vec<Point<LeftCamera>> {
    [[0.02, 0.03, 0.4], [-0.12, -0.05, 0.55], [0.15, 0.1, 0.6], [-0.03, 0.12, 0.35]]
        .map(|[x, y, z]| Point::new(x, y, z))
        .to_vec()
}

fn turned_head(rig: &Rig) -> Posture {
    rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[0.2, -0.5])
}

const SEEN: SeenUnder = SeenUnder { t_secs: Some(900.0), background_m: Some(0.9), apart_rad: 0.0 };

#[test]
fn without_effects_every_answer_is_the_descriptions_own() {
    let rig = nico();
    let here = RobotModel::nominal(rig.clone());
    assert!(here.is_nominal());
    assert_eq!(here.title(), "as described");
    let posture = turned_head(&rig);
    let robot_from_left = rig.robot_from_left(&posture);
    assert_eq!(here.robot_from_left(&posture), robot_from_left);
    let covariance_m2 = Matrix3::from_diagonal(&Vector3::new(1e-6, 2e-6, 9e-6));
    for in_left in places() {
        let place = here.place(&in_left, &covariance_m2, &posture, &SEEN).expect("a place");
        assert_eq!(place.point, robot_from_left * in_left);
        assert!((place.sigma_m() - 3e-3).abs() < 1e-12);
        let (left, right) = here.project(&place.point, &posture, &SEEN).expect("seen");
        let back = rig.eyes.cameras.triangulate(left, right).expect("rays meet");
        assert!(back.distance_m(&in_left) < 1e-9);
    }
    for tip in TIPS {
        let (arm, chain) = (here.arm(tip).expect("a tip"), rig.chain(tip).expect("a tip"));
        for posture in [rig.home(), rig.description.rest()] {
            assert_eq!(
                arm.robot_from_tip(&posture, &Conditions::default()),
                chain.robot_from_tip_in(&posture)
            );
            assert_eq!(arm.covariance_m2(&posture, &Conditions::default()), Matrix3::zeros());
        }
        let target = Target::Position(Point::new(0.35, -0.15, 0.15));
        let own = arm.solver().solve_from(&target, &rig.home(), &Options::default()).expect("sound");
        let answer = arm
            .reach(&target, &rig.home(), &Options::default(), &Conditions::default())
            .expect("a sound question");
        assert_eq!(answer.answer, own);
    }
    assert!(here.arm("right_toe").is_err());
}

#[test]
fn what_is_seen_is_where_it_is_with_every_effect_of_the_eyes() {
    let rig = nico();
    let posture = turned_head(&rig);
    let nominal = rig.robot_from_left(&posture);
    let (mut judged, mut moved) = (0, 0);
    for present in of_the_eyes(&rig) {
        let name = format!("{} {:?} {:?}", present.name(), present.shape, present.values);
        let here = model(&rig, vec![present]);
        for in_left in places() {
            let place = here.place(&in_left, &Matrix3::zeros(), &posture, &SEEN);
            let place = place.unwrap_or_else(|| panic!("{name}: no place for {in_left:?}"));
            let (left, right) = here.project(&place.point, &posture, &SEEN).expect("seen");
            let back = rig.eyes.cameras.triangulate(left, right).expect("rays meet");
            assert!(back.distance_m(&in_left) < 1e-6, "{name}: {}", back.distance_m(&in_left));
            judged += 1;
            moved += usize::from(place.point.distance_m(&(nominal * in_left)) > 1e-4);
        }
    }
    assert!(judged > 80 && moved > judged / 2, "{moved} of {judged} are elsewhere");
}

#[test]
fn neck_and_mount_move_the_eye_itself() {
    let rig = nico();
    let posture = turned_head(&rig);
    let tilt = rig.description.joint(rig.eyes.tilt).name.clone();
    let here = model(&rig, vec![effect("head-joint", &tilt, None, &[0.02])]);
    let as_turned = posture.with(&[rig.eyes.tilt], &[posture[rig.eyes.tilt] + 0.02]);
    let (is, should) = (here.robot_from_left(&posture), rig.robot_from_left(&as_turned));
    assert!((is.translation_m() - should.translation_m()).norm() < 1e-12);
    assert!(is.isometry.rotation.angle_to(&should.isometry.rotation) < 1e-9);
    for in_left in places() {
        let place = here.place(&in_left, &Matrix3::zeros(), &posture, &SEEN).expect("a place");
        assert!(place.point.distance_m(&(should * in_left)) < 1e-7);
    }
    let here = model(&rig, vec![effect("camera-mount", "eyes", None, &[0.01, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let moved =
        here.robot_from_left(&posture).translation_m() - rig.robot_from_left(&posture).translation_m();
    assert!((moved.norm() - 0.01).abs() < 1e-12);
    assert_eq!(here.title(), "with 1 effect");
}

#[test]
fn the_tip_gets_to_its_target() {
    let rig = nico();
    let effects = vec![
        effect("joint-zero", "r_elbow_y", None, &[0.05]),
        effect("joint-sag", "r_arm_x", None, &[0.02]),
        effect("servo-droop", "r_shoulder_y", None, &[0.03]),
        effect("base-tilt", "base", None, &[0.02, -0.02, 0.01, 0.005, 0.0, -0.01]),
    ];
    let here = model(&rig, effects);
    let conditions = Conditions::default();
    for tip in TIPS {
        let arm = here.arm(tip).expect("a tip");
        let mut reached = 0;
        for k in 0..12 {
            let point = Point::new(0.25 + 0.015 * f64::from(k), -0.05 - 0.02 * f64::from(k), 0.12);
            let answer = arm
                .reach(&Target::Position(point), &rig.home(), &Options::default(), &conditions)
                .expect("a sound question");
            if !answer.is_reached() {
                continue;
            }
            let commanded = rig.home().with(arm.joints(), &answer.answer.best().joints);
            assert!(arm.tip(&commanded, &conditions).distance_m(&point) < 1e-4);
            let nominal = arm.chain().robot_from_tip_in(&commanded).translation_m();
            assert!((nominal - point.coords.coords).norm() > 5e-3, "the effects are not small");
            reached += 1;
        }
        assert!(reached >= 8, "{reached} of 12");
    }
}

#[test]
fn what_encoders_see_is_not_added_once_more() {
    let rig = nico();
    let here = model(&rig, vec![effect("servo-droop", "r_shoulder_y", None, &[0.03])]);
    let arm = here.arm(TIPS[0]).expect("a tip");
    let (posture, conditions) = (rig.home(), Conditions::default());
    let nominal = arm.chain().robot_from_tip_in(&posture).translation_m();
    let read = arm.robot_from_tip_by_encoders(&posture, &conditions).translation_m();
    let commanded = arm.robot_from_tip(&posture, &conditions).translation_m();
    assert!((read - nominal).norm() < 1e-12);
    assert!((commanded - nominal).norm() > 1e-3);
}

#[test]
fn the_tip_is_turned_as_its_joints_are() {
    let rig = nico();
    let wrist = rig.description.find_joint("r_wrist_x").expect("a joint of NICO");
    let here = model(&rig, vec![effect("joint-zero", "r_wrist_x", None, &[0.1])]);
    let arm = here.arm(TIPS[1]).expect("a tip");
    let home = rig.home();
    let place = arm.robot_from_tip(&home, &Conditions::default());
    let should = arm.chain().robot_from_tip_in(&home.with(&[wrist], &[home[wrist] + 0.1]));
    assert!((place.translation_m() - should.translation_m()).norm() < 1e-12);
    assert!(place.isometry.rotation.angle_to(&should.isometry.rotation) < 1e-9);
}

/// Standard normal numbers, always the same ones: a linear congruence and twelve uniform ones a piece.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Effects with a covariance that correlates what belongs together.
fn uncertain() -> Vec<ModelEffect> {
    let mount = [0.004, -0.002, 0.003, 0.01, -0.02, 0.015];
    let sd = [1e-3, 1e-3, 2e-3, 4e-3, 4e-3, 3e-3];
    let root = DMatrix::from_fn(6, 6, |i, j| {
        if i == j {
            sd[i]
        } else if j + 3 == i {
            0.5 * sd[i]
        } else {
            0.0
        }
    });
    let of_mount: Vec<f64> = (&root * root.transpose()).transpose().iter().copied().collect();
    vec![
        ModelEffect { covariance: of_mount, ..effect("camera-mount", "eyes", None, &mount) },
        ModelEffect { covariance: vec![4e-6], ..effect("eye-yaw", "right", None, &[0.004]) },
        ModelEffect { covariance: vec![2e-5], ..effect("joint-zero", "r_elbow_y", None, &[0.05]) },
        ModelEffect { covariance: vec![1e-5], ..effect("joint-sag", "r_arm_x", None, &[0.01]) },
    ]
}

/// One model of those that the covariances allow.
fn drawn(effects: &[ModelEffect], noise: &mut Noise) -> Vec<ModelEffect> {
    let one = |effect: &ModelEffect| {
        let count = effect.values.len();
        let covariance = DMatrix::from_row_slice(count, count, &effect.covariance);
        let root = covariance.cholesky().expect("positive").l();
        let step = root * DMatrix::from_fn(count, 1, |_, _| noise.normal());
        let values = effect.values.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        ModelEffect { values, ..effect.clone() }
    };
    effects.iter().map(one).collect()
}

/// Covariance of places about their mean, m².
fn scatter(places: &[Vector3<f64>]) -> Matrix3<f64> {
    let mean: Vector3<f64> = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    let sum: Matrix3<f64> = places.iter().map(|place| (place - mean) * (place - mean).transpose()).sum();
    sum / (places.len() - 1) as f64
}

fn agree(said: &Matrix3<f64>, drawn: &Matrix3<f64>, what: &str) {
    for axis in [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(1.0, 1.0, 1.0).normalize()] {
        let of = |covariance: &Matrix3<f64>| (axis.transpose() * covariance * axis).x;
        let ratio = of(said) / of(drawn);
        assert!((0.8..1.2).contains(&ratio), "{what}, along {axis:?}: {ratio}");
    }
}

#[test]
fn the_covariance_is_how_places_scatter_with_the_effects_values() {
    let rig = nico();
    let effects = uncertain();
    let here = model(&rig, effects.clone());
    let (posture, conditions) = (turned_head(&rig), Conditions::default());
    let in_left = Point::new(0.05, 0.02, 0.45);
    let mut noise = Noise(7);
    let (mut seen, mut tips) = (vec![], vec![]);
    for _ in 0..1500 {
        let other = model(&rig, drawn(&effects, &mut noise));
        let place = other.place(&in_left, &Matrix3::zeros(), &posture, &SEEN).expect("a place");
        seen.push(place.point.coords.coords);
        tips.push(other.arm(TIPS[0]).expect("a tip").tip(&posture, &conditions).coords.coords);
    }
    let place = here.place(&in_left, &Matrix3::zeros(), &posture, &SEEN).expect("a place");
    agree(&place.covariance_m2, &scatter(&seen), "what is seen");
    let arm = here.arm(TIPS[0]).expect("a tip");
    let said = arm.covariance_m2(&posture, &conditions);
    // One effect or two move the tip along few directions: each that it moves along is judged.
    let drawn_m2 = scatter(&tips);
    let (said_m2, drawn_m2) = (said.trace(), drawn_m2.trace());
    assert!((0.8..1.2).contains(&(said_m2 / drawn_m2)), "{said_m2} {drawn_m2}");
    // What was seen has an uncertainty of its own, which comes on top.
    let sight = Matrix3::identity() * 4e-6;
    let both = here.place(&in_left, &sight, &posture, &SEEN).expect("a place");
    assert!(both.sigma_m() > place.sigma_m() && both.sigma_m() > 1.5e-3);
}

/// Zeros of three joints that were fitted together: two of them are known by what they do together.
fn zeros() -> (Vec<ModelEffect>, DMatrix<f64>) {
    let sites = ["r_shoulder_y", "r_elbow_y", "r_wrist_z"];
    let root = DMatrix::from_row_slice(3, 3, &[0.03, 0.0, 0.0, -0.0285, 0.002, 0.0, 0.001, 0.0, 0.004]);
    let covariance = &root * root.transpose();
    let zero = |(k, site): (usize, &&str)| ModelEffect {
        covariance: vec![covariance[(k, k)]],
        ..effect("joint-zero", site, None, &[0.01])
    };
    (sites.iter().enumerate().map(zero).collect(), covariance)
}

#[test]
fn effects_that_were_fitted_together_are_known_together() {
    let rig = nico();
    let (effects, covariance) = zeros();
    let of = |effects: &[ModelEffect], together: Vec<Together>| {
        let mut added = RigModel::nominal(&rig);
        added.contents.effects = effects.to_vec();
        added.contents.together = together;
        let model = RobotModel::new(rig.clone(), Arc::new(added)).expect("they fit");
        model.arm(TIPS[0]).expect("a tip")
    };
    let together = Together::new(&effects, &covariance).expect("of one size");
    let (posture, conditions) = (rig.home(), Conditions::default());
    let said = of(&effects, vec![together.clone()]).covariance_m2(&posture, &conditions);
    let root = covariance.clone().cholesky().expect("positive").l();
    let mut noise = Noise(11);
    let drawn = (0..1500).map(|_| {
        let step = &root * DMatrix::from_fn(3, 1, |_, _| noise.normal());
        let moved = effects
            .iter()
            .zip(step.iter())
            .map(|(effect, step)| ModelEffect { values: vec![effect.values[0] + step], ..effect.clone() });
        let moved: Vec<ModelEffect> = moved.collect();
        of(&moved, vec![]).tip(&posture, &conditions).coords.coords
    });
    agree(&said, &scatter(&drawn.collect::<Vec<_>>()), "fitted together");
    let alone = of(&effects, vec![]).covariance_m2(&posture, &conditions);
    assert!((alone - said).norm() > 0.1 * said.norm(), "{alone} {said}");

    // What is not correlated is known as if nothing were said of it.
    let diagonal = DMatrix::from_diagonal(&covariance.diagonal());
    let apart = Together::new(&effects, &diagonal).expect("of one size");
    let apart = of(&effects, vec![apart]).covariance_m2(&posture, &conditions);
    assert!((apart - alone).norm() < 1e-12, "{apart} {alone}");
    // One that was taken out leaves the others as they are known.
    let left = of(&effects[1..], vec![together.clone()]).covariance_m2(&posture, &conditions);
    let two =
        Together::new(&effects[1..], &covariance.view((1, 1), (2, 2)).into_owned()).expect("of one size");
    let expected = of(&effects[1..], vec![two]).covariance_m2(&posture, &conditions);
    assert!((left - expected).norm() < 1e-12, "{left} {expected}");
    // Of one that was added twice nobody knows which part was fitted with the others.
    let twice = [effects.clone(), vec![effects[1].clone()]].concat();
    let twice = of(&twice, vec![together]).covariance_m2(&posture, &conditions);
    assert!(twice.trace() > alone.trace(), "{twice} {alone}");
    assert_eq!(Together::new(&effects[1..], &covariance), None);
}

#[test]
fn effects_of_another_rig_are_refused() {
    let rig = nico();
    let added = RigModel { rig: "icub".to_owned(), ..RigModel::nominal(&rig) };
    let said = RobotModel::new(rig, Arc::new(added)).expect_err("another rig").to_string();
    assert!(said.contains("icub"), "{said}");
}
