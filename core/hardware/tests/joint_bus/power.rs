//! The power of servos is cut and comes back: nothing moves by itself, and all is said.

use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{BusTiming, Item, open_port};
use plumbline_hardware::joints::{ArmDriver, ArmOptions, Motion, MoveOutcome, Refusal};
use plumbline_model::robot::Rig;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::chain::PtyChain;
use super::world::{await_state, has_torque, id_of, joint, limp, nico, ready, run, take_hold, turn};

/// Random cuts in the suite; the figure of SAFETY.md is taken with 1000.
const CUTS: usize = 24;

/// What the arm does when its power is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Doing {
    Stopped,
    Holding,
    Moving,
    Connecting,
}

const ALL: [Doing; 4] = [Doing::Stopped, Doing::Holding, Doing::Moving, Doing::Connecting];

fn positions(chain: &PtyChain) -> Vec<f64> {
    let mut chain = chain.lock();
    chain.advance();
    chain.servos.values().map(|servo| servo.position).collect()
}

fn moved(before: &[f64], after: &[f64]) -> f64 {
    before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn connect(rig: &std::sync::Arc<Rig>, chain: &PtyChain) -> Option<ArmDriver> {
    let port = open_port(&chain.path, rig.bus.baud).expect("the pseudo-terminal is there");
    ArmDriver::connect(port, rig.clone(), ArmOptions::default()).ok()
}

/// Three chains at a time and whatever else the machine does: servos that are threads get no
/// processor for a while, which no servo on a wire does.
fn connect_patiently(rig: &std::sync::Arc<Rig>, chain: &PtyChain) -> Option<ArmDriver> {
    let port = open_port(&chain.path, rig.bus.baud).expect("the pseudo-terminal is there");
    let timing = BusTiming { answer_margin: Duration::from_millis(30), ..BusTiming::default() };
    let options = ArmOptions {
        timing,
        cycle_deadline: Duration::from_millis(50),
        silence: Duration::from_millis(400),
        ..ArmOptions::default()
    };
    ArmDriver::connect(port, rig.clone(), options).ok()
}

/// Cuts the power of all servos (or of one) for a random time while the arm does something, lets it
/// sink meanwhile, and looks what happens when the power is back. Returns by how many ticks anything
/// moved then, and how many servos have torque.
fn cut(rig: &std::sync::Arc<Rig>, doing: Doing, random: &mut StdRng) -> (f64, usize) {
    let chain = PtyChain::of(rig);
    let pan = joint(rig, "head_z");
    let one = (random.random_range(0..4) == 0).then(|| id_of(rig, pan));
    let lasts = Duration::from_secs_f64(10f64.powf(random.random_range(-2.0..-0.2)));
    let pause = Duration::from_secs_f64(random.random_range(0.0..0.06));
    for servo in chain.lock().servos.values_mut() {
        servo.sinks_ticks_s = random.random_range(-900.0..900.0);
        // Nothing holds a limp arm before the test begins.
        servo.blocked = true;
    }
    let connecting = (doing == Doing::Connecting).then(|| {
        std::thread::scope(|scope| {
            let driver = scope.spawn(|| connect_patiently(rig, &chain));
            std::thread::sleep(pause);
            cut_for(&chain, one, lasts);
            driver.join().expect("no panic")
        })
    });
    let driver = match connecting {
        Some(driver) => driver,
        None => {
            let driver = connect_patiently(rig, &chain).expect("all answer");
            take_hold(&driver);
            chain.lock().servos.values_mut().for_each(|servo| servo.blocked = false);
            match doing {
                Doing::Stopped => driver.stop_switch().press(),
                Doing::Moving => {
                    driver.start_move(turn(pan, 0.9, 0.4)).expect("queued");
                    await_state(&driver, "moving", |s| matches!(s.motion, Motion::Moving { .. }));
                }
                _ => {}
            }
            std::thread::sleep(pause);
            cut_for(&chain, one, lasts);
            Some(driver)
        }
    };
    let after = look(&chain, one);
    drop(driver);
    after
}

fn cut_for(chain: &PtyChain, one: Option<u8>, lasts: Duration) {
    let switch = |on| match one {
        Some(id) => chain.power_of(id, on),
        None => chain.power(on),
    };
    chain.lock().servos.values_mut().for_each(|servo| servo.blocked = false);
    switch(false);
    std::thread::sleep(lasts);
    // Down by now; what moves from here on moves by itself.
    chain.lock().servos.values_mut().for_each(|servo| {
        servo.sinks_ticks_s = 0.0;
        servo.switched_on = 0;
    });
    switch(true);
}

fn look(chain: &PtyChain, one: Option<u8>) -> (f64, usize) {
    let only = |all: Vec<f64>| match one {
        // The others hold, or end their move within a step.
        Some(id) => vec![chain.lock().servos[&id].position],
        None => all,
    };
    let before = only(positions(chain));
    std::thread::sleep(Duration::from_millis(250));
    let after = only(positions(chain));
    let on = chain
        .lock()
        .servos
        .iter()
        .filter(|(id, s)| s.switched_on > 0 && one.is_none_or(|one| one == **id))
        .count();
    (moved(&before, &after), on)
}

/// `PLUMBLINE_POWER_CUTS=1000` for the figure.
#[test]
fn after_a_random_cut_of_the_power_nothing_moves_by_itself() {
    let cuts = std::env::var("PLUMBLINE_POWER_CUTS").ok().and_then(|n| n.parse().ok()).unwrap_or(CUTS);
    let rig = nico();
    let began = Instant::now();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let worst = std::thread::scope(|scope| {
        let work = || {
            let mut found = vec![];
            loop {
                let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                if i >= cuts {
                    return found;
                }
                let doing = ALL[i % ALL.len()];
                let mut random = StdRng::seed_from_u64(i as u64);
                let (ticks, on) = cut(&rig, doing, &mut random);
                if ticks > 0.0 || on > 0 {
                    found.push((i, doing, ticks, on));
                }
            }
        };
        let threads: Vec<_> = (0..3).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("no panic")).collect::<Vec<_>>()
    });
    eprintln!(
        "{cuts} random cuts of the power (stopped, holding, moving, connecting) in {:.0} s: {} with motion or torque",
        began.elapsed().as_secs_f64(),
        worst.len()
    );
    assert!(worst.is_empty(), "cut, situation, ticks moved, servos with torque: {worst:?}");
}

