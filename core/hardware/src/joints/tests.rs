//! Conversions, limits and guards, without a bus.

use std::sync::Arc;

use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::limiter::Limiter;
use super::servo_unit::ServoUnit;
use super::*;

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

#[test]
fn the_floor_refuses_what_goes_below_and_lets_out_who_is_there() {
    let rig = nico();
    let floor = FloorGuard::new(&rig);
    let home = rig.home();
    let arm = rig.arm("right").expect("it has one");
    let lowest_m = |posture: &Posture| floor.lowest(posture).expect("it has parts").1;
    // Some postures of the right arm above and below the floor.
    let mut above = None;
    let mut below = vec![];
    for i in 0..400u32 {
        let part = |k: u32| f64::from((i * (2 * k + 3) * 7919 + k * 104_729) % 1000) / 1000.0;
        let angles: Vec<f64> = (0u32..)
            .zip(&arm.joints)
            .map(|(k, j)| rig.limits(*j).lower_rad + part(k) * rig.limits(*j).span_rad())
            .collect();
        let posture = home.with(&arm.joints, &angles);
        if lowest_m(&posture) > rig.gate.floor_m + 0.05 {
            above = Some(posture)
        } else if lowest_m(&posture) < rig.gate.floor_m - 0.02 {
            below.push(posture)
        }
    }
    let above = above.expect("one above");
    let deep = below.iter().min_by(|a, b| lowest_m(a).total_cmp(&lowest_m(b))).expect("one below").clone();
    let refused = floor.check(&above, &deep).expect_err("below the floor");
    assert!(refused.to_string().contains("mm below the floor"), "{refused}");
    // From below upward, in small steps, and never further down.
    let up = deep.toward(&above, 0.02);
    let (first, second) = if lowest_m(&up) > lowest_m(&deep) { (&deep, &up) } else { (&up, &deep) };
    assert!(floor.check(first, second).is_ok());
    assert!(lowest_m(second) < lowest_m(first) + 1e-3 || floor.check(second, first).is_err());
    assert!(floor.check(&above, &above).is_ok());
    // For an arm that is known to stand higher the floor lies lower, by no more than is believed of one.
    let shift = FloorShift::default();
    let shifted = FloorGuard::new(&rig).shifted_by(shift.clone());
    let is_hand = |posture: &&Posture| {
        let shifted_m = floor.lowest_shifted(posture, 0.01).expect("it has parts").1;
        (shifted_m - (lowest_m(posture) - 0.01)).abs() < 1e-9
    };
    let little = below.iter().filter(is_hand).max_by(|a, b| lowest_m(a).total_cmp(&lowest_m(b)));
    let little = little.expect("a hand below");
    let down_m = rig.gate.floor_m - lowest_m(little);
    assert!(down_m < FARTHEST_FLOOR_M - 1e-3, "the least deep one is {down_m} below");
    for (up_m, passes) in
        [(0.0, false), (-down_m - 1e-3, true), (1e-3 - down_m, false), (-1.0, false), (f64::NAN, false)]
    {
        shift.set_m(up_m);
        assert_eq!(shifted.check(&above, little).is_ok(), passes, "{up_m}");
    }
    assert!(floor.check(&above, little).is_err(), "another guard is not shifted");
    // A hand that is known to stand lower is stopped earlier; an arm behind it is looked at as it is described.
    shift.set_m(down_m);
    let (floor_m, up_from) = (rig.gate.floor_m, |i: u32| little.toward(&above, f64::from(i) / 200.0));
    let stands_low = |posture: &Posture| (floor_m..floor_m + down_m - 1e-3).contains(&lowest_m(posture));
    let just_above = (1..200).map(up_from).find(|posture| is_hand(&posture) && stands_low(posture));
    let just_above = just_above.expect("a hand a little above the floor");
    assert!(floor.check(&above, &just_above).is_ok() && shifted.check(&above, &just_above).is_err());
    let arm_is_lowest = below.iter().find(|posture| !is_hand(posture)).expect("an arm below");
    shift.set_m(-FARTHEST_FLOOR_M);
    let refused = shifted.check(&above, arm_is_lowest);
    assert!(refused.is_err(), "of the arm behind the hand nobody knows how far it is off");
}
