//! STOP: how soon the hold is on the wire, and that it latches.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{ArmDriver, HoldReason, Motion, MoveOutcome, Refusal};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::chain::PtyChain;
use super::world::{assert_goals_stay_near, await_state, id_of, joint, ready, run, turn};

/// Presses in the suite; `PLUMBLINE_STOP_TRIALS=200` for the figure.
const TRIALS: usize = 20;

/// Presses while a joint moves; time until goals that equal the present angles are read at the
/// other end of the line.
fn stop_once(rig: &Rig, chain: &PtyChain, driver: &ArmDriver, pan: JointIndex, pause: Duration) -> Duration {
    let here = driver.state().of(pan).and_then(|r| r.angle_rad).expect("read");
    let goal_rad = if here > 0.0 { -0.8 } else { 0.8 };
    let id = driver.start_move(turn(pan, goal_rad, 0.5)).expect("queued");
    await_state(driver, "moving", |s| matches!(s.motion, Motion::Moving { fraction, .. } if fraction > 0.2));
    std::thread::sleep(pause);
    let pressed = Instant::now();
    driver.stop_switch().press();
    assert_eq!(driver.wait_for(id, Duration::from_secs(8)), Some(MoveOutcome::Held(HoldReason::Stop)));
    let servo = id_of(rig, pan);
    let end = Instant::now() + Duration::from_secs(8);
    let latency = loop {
        std::thread::sleep(Duration::from_millis(60));
        let chain = chain.lock();
        // Moving, the goal is another in every packet; the hold is the last word.
        let last = chain.told.iter().rev().find_map(|told| {
            let goal = told.goals.iter().find(|(id, ..)| *id == servo)?;
            Some((told.at, *goal))
        });
        let (at, (_, held, _, reported)) = last.expect("goals were sent");
        // Without a processor for a while its angle is too old to be held at: it is read anew first.
        if at >= pressed {
            assert!(reported.contains(&held), "held at {held}, where it had told {reported:?}");
            break at.duration_since(pressed);
        }
        assert!(Instant::now() < end, "no hold was sent");
    };
    let stood = chain.lock().servos[&servo].position;
    std::thread::sleep(Duration::from_millis(60));
    assert!((chain.lock().servos[&servo].position - stood).abs() <= 1.0, "it stands");
    driver.stop_switch().release();
    latency
}

