//! Laws of eyes that are not as warm as when they were calibrated: places drawn with what they usually turn lie where
//! the uncertainty says, and where they are as warm, or nobody knows it, nothing is added.

use nalgebra::Matrix3;
use plumbline_model::Point;
use plumbline_model::robot::{CalibratedAt, Rig, default_rig};

use super::drawn::{effect, model, share_inside};
use super::laws::Noise;
use super::*;
use crate::rig_model::ModelEffect;

/// Twenty-five minutes: warm.
const CALIBRATED_S: f64 = 1500.0;

fn calibrated(cameras_s: Option<f64>, mount_s: Option<f64>) -> Arc<Rig> {
    let mut rig = Rig::clone(&default_rig());
    rig.eyes.calibrated_at = CalibratedAt { cameras_s, mount_s };
    Arc::new(rig)
}

fn under(t_secs: Option<f64>) -> SeenUnder {
    SeenUnder { t_secs, ..SeenUnder::default() }
}

/// Of a place half a meter away, one standard deviation in the worst direction, m.
fn sigma_m(model: &RobotModel, t_secs: Option<f64>) -> f64 {
    let at = Point::new(0.02, 0.03, 0.5);
    let place = model.place(&at, &Matrix3::zeros(), &model.rig().home(), &under(t_secs));
    place.expect("a place").sigma_m()
}

#[test]
fn the_true_place_lies_inside_the_stated_95_percent_however_warm_the_eyes_are() {
    let rig = calibrated(Some(CALIBRATED_S), Some(CALIBRATED_S));
    let here = RobotModel::nominal(rig.clone());
    for t_secs in [0.0, 240.0, 600.0] {
        let since = warm_share(t_secs) - warm_share(CALIBRATED_S);
        let mut noise = Noise(11);
        let share = share_inside(&here, &under(Some(t_secs)), || {
            let mut turned = || 0.01 * since * noise.normal();
            let yaw = effect("eye-yaw", "right", None, vec![turned()]);
            let both = vec![0.0, 0.0, 0.0, turned(), turned(), turned()];
            model(&rig, vec![yaw, effect("camera-mount", "eyes", None, both)])
        });
        assert!((0.90..=0.99).contains(&share), "{t_secs} s: {share}");
    }
}

#[test]
fn cold_eyes_make_places_uncertain_by_centimeters_and_warm_ones_by_nothing() {
    let warm = RobotModel::nominal(calibrated(Some(CALIBRATED_S), Some(CALIBRATED_S)));
    // 10 mrad between the rays at half a meter, with eyes 7 cm apart, are 0.5² · 0.01 / 0.07 m.
    assert!((0.03..0.045).contains(&sigma_m(&warm, Some(0.0))), "{}", sigma_m(&warm, Some(0.0)));
    assert!(sigma_m(&warm, Some(300.0)) < 0.6 * sigma_m(&warm, Some(0.0)));
    assert_eq!(sigma_m(&warm, Some(CALIBRATED_S)), 0.0);
    let cold = RobotModel::nominal(calibrated(Some(60.0), Some(60.0)));
    assert!(sigma_m(&cold, Some(60.0)) == 0.0 && sigma_m(&cold, Some(CALIBRATED_S)) > 0.02);
}

#[test]
fn what_is_not_known_is_not_guessed_and_what_was_watched_is_not_added_again() {
    let at = |cameras_s, mount_s| RobotModel::nominal(calibrated(cameras_s, mount_s));
    assert_eq!(sigma_m(&at(Some(CALIBRATED_S), Some(CALIBRATED_S)), None), 0.0);
    assert_eq!(sigma_m(&at(None, None), Some(0.0)), 0.0);
    // Each by its own calibration: both eyes together move a place across the ray only, 5 mm at half a meter.
    let mount_only = sigma_m(&at(None, Some(CALIBRATED_S)), Some(0.0));
    assert!((0.003..0.006).contains(&mount_only), "{mount_only}");
    let watched =
        ModelEffect { reference_s: CALIBRATED_S, ..effect("eye-yaw", "right", Some(300.0), vec![0.006]) };
    let watched = model(&calibrated(Some(CALIBRATED_S), Some(CALIBRATED_S)), vec![watched]);
    assert_eq!(watched.turned_since(&under(Some(0.0))), Turned::default());
    assert!(sigma_m(&watched, Some(0.0)) < 1e-6);
    // What was seen is seen, whatever an effect in force says.
    let seen = SeenUnder { apart_rad: 0.006, ..under(Some(0.0)) };
    assert_eq!(watched.turned_since(&seen), Turned { apart_rad: 0.006, together_rad: 0.0 });
}
