//! Moves, jogging, and how fast the bus is.

use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{Item, open_port};
use plumbline_hardware::joints::{
    ArmDriver, ArmOptions, HoldReason, Motion, Move, MoveOutcome, Pace, Setpoint, SetpointKind,
};

use super::world::{assert_goals_stay_near, await_state, has_torque, id_of, joint, ready, run, turn};

#[test]
fn a_move_arrives_and_no_goal_runs_ahead_of_its_joint() {
    let (rig, chain, driver) = ready();
    let (elbow, wrist) = (joint(&rig, "r_elbow_y"), joint(&rig, "r_wrist_x"));
    let begin = driver.state().measured.clone().expect("read");
    let goals = vec![(elbow, begin[elbow] + 0.4), (wrist, 0.3)];
    let id =
        driver.start_move(Move { goals: goals.clone(), pace: Pace::SpeedFraction(0.8) }).expect("queued");
    let MoveOutcome::Arrived { residual_rad } =
        driver.wait_for(id, Duration::from_secs(10)).expect("it ends")
    else {
        panic!("{:?}", driver.state().outcomes)
    };
    assert!(residual_rad < 0.002, "{residual_rad}");
    for (joint, goal_rad) in goals {
        let servo = rig.servo_of(joint).expect("it has a servo");
        let true_rad = servo.joint_rad(chain.lock().servos[&servo.id].motor_rad());
        assert!((true_rad - goal_rad).abs() < 0.002, "{}: {true_rad}", servo.title);
    }
    assert_goals_stay_near(&rig, &chain);
    let state = driver.state();
    let other = joint(&rig, "l_elbow_y");
    let moved = state.measured.as_ref().expect("read")[other] - begin[other];
    assert!(moved.abs() < 1e-9, "the others stayed");
}

#[test]
fn a_duration_is_kept() {
    let (rig, _chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let wanted = Move { goals: vec![(pan, 0.3)], pace: Pace::Duration(Duration::from_millis(900)) };
    assert_eq!(driver.check(&wanted), Ok(Duration::from_millis(900)));
    let id = driver.start_move(wanted).expect("queued");
    let begin = Instant::now();
    let outcome = driver.wait_for(id, Duration::from_secs(5));
    assert!(matches!(outcome, Some(MoveOutcome::Arrived { .. })), "{outcome:?}");
    let took_s = begin.elapsed().as_secs_f64();
    assert!((0.85..2.0).contains(&took_s), "{took_s} s");
}

#[test]
fn a_jog_runs_while_it_is_renewed_and_stops_by_itself() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let jog = |rate| Setpoint {
        kind: SetpointKind::Velocity,
        joints: vec![(pan, rate)],
        valid_for: Duration::from_millis(200),
    };
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(500) {
        driver.follow(jog(0.4));
        std::thread::sleep(Duration::from_millis(30));
    }
    assert_eq!(driver.state().motion, Motion::Following);
    await_state(&driver, "the end of the jog", |s| s.motion == Motion::Holding(HoldReason::JogEnded));
    let angle_rad = driver.state().of(pan).and_then(|r| r.angle_rad).expect("read");
    assert!((0.15..0.35).contains(&angle_rad), "{angle_rad} rad after half a second and 0.2 s at 0.4 rad/s");
    // Released at once.
    driver.follow(jog(-0.4));
    await_state(&driver, "jogging", |s| s.motion == Motion::Following);
    driver.end_following();
    let released = Instant::now();
    await_state(&driver, "the end of the jog", |s| s.motion == Motion::Holding(HoldReason::JogEnded));
    assert!(released.elapsed() < Duration::from_millis(100));
    assert_goals_stay_near(&rig, &chain);
}

#[test]
fn a_newer_move_takes_the_place_of_the_one_before_without_a_jump() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let first = driver.start_move(turn(pan, 0.8, 0.5)).expect("queued");
    std::thread::sleep(Duration::from_millis(400));
    let outcome = run(&driver, pan, 0.0, 0.5);
    assert!(matches!(outcome, MoveOutcome::Arrived { .. }), "{outcome:?}");
    assert_eq!(driver.state().outcome(first), Some(&MoveOutcome::Replaced));
    assert_goals_stay_near(&rig, &chain);
}

