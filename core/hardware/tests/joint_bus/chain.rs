//! A chain of servos behind a pseudo-terminal, played by a thread: answers as servos do, moves
//! toward its goals, notes what it is told and when, and breaks on demand.

use std::collections::BTreeMap;
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{
    BROADCAST, ControlTable, Deframer, Found, Instruction, Item, Ticks, decode_instruction, encode_status,
};
use plumbline_model::robot::Rig;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// What a servo does wrong with its next answers.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    Silent,
    Cut,
    Garbled,
    Checksum,
    OtherId(u8),
    Late(Duration),
    Complains(u8),
    /// Another servo with the same id answers right behind.
    Twice,
    /// Another servo with the same id answers at the same moment.
    Collision,
}

pub struct FakeServo {
    pub table: &'static ControlTable,
    pub memory: Vec<u8>,
    /// Where it stands, ticks.
    pub position: f64,
    /// Fastest it can, rad/s of the motor.
    pub fastest_rad_s: f64,
    /// Whether something blocks it.
    pub blocked: bool,
    /// Fault and for how many answers.
    pub fault: Option<(Fault, u32)>,
    /// Whether it has power. Without, it neither hears nor answers nor holds, and its weight moves it.
    pub powered: bool,
    /// How fast its weight moves it while nothing holds it, ticks/s.
    pub sinks_ticks_s: f64,
    /// How far below its goal its weight lets it hang while it holds, ticks.
    pub hangs_ticks: f64,
    /// Times a goal or an "on" switched its torque on.
    pub switched_on: u32,
    /// Whether its limit of torque stays as it is, whatever is written.
    pub keeps_its_limit: bool,
    /// Goals outside of these are not taken, ticks.
    pub angle_limits: Option<[u16; 2]>,
}

/// A packet with goals, as it arrived.
pub struct Told {
    pub at: Instant,
    /// Servo, goal, where the servo was, what it had told last and before (ticks).
    pub goals: Vec<(u8, u16, f64, [u16; 2])>,
}

pub struct Chain {
    pub servos: BTreeMap<u8, FakeServo>,
    pub told: Vec<Told>,
    /// Where each servo last said that it was, and where it had said before that.
    reported: BTreeMap<u8, [u16; 2]>,
    pub echo: bool,
    /// Instructions other than reads: id and instruction.
    pub written: Vec<(u8, Instruction)>,
    /// Closes the line in the middle of the next answer.
    pub hang_up: bool,
    /// Sends bytes without a pause.
    pub flood: bool,
    moved_at: Instant,
}

impl FakeServo {
    pub fn new(model: &str, id: u8, position: f64) -> Self {
        let table = ControlTable::of_model(model).expect("a known model");
        let mut servo = Self {
            table,
            memory: vec![0; table.memory_bytes()],
            position,
            fastest_rad_s: 6.0,
            blocked: false,
            fault: None,
            powered: true,
            sinks_ticks_s: 0.0,
            hangs_ticks: 0.0,
            switched_on: 0,
            keeps_its_limit: false,
            angle_limits: None,
        };
        servo.set(Item::ModelNumber, table.number);
        servo.set(Item::FirmwareVersion, 36);
        servo.set(Item::Id, u16::from(id));
        servo.set(Item::ReturnDelayTime, 250);
        servo.set(Item::PresentVoltage, 120);
        servo.set(Item::PresentTemperature, 38);
        servo.set(Item::MaxTorque, 1000);
        servo.set(Item::TorqueLimit, 1000);
        servo
    }

    pub fn set(&mut self, item: Item, raw: u16) {
        if let Some(register) = self.table.register(item) {
            let begin = usize::from(register.address);
            self.memory[begin..begin + usize::from(register.size)].copy_from_slice(&register.bytes(raw));
        }
    }

    pub fn get(&self, item: Item) -> u16 {
        self.table.register(item).and_then(|r| r.in_data(0, &self.memory)).unwrap_or(0)
    }

