//! The process dies in the middle of a move.

use std::process::{Command, Stdio};
use std::time::Duration;

use plumbline_hardware::dynamixel::open_port;
use plumbline_hardware::joints::{ArmDriver, ArmOptions};

use rustix::process::{Pid, Signal, kill_process};

use super::chain::PtyChain;
use super::world::{assert_goals_stay_near, await_state, has_torque, id_of, joint, nico, turn};

const PORT: &str = "PLUMBLINE_TEST_SERVO_PORT";

/// Run as a process of its own by the test below; does nothing otherwise.
#[test]
fn child_that_moves_until_it_is_killed() {
    let Ok(path) = std::env::var(PORT) else { return };
    let rig = nico();
    let port = open_port(&path, rig.bus.baud).expect("the pseudo-terminal is there");
    let driver = ArmDriver::connect(port, rig.clone(), ArmOptions::default()).expect("all answer");
    driver.engage(&[]).expect("queued");
    await_state(&driver, "torque on", |s| s.joints.iter().all(|j| j.torque_on == Some(true)));
    driver.start_move(turn(joint(&rig, "head_z"), 1.5, 0.5)).expect("queued");
    std::thread::sleep(Duration::from_secs(20));
}

#[test]
fn a_killed_process_leaves_the_arm_within_a_step_of_where_it_was() {
    for signal in [Signal::KILL, Signal::TERM] {
        ended_by(signal);
    }
}

fn ended_by(signal: Signal) {
    let rig = nico();
    let chain = PtyChain::of(&rig);
    // It is slower than its goals, so that they run ahead as far as they may.
    let pan = id_of(&rig, joint(&rig, "head_z"));
    chain.lock().servos.get_mut(&pan).expect("there").fastest_rad_s = 0.4;
    let program = std::env::current_exe().expect("this test");
    let mut child = Command::new(program)
        .args(["--exact", "killed::child_that_moves_until_it_is_killed"])
        .env(PORT, &chain.path)
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    let begin = chain.lock().servos[&pan].position;
    for _ in 0..2000 {
        if (chain.lock().servos[&pan].position - begin).abs() > 150.0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let there = chain.lock().servos[&pan].position;
    kill_process(Pid::from_child(&child), signal).expect("it runs");
    child.wait().expect("it ended");
    assert!((there - begin).abs() > 150.0, "it did move");
    std::thread::sleep(Duration::from_millis(600));
    let rests = chain.lock().servos[&pan].position;
    let step_ticks = rig.gate.step_rad / std::f64::consts::TAU * 4096.0;
    eprintln!("moved on by {:.1} of at most {step_ticks:.1} ticks after {signal:?}", (rests - there).abs());
    assert!((rests - there).abs() <= step_ticks + 2.0, "{}", rests - there);
    assert!(has_torque(&chain, pan), "it holds");
    assert_goals_stay_near(&rig, &chain);
}
