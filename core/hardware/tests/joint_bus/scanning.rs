//! Who is on the bus.

use plumbline_hardware::dynamixel::{Bus, BusError, BusTiming, ScanRange, open_port};
use plumbline_hardware::joints::{ArmDriver, ArmOptions, Refusal, expected_servos};

use super::chain::{Chain, FakeServo, Fault, PtyChain};
use super::world::{await_state, id_of, joint, limp, nico};

fn bus(chain: &PtyChain) -> Bus {
    let port = open_port(&chain.path, 1_000_000).expect("the pseudo-terminal is there");
    Bus::new(port, BusTiming::default())
}

#[test]
fn a_complete_bus_is_found_complete() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    let scan = bus(&chain).scan(&expected_servos(&rig), ScanRange::Expected).expect("it answers");
    assert!(scan.is_complete(), "{:?}", scan.problems());
    assert_eq!(scan.found.len(), rig.servos.len() + rig.boards.len());
    assert_eq!(scan.problems(), Vec::<String>::new());
    let status = bus(&chain).ping(19).err();
    assert_eq!(status, None, "a ping is answered");
}

#[test]
fn missing_strange_wrong_and_doubled_servos_are_told_apart() {
    let rig = nico();
    let mut servos = Chain::of(&rig);
    servos.servos.remove(&5);
    servos.servos.insert(77, FakeServo::new("MX-28", 77, 2048.0));
    servos.servos.insert(3, FakeServo::new("MX-28", 3, 2048.0));
    servos.servos.get_mut(&31).expect("there").fault = Some((Fault::Twice, 100));
    servos.servos.get_mut(&33).expect("there").fault = Some((Fault::Collision, 100));
    let chain = PtyChain::start(servos);
    let scan = bus(&chain).scan(&expected_servos(&rig), ScanRange::All).expect("it answers");
    assert_eq!(scan.missing.iter().map(|s| s.id).collect::<Vec<_>>(), [5]);
    assert_eq!(scan.unexpected.iter().map(|s| (s.id, s.model())).collect::<Vec<_>>(), [(77, Some("MX-28"))]);
    assert_eq!(scan.wrong_model.iter().map(|w| w.found.id).collect::<Vec<_>>(), [3]);
    assert_eq!(scan.duplicates_suspected, [31, 33]);
    let words = scan.problems().join("; ");
    for told in ["two servos seem to have the id 31", "Right elbow (id 5)", "should be a MX-64", "77 (MX-28"]
    {
        assert!(words.contains(told), "{told}: {words}");
    }
}

#[test]
fn a_single_broken_answer_is_noise_not_a_second_servo() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    chain.fault(3, Fault::Checksum, 1);
    let scan = bus(&chain).scan(&expected_servos(&rig), ScanRange::Expected).expect("it answers");
    assert!(scan.is_complete(), "{:?}", scan.problems());
}

#[test]
fn a_late_answer_beside_a_prompt_one_is_not_a_second_servo() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    for servo in rig.servos.iter().take(4) {
        chain.fault(servo.id, Fault::Late(std::time::Duration::from_millis(40)), 1);
    }
    let scan = bus(&chain).scan(&expected_servos(&rig), ScanRange::Expected).expect("it answers");
    assert!(scan.is_complete(), "{:?}", scan.problems());
}

#[test]
fn an_unanswered_bus_and_a_used_port_are_told_in_words() {
    let rig = nico();
    let mut servos = Chain::of(&rig);
    servos.servos.clear();
    let chain = PtyChain::start(servos);
    let port = open_port(&chain.path, 1_000_000).expect("the pseudo-terminal is there");
    let used = open_port(&chain.path, 1_000_000).err().expect("it is locked");
    assert!(matches!(used, BusError::InUse { .. }), "{used:?}");
    let silent = ArmDriver::connect(port, rig, ArmOptions::default()).err().expect("nobody answers");
    assert!(matches!(silent, BusError::Silent { .. }), "{silent:?}");
    assert!(silent.to_string().contains("power"), "{silent}");
}

#[test]
fn two_servos_with_one_id_stay_out_of_use_and_the_rest_works() {
    let rig = nico();
    let elbow = joint(&rig, "r_elbow_y");
    let chain = PtyChain::of(&rig);
    chain.fault(id_of(&rig, elbow), Fault::Twice, u32::MAX);
    let port = open_port(&chain.path, 1_000_000).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("the others answer");
    assert_eq!(driver.scan().duplicates_suspected, [id_of(&rig, elbow)]);
    driver.engage(&[]).expect("the queue is empty");
    await_state(&driver, "torque on", |s| {
        s.joints.iter().all(|j| j.torque_on == Some(true) || j.joint == elbow) && !s.knows(elbow)
    });
    let id = driver.start_move(super::world::turn(elbow, 1.6, 0.3)).expect("the queue is empty");
    let outcome = driver.wait_for(id, std::time::Duration::from_secs(2)).expect("it is refused");
    let plumbline_hardware::joints::MoveOutcome::Refused(refusal) = outcome else { panic!("{outcome:?}") };
    assert!(matches!(refusal, Refusal::Barred { .. }), "{refusal}");
    assert!(refusal.to_string().contains("two servos answer to its id"), "{refusal}");
    assert!(!super::world::has_torque(&chain, id_of(&rig, elbow)), "it was never written to");
}

#[test]
fn connecting_moves_nothing_and_reads_every_joint() {
    let (rig, chain, driver) = limp();
    let state = driver.state();
    for (servo, reading) in rig.servos.iter().zip(state.joints.iter()) {
        let true_rad = servo.joint_rad(chain.lock().servos[&servo.id].motor_rad());
        let angle_rad = reading.angle_rad.expect("it was read");
        assert!((angle_rad - true_rad).abs() < 1e-9, "{}", servo.title);
        assert_eq!(reading.temperature_c, Some(38.0));
        assert_eq!((reading.torque_on, reading.goal_rad, &reading.problem), (Some(false), None, &None));
        assert_eq!(reading.voltage_v.is_some(), servo.model == "MX-64", "{}", servo.title);
    }
    assert!(state.measured.is_some());
    std::thread::sleep(std::time::Duration::from_millis(100));
    assert!(chain.lock().told.is_empty(), "a limp servo would switch its torque on by a goal");
    let outcome = super::world::run(&driver, joint(&rig, "r_elbow_y"), 1.6, 0.3);
    let limp = plumbline_hardware::joints::MoveOutcome::Refused(Refusal::Limp {
        joint: joint(&rig, "r_elbow_y"),
        name: "Right elbow".to_owned(),
    });
    assert_eq!(outcome, limp);
}

#[test]
fn a_servo_that_is_plugged_in_later_is_found_and_used() {
    let rig = nico();
    let elbow = joint(&rig, "r_elbow_y");
    let mut servos = Chain::of(&rig);
    let missing = servos.servos.remove(&id_of(&rig, elbow)).expect("there");
    let chain = PtyChain::start(servos);
    let port = open_port(&chain.path, 1_000_000).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("the others answer");
    assert_eq!(driver.scan().missing.len(), 1);
    let problem = driver.state().of(elbow).and_then(|r| r.problem.clone()).expect("told");
    assert!(problem.contains("does not answer"), "{problem}");
    chain.lock().servos.insert(id_of(&rig, elbow), missing);
    driver.scan_again(ScanRange::Expected).expect("the queue is empty");
    await_state(&driver, "it answers", |s| {
        s.scan.is_complete() && s.of(elbow).is_some_and(|r| r.problem.is_none())
    });
}