    /// Off: it forgets everything that is not in its permanent memory. On: limp, with its goal where
    /// it is, as after every start (MX-64 manual: Torque Enable is 0 after power-on).
    pub fn power(&mut self, on: bool) {
        self.powered = on;
        self.set(Item::TorqueEnable, 0);
        self.set(Item::MovingSpeed, 0);
        self.set(Item::Led, 0);
        self.set(Item::TorqueLimit, self.get(Item::MaxTorque));
        self.set(Item::GoalPosition, self.position.round() as u16);
    }

    fn advance(&mut self, dt_s: f64) {
        if !self.table.moves || self.blocked {
            return;
        }
        if !self.powered || self.get(Item::TorqueEnable) == 0 {
            self.position = (self.position + self.sinks_ticks_s * dt_s).clamp(0.0, 4095.0);
            return;
        }
        if self.get(Item::TorqueLimit) == 0 && self.table.register(Item::TorqueLimit).is_some() {
            return;
        }
        let speed = self.table.register(Item::MovingSpeed).map_or(0.0, |r| r.si(self.get(Item::MovingSpeed)));
        let largest = speed.min(self.fastest_rad_s) * dt_s / (std::f64::consts::TAU / 4096.0);
        let rests_at = f64::from(self.get(Item::GoalPosition)) - self.hangs_ticks;
        self.position += (rests_at - self.position).clamp(-largest, largest);
    }

    fn data(&mut self, address: u16, length: u16) -> Vec<u8> {
        let position = self.position.round();
        self.set(Item::PresentPosition, position as u16);
        let begin = usize::from(address);
        (begin..begin + usize::from(length)).map(|i| self.memory.get(i).copied().unwrap_or(0)).collect()
    }

    /// Motor angle, rad.
    pub fn motor_rad(&self) -> f64 {
        self.table.motor_rad(Ticks(self.position.round() as u16)).expect("in range")
    }
}

impl Chain {
    /// All servos and boards of a rig, standing at its first pose but with a level head, limp.
    pub fn of(rig: &Rig) -> Self {
        let home = rig.home();
        let mut servos = BTreeMap::new();
        for servo in &rig.servos {
            let table = ControlTable::of_model(&servo.model).expect("a known model");
            let limits = rig.limits(servo.joint);
            let is_tilt = servo.joint == rig.eyes.tilt;
            let angle_rad =
                if is_tilt { 0.0 } else { home[servo.joint].clamp(limits.lower_rad, limits.upper_rad) };
            let ticks = table.ticks(servo.motor_rad(angle_rad)).expect("in range");
            servos.insert(servo.id, FakeServo::new(&servo.model, servo.id, f64::from(ticks.0)));
        }
        for board in &rig.boards {
            servos.insert(board.id, FakeServo::new(&board.model, board.id, 0.0));
        }
        Self {
            servos,
            told: vec![],
            reported: BTreeMap::new(),
            echo: false,
            written: vec![],
            hang_up: false,
            flood: false,
            moved_at: Instant::now(),
        }
    }

    pub fn advance(&mut self) {
        let dt_s = self.moved_at.elapsed().as_secs_f64();
        self.moved_at = Instant::now();
        self.servos.values_mut().for_each(|servo| servo.advance(dt_s));
    }

