//! Gates and watchdogs: when the arm holds by itself.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use plumbline_hardware::dynamixel::Item;
use plumbline_hardware::joints::{
    ArmOptions, Guard, Heartbeat, HoldReason, JointState, Motion, MoveOutcome, Refusal, Setpoint,
    SetpointKind,
};

use plumbline_model::robot::{JointIndex, Posture};

use super::world::{assert_goals_stay_near, await_state, id_of, joint, ready, ready_with, run, turn};

#[test]
fn a_hot_servo_holds_the_arm_and_a_warm_one_warns() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let set = |raw| {
        chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").set(Item::PresentTemperature, raw)
    };
    set(57);
    await_state(&driver, "a warning", |s| s.warnings.iter().any(|warning| warning.contains("57 °C")));
    let id = driver.start_move(turn(pan, 0.8, 0.3)).expect("queued");
    std::thread::sleep(Duration::from_millis(300));
    set(71);
    let outcome = driver.wait_for(id, Duration::from_secs(2)).expect("it ends");
    assert!(matches!(outcome, MoveOutcome::Held(HoldReason::Refused(Refusal::Hot { .. }))), "{outcome:?}");
    let again = run(&driver, pan, 0.0, 0.3);
    assert!(matches!(again, MoveOutcome::Refused(Refusal::Hot { .. })), "{again:?}");
}

#[test]
fn too_much_load_holds_the_arm() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let id = driver.start_move(turn(pan, 0.8, 0.2)).expect("queued");
    std::thread::sleep(Duration::from_millis(200));
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").set(Item::PresentLoad, 1024 + 1000);
    let outcome = driver.wait_for(id, Duration::from_secs(2)).expect("it ends");
    let MoveOutcome::Held(HoldReason::Heavy { load, .. }) = outcome else { panic!("{outcome:?}") };
    assert!((load - 1000.0 / 1023.0).abs() < 1e-6);
}

#[test]
fn a_blocked_joint_holds_the_arm_and_its_goal_stays_near() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").blocked = true;
    let outcome = run(&driver, pan, 0.8, 0.3);
    let MoveOutcome::Held(HoldReason::NotFollowing { joint, behind_rad, .. }) = outcome else {
        panic!("{outcome:?}")
    };
    assert_eq!(joint, pan);
    assert!(behind_rad > 0.0 && behind_rad <= rig.gate.step_rad, "{behind_rad}");
    assert_goals_stay_near(&rig, &chain);
}

/// A finger on the table pushes the hand up tick by tick, and gets hot.
#[test]
fn a_joint_that_only_creeps_holds_the_arm() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").fastest_rad_s = 0.004;
    let outcome = run(&driver, pan, 0.8, 0.3);
    let MoveOutcome::Held(HoldReason::NotFollowing { joint, since, .. }) = outcome else {
        panic!("{outcome:?}")
    };
    assert_eq!(joint, pan);
    assert!(since < Duration::from_secs(3), "{since:?}");
    assert_goals_stay_near(&rig, &chain);
}

/// Slower than it was asked to be is no reason to hold.
#[test]
fn a_joint_that_is_slow_arrives() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").fastest_rad_s = 0.12;
    let outcome = run(&driver, pan, 0.5, 0.6);
    assert!(matches!(outcome, MoveOutcome::Arrived { .. }), "{outcome:?}");
}

#[test]
fn without_a_sign_of_life_the_arm_holds() {
    let heartbeat = Heartbeat::default();
    heartbeat.beat();
    let options = ArmOptions {
        heartbeat: Some(heartbeat.clone()),
        heartbeat_timeout: Duration::from_millis(600),
        ..ArmOptions::default()
    };
    let (rig, _chain, driver) = ready_with(options);
    let pan = joint(&rig, "head_z");
    heartbeat.beat();
    let id = driver.start_move(turn(pan, 1.2, 0.2)).expect("queued");
    let outcome = driver.wait_for(id, Duration::from_secs(3)).expect("it ends");
    assert!(matches!(outcome, MoveOutcome::Held(HoldReason::NoHeartbeat(_))), "{outcome:?}");
    assert_eq!(run(&driver, pan, 0.0, 0.3), MoveOutcome::Refused(Refusal::NoHeartbeat));
    heartbeat.beat();
    driver.start_move(turn(pan, 0.0, 0.3)).expect("queued");
    await_state(&driver, "moving again", |s| matches!(s.motion, Motion::Moving { .. }));
}