#[test]
fn the_arm_stays_where_it_sank_to_until_it_is_taken_hold_of() {
    for stopped in [false, true] {
        let (rig, chain, driver) = ready();
        let elbow = joint(&rig, "r_elbow_y");
        let servo = id_of(&rig, elbow);
        if stopped {
            driver.stop_switch().press();
            await_state(&driver, "stopped", |s| s.stopped);
        }
        chain.lock().servos.get_mut(&servo).expect("there").sinks_ticks_s = -500.0;
        chain.power(false);
        let cut_at = Instant::now();
        let state = await_state(&driver, "the loss is said", |s| s.motion == Motion::Unknown);
        assert!(cut_at.elapsed() < Duration::from_secs(1), "{:?}", cut_at.elapsed());
        assert!(state.warnings[0].contains("power seems to be off"), "{:?}", state.warnings);
        assert_eq!(state.unknown.len(), rig.servos.len());
        std::thread::sleep(Duration::from_millis(500));
        let told = chain.lock().told.len();
        chain.power(true);
        chain.lock().servos.get_mut(&servo).expect("there").sinks_ticks_s = 0.0;
        let there = chain.lock().servos[&servo].position;
        let state = await_state(&driver, "they answer", |s| s.unknown.is_empty());
        assert_eq!(state.motion, Motion::Limp);
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(chain.lock().servos[&servo].position, there);
        assert!(!has_torque(&chain, servo));
        assert_eq!(chain.lock().told.len(), told, "no goal is written");
        driver.stop_switch().release();
        let refused = run(&driver, elbow, 1.6, 0.3);
        assert!(matches!(refused, MoveOutcome::Refused(Refusal::LetGo { .. })), "{refused:?}");
        driver.engage(&[]).expect("queued");
        await_state(&driver, "taken hold of", |s| {
            s.joints.iter().all(|j| j.torque_on == Some(true) && !j.let_go)
        });
        assert!((chain.lock().servos[&servo].position - there).abs() <= 1.0, "held where it sank to");
        let begin = driver.state().measured.clone().expect("read");
        assert!(matches!(run(&driver, elbow, begin[elbow] + 0.1, 0.3), MoveOutcome::Arrived { .. }));
    }
}

