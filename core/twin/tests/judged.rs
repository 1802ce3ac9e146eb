//! The scenarios miss by as much as they shall.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_twin::{Scenario, judging};

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("valid"))
}

/// Mean and largest error of touches, m.
fn touch_error(scenario: &str) -> (f64, f64) {
    let scenario = Scenario::built_in(scenario).expect("valid");
    let touches = judging::touches(&rig(), &scenario, 1, 7, 3).expect("a world");
    let errors: Vec<f64> = touches.iter().filter_map(|touch| Some(touch.error_m?.norm())).collect();
    assert!(errors.len() * 10 >= touches.len() * 9, "{} of {} touched", errors.len(), touches.len());
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    println!("{}: {} touches, mean {:.1} mm", scenario.name, errors.len(), mean * 1e3);
    (mean, errors.into_iter().fold(0.0, f64::max))
}

#[test]
fn the_robot_as_described_touches_where_it_is_sent() {
    let (mean_m, most_m) = touch_error("perfect");
    // A round fingertip touches beside its tip when it is inclined.
    assert!(mean_m < 1e-3 && most_m < 4e-3, "{mean_m} m, {most_m} m");
}

#[test]
fn the_laboratory_misses_by_a_centimeter() {
    let (mean_m, most_m) = touch_error("lab");
    assert!((9e-3..14e-3).contains(&mean_m), "{mean_m} m");
    assert!(most_m < 3e-2, "{most_m} m");
}

#[test]
fn touches_repeat_with_the_same_seed() {
    let scenario = Scenario::built_in("lab").expect("valid");
    let once = judging::touches(&rig(), &scenario, 1, 2, 2).expect("a world");
    let again = judging::touches(&rig(), &scenario, 1, 2, 2).expect("a world");
    assert_eq!(once, again);
}

#[test]
fn places_drift_by_six_centimeters_in_ten_minutes_at_the_far_corner_and_less_nearby() {
    let corners = [Vector3::new(0.5, 0.4, 0.05), Vector3::new(0.5, -0.4, 0.05), Vector3::new(0.2, 0.0, 0.05)];
    let at = |scenario: &str, minutes: f64| -> Vec<f64> {
        let scenario = Scenario::built_in(scenario).expect("valid");
        let drift = judging::drift(&rig(), &scenario, &corners, minutes).expect("a world");
        drift.iter().map(|drift| drift.drift_m.norm()).collect()
    };
    let drift_m = at("lab", 10.0);
    println!("lab, 10 min: {drift_m:?} m");
    assert!((0.045..0.075).contains(&drift_m[0]) && (0.045..0.075).contains(&drift_m[1]), "{drift_m:?}");
    assert!(drift_m[2] < 0.2 * drift_m[0], "{drift_m:?}");
    // It comes late: most of it after the first two minutes.
    assert!(at("lab", 2.0)[0] < 0.3 * drift_m[0]);
    assert!(at("perfect", 10.0).iter().all(|drift_m| *drift_m < 1e-12));
}
