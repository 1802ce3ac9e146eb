//! Eyes that were calibrated warm are watched from switching on, explained and corrected: what is found counts from
//! the calibration.

use std::sync::{Arc, OnceLock};

use nalgebra::{Matrix3, Rotation3, Vector3};
use plumbline_drift::{Look, Sample, errors, log_of};
use plumbline_effects::{Measurements, SeenUnder};
use plumbline_gap::{Options, find};
use plumbline_model::robot::{CalibratedAt, default_rig};
use plumbline_model::session::Manifest;
use plumbline_model::{LeftCamera, Point, Robot, Unattended};

use super::*;

/// When the eyes were calibrated: twelve minutes after switching on.
const CALIBRATED_S: f64 = 720.0;
/// How far the right eye turns to the side in the end (rad), and how fast.
const END_RAD: f64 = 0.006;
const TIME_CONSTANT_S: f64 = 301.0;
/// What a look is off by, of each eye's turn, rad.
const NOISE_RAD: f64 = 2e-5;
/// A quantile of the squared distance of three normal numbers: 99.9 %.
const INSIDE: f64 = 16.27;

/// Calibrated after twelve minutes; what `known` says of when.
fn calibrated(known: CalibratedAt) -> Arc<Rig> {
    let mut rig = Rig::clone(&default_rig());
    rig.eyes.calibrated_at = known;
    Arc::new(rig)
}

fn after_twelve_minutes() -> Arc<Rig> {
    calibrated(CalibratedAt { cameras_s: Some(CALIBRATED_S), mount_s: Some(CALIBRATED_S) })
}

/// How far the right eye has turned between two times.
fn turn(from_s: f64, to_s: f64) -> Vector3<f64> {
    let grown = |t_s: f64| -(-t_s / TIME_CONSTANT_S).exp_m1();
    Vector3::y() * END_RAD * (grown(to_s) - grown(from_s))
}

/// Normal numbers, always the same ones: a linear congruence and twelve uniform ones a piece.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    move || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Twenty minutes from switching on, a look every half a minute.
fn watched(rig: &Arc<Rig>) -> Vec<Sample> {
    let (model, mut noise) = (RobotModel::nominal(rig.clone()), noise());
    let (first_s, seen) = (5.0, SeenUnder::default());
    let look = |k: u32| {
        let at_s = first_s + 30.0 * f64::from(k);
        let mut off = || Vector3::new(noise(), noise(), noise()) * NOISE_RAD;
        let turns_rad = [off(), turn(first_s, at_s) + off()];
        let table = errors(&model, &rig.home(), turns_rad, &seen, &seen).expect("the table is seen");
        let look = Look {
            turns_rad,
            sigmas_rad: [NOISE_RAD; 2],
            against_rad: turns_rad[1] - turns_rad[0],
            knows_which: true,
            table,
            epipolar_px: None,
            references: vec![],
            along_share: 1.0,
        };
        Sample { at_s, look }
    };
    (0..40).map(look).collect()
}

/// As the window does it: a session of what was watched, a search in it, and all that was found.
fn corrected(rig: &Arc<Rig>) -> RobotModel {
    let table = log_of(rig, &rig.home(), &watched(rig)).expect("long enough");
    let manifest = Manifest::of_rig(rig.name.as_str(), Timestamp::UNIX_EPOCH);
    let session = Session { localizations: Some(table), ..Session::new(manifest) };
    let sessions = [("watched".to_owned(), session.clone())];
    let rows = Measurements::of_sessions(&sessions, rig).expect("usable");
    let finding = find(&rows, &Options::default(), &Unattended).expect("can be looked at");
    let added = with(
        &RigModel::nominal(rig),
        rig,
        (&finding, &[session]),
        &finding.addable(),
        true,
        Timestamp::UNIX_EPOCH,
    );
    let added = added.unwrap_or_else(|error| panic!("{error}: {}", finding.sentence));
    RobotModel::new(rig.clone(), Arc::new(added)).expect("fits")
}

/// The same for eyes of which it is known that they were calibrated after twelve minutes; searched once.
fn corrected_after_twelve_minutes() -> &'static RobotModel {
    static CORRECTED: OnceLock<RobotModel> = OnceLock::new();
    CORRECTED.get_or_init(|| corrected(&after_twelve_minutes()))
}

/// Where stereo with the calibration puts a place at a time.
fn seen(rig: &Rig, at: Point<Robot>, t_s: f64) -> Point<LeftCamera> {
    let cameras = &rig.eyes.cameras;
    let in_left = rig.robot_from_left(&rig.home()).inverse() * at;
    let in_right = cameras.right_from_left * in_left;
    let turned = Rotation3::new(turn(CALIBRATED_S, t_s)) * in_right.coords.coords;
    let left = cameras.left.project(&in_left.coords.coords).expect("in view");
    cameras.triangulate(left, cameras.right.project(&turned).expect("in view")).expect("in front")
}

