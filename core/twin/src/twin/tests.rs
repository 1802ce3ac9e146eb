//! A running twin, used as its owner and a host on the bus use it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{
    ControlTable, Deframer, Found, Instruction, Item, ServoPort, encode_instruction, open_port,
};
use plumbline_hardware::joints::TouchSource;
use plumbline_model::Pose;
use plumbline_model::robot::Rig;

use super::*;
use crate::scenery::object;
use crate::toys::Toy;

fn twin(scenario: &str) -> Twin {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let scenario = Scenario::built_in(scenario).expect("valid");
    Twin::start(TwinSettings { rig, scenario, seed: 1, pace: 1.0 }).expect("it starts")
}

/// Waits until something is so.
fn soon(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < Duration::from_secs(8), "{what} did not happen");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Asks one servo; `None` without a whole answer.
fn ask(port: &mut Box<dyn ServoPort>, id: u8, instruction: &Instruction) -> Option<Vec<u8>> {
    let bytes = encode_instruction(id, instruction).expect("it fits");
    std::io::Write::write_all(port, &bytes).ok()?;
    let mut deframer = Deframer::default();
    let (mut buffer, began) = ([0; 256], Instant::now());
    while began.elapsed() < Duration::from_millis(100) {
        let Ok(count) = std::io::Read::read(port, &mut buffer) else { continue };
        deframer.push(&buffer[..count]);
        while let Some(found) = deframer.pop() {
            if let Found::Frame(frame) = found {
                return Some(frame.data);
            }
        }
    }
    None
}

#[test]
fn a_goal_over_the_bus_moves_the_arm_and_the_reading_follows() {
    let twin = twin("perfect");
    let mut port = open_port(&twin.port().to_string_lossy(), 1_000_000).expect("it opens");
    let rig = Rig::built_in("nico").expect("valid");
    let servo = rig.servos.iter().find(|servo| servo.id == 21).expect("a servo");
    let table = ControlTable::of_model(&servo.model).expect("known");
    let goal_rad = 0.3;
    let ticks = table.ticks(servo.motor_rad(goal_rad)).expect("in range");
    let address = table.register(Item::GoalPosition).expect("a register").address;
    let write = Instruction::Write { address, data: ticks.0.to_le_bytes().to_vec() };
    assert!(ask(&mut port, servo.id, &write).is_some());
    let read = Instruction::Read { address: 36, length: 2 };
    soon("the arm arrives", || {
        let Some(data) = ask(&mut port, servo.id, &read) else { return false };
        let raw = u16::from_le_bytes([data[0], data[1]]);
        let seen = table.register(Item::PresentPosition).expect("a register").si(raw);
        (servo.joint_rad(seen) - goal_rad).abs() < 0.002
    });
    soon("it stays there", || {
        let truth = twin.truth_for_judging();
        (truth.encoders[servo.joint] - goal_rad).abs() < 0.002
    });
}

#[test]
fn toys_and_the_board_come_and_go_in_state_and_scenery() {
    let twin = twin("lab");
    let scene = twin.scene();
    let first = scene.newest().0;
    twin.send(TwinCommand::RemoveObject { toy: Toy::Duck });
    soon("the duck is away", || {
        let places = twin.state().toys;
        places.iter().any(|(toy, place)| *toy == Toy::Duck && place.is_none())
    });
    twin.send(TwinCommand::PlaceBoard { robot_from_board: Pose::identity() });
    soon("the board is out", || twin.state().board.is_some());
    let later = scene.newest().0;
    assert!(later.revision > first.revision);
    assert!(!later.items.iter().any(|item| item.object == object::of_toy(Toy::Duck)));
    assert!(later.items.iter().any(|item| item.object == object::BOARD));
    twin.send(TwinCommand::HideBoard);
    twin.send(TwinCommand::PlaceObject { toy: Toy::Duck, x_m: 0.4, y_m: 0.1 });
    soon("the duck is back", || {
        let state = twin.state();
        let duck = state.toys.iter().find(|(toy, _)| *toy == Toy::Duck).and_then(|(_, place)| *place);
        state.board.is_none() && duck.is_some_and(|p| (p.x - 0.4).abs() < 0.03 && p.z < 0.09)
    });
}

