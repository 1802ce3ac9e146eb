//! A host on the other end of the pseudo-terminal, and every fault.

use std::io::{Read, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{
    BulkItem, Deframer, Found, Instruction, Item, ServoPort, Status, decode_status, encode_instruction,
    open_port,
};
use plumbline_model::robot::Rig;

use super::*;
use crate::physics::Reading;
use crate::servos::memory::error_bit;

const ELBOW: u8 = 5;
const PRESENT_POSITION: u16 = 36;
const GOAL_POSITION: u16 = 30;
/// After this long without a byte an answer is over.
const SILENCE: Duration = Duration::from_millis(20);

struct Host {
    bank: Arc<Mutex<Bank>>,
    terminal: ServoTerminal,
    port: Box<dyn ServoPort>,
}

/// What came back within a moment.
#[derive(Default, Debug)]
struct Heard {
    statuses: Vec<Status>,
    garbage: usize,
    wrong_checks: usize,
    pending: usize,
    after: Duration,
}

fn bank() -> Bank {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let home = rig.home();
    let angles: Vec<f64> = rig.servos.iter().map(|servo| home[servo.joint]).collect();
    Bank::new(rig, &angles).expect("all models are known")
}

impl Host {
    fn new(faults: &[Fault]) -> Self {
        let bank = Arc::new(Mutex::new(bank()));
        faults.iter().for_each(|fault| bank.lock().expect("whole").set_fault(*fault, true));
        let terminal = ServoTerminal::open(bank.clone(), 1_000_000, 7).expect("a terminal");
        let port = open_port(&terminal.path().to_string_lossy(), 1_000_000).expect("it opens");
        Self { bank, terminal, port }
    }

    fn say(&mut self, id: u8, instruction: &Instruction) -> Heard {
        let bytes = encode_instruction(id, instruction).expect("it fits");
        // Long for a loaded machine; an answer ends the wait.
        self.say_bytes(&bytes, 250)
    }

    fn say_bytes(&mut self, bytes: &[u8], wait_ms: u64) -> Heard {
        self.port.write_all(bytes).expect("the port is there");
        self.hear(Duration::from_millis(wait_ms))
    }

    /// Listens for `patience`, and a little after the last byte.
    fn hear(&mut self, patience: Duration) -> Heard {
        let (began, mut heard) = (Instant::now(), Heard::default());
        let mut until = began + patience;
        let mut deframer = Deframer::default();
        let mut buffer = [0; 512];
        while Instant::now() < until {
            let Ok(count) = self.port.read(&mut buffer) else { continue };
            until = Instant::now() + SILENCE.min(patience);
            deframer.push(&buffer[..count]);
            while let Some(found) = deframer.pop() {
                match found {
                    Found::Frame(frame) => {
                        heard.after = began.elapsed();
                        heard.statuses.push(decode_status(&frame));
                    }
                    Found::Garbage(bytes) => heard.garbage += bytes,
                    Found::WrongCheck { .. } => heard.wrong_checks += 1,
                }
            }
        }
        heard.pending = deframer.pending();
        heard
    }

    fn read_position(&mut self, id: u8) -> Heard {
        self.say(id, &Instruction::Read { address: PRESENT_POSITION, length: 2 })
    }
}

fn bytes_of(statuses: &[Status]) -> Vec<(u8, u8, Vec<u8>)> {
    statuses.iter().map(|s| (s.id, s.error.byte(), s.data.clone())).collect()
}

#[test]
fn every_servo_and_board_answers_a_ping() {
    let mut host = Host::new(&[]);
    let rig = Rig::built_in("nico").expect("valid");
    let ids = rig.servos.iter().map(|s| s.id).chain(rig.boards.iter().map(|b| b.id));
    for id in ids {
        assert_eq!(bytes_of(&host.say(id, &Instruction::Ping).statuses), vec![(id, 0, vec![])]);
    }
    assert!(host.say(99, &Instruction::Ping).statuses.is_empty());
}

#[test]
fn a_ping_is_answered_as_in_the_manual() {
    let mut host = Host::new(&[]);
    host.port.write_all(&[0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB]).expect("there");
    let (mut bytes, mut buffer) = (vec![], [0; 64]);
    let began = Instant::now();
    while began.elapsed() < Duration::from_millis(250) && bytes.len() < 6 {
        if let Ok(count) = host.port.read(&mut buffer) {
            bytes.extend_from_slice(&buffer[..count]);
        }
    }
    assert_eq!(bytes, [0xFF, 0xFF, 0x01, 0x02, 0x00, 0xFC]);
}

#[test]
fn goals_are_written_read_and_reach_the_drive() {
    let mut host = Host::new(&[]);
    let write = Instruction::Write { address: GOAL_POSITION, data: 1500u16.to_le_bytes().to_vec() };
    assert_eq!(bytes_of(&host.say(ELBOW, &write).statuses), vec![(ELBOW, 0, vec![])]);
    let read = host.say(ELBOW, &Instruction::Read { address: GOAL_POSITION, length: 2 });
    assert_eq!(read.statuses[0].data, 1500u16.to_le_bytes());
    let bank = host.bank.lock().expect("whole");
    let servo = bank.suspect().expect("an elbow");
    let goal_rad = bank.drive(servo).goal_rad;
    // (1500 − 2048) ticks, offset of the elbow in the rig.
    assert!((goal_rad - (-548.0 * std::f64::consts::TAU / 4096.0 + 2.373648)).abs() < 1e-9, "{goal_rad}");
}

#[test]
fn goals_outside_of_the_limits_are_refused_aloud() {
    let mut host = Host::new(&[]);
    let write = Instruction::Write { address: GOAL_POSITION, data: 4000u16.to_le_bytes().to_vec() };
    assert_eq!(host.say(ELBOW, &write).statuses[0].error.byte(), error_bit::ANGLE);
    let write = Instruction::Write { address: PRESENT_POSITION, data: vec![0, 0] };
    assert_eq!(host.say(ELBOW, &write).statuses[0].error.byte(), error_bit::RANGE);
}

#[test]
fn a_sync_write_reaches_everyone_and_nobody_answers() {
    let mut host = Host::new(&[]);
    let data = vec![(1, 1800u16.to_le_bytes().to_vec()), (3, 2100u16.to_le_bytes().to_vec())];
    let sync = Instruction::SyncWrite { address: GOAL_POSITION, length: 2, data };
    assert!(host.say(0xFE, &sync).statuses.is_empty());
    for (id, ticks) in [(1, 1800u16), (3, 2100)] {
        let read = host.say(id, &Instruction::Read { address: GOAL_POSITION, length: 2 });
        assert_eq!(read.statuses[0].data, ticks.to_le_bytes());
    }
}

#[test]
fn a_bulk_read_is_answered_in_order_and_ends_at_a_silent_servo() {
    let ask = |ids: &[u8]| {
        let item = |id: &u8| BulkItem { id: *id, address: PRESENT_POSITION, length: 8 };
        Instruction::BulkRead { items: ids.iter().map(item).collect() }
    };
    let mut host = Host::new(&[]);
    let heard = host.say(0xFE, &ask(&[3, 1, 21]));
    assert_eq!(heard.statuses.iter().map(|s| s.id).collect::<Vec<_>>(), [3, 1, 21]);
    assert!(heard.statuses.iter().all(|s| s.data.len() == 8));
    let mut host = Host::new(&[Fault::MissingServo]);
    let heard = host.say(0xFE, &ask(&[3, ELBOW, 21]));
    assert_eq!(heard.statuses.iter().map(|s| s.id).collect::<Vec<_>>(), [3]);
}

#[test]
fn readings_are_rounded_to_ticks_and_signed_like_the_motor() {
    let mut bank = bank();
    let rig = Rig::built_in("nico").expect("valid");
    for (i, servo) in rig.servos.iter().enumerate() {
        let angle_rad = servo.joint_limits().middle_rad();
        let reading =
            Reading { angle_rad, speed_rad_s: 0.3, load: 0.25, temperature_c: 41.7, voltage_v: 11.9 };
        bank.take(i, reading, 0.002);
        let memory = &bank.units[i].memory;
        let seen_rad = servo.joint_rad(memory.si(Item::PresentPosition).expect("a register"));
        assert!((seen_rad - angle_rad).abs() <= 0.5 * 0.001534 / servo.ratio + 1e-9, "{}", servo.title);
        let speed = memory.si(Item::PresentSpeed).expect("a register");
        let moved = servo.motor_rad(angle_rad + 0.1) - servo.motor_rad(angle_rad);
        assert!(speed * moved > 0.0 && (speed.abs() - 0.3 * servo.ratio).abs() < 0.012);
        assert_eq!(memory.get(Item::PresentTemperature), Some(42));
        assert_eq!(memory.get(Item::Moving), Some(1));
    }
}

#[test]
fn answers_take_their_time_on_the_wire() {
    let mut host = Host::new(&[]);
    let delay = Instruction::Write { address: 5, data: vec![250] };
    host.say(ELBOW, &delay);
    // Request and answer of 8 bytes at 10 µs, and 500 µs of return delay.
    let heard = host.read_position(ELBOW);
    assert!(heard.after >= Duration::from_micros(655), "{:?}", heard.after);
    assert!(heard.after < Duration::from_millis(200), "{:?}", heard.after);
}

#[test]
fn broken_and_unknown_instructions_are_complained_about() {
    let mut host = Host::new(&[]);
    let heard = host.say_bytes(&[0xFF, 0xFF, 0x05, 0x02, 0x01, 0x00], 250);
    assert_eq!(heard.statuses[0].error.byte(), error_bit::CHECKSUM);
    let check = !(0x05u8 + 0x02 + 0x77);
    let heard = host.say_bytes(&[0xFF, 0xFF, 0x05, 0x02, 0x77, check], 250);
    assert_eq!(heard.statuses[0].error.byte(), error_bit::INSTRUCTION);
    let heard = host.say_bytes(&[0x12, 0x34, 0xFF], 10);
    assert!(heard.statuses.is_empty());
    // A cut instruction does not spoil the next whole ones for long.
    host.say_bytes(&[0xFF, 0xFF, 0x05, 0x04, 0x02], 5);
    let answered = (0..3).any(|_| !host.read_position(ELBOW).statuses.is_empty());
    assert!(answered);
}

/// Of 60 reads: how many were answered well, and what else was heard.
fn sixty(fault: Fault) -> (usize, Heard) {
    let mut host = Host::new(&[fault]);
    let (mut good, mut all) = (0, Heard::default());
    for _ in 0..60 {
        let bytes = encode_instruction(ELBOW, &Instruction::Read { address: PRESENT_POSITION, length: 2 })
            .expect("it fits");
        let heard = host.say_bytes(&bytes, 8);
        good += usize::from(heard.statuses.iter().any(|s| s.id == ELBOW && s.data.len() == 2));
        all.garbage += heard.garbage;
        all.wrong_checks += heard.wrong_checks;
        all.pending += heard.pending;
        all.statuses.extend(heard.statuses);
    }
    (good, all)
}

#[test]
fn faults_that_hit_sometimes_hit_sometimes() {
    for fault in
        [Fault::Dropped, Fault::Late, Fault::Garbled, Fault::Cut, Fault::WrongChecksum, Fault::WrongId]
    {
        let (good, all) = sixty(fault);
        assert!((10..60).contains(&good), "{fault:?}: {good} of 60 good");
        match fault {
            Fault::WrongChecksum => assert!(all.wrong_checks > 0),
            Fault::Cut => assert!(all.pending > 0),
            Fault::WrongId => assert!(all.statuses.iter().any(|s| s.id == ELBOW ^ 0x40)),
            _ => {}
        }
    }
}

#[test]
fn late_answers_come_in_the_end() {
    let mut host = Host::new(&[Fault::Late]);
    let mut latest = Duration::ZERO;
    for _ in 0..25 {
        let read = Instruction::Read { address: PRESENT_POSITION, length: 2 };
        let bytes = encode_instruction(ELBOW, &read).expect("it fits");
        let heard = host.say_bytes(&bytes, 250);
        assert_eq!(heard.statuses.len(), 1);
        latest = latest.max(heard.after);
    }
    assert!(latest >= Duration::from_millis(30), "{latest:?}");
}

#[test]
fn the_adapter_may_echo() {
    let mut host = Host::new(&[Fault::Echo]);
    let read = Instruction::Read { address: PRESENT_POSITION, length: 2 };
    let bytes = encode_instruction(ELBOW, &read).expect("it fits");
    let heard = host.say_bytes(&bytes, 250);
    assert_eq!(heard.statuses.len(), 2, "the own packet and the answer");
    assert_eq!(heard.statuses[0].error.byte(), 0x02, "a read looks like an error byte");
}

#[test]
fn a_missing_servo_is_silent_and_a_doubled_one_answers_twice() {
    let mut host = Host::new(&[Fault::MissingServo]);
    assert!(host.read_position(ELBOW).statuses.is_empty());
    assert_eq!(host.read_position(3).statuses.len(), 1);
    let mut host = Host::new(&[Fault::TwoWithOneId]);
    assert_eq!(host.read_position(ELBOW).statuses.len(), 2);
}

#[test]
fn a_closed_port_is_an_error_to_the_host() {
    let mut host = Host::new(&[]);
    assert_eq!(host.read_position(ELBOW).statuses.len(), 1);
    host.bank.lock().expect("whole").set_fault(Fault::PortClosed, true);
    std::thread::sleep(Duration::from_millis(40));
    let mut buffer = [0; 8];
    let gone = match host.port.read(&mut buffer) {
        Ok(count) => count == 0,
        Err(error) => error.kind() != std::io::ErrorKind::TimedOut,
    };
    assert!(gone || host.port.write_all(&[0xFF]).is_err());
    // A new terminal on the same bank serves again.
    host.bank.lock().expect("whole").set_fault(Fault::PortClosed, false);
    host.terminal = ServoTerminal::open(host.bank.clone(), 1_000_000, 7).expect("a terminal");
    host.port = open_port(&host.terminal.path().to_string_lossy(), 1_000_000).expect("it opens");
    assert_eq!(host.read_position(ELBOW).statuses.len(), 1);
}

#[test]
fn the_port_may_vanish_in_the_middle_of_an_answer() {
    let mut host = Host::new(&[Fault::PortClosedMidAnswer]);
    let read = Instruction::Read { address: PRESENT_POSITION, length: 2 };
    let bytes = encode_instruction(ELBOW, &read).expect("it fits");
    host.port.write_all(&bytes).expect("still there");
    let (mut received, mut gone, began) = (0, false, Instant::now());
    let mut buffer = [0; 64];
    while !gone && began.elapsed() < Duration::from_millis(200) {
        match host.port.read(&mut buffer) {
            Ok(0) => gone = true,
            Ok(count) => received += count,
            Err(error) => gone = error.kind() != std::io::ErrorKind::TimedOut,
        }
    }
    assert!(gone, "the host notices");
    assert!(received <= 4, "no more than half of 8 bytes: {received}");
}

#[test]
fn a_hot_servo_says_so_and_lets_go() {
    let mut bank = bank();
    let servo = bank.suspect().expect("an elbow");
    let reading = |temperature_c| Reading { temperature_c, voltage_v: 12.0, ..Reading::default() };
    bank.take(servo, reading(79.0), 0.002);
    assert!(bank.drive(servo).torque_on);
    bank.take(servo, reading(81.0), 0.002);
    assert!(!bank.drive(servo).torque_on);
    let host = Host::new(&[]);
    *host.bank.lock().expect("whole") = bank;
    let mut host = host;
    assert_eq!(host.read_position(ELBOW).statuses[0].error.byte(), error_bit::HOT);
    host.bank.lock().expect("whole").take(servo, reading(60.0), 0.002);
    assert_eq!(host.read_position(ELBOW).statuses[0].error.byte(), 0);
}

#[test]
fn a_servo_that_strains_for_long_lets_go() {
    let mut bank = bank();
    let servo = bank.suspect().expect("an elbow");
    let reading = Reading { load: 1.0, voltage_v: 12.0, temperature_c: 30.0, ..Reading::default() };
    for _ in 0..900 {
        bank.take(servo, reading, 0.002);
    }
    assert!(bank.drive(servo).torque_on, "1.8 s");
    for _ in 0..200 {
        bank.take(servo, reading, 0.002);
    }
    assert!(!bank.drive(servo).torque_on, "2.2 s");
}

#[test]
fn without_power_nobody_answers_and_after_it_all_are_limp_where_they_are() {
    const HEAD: u8 = 19;
    for (fault, others) in [(Fault::PowerCut, 0), (Fault::ElbowPowerCut, 1)] {
        let mut host = Host::new(&[]);
        let place = host.bank.lock().expect("whole").suspect().expect("an elbow");
        let held = host.bank.lock().expect("whole").units[place].memory.get(Item::GoalPosition);
        host.bank.lock().expect("whole").set_fault(fault, true);
        let pings = |host: &mut Host, id| host.say(id, &Instruction::Ping).statuses.len();
        assert_eq!((pings(&mut host, ELBOW), pings(&mut host, HEAD)), (0, others), "{fault:?}");
        {
            let mut bank = host.bank.lock().expect("whole");
            assert!(!bank.drive(place).torque_on, "it holds nothing");
            // It sinks.
            bank.units[place].memory.set(Item::PresentPosition, 1500);
            bank.set_fault(Fault::HotServo, true);
            assert!(!bank.units[place].powered, "another fault gives no power");
            bank.set_fault(fault, false);
        }
        assert_eq!(pings(&mut host, ELBOW), 1);
        let bank = host.bank.lock().expect("whole");
        let memory = &bank.units[place].memory;
        assert_eq!(memory.get(Item::TorqueEnable), Some(0));
        assert_ne!(held, Some(1500));
        assert_eq!(
            memory.get(Item::GoalPosition),
            Some(1500),
            "its goal is where it was when the power came"
        );
        assert_eq!(memory.get(Item::TorqueLimit), memory.get(Item::MaxTorque));
    }
}