    /// Bytes to answer with, and whether the line breaks after them.
    fn answer(&mut self, id: u8, instruction: Instruction, at: Instant) -> Vec<u8> {
        self.advance();
        match instruction {
            Instruction::Ping => self.status(id, 0, 0).unwrap_or_default(),
            Instruction::Read { address, length } => self.status(id, address, length).unwrap_or_default(),
            Instruction::BulkRead { items } => {
                // Each waits for the one before it.
                let answer = |item: plumbline_hardware::dynamixel::BulkItem| {
                    self.status(item.id, item.address, item.length)
                };
                items.into_iter().map_while(answer).flatten().collect()
            }
            Instruction::Write { address, data } => {
                self.written.push((id, Instruction::Write { address, data: data.clone() }));
                if self.is_outside(id, address, &data) {
                    return encode_status(id, 0x02, &[]).expect("short");
                }
                self.store(id, address, &data);
                self.status(id, 0, 0).unwrap_or_default()
            }
            Instruction::SyncWrite { address, length, data } => {
                let mut goals = vec![];
                for (id, bytes) in &data {
                    let before = self.servos.get(id).map_or(0.0, |servo| servo.position);
                    let reported = self.reported.get(id).copied().unwrap_or([0; 2]);
                    goals.push((*id, u16::from_le_bytes([bytes[0], bytes[1]]), before, reported));
                    self.store(*id, address, bytes);
                }
                self.written.push((BROADCAST, Instruction::SyncWrite { address, length, data }));
                self.told.push(Told { at, goals });
                vec![]
            }
            _ => vec![],
        }
    }

    /// Whether a goal lies outside of the servo's limits: then nothing is stored (MX-64 manual).
    fn is_outside(&self, id: u8, address: u16, data: &[u8]) -> bool {
        let servo = self.servos.get(&id).filter(|servo| servo.powered);
        let Some([low, high]) = servo.and_then(|servo| servo.angle_limits) else { return false };
        let is_goal = servo
            .and_then(|servo| servo.table.register(Item::GoalPosition))
            .is_some_and(|register| register.address == address);
        is_goal && !(low..=high).contains(&u16::from_le_bytes([data[0], data[1]]))
    }

    fn store(&mut self, id: u8, address: u16, data: &[u8]) {
        let Some(servo) = self.servos.get_mut(&id).filter(|servo| servo.powered) else { return };
        let was_on = servo.get(Item::TorqueEnable);
        if servo.keeps_its_limit
            && servo.table.register(Item::TorqueLimit).is_some_and(|r| r.address == address)
        {
            return;
        }
        let begin = usize::from(address);
        servo.memory[begin..begin + data.len()].copy_from_slice(data);
        // Protocol 1.0: a goal switches the torque on.
        if servo.table.register(Item::GoalPosition).is_some_and(|r| r.address == address) {
            servo.set(Item::TorqueEnable, 1);
        }
        servo.switched_on += u32::from(servo.get(Item::TorqueEnable) > was_on);
    }

    /// A servo's answer; `None` when it keeps silent.
    fn status(&mut self, id: u8, address: u16, length: u16) -> Option<Vec<u8>> {
        let servo = self.servos.get_mut(&id).filter(|servo| servo.powered)?;
        let data = servo.data(address, length);
        let fault = servo.fault.take();
        if let Some((kind, left)) = &fault
            && *left > 1
        {
            servo.fault = Some((kind.clone(), left - 1));
        }
        let encode = |id, error| encode_status(id, error, &data).expect("short");
        let mut bytes = encode(id, 0);
        match fault.map(|(kind, _)| kind) {
            None => {
                if length >= 8 {
                    let before = self.reported.get(&id).map_or(0, |[last, _]| *last);
                    self.reported.insert(id, [servo.get(Item::PresentPosition), before]);
                }
            }
            Some(Fault::Silent) => return None,
            Some(Fault::Cut) => bytes.truncate(bytes.len() - 3),
            Some(Fault::Garbled) => bytes.iter_mut().for_each(|byte| *byte ^= 0x5A),
            Some(Fault::Checksum) => *bytes.last_mut().expect("not empty") ^= 1,
            Some(Fault::OtherId(other)) => bytes = encode(other, 0),
            Some(Fault::Complains(error)) => bytes = encode(id, error),
            Some(Fault::Late(pause)) => std::thread::sleep(pause),
            Some(Fault::Twice) => bytes = [bytes.clone(), bytes].concat(),
            Some(Fault::Collision) => bytes.iter_mut().skip(2).for_each(|byte| *byte &= 0x6D),
        }
        Some(bytes)
    }
}

