//! Fingers press with a limited force, never far ahead of where they are, and get their force back.

use std::process::{Command, Stdio};
use std::time::Duration;

use plumbline_hardware::dynamixel::{Instruction, Item, open_port};
use plumbline_hardware::joints::{ArmDriver, ArmOptions, Grip, GripFinger, MoveOutcome, Refusal};
use plumbline_model::robot::{JointIndex, Rig};
use rustix::process::{Pid, Signal, kill_process};

use super::chain::PtyChain;
use super::world::{
    assert_goals_stay_near, await_state, has_torque, id_of, joint, nico, ready, run, take_hold,
};

const FORCE: f64 = 0.7;
const FORCE_RAW: u16 = 716;
const FULL_RAW: u16 = 1023;

fn finger(rig: &Rig) -> (JointIndex, u8) {
    let finger = joint(rig, "r_indexfinger_x");
    (finger, id_of(rig, finger))
}

/// Half a radian toward the side on which there is more room.
fn bent_rad(rig: &Rig, finger: JointIndex) -> f64 {
    let limits = rig.limits(finger);
    if limits.upper_rad > -limits.lower_rad { 0.5 } else { -0.5 }
}

fn grip(finger: JointIndex, goal_rad: f64) -> Grip {
    with_force(finger, goal_rad, FORCE)
}

fn with_force(joint: JointIndex, goal_rad: f64, force: f64) -> Grip {
    Grip { fingers: vec![GripFinger { joint, goal_rad, force }], speed_rad_s: 1.0 }
}

fn block(chain: &PtyChain, id: u8, blocked: bool) {
    chain.lock().servos.get_mut(&id).expect("there").blocked = blocked;
}

fn limit_of(chain: &PtyChain, id: u8) -> u16 {
    chain.lock().servos[&id].get(Item::TorqueLimit)
}

#[test]
fn a_finger_that_meets_something_presses_with_a_limited_force_and_goes_on_when_it_gives_way() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    let goal_rad = bent_rad(&rig, finger);
    block(&chain, id, true);
    let before = chain.lock().written.len();
    driver.grip(grip(finger, goal_rad)).expect("queued");
    let ahead = |state: &plumbline_hardware::joints::JointState| {
        let (goal, angle) = (state.commanded.clone()?[finger], state.of(finger)?.angle_rad?);
        Some((goal - angle).abs())
    };
    let pressing = await_state(&driver, "pressing", |state| ahead(state).is_some_and(|ahead| ahead > 0.09));
    assert!(ahead(&pressing).is_some_and(|ahead| ahead <= rig.gate.step_rad), "{:?}", ahead(&pressing));
    assert_eq!(limit_of(&chain, id), FORCE_RAW);
    {
        let chain = chain.lock();
        let limit = chain.servos[&id].table.register(Item::TorqueLimit).expect("it has one").address;
        let told = &chain.written[before..];
        let is_limit = |(to, said): &(u8, Instruction)| {
            *to == id && matches!(said, Instruction::Write { address, .. } if *address == limit)
        };
        let is_goal = |(_, said): &(u8, Instruction)| matches!(said, Instruction::SyncWrite { data, .. } if data.iter().any(|(to, _)| *to == id));
        let (limited, sent) = (told.iter().position(is_limit), told.iter().position(is_goal));
        assert!(limited.is_some() && limited < sent, "the limit comes first: {limited:?}, {sent:?}");
    }
    // The arm moves meanwhile, and what is held gives way: the finger presses on.
    block(&chain, id, false);
    let shoulder = joint(&rig, "head_z");
    assert!(matches!(run(&driver, shoulder, 0.3, 0.5), MoveOutcome::Arrived { .. }));
    await_state(&driver, "the finger at its goal", |state| {
        state.of(finger).and_then(|reading| reading.angle_rad).is_some_and(|at| (at - goal_rad).abs() < 0.01)
    });
    assert_eq!(limit_of(&chain, id), FORCE_RAW, "it holds on");
    assert!(matches!(run(&driver, finger, 0.0, 0.5), MoveOutcome::Arrived { .. }));
    await_state(&driver, "its force", |state| state.of(finger).is_some_and(|r| r.force == Some(1.0)));
    assert_eq!(limit_of(&chain, id), FULL_RAW);
    assert_goals_stay_near(&rig, &chain);
}

