//! Answers that are late, garbled, cut, missing, echoed, or of somebody else; lines that break.

use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{FaultKind, Item, open_port};
use plumbline_hardware::joints::{
    ArmDriver, ArmOptions, HoldReason, JointState, Motion, MoveOutcome, Refusal, Unheard,
};

use super::chain::{Fault, PtyChain};
use super::world::{await_state, id_of, joint, nico, ready, run, turn};

/// A servo read by the bulk read and one read singly, each with a few broken answers: counted,
/// repeated, and the arm works on.
#[test]
fn every_kind_of_broken_answer_is_counted_and_repeated() {
    for (fault, kind) in [
        (Fault::Silent, FaultKind::Missing),
        (Fault::Cut, FaultKind::Cut),
        (Fault::Checksum, FaultKind::Checksum),
        (Fault::OtherId(99), FaultKind::WrongId),
        (Fault::Garbled, FaultKind::Garbled),
        (Fault::Complains(0x10), FaultKind::Refused),
    ] {
        let (rig, chain, driver) = ready();
        let finger = id_of(&rig, joint(&rig, "r_thumb_x"));
        let elbow = id_of(&rig, joint(&rig, "r_elbow_y"));
        let retries = driver.state().bus.counts.retries;
        chain.fault(finger, fault.clone(), 2);
        chain.fault(elbow, fault.clone(), 1);
        await_state(&driver, "counted faults", |s| {
            let of = |id, kind| s.bus.counts.by_servo.get(&id).map_or(0, |c| c.of(kind));
            // Cut in the middle of a bulk read, a packet runs into the next one: its sum is wrong.
            let cut = if kind == FaultKind::Cut { of(elbow, FaultKind::Checksum) } else { 0 };
            of(finger, kind) >= 1 && of(elbow, kind) + cut >= 1 && s.bus.counts.retries > retries
        });
        let pan = joint(&rig, "head_z");
        assert!(matches!(run(&driver, pan, 0.1, 0.5), MoveOutcome::Arrived { .. }), "{fault:?}");
        await_state(&driver, "all is well again", |s| s.joints.iter().all(|j| j.problem.is_none()));
    }
}

/// A servo that takes hold unheard is nobody's to command: that is said before a move is refused for it.
#[test]
fn who_could_not_be_taken_hold_of_is_said() {
    let (rig, chain, driver) = ready();
    let elbow = joint(&rig, "r_elbow_y");
    let at = rig.servos.iter().position(|servo| servo.joint == elbow).expect("there");
    driver.relax(&[]).expect("queued");
    await_state(&driver, "limp", |s| s.joints.iter().all(|j| j.torque_on == Some(false)));
    chain.fault(id_of(&rig, elbow), Fault::Silent, u32::MAX);
    driver.engage(&[]).expect("queued");
    let others = |s: &JointState| {
        s.joints.iter().enumerate().filter(|(i, _)| *i != at).all(|(_, j)| j.torque_on == Some(true))
    };
    await_state(&driver, "the others hold", others);
    chain.lock().servos.get_mut(&id_of(&rig, elbow)).expect("there").fault = None;
    let state =
        await_state(&driver, "it is heard", |s| s.joints[at].torque_on.is_some() && s.unknown.is_empty());
    assert!(state.joints[at].let_go && state.joints[at].problem.is_some(), "{:?}", state.joints[at]);
    let refused = run(&driver, elbow, 1.6, 0.3);
    assert!(matches!(refused, MoveOutcome::Refused(Refusal::LetGo { .. })), "{refused:?}");
    driver.engage(&[]).expect("queued");
    await_state(&driver, "held", |s| s.joints.iter().all(|j| j.torque_on == Some(true) && !j.let_go));
    // What holds already keeps its goal: under a load it stands below it, and would creep with every press.
    let goals = || driver.state().joints.iter().map(|j| j.goal_rad).collect::<Vec<_>>();
    let (before, told) = (goals(), chain.lock().told.len());
    driver.engage(&[]).expect("queued");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!((goals(), chain.lock().told.len()), (before, told));
}

#[test]
fn a_late_answer_is_not_taken_for_another_servos() {
    let (rig, chain, driver) = ready();
    let finger = id_of(&rig, joint(&rig, "r_thumb_x"));
    chain.fault(finger, Fault::Late(Duration::from_millis(15)), 1);
    let state = await_state(&driver, "a late answer", |s| {
        s.bus.counts.by_servo.get(&finger).is_some_and(|c| c.of(FaultKind::Late) >= 1)
    });
    for (servo, reading) in rig.servos.iter().zip(state.joints.iter()) {
        let true_rad = servo.joint_rad(chain.lock().servos[&servo.id].motor_rad());
        assert!((reading.angle_rad.expect("read") - true_rad).abs() < 2e-3, "{}", servo.title);
    }
}

