//! Goal, limit and angle around the seam of a turn, where the fingers rest; and lines that somebody
//! floods.

use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::Item;
use plumbline_hardware::joints::{HoldReason, Motion, MoveOutcome};

use super::world::{await_state, id_of, joint, ready, run, turn};

/// A finger that rests at the first tick is pushed over it: the servo reads the last one. That is no
/// turn of its motor, and holding it there would make it one.
#[test]
fn a_finger_pushed_over_the_seam_is_not_sent_around() {
    let (rig, chain, driver) = ready();
    let finger = joint(&rig, "r_indexfinger_x");
    let servo = id_of(&rig, finger);
    let limits = rig.limits(finger);
    assert!(matches!(run(&driver, finger, limits.upper_rad, 0.5), MoveOutcome::Arrived { .. }));
    assert_eq!(chain.lock().servos[&servo].get(Item::GoalPosition), 0, "it rests at the seam");
    {
        let mut chain = chain.lock();
        let servo = chain.servos.get_mut(&servo).expect("there");
        (servo.blocked, servo.position) = (true, 4093.0);
    }
    let tick_rad = std::f64::consts::TAU / 4096.0 / 2.444819;
    let state = await_state(&driver, "it reads beyond the seam", |s| {
        s.of(finger)
            .and_then(|r| r.angle_rad)
            .is_some_and(|angle| (angle - limits.upper_rad).abs() > 0.5 * tick_rad)
    });
    let angle_rad = state.of(finger).and_then(|r| r.angle_rad).expect("known");
    assert!((angle_rad - limits.upper_rad - 3.0 * tick_rad).abs() < 1e-6, "{angle_rad}");
    let told = chain.lock().told.len();
    driver.stop_switch().press();
    await_state(&driver, "holding", |s| s.motion == Motion::Holding(HoldReason::Stop));
    std::thread::sleep(Duration::from_millis(100));
    for told in &chain.lock().told[told..] {
        for (id, goal, ..) in &told.goals {
            assert!(*id != servo || *goal == 0, "sent to {goal}, a whole turn away");
        }
    }
    driver.stop_switch().release();
    // Back on this side it moves as before.
    {
        let mut chain = chain.lock();
        let servo = chain.servos.get_mut(&servo).expect("there");
        (servo.blocked, servo.position) = (false, 1.0);
    }
    await_state(&driver, "back", |s| {
        s.of(finger).and_then(|r| r.angle_rad).is_some_and(|angle| angle <= limits.upper_rad)
    });
    assert!(matches!(run(&driver, finger, limits.upper_rad - 0.3, 0.3), MoveOutcome::Arrived { .. }));
    assert!(matches!(run(&driver, finger, limits.upper_rad, 0.3), MoveOutcome::Arrived { .. }));
    let outcome = run(&driver, finger, limits.upper_rad + 0.05, 0.3);
    assert!(matches!(outcome, MoveOutcome::Refused(_)), "{outcome:?}");
}

#[test]
fn a_flood_on_the_line_does_not_outlive_the_stop_and_is_said() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    driver.start_move(turn(pan, 0.8, 0.2)).expect("queued");
    await_state(&driver, "moving", |s| matches!(s.motion, Motion::Moving { .. }));
    chain.lock().flood = true;
    let flooded = Instant::now();
    await_state(&driver, "it is said", |s| s.warnings.iter().any(|w| w.contains("no servo should send")));
    let said = flooded.elapsed();
    let pressed = Instant::now();
    driver.stop_switch().press();
    await_state(&driver, "stopped", |s| !matches!(s.motion, Motion::Moving { .. }) && s.stopped);
    let stopped = pressed.elapsed();
    eprintln!("a flood is said after {said:?}, and stopped after {stopped:?}");
    assert!(stopped < Duration::from_secs(1), "{stopped:?}");
    let there = chain.lock().servos[&id_of(&rig, pan)].position;
    std::thread::sleep(Duration::from_millis(300));
    let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
    assert!((chain.lock().servos[&id_of(&rig, pan)].position - there).abs() <= step_ticks);
}