/// A servo takes no goal beyond the limits in its memory and keeps the one that it had: with torque it would go there.
#[test]
fn a_joint_that_sank_beyond_its_limits_never_goes_to_an_older_goal() {
    for (beyond, is_held) in [(20_u16, true), (300, false)] {
        let (rig, chain, driver) = limp();
        let elbow = joint(&rig, "r_elbow_y");
        let servo = id_of(&rig, elbow);
        let there = {
            let mut chain = chain.lock();
            let fake = chain.servos.get_mut(&servo).expect("there");
            let there = fake.position.round() as u16;
            // It was somewhere else before it sank.
            fake.set(Item::GoalPosition, there + 500);
            fake.set(Item::CwAngleLimit, there + beyond);
            fake.set(Item::CcwAngleLimit, there + 1000);
            fake.angle_limits = Some([there + beyond, there + 1000]);
            there
        };
        driver.engage(&[]).expect("queued");
        let all_others = |s: &plumbline_hardware::joints::JointState| {
            s.joints
                .iter()
                .enumerate()
                .all(|(i, j)| rig.servos[i].id == servo && !is_held || j.torque_on == Some(true))
        };
        await_state(&driver, "the others hold", all_others);
        std::thread::sleep(Duration::from_millis(500));
        assert_eq!(has_torque(&chain, servo), is_held, "{beyond} ticks beyond");
        let moved = chain.lock().servos[&servo].position - f64::from(there);
        let wanted = if is_held { f64::from(beyond) } else { 0.0 };
        assert!((moved - wanted).abs() <= 1.0, "{beyond} ticks beyond: it moved by {moved}");
        if !is_held {
            let state = await_state(&driver, "it is refused", |s| s.refusal.is_some());
            let (_, refusal) = state.refusal.clone().expect("it is refused");
            assert!(refusal.to_string().contains("turn it back by hand"), "{refusal:?}");
        }
    }
}

#[test]
fn a_servo_that_started_anew_between_two_cycles_is_limp_and_said_so() {
    let (rig, chain, driver) = ready();
    let finger = joint(&rig, "r_thumb_x");
    let servo = id_of(&rig, finger);
    chain.power_of(servo, false);
    chain.power_of(servo, true);
    await_state(&driver, "told", |s| {
        let problem = s.of(finger).and_then(|r| r.problem.as_ref());
        problem.is_some_and(|problem| problem.contains("lost its torque"))
    });
    std::thread::sleep(Duration::from_millis(100));
    assert!(!has_torque(&chain, servo), "it is left off");
    driver.engage(&[finger]).expect("queued");
    await_state(&driver, "on again", |s| s.of(finger).is_some_and(|r| r.problem.is_none()));
    assert!(has_torque(&chain, servo));
}