#[test]
fn after_stop_it_presses_no_farther_and_with_no_more_force() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    let stood_rad = driver.state().measured.clone().expect("read")[finger];
    block(&chain, id, true);
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    await_state(&driver, "pressing", |state| {
        state.commanded.as_ref().is_some_and(|goals| (goals[finger] - stood_rad).abs() > 0.09)
    });
    driver.stop_switch().press();
    std::thread::sleep(Duration::from_millis(100));
    block(&chain, id, false);
    std::thread::sleep(Duration::from_millis(600));
    let state = driver.state();
    let turned_rad = state.measured.clone().expect("read")[finger] - stood_rad;
    assert!(turned_rad.abs() <= rig.gate.step_rad, "it bent on by {turned_rad} rad");
    assert_eq!(limit_of(&chain, id), FORCE_RAW);
    // Released, nothing goes on; and a grip while it is pressed is refused.
    driver.grip(grip(finger, 0.0)).expect("queued");
    await_state(&driver, "the refusal", |s| matches!(s.refusal, Some((_, Refusal::Stopped))));
    driver.stop_switch().release();
    std::thread::sleep(Duration::from_millis(300));
    let later_rad = driver.state().measured.clone().expect("read")[finger] - stood_rad;
    assert!((later_rad - turned_rad).abs() < 0.01);
}

#[test]
fn a_finger_that_lost_its_power_grips_no_more_and_hold_gives_it_the_force_of_its_own_memory() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    await_state(&driver, "closing", |state| {
        state.measured.as_ref().is_some_and(|now| now[finger].abs() > 0.2)
    });
    for on in [false, true] {
        chain.lock().servos.get_mut(&id).expect("there").power(on);
        std::thread::sleep(Duration::from_millis(500));
    }
    await_state(&driver, "limp", |s| s.of(finger).is_some_and(|r| r.torque_on == Some(false)));
    let fell = chain.lock().servos[&id].position;
    take_hold(&driver);
    std::thread::sleep(Duration::from_millis(400));
    assert!((chain.lock().servos[&id].position - fell).abs() <= 1.0, "it stays where it was taken hold of");
    assert_ne!(limit_of(&chain, id), FORCE_RAW);
    assert_goals_stay_near(&rig, &chain);
}

#[test]
fn a_limit_that_a_program_left_behind_is_lifted_by_hold() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    await_state(&driver, "the limit", |s| s.of(finger).is_some_and(|r| r.force.is_some_and(|f| f < 0.71)));
    drop(driver);
    let port = open_port(&chain.path, rig.bus.baud).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("all answer");
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(limit_of(&chain, id), FORCE_RAW, "connecting writes nothing");
    driver.engage(&[finger]).expect("queued");
    await_state(&driver, "its force", |s| s.of(finger).is_some_and(|r| r.force == Some(1.0)));
    assert_eq!(limit_of(&chain, id), FULL_RAW);
}

#[test]
fn too_much_force_or_speed_and_a_hot_finger_are_refused() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    for bad in [
        with_force(finger, 0.3, 0.95),
        with_force(finger, 0.3, f64::NAN),
        Grip { speed_rad_s: 9.0, ..grip(finger, 0.3) },
        grip(finger, f64::NAN),
        grip(finger, 9.0),
    ] {
        let before = driver.state().refusal.as_ref().map_or(0, |(number, _)| *number);
        driver.grip(bad.clone()).expect("queued");
        await_state(&driver, "the refusal", |s| {
            s.refusal.as_ref().is_some_and(|(number, _)| *number > before)
        });
        assert_eq!(limit_of(&chain, id), 1000, "{bad:?}");
    }
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    await_state(&driver, "the limit", |s| s.of(finger).is_some_and(|r| r.force.is_some_and(|f| f < 0.71)));
    chain.lock().servos.get_mut(&id).expect("there").set(Item::PresentTemperature, 75);
    await_state(&driver, "too hot", |s| matches!(s.refusal, Some((_, Refusal::Hot { .. }))));
    let state = await_state(&driver, "rest", |s| {
        let (Some(goals), Some(now)) = (&s.commanded, &s.measured) else { return false };
        (goals[finger] - now[finger]).abs() < 0.02
    });
    assert!(state.of(finger).is_some());
}