/// How far off places on the table come out at a time: the largest error (m), and how many lie in what is stated.
fn judged(model: &RobotModel, t_s: f64) -> (f64, usize) {
    let (rig, under) = (model.rig(), SeenUnder { t_secs: Some(t_s), ..SeenUnder::default() });
    let mut result = (0.0_f64, 0);
    for [x, y] in [[0.25, -0.2], [0.4, 0.0], [0.4, 0.2], [0.55, 0.15]] {
        let at = Point::new(x, y, rig.table.height_m);
        let put = model.place(&seen(rig, at, t_s), &Matrix3::zeros(), &rig.home(), &under).expect("a place");
        let error = put.point.coords.coords - at.coords.coords;
        let distance = put.covariance_m2.try_inverse().map(|inverse| error.dot(&(inverse * error)));
        result.0 = result.0.max(error.norm());
        result.1 += usize::from(distance.is_some_and(|distance| distance <= INSIDE));
    }
    result
}

#[test]
fn what_is_found_in_watching_warm_calibrated_eyes_takes_the_drift_off_at_every_time() {
    let corrected = corrected_after_twelve_minutes();
    assert!(!corrected.is_nominal());
    let nominal = RobotModel::nominal(corrected.rig().clone());
    assert!(judged(&nominal, 0.0).0 > 0.01, "cold eyes need it");
    assert!(judged(&nominal, CALIBRATED_S).0 < 1e-6, "the calibration holds when it was made");
    for t_s in [5.0, 60.0, 240.0, CALIBRATED_S, 1150.0] {
        let (error_m, inside) = judged(corrected, t_s);
        assert!(error_m < 2e-3 && inside == 4, "{t_s} s: {error_m} m, {inside} inside");
    }
    let effects = corrected.added().effects().iter();
    assert!(effects.clone().all(|effect| effect.reference_s == CALIBRATED_S), "{effects:?}");
}

#[test]
fn as_from_cold_eyes_the_same_would_count_twice_what_the_calibration_holds() {
    let corrected = corrected(&calibrated(CalibratedAt::default()));
    let (error_m, _) = judged(&corrected, CALIBRATED_S);
    assert!(error_m > 0.01, "{error_m} m: that is what is warned of where the time is not known");
}

#[test]
fn with_another_calibration_the_same_law_goes_on_from_there() {
    let corrected = corrected_after_twelve_minutes();
    let mut described = Rig::clone(corrected.rig());
    described.eyes.calibrated_at = CalibratedAt::default();
    // Made when they were cold: the right eye stands where it stood then.
    let mut cameras = described.eyes.cameras;
    let turned = nalgebra::UnitQuaternion::from_scaled_axis(turn(CALIBRATED_S, 0.0));
    cameras.right_from_left.isometry = turned * cameras.right_from_left.isometry;
    let accepted = |calibrated_at: CalibratedAt| {
        let effects = Some(corrected.added());
        let accepted = Accepted { cameras: Some(&cameras), calibrated_at, effects, ..Accepted::default() };
        let model = accepted.robot_model(&described).expect("it fits");
        assert!(accepted.is_in(&model, &described));
        model
    };
    let cold = accepted(CalibratedAt { cameras_s: Some(0.0), mount_s: Some(0.0) });
    let put = |model: &RobotModel, t_s: f64| {
        let at = Point::new(0.4, 0.0, model.rig().table.height_m);
        let rig = model.rig();
        let in_left = rig.robot_from_left(&rig.home()).inverse() * at;
        let in_right = described.eyes.cameras.right_from_left * in_left;
        let now = Rotation3::new(turn(CALIBRATED_S, t_s)) * in_right.coords.coords;
        let left = cameras.left.project(&in_left.coords.coords).expect("in view");
        let seen =
            cameras.triangulate(left, cameras.right.project(&now).expect("in view")).expect("in front");
        let under = SeenUnder { t_secs: Some(t_s), ..SeenUnder::default() };
        let put = model.place(&seen, &Matrix3::zeros(), &rig.home(), &under).expect("a place");
        put.point.distance_m(&at)
    };
    for t_s in [0.0, 120.0, CALIBRATED_S] {
        assert!(put(&cold, t_s) < 2e-3, "{t_s} s: {} m", put(&cold, t_s));
    }
    // Where nobody knows how warm they were, nothing is corrected.
    assert!(accepted(CalibratedAt::default()).is_nominal());
    assert!(put(&accepted(CalibratedAt::default()), CALIBRATED_S) > 0.01);
}
