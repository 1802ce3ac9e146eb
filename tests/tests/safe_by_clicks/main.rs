//! What must hold when something goes wrong with the arm, by clicks in a window over the real engine,
//! which is connected to servos on a pseudo-terminal whose power can be cut: STOP from a click to the
//! wire, and every fault named in the window.

#![allow(clippy::print_stderr, reason = "prints the figures of SAFETY.md")]

#[path = "../../../core/hardware/tests/joint_bus/chain.rs"]
#[allow(dead_code, reason = "shared with the tests of the joint bus")]
mod chain;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use chain::{Fault, PtyChain};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, WindowOptions};
use plumbline_engine::view::MotionState;
use plumbline_engine::{Engine, EngineSettings, RobotCommand};
use plumbline_hardware::dynamixel::Item;
use plumbline_model::robot::Rig;
use plumbline_tests::{Window, click, click_containing, for_a_while, until, view};

/// Presses of STOP in the suite; `PLUMBLINE_STOP_TRIALS=200` for the figure.
const STOPS: usize = 6;
/// Within this time every fault is named.
const NAMED: Duration = Duration::from_secs(1);
/// All joints are held within this time after it was pressed …
const HELD_WITHIN: Duration = Duration::from_secs(5);
/// … or it is pressed again, so often.
const MOST_PRESSES: usize = 20;

fn window(data_dir: &Path, chain: &PtyChain) -> Window {
    let settings = EngineSettings { data_dir: Some(data_dir.to_owned()), source: None, twin: None };
    let path = chain.path.clone();
    let mut window = Harness::builder().with_size([1280.0, 800.0]).build_eframe(move |creation| {
        let engine = Engine::start(settings, Arc::new(|| {}));
        engine.send(RobotCommand::ConnectPort { path: path.into() });
        PlumblineWindow::new(&creation.egui_ctx, Box::new(engine), WindowOptions::default())
    });
    until(&mut window, "the joints", |window| view(window).robot.measured.is_some());
    click_containing(&mut window, "Robot");
    window
}