/// The chain behind a pseudo-terminal.
pub struct PtyChain {
    pub path: String,
    chain: Arc<Mutex<Chain>>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl PtyChain {
    pub fn start(chain: Chain) -> Self {
        use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&master).expect("it can be used");
        unlockpt(&master).expect("it can be used");
        let path = ptsname(&master, Vec::new()).expect("it has a name").into_string().expect("readable");
        let chain = Arc::new(Mutex::new(chain));
        let end = Arc::new(AtomicBool::new(false));
        let thread = std::thread::Builder::new()
            .name("servo chain".to_owned())
            .spawn({
                let (chain, end) = (chain.clone(), end.clone());
                move || play(&master, &chain, &end)
            })
            .expect("a thread");
        Self { path, chain, end, thread: Some(thread) }
    }

    pub fn of(rig: &Rig) -> Self {
        Self::start(Chain::of(rig))
    }

    pub fn lock(&self) -> MutexGuard<'_, Chain> {
        self.chain.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn fault(&self, id: u8, fault: Fault, answers: u32) {
        self.lock().servos.get_mut(&id).expect("a servo").fault = Some((fault, answers));
    }

    /// Cuts the power of all servos, or gives it back.
    pub fn power(&self, on: bool) {
        let mut chain = self.lock();
        chain.advance();
        chain.servos.values_mut().for_each(|servo| servo.power(on));
    }

    /// Cuts the power of one servo, or gives it back.
    pub fn power_of(&self, id: u8, on: bool) {
        let mut chain = self.lock();
        chain.advance();
        chain.servos.get_mut(&id).expect("a servo").power(on);
    }

    /// The other end of the line goes away.
    pub fn close(&mut self) {
        self.end.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the chain does not panic");
        }
    }
}

impl Drop for PtyChain {
    fn drop(&mut self) {
        self.close();
    }
}

fn play(master: &OwnedFd, chain: &Mutex<Chain>, end: &AtomicBool) {
    let mut deframer = Deframer::default();
    let mut buffer = [0; 1024];
    while !end.load(Ordering::Acquire) {
        let mut fds = [PollFd::new(master, PollFlags::IN)];
        let wait = Timespec { tv_sec: 0, tv_nsec: 2_000_000 };
        let flood = chain.lock().unwrap_or_else(PoisonError::into_inner).flood;
        if flood {
            // What does not fit is lost, as on a real line.
            let _ = rustix::io::ioctl_fionbio(master, true);
            let _ = rustix::io::write(master, &[0x55; 512]);
        }
        let wait = if flood { Timespec { tv_sec: 0, tv_nsec: 100_000 } } else { wait };
        let ready = poll(&mut fds, Some(&wait)).unwrap_or(0) > 0;
        if !ready || !fds[0].revents().contains(PollFlags::IN) {
            if ready {
                // Nobody has the other end open.
                std::thread::sleep(Duration::from_millis(1));
            }
            chain.lock().unwrap_or_else(PoisonError::into_inner).advance();
            continue;
        }
        let Ok(bytes) = rustix::io::read(master, &mut buffer) else { continue };
        let at = Instant::now();
        deframer.push(&buffer[..bytes]);
        if chain.lock().unwrap_or_else(PoisonError::into_inner).echo {
            write_all(master, &buffer[..bytes]);
        }
        while let Some(found) = deframer.pop() {
            let Found::Frame(frame) = found else { continue };
            let Ok(instruction) = decode_instruction(&frame) else { continue };
            let mut chain = chain.lock().unwrap_or_else(PoisonError::into_inner);
            let answer = chain.answer(frame.id, instruction, at);
            let hang_up = chain.hang_up && !answer.is_empty();
            drop(chain);
            if hang_up {
                write_all(master, &answer[..answer.len() / 2]);
                return;
            }
            write_all(master, &answer);
        }
    }
}

fn write_all(master: &OwnedFd, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        match rustix::io::write(master, bytes) {
            Ok(written) => bytes = &bytes[written..],
            Err(_) => return,
        }
    }
}