#[test]
fn what_cannot_be_done_is_told() {
    let twin = twin("lab");
    twin.send(TwinCommand::PlaceObject { toy: Toy::Duck, x_m: 9.0, y_m: 0.1 });
    soon("the refusal", || twin.state().refusal.is_some_and(|text| text.contains("table")));
    twin.send(TwinCommand::Pace(f64::NAN));
    soon("the refusal", || twin.state().refusal.is_some_and(|text| text.contains("pace")));
    twin.send(TwinCommand::AdvanceWarmUp { minutes: -1.0 });
    soon("the refusal", || twin.state().refusal.is_some_and(|text| text.contains("minutes")));
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let scenario = Scenario::built_in("lab").expect("valid");
    assert!(Twin::start(TwinSettings { rig, scenario, seed: 1, pace: 0.0 }).is_err());
}

#[test]
fn eyes_warm_up_and_cool() {
    let twin = twin("lab");
    let turn = |twin: &Twin| {
        let (_, snapshot) = twin.scene().newest();
        let left_from_right =
            snapshot.eyes.robot_from_left.isometry.inverse() * snapshot.eyes.robot_from_right.isometry;
        left_from_right.rotation
    };
    let cold = turn(&twin);
    twin.send(TwinCommand::AdvanceWarmUp { minutes: 30.0 });
    soon("the eyes are warm", || twin.state().eyes_on_s > 1800.0);
    soon("they turned", || cold.angle_to(&turn(&twin)) > 3e-3);
    twin.send(TwinCommand::WarmUpPace { times: 0.0 });
    soon("no clock stands still", || twin.state().refusal.is_some_and(|why| why.contains("1 to 60")));
    let (before_s, time_s) = (twin.state().eyes_on_s, twin.state().time_s);
    twin.send(TwinCommand::WarmUpPace { times: 30.0 });
    soon("their clock runs faster", || twin.state().eyes_on_s > before_s + 30.0);
    assert!(twin.state().time_s < time_s + 20.0, "everything else goes on as it does");
    twin.send(TwinCommand::WarmUpPace { times: 1.0 });
    twin.send(TwinCommand::CoolEyes);
    soon("they turned back", || cold.angle_to(&turn(&twin)) < 1e-4 && twin.state().eyes_on_s < 60.0);
}

#[test]
fn time_runs_at_its_pace_and_faults_are_shown_until_cleared() {
    let twin = twin("lab");
    let (began, began_s) = (Instant::now(), twin.state().time_s);
    twin.send(TwinCommand::Fault { fault: Fault::Dropped, on: true });
    assert_eq!(twin.state().faults, vec![Fault::Dropped]);
    std::thread::sleep(Duration::from_millis(1500));
    let passed_s = twin.state().time_s - began_s;
    let factor = passed_s / began.elapsed().as_secs_f64();
    // A loaded machine may be slow, never fast.
    assert!((0.3..1.05).contains(&factor), "{factor}");
    twin.send(TwinCommand::ClearFaults);
    assert!(twin.state().faults.is_empty());
}

#[test]
fn a_port_that_was_closed_opens_again() {
    let twin = twin("perfect");
    let ping = Instruction::Ping;
    let mut port = open_port(&twin.port().to_string_lossy(), 1_000_000).expect("it opens");
    assert!(ask(&mut port, 5, &ping).is_some());
    twin.send(TwinCommand::Fault { fault: Fault::PortClosed, on: true });
    soon("it is gone", || ask(&mut port, 5, &ping).is_none());
    drop(port);
    twin.send(TwinCommand::Fault { fault: Fault::PortClosed, on: false });
    let mut port = open_port(&twin.port().to_string_lossy(), 1_000_000).expect("it opens");
    assert!(ask(&mut port, 5, &ping).is_some());
}

#[test]
fn the_screen_is_untouched_at_first() {
    let twin = twin("lab");
    assert_eq!(twin.touchscreen().newest(), Ok(None));
    assert!(twin.touchscreen().take().is_empty());
}