#[test]
fn angles_are_interpolated_at_the_time_of_an_image() {
    let (rig, _chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    driver.start_move(turn(pan, 0.6, 0.5)).expect("queued");
    std::thread::sleep(Duration::from_millis(500));
    // Between two readings lies what lies between their angles.
    let state = driver.state();
    let reading = state.of(pan).expect("it has a servo");
    let (at, angle_rad) = (reading.read_at.expect("read"), reading.angle_rad.expect("read"));
    let next = await_state(&driver, "another reading", |s| s.of(pan).and_then(|r| r.read_at) > Some(at));
    let next = next.of(pan).expect("it has a servo");
    let (next_at, next_rad) = (next.read_at.expect("read"), next.angle_rad.expect("read"));
    std::thread::sleep(Duration::from_millis(50));
    let middle = driver.posture_at(at + next_at.duration_since(at) / 2).expect("covered");
    let low_high = (angle_rad.min(next_rad) - 1e-9, angle_rad.max(next_rad) + 1e-9);
    assert!(middle[pan] >= low_high.0 && middle[pan] <= low_high.1, "{} in {low_high:?}", middle[pan]);
    assert_eq!(driver.posture_at(Instant::now() + Duration::from_secs(1)), None, "not yet known");
    assert_eq!(driver.posture_at(at - Duration::from_secs(60)), None, "no longer known");
}

#[test]
fn fifty_complete_cycles_per_second_on_the_wire() {
    let (rig, _chain, driver) = ready();
    std::thread::sleep(Duration::from_millis(1300));
    let state = driver.state();
    let cycle = state.bus.last_cycle;
    assert!(cycle.answers as usize >= rig.servos.len(), "every servo answered: {cycle:?}");
    let rate = |return_delay_s, turnaround_s| 1.0 / cycle.seconds(rig.bus.baud, return_delay_s, turnaround_s);
    let on_wire = rate(10e-6, 0.0);
    eprintln!(
        "{} servos: {} bytes out, {} in, {} answers in {} conversations; {:.0} cycles/s on the wire at 1 Mbaud \
         with 10 µs return delay, {:.0} with the factory's 500 µs, {:.0} with 10 µs and 1 ms of USB per conversation; \
         {:?} complete cycles/s here, paced at 62.5",
        rig.servos.len(),
        cycle.bytes_out,
        cycle.bytes_in,
        cycle.answers,
        cycle.turnarounds,
        on_wire,
        rate(500e-6, 0.0),
        rate(10e-6, 1e-3),
        state.bus.complete_per_s
    );
    assert!(on_wire >= 50.0 && rate(500e-6, 0.0) >= 50.0, "{on_wire}");
    assert!(state.bus.complete_per_s.expect("a second has passed") > 5.0, "{:?}", state.bus);
    eprintln!("faults on the way: {}", state.bus.counts.faults);
}

#[test]
fn relaxing_is_explicit_and_a_dropped_driver_holds() {
    let (rig, chain, driver) = ready();
    let (pan, elbow) = (joint(&rig, "head_z"), joint(&rig, "r_elbow_y"));
    driver.relax(&[elbow]).expect("queued");
    await_state(&driver, "a limp elbow", |s| s.of(elbow).is_some_and(|r| r.torque_on == Some(false)));
    std::thread::sleep(Duration::from_millis(100));
    assert!(!has_torque(&chain, id_of(&rig, elbow)), "no goal switches it on again");
    assert!(has_torque(&chain, id_of(&rig, pan)));
    driver.start_move(turn(pan, 0.8, 0.3)).expect("queued");
    std::thread::sleep(Duration::from_millis(400));
    drop(driver);
    let there = chain.lock().servos[&id_of(&rig, pan)].position;
    std::thread::sleep(Duration::from_millis(300));
    let later = chain.lock().servos[&id_of(&rig, pan)].position;
    let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
    assert!((later - there).abs() <= step_ticks, "moved on by {} ticks", later - there);
    assert!(has_torque(&chain, id_of(&rig, pan)));
}

#[test]
fn connecting_again_leaves_a_loaded_joint_where_it_was_told_to_be() {
    let (rig, chain, driver) = ready();
    drop(driver);
    // It hangs a little below its goal, as loaded joints do.
    let elbow = id_of(&rig, joint(&rig, "r_elbow_y"));
    let goal = chain.lock().servos[&elbow].get(Item::GoalPosition);
    {
        let mut chain = chain.lock();
        let servo = chain.servos.get_mut(&elbow).expect("there");
        servo.blocked = true;
        servo.position -= 20.0;
    }
    let port = open_port(&chain.path, rig.bus.baud).expect("free again");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("all answer");
    await_state(&driver, "a few cycles", |s| s.bus.cycles > 5);
    assert_eq!(chain.lock().servos[&elbow].get(Item::GoalPosition), goal, "else it would sink a little more");
}