/// Presses again, as an operator would, where a servo was not heard in time because this machine has other work.
fn take_hold(window: &mut Window) {
    for _ in 0..MOST_PRESSES {
        click_containing(window, "Hold all joints");
        let since = Instant::now();
        while since.elapsed() < HELD_WITHIN {
            window.step();
            let joints = view(window).robot.joints.clone();
            if joints.iter().all(|joint| joint.torque_on == Some(true) && !joint.let_go) {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    panic!("not all joints are held: {:?}", view(window).robot.motion);
}

/// Shows a pose and moves there.
fn go(window: &mut Window, title: &str) {
    click_containing(window, title);
    until(window, "a way that is free", |window| {
        view(window).robot.preview.as_ref().is_some_and(|preview| preview.path.is_ok())
    });
    click_containing(window, "Move there");
    let on_its_way = |window: &Window| matches!(view(window).robot.motion, MotionState::Moving { fraction: Some(part), .. } if part > 0.1);
    until(window, "the arm on its way", on_its_way);
}

/// Whether the window says something anywhere.
fn says(window: &Window, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

fn named_within(window: &mut Window, since: Instant, what: &str) -> Duration {
    until(window, what, |window| says(window, what));
    since.elapsed()
}

#[test]
fn stop_from_a_click_to_the_wire() {
    let trials = std::env::var("PLUMBLINE_STOP_TRIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(STOPS);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rig = Rig::built_in("nico").expect("comes with the program");
    let chain = PtyChain::of(&rig);
    let mut window = window(&folder.path().join("data"), &chain);
    take_hold(&mut window);
    let poses = ["touch-ready", "home"].map(|name| rig.pose(name).expect("a pose of NICO").title.clone());
    let mut latencies = vec![];
    while latencies.len() < trials {
        go(&mut window, &poses[latencies.len() % 2]);
        let before = chain.lock().told.len();
        let clicked = Instant::now();
        window.get_by_label("STOP").click();
        window.step();
        until(&mut window, "STOP", |window| view(window).robot.stopped);
        for_a_while(&mut window, Duration::from_millis(60));
        let chain = chain.lock();
        // The hold is the last word: nothing is sent after it.
        let hold = chain.told[before..].last().expect("goals were sent").at;
        latencies.push(hold.saturating_duration_since(clicked));
        drop(chain);
        let stood: Vec<f64> = positions(&window);
        for_a_while(&mut window, Duration::from_millis(200));
        let moved = positions(&window).iter().zip(&stood).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 0.02, "it moved on by {moved} rad");
        click_containing(&mut window, "Release STOP");
        until(&mut window, "the release", |window| !view(window).robot.stopped);
    }
    latencies.sort();
    let ms = |share: f64| latencies[((latencies.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    eprintln!(
        "STOP from a click to the wire, {trials} trials, none repeated: median {:.1} ms, 95 % {:.1} ms, worst {:.1} ms",
        ms(0.5),
        ms(0.95),
        ms(1.0)
    );
}

fn positions(window: &Window) -> Vec<f64> {
    view(window).robot.measured.as_ref().expect("known").angles_rad().to_vec()
}

#[test]
fn every_fault_of_the_arm_is_named_in_the_window() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rig = Rig::built_in("nico").expect("comes with the program");
    let elbow = rig.description.find_joint("r_elbow_y").expect("a joint");
    let servo = rig.servo_of(elbow).expect("a servo").id;
    let chain = PtyChain::of(&rig);
    let mut window = window(&folder.path().join("data"), &chain);
    take_hold(&mut window);
    let mut named = vec![];

    // All power: nothing is known, nothing is held, and it stays so when the power is back.
    chain.power(false);
    let since = Instant::now();
    named.push(("power of all servos cut", named_within(&mut window, since, "No servo answers")));
    assert_eq!(view(&window).robot.motion, MotionState::Unknown);
    assert!(view(&window).robot.joints.iter().all(|joint| joint.angle_rad.is_none()));
    chain.power(true);
    until(&mut window, "all known again", |window| view(window).robot.unknown.is_empty());
    named_within(&mut window, Instant::now(), "did not answer for a while");
    assert!(chain.lock().servos.values().all(|servo| servo.get(Item::TorqueEnable) == 0), "all are limp");
    take_hold(&mut window);

    // One servo: its chain stays, the reason is said.
    chain.power_of(servo, false);
    let since = Instant::now();
    named.push((
        "power of one servo cut",
        named_within(&mut window, since, &format!("servo {servo} does not answer")),
    ));
    assert!(view(&window).robot.unknown.contains(&elbow));
    click_containing(&mut window, &rig.pose("touch-ready").expect("a pose").title.clone());
    until(&mut window, "the refusal", |window| says(window, "The servo of Right elbow does not answer"));
    chain.power_of(servo, true);
    until(&mut window, "it is known again", |window| view(window).robot.unknown.is_empty());
    take_hold(&mut window);

    // It started anew too fast to be missed.
    chain.power_of(servo, false);
    chain.power_of(servo, true);
    named.push((
        "torque lost",
        named_within(&mut window, Instant::now(), &format!("servo {servo} lost its torque")),
    ));
    take_hold(&mut window);

    // An overload shutdown: held without force; taking hold gives it back.
    chain.lock().servos.get_mut(&servo).expect("there").set(Item::TorqueLimit, 0);
    named.push((
        "overload shutdown",
        named_within(&mut window, Instant::now(), "after an overload and has no force"),
    ));
    take_hold(&mut window);
    until(&mut window, "force again", |window| view(window).robot.joints.iter().all(|joint| !joint.no_force));
    assert_eq!(chain.lock().servos[&servo].get(Item::TorqueLimit), 1000);

    // Two with one id, when somebody asks.
    chain.fault(servo, Fault::Twice, u32::MAX);
    click_containing(&mut window, "Bus");
    click(&mut window, "Look for servos again");
    until(&mut window, "the scan", |window| says(window, "two servos"));
    chain.fault(servo, Fault::Late(Duration::ZERO), 1);

    for (fault, after) in &named {
        eprintln!("{fault}: named in the window after {:.2} s", after.as_secs_f64());
    }
    assert!(named.iter().all(|(_, after)| *after < 5 * NAMED), "{named:?}");
}

#[test]
fn connecting_while_the_power_is_cut_says_so_and_moves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rig = Rig::built_in("nico").expect("comes with the program");
    let chain = PtyChain::of(&rig);
    chain.power(false);
    let settings = EngineSettings { data_dir: Some(folder.path().join("data")), source: None, twin: None };
    let path = chain.path.clone();
    let mut window = Harness::builder().with_size([1280.0, 800.0]).build_eframe(move |creation| {
        let engine = Engine::start(settings, Arc::new(|| {}));
        engine.send(RobotCommand::ConnectPort { path: path.into() });
        PlumblineWindow::new(&creation.egui_ctx, Box::new(engine), WindowOptions::default())
    });
    click_containing(&mut window, "Robot");
    until(&mut window, "the reason", |window| says(window, "switch the robot's power on"));
    chain.power(true);
    for_a_while(&mut window, Duration::from_millis(500));
    assert!(chain.lock().written.is_empty(), "nothing was written");
}