#[test]
fn jogging_into_a_limit_is_told_not_clamped() {
    let (rig, chain, driver) = ready();
    let tilt = joint(&rig, "head_y");
    let limit_rad = rig.limits(tilt).upper_rad;
    assert!(matches!(run(&driver, tilt, limit_rad - 0.05, 0.5), MoveOutcome::Arrived { .. }));
    let refused = |s: &plumbline_hardware::joints::JointState| {
        matches!(&s.refusal, Some((_, Refusal::Position { .. })))
    };
    for _ in 0..40 {
        driver.follow(Setpoint {
            kind: SetpointKind::Velocity,
            joints: vec![(tilt, 0.4)],
            valid_for: Duration::from_millis(200),
        });
        std::thread::sleep(Duration::from_millis(25));
        if refused(&driver.state()) {
            break;
        }
    }
    let state = await_state(&driver, "a refusal", refused);
    assert!(state.refusal.as_ref().is_some_and(|(_, r)| r.to_string().contains("beyond its limit")));
    let servo = rig.servo_of(tilt).expect("it has a servo");
    let angle_rad = servo.joint_rad(chain.lock().servos[&servo.id].motor_rad());
    assert!(angle_rad <= limit_rad + 0.003, "{angle_rad} beyond {limit_rad}");
}

#[test]
fn setpoints_that_are_no_numbers_or_too_fast_move_nothing() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let before = chain.lock().servos[&id_of(&rig, pan)].position;
    for (value, kind) in [
        (f64::NAN, SetpointKind::Velocity),
        (f64::INFINITY, SetpointKind::Position),
        (100.0, SetpointKind::Velocity),
    ] {
        let seen = driver.state().refusal.as_ref().map(|(number, _)| *number);
        driver.follow(Setpoint { kind, joints: vec![(pan, value)], valid_for: Duration::from_millis(200) });
        await_state(&driver, "a refusal", |s| s.refusal.as_ref().map(|(number, _)| *number) > seen);
    }
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        assert!(matches!(run(&driver, pan, bad, 0.3), MoveOutcome::Refused(Refusal::NotANumber { .. })));
    }
    assert_eq!(chain.lock().servos[&id_of(&rig, pan)].position, before);
}

/// Lets everything pass (0), refuses (1), or fails (2).
struct Moody(AtomicU8);

impl Guard for Moody {
    fn check(&self, _present: &Posture, _goal: &Posture) -> Result<(), Refusal> {
        match self.0.load(Ordering::Relaxed) {
            0 => Ok(()),
            1 => Err(Refusal::Guarded("a cup is in the way".to_owned())),
            _ => panic!("a defect in a guard"),
        }
    }
}

#[test]
fn a_guard_of_the_caller_is_asked_before_and_on_the_way() {
    let guard = Arc::new(Moody(AtomicU8::new(1)));
    let (rig, chain, driver) =
        ready_with(ArmOptions { guards: vec![guard.clone()], ..ArmOptions::default() });
    let pan = joint(&rig, "head_z");
    let cup = || Refusal::Guarded("a cup is in the way".to_owned());
    assert_eq!(driver.check(&turn(pan, 0.5, 0.3)), Err(cup()));
    assert_eq!(run(&driver, pan, 0.5, 0.3), MoveOutcome::Refused(cup()));
    guard.0.store(0, Ordering::Relaxed);
    let id = driver.start_move(turn(pan, 0.8, 0.2)).expect("queued");
    std::thread::sleep(Duration::from_millis(300));
    guard.0.store(1, Ordering::Relaxed);
    let outcome = driver.wait_for(id, Duration::from_secs(2));
    assert_eq!(outcome, Some(MoveOutcome::Held(HoldReason::Refused(cup()))));
    assert_goals_stay_near(&rig, &chain);
}