/// How long it takes is printed, with no trial left out; what the machine does beside it is in there.
#[test]
fn the_hold_is_on_the_wire_after_every_press() {
    let trials = std::env::var("PLUMBLINE_STOP_TRIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(TRIALS);
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let mut latencies: Vec<Duration> = (0..trials)
        // Somewhere else in the cycle every time.
        .map(|i| stop_once(&rig, &chain, &driver, pan, Duration::from_micros((i as u64 * 2_617) % 16_000)))
        .collect();
    latencies.sort();
    let ms = |share: f64| latencies[((latencies.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    eprintln!(
        "stop to hold on the wire over {trials} trials: median {:.2} ms, 90 % {:.2} ms, 99 % {:.2} ms, worst {:.2} ms",
        ms(0.5),
        ms(0.9),
        ms(0.99),
        ms(1.0)
    );
    assert!(ms(1.0) <= 1000.0, "{latencies:?}");
    assert_goals_stay_near(&rig, &chain);
}

#[test]
fn the_stop_latches_until_it_is_released() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    driver.stop_switch().press();
    await_state(&driver, "holding", |s| s.motion == Motion::Holding(HoldReason::Stop) && s.stopped);
    assert_eq!(run(&driver, pan, 0.3, 0.3), MoveOutcome::Refused(Refusal::Stopped));
    let before = chain.lock().servos[&id_of(&rig, pan)].position;
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(chain.lock().servos[&id_of(&rig, pan)].position, before);
    assert!(super::world::has_torque(&chain, id_of(&rig, pan)), "it keeps its torque");
    driver.stop_switch().release();
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(chain.lock().servos[&id_of(&rig, pan)].position, before, "releasing moves nothing");
    assert!(matches!(run(&driver, pan, 0.3, 0.3), MoveOutcome::Arrived { .. }));
}

/// A hold is at an angle that the servo itself had just told, so that it is not moved back to where
/// it was some time ago.
#[test]
fn the_stop_interrupts_the_wait_for_a_servo_that_is_silent() {
    let (rig, chain, driver) = ready();
    let (pan, finger) = (joint(&rig, "head_z"), joint(&rig, "r_thumb_x"));
    driver.start_move(turn(pan, 0.8, 0.3)).expect("queued");
    await_state(&driver, "moving", |s| matches!(s.motion, Motion::Moving { fraction, .. } if fraction > 0.2));
    chain.fault(id_of(&rig, finger), super::chain::Fault::Silent, u32::MAX);
    std::thread::sleep(Duration::from_millis(30));
    let pressed = Instant::now();
    driver.stop_switch().press();
    await_state(&driver, "holding", |s| s.motion == Motion::Holding(HoldReason::Stop));
    let pan = id_of(&rig, pan);
    let end = Instant::now() + Duration::from_secs(8);
    let (latency, held) = loop {
        // What was sent before the press may still be read after it: the hold is the last word.
        let last = chain.lock().told.iter().rev().find_map(|told| {
            let goal = told.goals.iter().find(|(id, ..)| *id == pan)?;
            Some((told.at, *goal))
        });
        if let Some((at, (_, goal, _, reported))) = last.filter(|(at, _)| *at > pressed)
            && reported.contains(&goal)
        {
            break (at.duration_since(pressed), goal);
        }
        assert!(Instant::now() < end, "no hold at an angle that the servo told: {last:?}");
        std::thread::sleep(Duration::from_millis(1));
    };
    eprintln!("with a silent servo: {:.2} ms", latency.as_secs_f64() * 1e3);
    let stood = chain.lock().servos[&pan].position;
    std::thread::sleep(Duration::from_millis(300));
    let chain = chain.lock();
    let rests = chain.servos[&pan].position;
    assert_eq!(rests.round() as u16, held, "it stands where it is held");
    let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
    assert!((rests - stood).abs() <= step_ticks, "moved on by {}", rests - stood);
    assert!(chain.told.iter().all(|told| told.at <= pressed + latency), "nothing is said after the hold");
}

/// How far above where it was read the elbow is held that STOP meets on its way from rest, and how far it has sunk half a
/// second later, ticks. Above is where its hand is higher.
fn stopped_elbow(hangs_ticks: f64, way_rad: f64, until: f64) -> (f64, f64) {
    let (rig, chain, driver) = ready();
    let elbow = joint(&rig, "r_elbow_y");
    let id = id_of(&rig, elbow);
    // Where it begins, its hand is as high as it gets: further on it is clear which way is up.
    let home = driver.state().of(elbow).and_then(|r| r.angle_rad).expect("read");
    assert!(matches!(run(&driver, elbow, home + 0.6, 0.5), MoveOutcome::Arrived { .. }));
    let palm = rig.description.find_link("right_palm_center").expect("of this robot");
    let height_m = |posture: &Posture| rig.description.forward(posture).all()[palm.0].translation.z;
    let at = driver.state().measured.clone().expect("read");
    let servo = rig.servo_of(elbow).expect("it has one");
    let motor = (servo.motor_rad(at[elbow] + 0.01) - servo.motor_rad(at[elbow])).signum();
    let up = motor * (height_m(&at.with(&[elbow], &[at[elbow] + 0.01])) - height_m(&at)).signum();
    chain.lock().servos.get_mut(&id).expect("there").hangs_ticks = up * hangs_ticks;
    std::thread::sleep(Duration::from_millis(500));
    let here = driver.state().of(elbow).and_then(|r| r.angle_rad).expect("read");
    driver.start_move(turn(elbow, here + way_rad, 0.2)).expect("queued");
    await_state(
        &driver,
        "on its way",
        |s| matches!(s.motion, Motion::Moving { fraction, .. } if fraction > until),
    );
    driver.stop_switch().press();
    await_state(&driver, "holding", |s| s.motion == Motion::Holding(HoldReason::Stop));
    std::thread::sleep(Duration::from_millis(500));
    assert_goals_stay_near(&rig, &chain);
    let chain = chain.lock();
    let told =
        chain.told.iter().rev().find_map(|told| told.goals.iter().find(|(told, ..)| *told == id).copied());
    let (_, held, _, [read, _]) = told.expect("goals were sent");
    (up * (f64::from(held) - f64::from(read)), up * (f64::from(read) - chain.servos[&id].position))
}

/// 20 ticks are 1.8°: a stretched arm.
#[test]
fn a_loaded_joint_that_is_stopped_does_not_sink_by_what_it_hangs_below_its_goal() {
    for way_rad in [0.3, -0.3] {
        let (above, sank) = stopped_elbow(20.0, way_rad, 0.4);
        assert!(above > 8.0 && above <= 20.0, "{way_rad} rad: held {above} ticks above where it was");
        assert!((sank + above - 20.0).abs() <= 2.0, "{way_rad} rad: it has sunk by {sank} ticks");
    }
}

/// An arm that rested on something stood above its goal: stopped on its way up it is not sent down onto it again.
#[test]
fn a_joint_that_rested_on_something_is_not_sent_down_onto_it_again() {
    for way_rad in [0.3, -0.3] {
        let (above, _) = stopped_elbow(-20.0, way_rad, 0.4);
        assert!(above.abs() <= 1.0, "{way_rad} rad: held {above} ticks above where it was");
    }
}

/// What keeps a joint farther from its goal than its weight does is not pressed against after a stop.
#[test]
fn a_joint_that_pressed_against_something_is_held_where_it_was_read() {
    let (above, _) = stopped_elbow(35.0, 0.3, 0.4);
    assert!(above.abs() <= 1.0, "held {above} ticks above where it was");
}

/// Far from where it rested nothing is known of how it hangs.
#[test]
fn how_a_joint_hangs_is_forgotten_far_from_where_it_rested() {
    // By then it has come 0.9 rad of the 1.2 within which something is known: a quarter of the 20 ticks, and a tick.
    let (above, _) = stopped_elbow(20.0, -1.2, 0.8);
    assert!(above.abs() <= 6.0, "held {above} ticks above where it was");
}