#[test]
fn a_thumb_that_does_not_take_its_limit_is_named_and_stays_where_it_is_while_the_others_close() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    let thumb = joint(&rig, "r_thumb_x");
    let thumb_id = id_of(&rig, thumb);
    chain.lock().servos.get_mut(&thumb_id).expect("there").keeps_its_limit = true;
    let stood = chain.lock().servos[&thumb_id].position;
    let goal_rad = bent_rad(&rig, finger);
    let fingers = [(finger, goal_rad), (thumb, bent_rad(&rig, thumb))];
    let fingers = fingers.map(|(joint, goal_rad)| GripFinger { joint, goal_rad, force: FORCE });
    driver.grip(Grip { fingers: fingers.to_vec(), speed_rad_s: 1.0 }).expect("queued");
    let state =
        await_state(&driver, "the refusal", |s| matches!(s.refusal, Some((_, Refusal::Force { .. }))));
    let (_, refusal) = state.refusal.as_ref().expect("refused");
    assert!(refusal.to_string().contains("does not take a limit of 70 %"), "{refusal}");
    assert!(matches!(refusal, Refusal::Force { joint, .. } if *joint == thumb), "{refusal}");
    await_state(&driver, "the finger at its goal", |state| {
        state.of(finger).and_then(|reading| reading.angle_rad).is_some_and(|at| (at - goal_rad).abs() < 0.01)
    });
    assert_eq!(limit_of(&chain, id), FORCE_RAW);
    assert!((chain.lock().servos[&thumb_id].position - stood).abs() <= 1.0, "it was bent with all its force");
    assert_goals_stay_near(&rig, &chain);
}

/// What gets warm of pressing presses less, with all fingers of its hand, and after a stop too.
#[test]
fn a_hand_that_gets_warm_presses_less_with_all_its_fingers() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    let thumb = joint(&rig, "r_thumb_x");
    let thumb_id = id_of(&rig, thumb);
    let fingers = [(finger, 0.5), (thumb, 0.8)];
    let fingers = fingers.map(|(joint, force)| GripFinger { joint, goal_rad: bent_rad(&rig, joint), force });
    let both = Grip { fingers: fingers.to_vec(), speed_rad_s: 1.0 };
    let warm = |to_c: u16| {
        chain.lock().servos.get_mut(&thumb_id).expect("there").set(Item::PresentTemperature, to_c);
    };
    let limited = |what: &str, [of_finger, of_thumb]: [f64; 2]| {
        await_state(&driver, what, |state| {
            let force = |joint| state.of(joint).and_then(|reading| reading.force);
            let near = |force: Option<f64>, to: f64| force.is_some_and(|force| (force - to).abs() < 2e-3);
            near(force(finger), of_finger) && near(force(thumb), of_thumb)
        })
    };
    for blocked in [id, thumb_id] {
        block(&chain, blocked, true);
    }
    driver.grip(both.clone()).expect("queued");
    limited("as told", [0.5, 0.8]);
    warm(66);
    let eased = limited("less, of both", [0.4, 0.64]);
    let said = eased.warnings.iter().find(|warning| warning.contains("66 °C")).expect("it is said");
    assert!(said.contains("lets go at 70 °C") && said.contains("put down"), "{said}");
    // A degree less does not press it out of the hand again.
    warm(50);
    std::thread::sleep(Duration::from_millis(300));
    limited("as eased", [0.4, 0.64]);
    driver.grip(both).expect("queued");
    limited("told anew", [0.5, 0.8]);
    // A stop ends that fingers follow what gives way; they press on, and get warm of it.
    driver.stop_switch().press();
    std::thread::sleep(Duration::from_millis(100));
    warm(68);
    limited("after the stop", [0.35, 0.56]);
    assert_goals_stay_near(&rig, &chain);
}

