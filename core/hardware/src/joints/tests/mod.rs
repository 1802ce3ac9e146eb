//! Conversions, limits and guards, without a bus.

use std::sync::Arc;

use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::limiter::Limiter;
use super::servo_unit::ServoUnit;
use super::*;

mod floor;

fn nico() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

fn joint(rig: &Rig, name: &str) -> JointIndex {
    rig.description.find_joint(name).expect("a joint of the robot")
}

fn limiter(rig: &Arc<Rig>, guards: Vec<Arc<dyn Guard>>) -> Limiter {
    Limiter { rig: rig.clone(), guards }
}

fn at(pace: f64, goals: Vec<(JointIndex, f64)>) -> Move {
    Move { goals, pace: Pace::SpeedFraction(pace) }
}

#[test]
fn every_servo_has_a_table_and_its_joint_comes_back_within_a_tick() {
    let rig = nico();
    for servo in &rig.servos {
        let unit = ServoUnit::new(servo).unwrap_or_else(|| panic!("{} is not known", servo.model));
        let limits = rig.limits(servo.joint);
        for part in 0..=20 {
            let wanted = limits.lower_rad + limits.span_rad() * f64::from(part) / 20.0;
            let rounded = unit.rounded_rad(wanted).unwrap_or_else(|| panic!("{} at {wanted}", servo.title));
            // Half a tick of the motor, or a whole one where half a turn is not quite reached.
            let tick_rad = std::f64::consts::TAU / 4096.0 / servo.ratio.abs();
            assert!(
                (rounded - wanted).abs() <= 1.01 * tick_rad,
                "{}: {wanted} became {rounded}",
                servo.title
            );
        }
    }
}

#[test]
fn a_wrist_turns_by_half_and_by_a_quarter_of_its_motor() {
    let rig = nico();
    for (name, ratio) in [("r_wrist_z", 2.0), ("r_wrist_x", 4.0)] {
        let servo = rig.servo_of(joint(&rig, name)).expect("it has a servo");
        let unit = ServoUnit::new(servo).expect("known");
        let turned =
            unit.joint_rad(2048 + 1024).expect("a position") - unit.joint_rad(2048).expect("a position");
        assert!((turned.abs() - std::f64::consts::FRAC_PI_2 / ratio).abs() < 1e-9, "{name}: {turned}");
    }
}

#[test]
fn goals_beyond_limits_are_refused_with_joint_limit_and_amount() {
    let rig = nico();
    let limiter = limiter(&rig, vec![]);
    let home = rig.home();
    let elbow = joint(&rig, "r_elbow_y");
    let limits = rig.limits(elbow);
    let wanted = at(0.5, vec![(elbow, limits.upper_rad + 0.1)]);
    let Err(Refusal::Position { joint, beyond_rad, .. }) = limiter.plan(&home, &home, &wanted) else {
        panic!("not refused")
    };
    assert_eq!(joint, elbow);
    assert!((beyond_rad - 0.1).abs() < 1e-9);
    let text = limiter.plan(&home, &home, &wanted).expect_err("refused").to_string();
    assert!(text.contains("elbow") && text.contains("5.7°"), "{text}");
    for bad in [f64::NAN, f64::INFINITY] {
        let refused = limiter.plan(&home, &home, &at(0.5, vec![(elbow, bad)]));
        assert!(matches!(refused, Err(Refusal::NotANumber { .. })), "{refused:?}");
    }
    for pace in [0.0, -1.0, 1.5, f64::NAN, 1e-30, 5e-324] {
        assert!(matches!(
            limiter.plan(&home, &home, &at(pace, vec![(elbow, 1.6)])),
            Err(Refusal::NotAMove { .. })
        ));
    }
    assert!(matches!(limiter.plan(&home, &home, &at(0.5, vec![])), Err(Refusal::NotAMove { .. })));
}

#[test]
fn a_move_that_is_too_fast_is_refused_with_the_time_it_needs() {
    let rig = nico();
    let limiter = limiter(&rig, vec![]);
    let pan = joint(&rig, "head_z");
    let start = rig.description.rest();
    let wanted = |secs: f64| Move {
        goals: vec![(pan, 1.0)],
        pace: Pace::Duration(std::time::Duration::from_secs_f64(secs)),
    };
    let needed_s = 1.875 / rig.gate.speed_rad_s;
    assert!(limiter.plan(&start, &start, &wanted(needed_s * 1.01)).is_ok());
    let refused = limiter.plan(&start, &start, &wanted(needed_s * 0.9)).expect_err("too fast");
    assert!(
        matches!(refused, Refusal::Speed { .. }) && refused.to_string().contains("at least"),
        "{refused}"
    );
    let line = limiter.plan(&start, &start, &at(1.0, vec![(pan, 1.0)])).expect("allowed");
    assert!((line.duration_s - needed_s).abs() < 1e-9);
}

#[test]
fn the_head_cannot_turn_into_its_counterweights_nor_nod_into_them() {
    let rig = nico();
    let limiter = limiter(&rig, vec![]);
    let (pan, tilt) = (joint(&rig, "head_z"), joint(&rig, "head_y"));
    let down = rig.description.rest().with(&[tilt], &[-0.7]);
    let refused =
        limiter.plan(&down, &down, &at(0.3, vec![(pan, 1.2)])).expect_err("the counterweight is there");
    assert!(matches!(refused, Refusal::Coupled { .. }), "{refused}");
    let aside = rig.description.rest().with(&[pan], &[1.2]);
    assert!(matches!(
        limiter.plan(&aside, &aside, &at(0.3, vec![(tilt, -0.7)])),
        Err(Refusal::Coupled { .. })
    ));
    // On its way both ends are free, and something is in between.
    assert!(limiter.plan(&down, &down, &at(0.3, vec![(pan, 0.2)])).is_ok());
    // Somebody turned it there by hand: the way out is free.
    let stuck = rig.description.rest().with(&[pan, tilt], &[1.2, -0.7]);
    assert!(limiter.plan(&stuck, &stuck, &at(0.3, vec![(pan, 0.0)])).is_ok());
}