/// Something that no joint may be turned into farther than it is: at this angle of this joint, rad.
struct Wall(JointIndex, Mutex<f64>);

impl Guard for Wall {
    fn check(&self, present: &Posture, goal: &Posture) -> Result<(), Refusal> {
        let at_rad = *self.1.lock().expect("not poisoned");
        match goal[self.0] > at_rad.max(present[self.0]) {
            true => Err(Refusal::Guarded("a wall is in the way".to_owned())),
            false => Ok(()),
        }
    }
}

#[test]
fn what_was_sent_into_something_comes_away_from_where_it_stands() {
    let pan = joint(&super::world::nico(), "head_z");
    let wall = Arc::new(Wall(pan, Mutex::new(1.0)));
    let (rig, chain, driver) = ready_with(ArmOptions { guards: vec![wall.clone()], ..ArmOptions::default() });
    assert!(matches!(run(&driver, pan, 0.2, 0.3), MoveOutcome::Arrived { .. }), "it stands before the wall");
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").blocked = true;
    let setpoint = Setpoint {
        kind: SetpointKind::Position,
        joints: vec![(pan, 0.4)],
        valid_for: Duration::from_secs(2),
    };
    driver.follow(setpoint);
    let sent_rad = |state: &JointState| state.commanded.as_ref().map_or(0.0, |sent| sent[pan]);
    await_state(&driver, "sent on", |state| sent_rad(state) > 0.215);
    // From now on nothing may meet: the goal stays where it was sent, and that is in the wall.
    *wall.1.lock().expect("not poisoned") = 0.205;
    let state = await_state(&driver, "refused", |state| matches!(state.motion, Motion::Holding(_)));
    assert!(sent_rad(&state) > 0.21, "{}", sent_rad(&state));
    assert!(driver.check(&turn(pan, 0.0, 0.3)).is_ok());
    let outcome = run(&driver, pan, 0.0, 0.3);
    assert!(!matches!(outcome, MoveOutcome::Refused(_)), "the way away begins where it stands: {outcome:?}");
    assert!(sent_rad(&driver.state()) < 0.205, "and its goal is out of the wall");
}

#[test]
fn a_defect_inside_is_told_and_the_arm_stays() {
    let guard = Arc::new(Moody(AtomicU8::new(0)));
    let (rig, chain, driver) =
        ready_with(ArmOptions { guards: vec![guard.clone()], ..ArmOptions::default() });
    let pan = joint(&rig, "head_z");
    driver.start_move(turn(pan, 0.8, 0.2)).expect("queued");
    std::thread::sleep(Duration::from_millis(300));
    guard.0.store(2, Ordering::Relaxed);
    let state = await_state(&driver, "told", |s| s.gone.is_some());
    assert!(state.gone.as_ref().is_some_and(|reason| reason.contains("connect again")), "{:?}", state.gone);
    assert!(driver.start_move(turn(pan, 0.0, 0.2)).is_err());
    let there = chain.lock().servos[&id_of(&rig, pan)].position;
    std::thread::sleep(Duration::from_millis(300));
    let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
    assert!((chain.lock().servos[&id_of(&rig, pan)].position - there).abs() <= step_ticks);
    assert!(super::world::has_torque(&chain, id_of(&rig, pan)));
}

#[test]
fn a_joint_that_is_read_too_seldom_is_not_moved_and_says_so() {
    let options = ArmOptions { write_window: Duration::ZERO, ..ArmOptions::default() };
    let (rig, chain, driver) = ready_with(options);
    let pan = joint(&rig, "head_z");
    let told = chain.lock().told.len();
    let outcome = run(&driver, pan, 0.5, 0.3);
    assert!(matches!(outcome, MoveOutcome::Held(HoldReason::Slow { .. })), "{outcome:?}");
    assert!(format!("{:?}", driver.state().motion).contains("Slow"));
    assert_eq!(chain.lock().told.len(), told, "no goal rests on an old angle");
}