#[test]
fn an_adapter_that_echoes_is_noticed_and_does_no_harm() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    chain.lock().echo = true;
    let port = open_port(&chain.path, rig.bus.baud).expect("there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("all answer");
    assert!(driver.scan().is_complete(), "{:?}", driver.scan().problems());
    driver.engage(&[]).expect("queued");
    await_state(&driver, "torque on", |s| s.joints.iter().all(|j| j.torque_on == Some(true)));
    let pan = joint(&rig, "head_z");
    assert!(matches!(run(&driver, pan, 0.1, 0.5), MoveOutcome::Arrived { .. }));
    let counts = driver.state().bus.counts.clone();
    assert!(counts.echoes > 100, "{counts:?}");
}

/// On a slow line (a busy machine, an adapter that collects bytes) a cycle is over before everybody
/// behind the silent servo was asked: its turn comes nevertheless, and nobody else is blamed.
#[test]
fn a_silent_servo_is_named_on_a_slow_line_too() {
    for pause in [Duration::from_millis(2), Duration::from_millis(5)] {
        let (rig, chain, driver) = ready();
        let elbow = joint(&rig, "r_elbow_y");
        for servo in rig.servos.iter().filter(|servo| servo.joint != elbow) {
            chain.fault(servo.id, Fault::Late(pause), u32::MAX);
        }
        chain.fault(id_of(&rig, elbow), Fault::Silent, u32::MAX);
        let cut = Instant::now();
        await_state(&driver, "an elbow that is not known", |s| s.unknown.contains(&elbow));
        let took = cut.elapsed();
        assert!(took < Duration::from_millis(1500), "{pause:?} per answer: {took:?}");
        let state = await_state(&driver, "words for it", |s| {
            let elbow = s.joints.iter().find(|j| j.joint == elbow).expect("a joint");
            elbow.problem.as_ref().is_some_and(|p| p.contains("does not answer and is left out"))
        });
        assert!(state.joints.iter().all(|j| j.joint == elbow || !j.let_go), "nobody else is blamed");
        await_state(&driver, "readings of everybody else", |s| s.unknown.to_vec() == [elbow]);
    }
}

/// A computer that is too busy hears answers when their time is over: they tell that power and cable are
/// there, so nobody is let go, and nobody is sent to look at cables.
#[test]
fn a_servo_that_answers_too_late_is_not_taken_for_a_silent_one() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    chain.fault(id_of(&rig, pan), Fault::Late(Duration::from_millis(70)), u32::MAX);
    let state = await_state(&driver, "a head that is not known", |s| s.unknown.contains(&pan));
    assert!(state.late.contains(&pan), "{:?}", state.late);
    let reading = state.of(pan).expect("a joint");
    assert!(!reading.let_go, "nobody let it go");
    let problem = reading.problem.as_ref().expect("told");
    assert!(problem.contains("computer") && !problem.contains("cable"), "{problem}");
    let outcome = run(&driver, pan, 0.1, 0.5);
    let MoveOutcome::Refused(refusal @ Refusal::Unknown { why: Unheard::TooBusy, .. }) = outcome else {
        panic!("{outcome:?}")
    };
    let words = refusal.to_string();
    assert!(words.contains("the computer was too busy") && !words.contains("cable"), "{words}");
    // Nobody has to take hold of it anew.
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").fault = None;
    await_state(&driver, "it is heard again", |s| s.joints.iter().all(|j| j.problem.is_none()));
    assert!(matches!(run(&driver, pan, 0.1, 0.5), MoveOutcome::Arrived { .. }));
}