/// With the force of its own memory it would press harder than before.
#[test]
fn a_servo_that_takes_no_smaller_limit_keeps_the_one_it_has_and_lets_go_when_it_is_hot() {
    let (rig, chain, driver) = ready();
    let (finger, id) = finger(&rig);
    block(&chain, id, true);
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    await_state(&driver, "the limit", |s| s.of(finger).is_some_and(|r| r.force.is_some_and(|f| f < 0.71)));
    let change = |keeps: bool, to_c: u16| {
        let mut chain = chain.lock();
        let servo = chain.servos.get_mut(&id).expect("there");
        servo.keeps_its_limit = keeps;
        servo.set(Item::PresentTemperature, to_c);
    };
    change(true, 66);
    // Longer than it is told so in vain: 25 cycles of the bus.
    std::thread::sleep(Duration::from_millis(1500));
    assert_eq!(limit_of(&chain, id), FORCE_RAW);
    assert!(driver.state().refusal.is_none(), "{:?}", driver.state().refusal);
    // One that takes it after all is eased as it gets warmer, and let go when it is hot.
    change(false, 68);
    await_state(&driver, "less", |s| s.of(finger).is_some_and(|r| r.force.is_some_and(|f| f < 0.5)));
    change(false, 75);
    await_state(&driver, "let go", |s| matches!(s.refusal, Some((_, Refusal::Hot { .. }))));
    assert_goals_stay_near(&rig, &chain);
}

const PORT: &str = "PLUMBLINE_TEST_GRIP_PORT";

/// Run as a process of its own by the test below; does nothing otherwise.
#[test]
fn child_that_grips_until_it_is_killed() {
    let Ok(path) = std::env::var(PORT) else { return };
    let rig = nico();
    let port = open_port(&path, rig.bus.baud).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("all answer");
    take_hold(&driver);
    let (finger, _) = finger(&rig);
    driver.grip(grip(finger, bent_rad(&rig, finger))).expect("queued");
    std::thread::sleep(Duration::from_secs(20));
}

#[test]
fn killed_while_it_grips_a_finger_bends_no_farther_than_a_step_and_keeps_its_limit() {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    let (finger, id) = finger(&rig);
    let mut child = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "gripping::child_that_grips_until_it_is_killed"])
        .env(PORT, &chain.path)
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    let stood = chain.lock().servos[&id].position;
    block(&chain, id, true);
    let ahead_ticks =
        |chain: &PtyChain| (f64::from(chain.lock().servos[&id].get(Item::GoalPosition)) - stood).abs();
    let tick_rad = std::f64::consts::TAU / 4096.0;
    let ratio = rig.servo_of(finger).expect("it has a servo").ratio.abs();
    for _ in 0..2000 {
        if has_torque(&chain, id) && ahead_ticks(&chain) * tick_rad / ratio > 0.09 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    kill_process(Pid::from_child(&child), Signal::KILL).expect("it runs");
    child.wait().expect("it ended");
    assert!(ahead_ticks(&chain) * tick_rad / ratio > 0.09, "it pressed");
    block(&chain, id, false);
    std::thread::sleep(Duration::from_millis(600));
    let turned_rad = (chain.lock().servos[&id].position - stood).abs() * tick_rad / ratio;
    assert!(turned_rad <= rig.gate.step_rad + tick_rad, "it bent on by {turned_rad} rad");
    assert_eq!(limit_of(&chain, id), FORCE_RAW);
    assert_goals_stay_near(&rig, &chain);
}
