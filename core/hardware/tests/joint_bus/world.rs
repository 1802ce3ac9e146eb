//! An arm to try things on.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{Item, open_port};
use plumbline_hardware::joints::{ArmDriver, ArmOptions, JointState, Move, MoveOutcome, Pace};
use plumbline_model::robot::{JointIndex, Rig};

use super::chain::PtyChain;

pub fn nico() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

pub fn joint(rig: &Rig, name: &str) -> JointIndex {
    rig.description.find_joint(name).expect("a joint of the robot")
}

pub fn id_of(rig: &Rig, joint: JointIndex) -> u8 {
    rig.servo_of(joint).expect("it has a servo").id
}

/// A limp arm at its first pose.
pub fn limp() -> (Arc<Rig>, PtyChain, ArmDriver) {
    limp_with(ArmOptions::default())
}

pub fn limp_with(options: ArmOptions) -> (Arc<Rig>, PtyChain, ArmDriver) {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    let port = open_port(&chain.path, rig.bus.baud).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), options).expect("all servos answer");
    (rig, chain, driver)
}

/// The same with torque.
pub fn ready() -> (Arc<Rig>, PtyChain, ArmDriver) {
    ready_with(ArmOptions::default())
}

pub fn ready_with(options: ArmOptions) -> (Arc<Rig>, PtyChain, ArmDriver) {
    let (rig, chain, driver) = limp_with(options);
    take_hold(&driver);
    (rig, chain, driver)
}

/// All joints get torque.
pub fn take_hold(driver: &ArmDriver) {
    let all_on = |state: &JointState| state.joints.iter().all(|j| j.torque_on == Some(true) && !j.let_go);
    // On a busy machine a servo may have to be asked again, as an operator would.
    for _ in 0..6 {
        if all_on(&driver.state()) {
            break;
        }
        driver.engage(&[]).expect("the queue is empty");
        let end = Instant::now() + Duration::from_secs(2);
        while !all_on(&driver.state()) && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
    await_state(driver, "torque on", all_on);
}

pub fn await_state(driver: &ArmDriver, what: &str, is_so: impl Fn(&JointState) -> bool) -> Arc<JointState> {
    let end = Instant::now() + Duration::from_secs(8);
    loop {
        let state = driver.state();
        if is_so(&state) {
            return state;
        }
        assert!(Instant::now() < end, "waited in vain for {what}; {:?}, {:?}", state.motion, state.refusal);
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Runs a move to its end.
pub fn run(driver: &ArmDriver, joint: JointIndex, goal_rad: f64, share: f64) -> MoveOutcome {
    let id = driver.start_move(turn(joint, goal_rad, share)).expect("the queue is empty");
    driver.wait_for(id, Duration::from_secs(15)).expect("it ends")
}

pub fn turn(joint: JointIndex, goal_rad: f64, share: f64) -> Move {
    Move { goals: vec![(joint, goal_rad)], pace: Pace::SpeedFraction(share) }
}

/// Every goal that a servo was ever sent was within one step of where it was.
pub fn assert_goals_stay_near(rig: &Rig, chain: &PtyChain) {
    let tick_rad = std::f64::consts::TAU / 4096.0;
    for told in &chain.lock().told {
        for (id, goal, _, reported) in &told.goals {
            let servo = rig.servos.iter().find(|servo| servo.id == *id).expect("in the rig");
            let ahead_rad = (f64::from(*goal) - f64::from(reported[0])).abs() * tick_rad / servo.ratio.abs();
            assert!(
                ahead_rad <= rig.gate.step_rad + tick_rad,
                "{}: a goal {ahead_rad} rad ahead of the present angle",
                servo.title
            );
        }
    }
}

pub fn has_torque(chain: &PtyChain, id: u8) -> bool {
    chain.lock().servos[&id].get(Item::TorqueEnable) == 1
}