#[test]
fn what_is_not_known_forbids_motion_of_its_chain() {
    let (rig, chain, driver) = ready();
    let (shoulder, elbow) = (joint(&rig, "r_shoulder_y"), joint(&rig, "r_elbow_y"));
    let begin = driver.state().measured.clone().expect("read");
    chain.power_of(id_of(&rig, shoulder), false);
    let state = await_state(&driver, "it is not known", |s| !s.knows(shoulder));
    assert!(state.knows(elbow));
    let refused = run(&driver, elbow, begin[elbow] + 0.1, 0.3);
    let MoveOutcome::Refused(refusal @ Refusal::UnknownInChain { .. }) = refused else {
        panic!("{refused:?}")
    };
    assert!(refusal.to_string().contains("Right shoulder swing"), "{refusal}");
    assert!(driver.check(&turn(elbow, begin[elbow] + 0.1, 0.3)).is_err(), "nor is it shown as possible");
    let other = joint(&rig, "l_elbow_y");
    assert!(matches!(run(&driver, other, begin[other] + 0.1, 0.5), MoveOutcome::Arrived { .. }));
}

#[test]
fn a_chain_that_becomes_unknown_on_the_way_is_held() {
    let (rig, chain, driver) = ready();
    let (shoulder, elbow) = (joint(&rig, "r_shoulder_y"), joint(&rig, "r_elbow_y"));
    let begin = driver.state().measured.clone().expect("read");
    let id = driver.start_move(turn(elbow, begin[elbow] + 0.5, 0.1)).expect("queued");
    std::thread::sleep(Duration::from_millis(300));
    chain.power_of(id_of(&rig, shoulder), false);
    let outcome = driver.wait_for(id, Duration::from_secs(2)).expect("it ends");
    assert!(format!("{outcome:?}").contains("UnknownInChain"), "{outcome:?}");
}

#[test]
fn a_silent_servo_does_not_make_its_neighbors_blamed() {
    let (rig, chain, driver) = ready();
    let (first, elbow) = (rig.servos[0].joint, joint(&rig, "r_elbow_y"));
    let begin = driver.state().measured.clone().expect("read");
    let id = driver.start_move(turn(elbow, begin[elbow] + 0.5, 0.2)).expect("queued");
    std::thread::sleep(Duration::from_millis(200));
    // The first of the bulk read: all behind it wait for it.
    chain.power_of(id_of(&rig, first), false);
    let outcome = driver.wait_for(id, Duration::from_secs(8)).expect("it ends");
    assert!(matches!(outcome, MoveOutcome::Arrived { .. }), "{outcome:?}");
    let state = driver.state();
    assert_eq!(&*state.unknown, [first]);
    let blamed = |j: &&plumbline_hardware::joints::JointReading| j.problem.is_some();
    assert_eq!(state.joints.iter().filter(blamed).count(), 1, "{:?}", state.joints);
}

#[test]
fn after_an_overload_shutdown_the_joint_says_so_and_gets_its_force_back() {
    for torque_on in [0, 1] {
        let (rig, chain, driver) = ready();
        let elbow = joint(&rig, "r_elbow_y");
        let servo = id_of(&rig, elbow);
        let begin = driver.state().measured.clone().expect("read");
        {
            let mut chain = chain.lock();
            let servo = chain.servos.get_mut(&servo).expect("there");
            servo.set(Item::TorqueLimit, 0);
            servo.set(Item::TorqueEnable, torque_on);
        }
        let state = await_state(&driver, "told", |s| s.of(elbow).is_some_and(|r| r.problem.is_some()));
        let problem = state.of(elbow).and_then(|r| r.problem.clone()).expect("told");
        assert!(problem.contains("overload") && problem.contains("switch torque on"), "{problem}");
        let refused = run(&driver, elbow, begin[elbow] + 0.1, 0.3);
        assert!(
            matches!(refused, MoveOutcome::Refused(Refusal::NoForce { .. } | Refusal::Limp { .. })),
            "{refused:?}"
        );
        chain.lock().servos.get_mut(&servo).expect("there").position -= 100.0;
        let sank_to = chain.lock().servos[&servo].position;
        driver.engage(&[elbow]).expect("queued");
        await_state(&driver, "force again", |s| s.of(elbow).is_some_and(|r| r.problem.is_none()));
        assert_eq!(chain.lock().servos[&servo].get(Item::TorqueLimit), 1000, "what its memory allows");
        assert!((chain.lock().servos[&servo].position - sank_to).abs() <= 1.0, "held where it is");
        let now = driver.state().measured.clone().expect("read");
        assert!(matches!(run(&driver, elbow, now[elbow] + 0.1, 0.3), MoveOutcome::Arrived { .. }));
    }
}