#[test]
fn a_moving_servo_that_falls_silent_holds_the_arm_and_says_so() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let id = driver.start_move(turn(pan, 0.8, 0.2)).expect("queued");
    std::thread::sleep(Duration::from_millis(300));
    chain.fault(id_of(&rig, pan), Fault::Silent, u32::MAX);
    let outcome = driver.wait_for(id, Duration::from_secs(3)).expect("it ends");
    let MoveOutcome::Held(HoldReason::NoAnswer { servo, .. }) = outcome else { panic!("{outcome:?}") };
    assert_eq!(servo, id_of(&rig, pan));
    let state = await_state(&driver, "it is left out", |s| {
        s.of(pan).and_then(|r| r.problem.as_ref()).is_some_and(|p| p.contains("left out"))
    });
    assert!(state.of(pan).and_then(|r| r.age) > Some(Duration::from_millis(50)));
    // The others go on, complete cycles too, though it was the first of the bulk read.
    let elbow = joint(&rig, "r_elbow_y");
    let begin = state.measured.as_ref().expect("known")[elbow];
    assert!(matches!(run(&driver, elbow, begin + 0.1, 0.5), MoveOutcome::Arrived { .. }));
    let refused = run(&driver, pan, 0.0, 0.5);
    assert!(
        matches!(refused, MoveOutcome::Refused(Refusal::Unknown { why: Unheard::Silent, .. })),
        "{refused:?}"
    );
    // It comes back: left alone until it is taken hold of.
    let told = chain.lock().written.len();
    chain.lock().servos.get_mut(&id_of(&rig, pan)).expect("there").fault = None;
    let state = await_state(&driver, "it answers again", |s| s.knows(pan));
    let problem = state.of(pan).and_then(|r| r.problem.clone()).expect("told");
    assert!(problem.contains("switch torque on"), "{problem}");
    assert!(matches!(run(&driver, pan, 0.0, 0.5), MoveOutcome::Refused(Refusal::LetGo { .. })));
    assert_eq!(chain.lock().written.len(), told, "nothing is written meanwhile");
    driver.engage(&[pan]).expect("queued");
    await_state(&driver, "it is taken hold of", |s| s.of(pan).is_some_and(|r| r.problem.is_none()));
    assert!(matches!(run(&driver, pan, 0.0, 0.5), MoveOutcome::Arrived { .. }));
}

#[test]
fn an_overloaded_servo_holds_the_arm() {
    let (rig, chain, driver) = ready();
    let pan = joint(&rig, "head_z");
    let servo = id_of(&rig, pan);
    let id = driver.start_move(turn(pan, 1.2, 0.1)).expect("queued");
    std::thread::sleep(Duration::from_millis(200));
    chain.fault(servo, Fault::Complains(0x20), u32::MAX);
    let outcome = driver.wait_for(id, Duration::from_secs(3)).expect("it ends");
    let MoveOutcome::Held(HoldReason::Alarm { words, .. }) = outcome else { panic!("{outcome:?}") };
    assert!(words.contains("overloaded"), "{words}");
    let problem = driver.state().of(pan).and_then(|r| r.problem.clone()).expect("told");
    assert!(problem.contains("overloaded"), "{problem}");
    chain.lock().servos.get_mut(&servo).expect("there").fault = None;
    await_state(&driver, "it is well", |s| s.of(pan).is_some_and(|r| r.problem.is_none()));
    let other = joint(&rig, "r_elbow_y");
    let begin = driver.state().measured.as_ref().expect("read")[other];
    assert!(matches!(run(&driver, other, begin + 0.1, 0.5), MoveOutcome::Arrived { .. }));
}

#[test]
fn a_port_that_vanishes_is_told_and_the_arm_stays_near() {
    for mid_packet in [false, true] {
        let (rig, mut chain, driver) = ready();
        let pan = joint(&rig, "head_z");
        let id = driver.start_move(turn(pan, 1.2, 0.3)).expect("queued");
        std::thread::sleep(Duration::from_millis(500));
        if mid_packet {
            chain.lock().hang_up = true;
            std::thread::sleep(Duration::from_millis(100));
        }
        let there = chain.lock().servos[&id_of(&rig, pan)].position;
        chain.close();
        let state = await_state(&driver, "the port is gone", |s| s.gone.is_some());
        assert!(state.gone.as_ref().is_some_and(|reason| reason.contains("is gone")), "{:?}", state.gone);
        assert!(matches!(state.motion, Motion::Holding(HoldReason::Gone(_))), "{:?}", state.motion);
        let outcome = driver.wait_for(id, Duration::from_secs(1));
        assert!(matches!(outcome, Some(MoveOutcome::Held(HoldReason::Gone(_)))), "{outcome:?}");
        assert!(matches!(run(&driver, pan, 0.0, 0.3), MoveOutcome::Refused(Refusal::Gone(_))));
        let goal = f64::from(chain.lock().servos[&id_of(&rig, pan)].get(Item::GoalPosition));
        let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
        assert!((goal - there).abs() <= step_ticks + 1.0, "{} ticks ahead", goal - there);
    }
}