#[test]
fn connecting_writes_nothing_and_slow_answers_are_shortened_when_asked() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    let driver = connect(&rig, &chain).expect("all answer");
    std::thread::sleep(Duration::from_millis(100));
    assert!(chain.lock().written.is_empty(), "{:?}", chain.lock().written);
    let state = driver.state();
    let has_register = rig.servos.iter().filter(|s| s.model.starts_with("MX")).count();
    assert_eq!(state.slow_answers, has_register);
    assert!(state.warnings.iter().any(|w| w.contains("Shorten answers")), "{:?}", state.warnings);
    driver.shorten_answers().expect("queued");
    await_state(&driver, "short", |s| s.slow_answers == 0);
    let delay = chain.lock().servos[&id_of(&rig, joint(&rig, "head_z"))].get(Item::ReturnDelayTime);
    assert_eq!(delay, 5, "10 µs in units of 2");
}

#[test]
fn who_answers_later_is_identified_before_it_is_used() {
    let rig = nico();
    let elbow = joint(&rig, "r_elbow_y");
    let servo = id_of(&rig, elbow);
    for wrong in [false, true] {
        let mut servos = super::chain::Chain::of(&rig);
        let missing = servos.servos.remove(&servo).expect("there");
        let chain = PtyChain::start(servos);
        let driver = connect(&rig, &chain).expect("the others answer");
        let model = if wrong { "MX-28" } else { "MX-64" };
        let mut late = super::chain::FakeServo::new(model, servo, missing.position);
        // It holds already: that was not the operator's doing here.
        late.set(Item::TorqueEnable, 1);
        late.set(Item::GoalPosition, 3000);
        late.blocked = true;
        chain.lock().servos.insert(servo, late);
        if wrong {
            await_state(&driver, "it is named", |s| {
                s.of(elbow)
                    .and_then(|r| r.problem.as_ref())
                    .is_some_and(|p| p.contains("says MX-64, but it is"))
            });
            driver.engage(&[elbow]).expect("queued");
        } else {
            await_state(&driver, "it is known", |s| s.knows(elbow));
            let refused = run(&driver, elbow, 1.6, 0.3);
            assert!(matches!(refused, MoveOutcome::Refused(Refusal::LetGo { .. })), "{refused:?}");
        }
        std::thread::sleep(Duration::from_millis(200));
        assert!(chain.lock().written.is_empty(), "{:?}", chain.lock().written);
    }
}

#[test]
fn who_a_later_scan_finds_wrong_or_doubled_is_used_no_more() {
    let (rig, chain, driver) = ready();
    let elbow = joint(&rig, "r_elbow_y");
    let servo = id_of(&rig, elbow);
    chain.fault(servo, super::chain::Fault::Twice, u32::MAX);
    driver.scan_again(plumbline_hardware::dynamixel::ScanRange::Expected).expect("queued");
    let state = await_state(&driver, "it is barred", |s| !s.knows(elbow));
    assert!(state.of(elbow).and_then(|r| r.problem.as_ref()).is_some_and(|p| p.contains("two servos")));
    let written = chain.lock().written.len();
    driver.engage(&[elbow]).expect("queued");
    let refused = run(&driver, elbow, 1.6, 0.3);
    assert!(matches!(refused, MoveOutcome::Refused(Refusal::Barred { .. })), "{refused:?}");
    assert_eq!(chain.lock().written.len(), written);
}
