//! One cycle's conversation with all servos: goals out, readings in, within a deadline.

use std::time::{Duration, Instant};

use super::reading::JointReading;
use super::refusal::Refusal;
use super::servo_unit::{Measured, ServoUnit};
use crate::dynamixel::{BulkItem, Bus, BusError, Item, Status};

/// Cycles without an answer, and time, after which a servo no longer takes part.
const GIVE_UP: u32 = 12;
const GIVE_UP_TIME: Duration = Duration::from_millis(400);
/// The first attempt of a cycle waits as long as answers take at the moment.
const FIRST_ATTEMPT: Duration = Duration::from_millis(100);
/// A servo that was given up is asked again every so many cycles.
const ASK_AGAIN: u64 = 32;
/// Cycles with an answer to a single read but none to the bulk read after which it is read singly.
const NO_BULK: u32 = 30;

/// A servo, what is known of it, and how it answers.
#[derive(Clone, Debug)]
pub(super) struct Slot {
    pub unit: ServoUnit,
    pub reading: JointReading,
    /// Cycles in a row without an answer.
    pub missed: u32,
    /// What it complained about last.
    pub complaint: Option<String>,
    /// Whether it raises an alarm (overload, overheating).
    pub alarm: bool,
    /// Whether its torque was on and is off without our doing.
    pub torque_lost: bool,
    /// It raised an alarm, and may have switched its torque off; a goal would switch it on again.
    suspect: bool,
    reads_singly: bool,
    no_bulk: u32,
}

impl Slot {
    pub fn new(unit: ServoUnit) -> Self {
        let reading = JointReading::new(unit.servo.joint, unit.id());
        let reads_singly = !unit.table.bulk_read;
        Self {
            unit,
            reading,
            missed: 0,
            complaint: None,
            alarm: false,
            torque_lost: false,
            suspect: false,
            reads_singly,
            no_bulk: 0,
        }
    }

    /// Whether it takes part in every cycle.
    pub fn in_use(&self) -> bool {
        self.missed < GIVE_UP || (self.missed < u32::MAX && self.silence() < GIVE_UP_TIME)
    }

    /// Time since the last answer; long before the first.
    pub fn silence(&self) -> Duration {
        self.reading.read_at.map_or(Duration::MAX, |at| at.elapsed())
    }

    pub fn holds_torque(&self) -> bool {
        self.reading.torque_on == Some(true)
    }

    fn take(&mut self, status: &Status) {
        let now = Instant::now();
        let Measured { angle_rad, speed_rad_s, load, voltage_v, temperature_c } =
            self.unit.measured(&status.data);
        let reading = &mut self.reading;
        reading.angle_rad = angle_rad;
        reading.speed_rad_s = speed_rad_s;
        reading.load = load;
        reading.voltage_v = voltage_v;
        reading.temperature_c = temperature_c;
        self.complaint = (!status.error.is_none()).then(|| status.error.to_string());
        if angle_rad.is_some() {
            reading.read_at = Some(now);
            self.missed = 0;
        } else {
            self.missed = self.missed.saturating_add(1);
            self.complaint = Some("its position is out of range: take it out of multi-turn mode".to_owned());
        }
        let alarm = status.error.is_alarm();
        self.suspect |= alarm && !self.alarm;
        self.alarm = alarm;
    }
}

/// All servos of a rig on a bus.
#[derive(Debug)]
pub(super) struct Exchange {
    pub bus: Bus,
    pub slots: Vec<Slot>,
    /// Largest speed of a joint, rad/s; servos are told a little more.
    pub speed_rad_s: f64,
    turn: u64,
}

/// How many bytes are read to learn the return delay.
const RETURN_DELAY_BYTES: u16 = 4;

/// Goals whose registers lie at the same place.
struct GoalPacket {
    address: u16,
    length: u16,
    goals: Vec<(u8, Vec<u8>)>,
}

/// A servo may catch up with its goal at this much more than the largest planned speed.
const CATCH_UP: f64 = 1.25;

impl Exchange {
    pub fn new(bus: Bus, units: Vec<ServoUnit>, speed_rad_s: f64) -> Self {
        Self { bus, slots: units.into_iter().map(Slot::new).collect(), speed_rad_s, turn: 0 }
    }

    /// Sends goals (rad of the joint) to servos that have torque; a goal would switch the torque of
    /// the others on. One packet for all servos whose goals lie at the same address.
    pub fn send_goals(
        &mut self,
        goal_rad: impl Fn(usize, &Slot) -> Option<f64>,
    ) -> Result<Option<Refusal>, BusError> {
        let mut refusal = None;
        let mut packets: Vec<GoalPacket> = vec![];
        for (i, slot) in self.slots.iter_mut().enumerate() {
            if !slot.holds_torque() || !slot.in_use() || slot.suspect {
                continue;
            }
            let (Some(goal_rad), Some(address)) = (goal_rad(i, slot), slot.unit.goal_address()) else {
                continue;
            };
            let bytes = match slot.unit.goal_bytes(goal_rad, self.speed_rad_s * CATCH_UP) {
                Ok(bytes) => bytes,
                Err(error) => {
                    refusal = Some(error);
                    continue;
                }
            };
            slot.reading.goal_rad = Some(goal_rad);
            let length = bytes.len() as u16;
            match packets.iter_mut().find(|packet| (packet.address, packet.length) == (address, length)) {
                Some(packet) => packet.goals.push((slot.unit.id(), bytes)),
                None => packets.push(GoalPacket { address, length, goals: vec![(slot.unit.id(), bytes)] }),
            }
        }
        for packet in packets {
            self.bus.sync_write(packet.address, packet.length, packet.goals)?;
        }
        Ok(refusal)
    }

    /// Reads every servo in use once, repeats what failed until `deadline`, and asks one servo for
    /// what changes slowly. Returns whether all answered.
    pub fn read_all(&mut self, deadline: Instant) -> Result<bool, BusError> {
        self.turn += 1;
        let first = Instant::now() + FIRST_ATTEMPT;
        let mut open = vec![];
        let bulk: Vec<usize> = (0..self.slots.len()).filter(|i| self.in_bulk(*i)).collect();
        let items: Vec<BulkItem> = bulk.iter().map(|i| self.item(*i)).collect();
        for (i, answer) in bulk.iter().zip(self.bus.bulk_read(&items, first)?) {
            match answer {
                Ok(status) => {
                    self.slots[*i].take(&status);
                    self.slots[*i].no_bulk = 0;
                }
                Err(_) => open.push(*i),
            }
        }
        for i in 0..self.slots.len() {
            if (self.slots[i].in_use() && self.slots[i].reads_singly) || self.asked_again(i) {
                self.read_one(i, first, &mut open)?;
            }
        }
        for _ in 1..self.bus.timing().attempts {
            for i in std::mem::take(&mut open) {
                if Instant::now() >= deadline || !self.slots[i].in_use() {
                    open.push(i);
                    continue;
                }
                self.bus.count_retry();
                if self.read_one(i, deadline, &mut open)? && !self.slots[i].reads_singly {
                    self.slots[i].no_bulk += 1;
                    self.slots[i].reads_singly = self.slots[i].no_bulk >= NO_BULK;
                }
            }
        }
        for i in &open {
            self.slots[*i].missed = self.slots[*i].missed.saturating_add(1);
        }
        if Instant::now() < deadline {
            self.read_slow()?;
        }
        Ok(open.iter().all(|i| !self.slots[*i].in_use()))
    }

    fn in_bulk(&self, i: usize) -> bool {
        self.slots[i].in_use() && !self.slots[i].reads_singly
    }

    fn asked_again(&self, i: usize) -> bool {
        !self.slots[i].in_use() && (self.turn + i as u64).is_multiple_of(ASK_AGAIN)
    }

    fn item(&self, i: usize) -> BulkItem {
        let unit = &self.slots[i].unit;
        BulkItem { id: unit.id(), address: unit.block.0, length: unit.block.1 }
    }

    fn read_one(&mut self, i: usize, deadline: Instant, open: &mut Vec<usize>) -> Result<bool, BusError> {
        let BulkItem { id, address, length } = self.item(i);
        let instruction = crate::dynamixel::Instruction::Read { address, length };
        match self.bus.ask_once(id, &instruction, Some(usize::from(length)), deadline)? {
            Ok(status) => {
                self.slots[i].take(&status);
                Ok(true)
            }
            Err(_) => {
                open.push(i);
                Ok(false)
            }
        }
    }

    /// Torque or current of one servo per cycle, round and round; first the torque of one that
    /// raised an alarm.
    fn read_slow(&mut self) -> Result<(), BusError> {
        let n = self.slots.len() as u64;
        if n == 0 {
            return Ok(());
        }
        let suspect = self.slots.iter().position(|slot| slot.suspect && slot.in_use());
        let i = suspect.unwrap_or((self.turn / 2 % n) as usize);
        if !self.slots[i].in_use() {
            return Ok(());
        }
        let is_torque = suspect.is_some() || self.turn.is_multiple_of(2);
        let item = if is_torque { Item::TorqueEnable } else { Item::PresentCurrent };
        let Some(register) = self.slots[i].unit.table.register(item).copied() else { return Ok(()) };
        let id = self.slots[i].unit.id();
        let instruction =
            crate::dynamixel::Instruction::Read { address: register.address, length: register.size };
        let soon = Instant::now() + Duration::from_millis(10);
        let answer = self.bus.ask_once(id, &instruction, Some(usize::from(register.size)), soon)?;
        let Some(raw) = answer.ok().and_then(|status| register.in_data(register.address, &status.data))
        else {
            return Ok(());
        };
        let slot = &mut self.slots[i];
        if item == Item::PresentCurrent {
            slot.reading.current_a = Some(register.si(raw));
        } else {
            let on = raw != 0;
            slot.torque_lost |= slot.reading.torque_on == Some(true) && !on;
            slot.reading.torque_on = Some(on);
            slot.suspect = false;
        }
        Ok(())
    }

    /// Reads torque and goal of every servo in use, at the beginning: who holds already goes on
    /// holding where it was told to.
    pub fn read_torques(&mut self) -> Result<(), BusError> {
        for slot in &mut self.slots {
            let Some(register) = slot.unit.table.register(Item::TorqueEnable).filter(|_| slot.missed == 0)
            else {
                continue;
            };
            self.bus.await_owed(slot.unit.id())?;
            match self.bus.read(slot.unit.id(), register.address, register.size) {
                Ok(status) => slot.reading.torque_on = status.data.first().map(|on| *on != 0),
                Err(BusError::Servo { .. }) => continue,
                Err(error) => return Err(error),
            }
            let Some(register) = slot.unit.table.register(Item::GoalPosition).filter(|_| slot.holds_torque())
            else {
                continue;
            };
            match self.bus.read(slot.unit.id(), register.address, register.size) {
                Ok(status) => slot.reading.goal_rad = slot.unit.goal_rad(&status.data),
                Err(BusError::Servo { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Makes servos answer after `delay_s` where they wait longer. They take it only without torque.
    pub fn shorten_return_delays(&mut self, delay_s: f64) -> Result<(), BusError> {
        for slot in &mut self.slots {
            let Some(register) = slot.unit.table.register(Item::ReturnDelayTime) else { continue };
            if slot.missed > 0 || slot.reading.torque_on != Some(false) {
                continue;
            }
            let Some(raw) = register.raw(delay_s) else { continue };
            let id = slot.unit.id();
            // Read together with its neighbors, because every question has its own length: a late
            // answer is never taken for one about the torque.
            let (first, length) = (register.address - 1, RETURN_DELAY_BYTES);
            let outcome = self.bus.read(id, first, length).and_then(|status| match status.data.first() {
                Some(now) if u16::from(*now) > raw => {
                    self.bus.write(id, register.address, &register.bytes(raw)).map(|_| ())
                }
                _ => Ok(()),
            });
            match outcome {
                Ok(()) | Err(BusError::Servo { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Switches torque. Switched on, a servo holds where it is: its goal is written first.
    pub fn switch_torque(&mut self, i: usize, on: bool) -> Result<Option<Refusal>, BusError> {
        self.bus.be_patient(true);
        let switched = self.try_switch_torque(i, on);
        self.bus.be_patient(false);
        switched
    }

    fn try_switch_torque(&mut self, i: usize, on: bool) -> Result<Option<Refusal>, BusError> {
        let slot = &mut self.slots[i];
        let (joint, name) = (slot.unit.servo.joint, slot.unit.servo.title.clone());
        let unknown = Refusal::Unknown { joint, name };
        let Some(register) = slot.unit.table.register(Item::TorqueEnable) else { return Ok(Some(unknown)) };
        let id = slot.unit.id();
        self.bus.await_owed(id)?;
        let written = (|| {
            if on {
                let BulkItem { address, length, .. } =
                    BulkItem { id, address: slot.unit.block.0, length: slot.unit.block.1 };
                let status = self.bus.read(id, address, length)?;
                slot.take(&status);
                let goal = slot.reading.angle_rad.and_then(|angle_rad| {
                    Some((slot.unit.goal_address()?, slot.unit.goal_bytes(angle_rad, self.speed_rad_s).ok()?))
                });
                let Some((address, bytes)) = goal else { return Ok(false) };
                self.bus.write(id, address, &bytes)?;
                slot.reading.goal_rad = slot.reading.angle_rad;
            }
            self.bus.write(id, register.address, &[u8::from(on)])?;
            // Only what the servo itself says counts.
            let told = self.bus.read(id, register.address, register.size)?;
            Ok(register.in_data(register.address, &told.data).map(|raw| raw != 0) == Some(on))
        })();
        match written {
            Ok(true) => {
                slot.reading.torque_on = Some(on);
                slot.torque_lost = false;
                slot.suspect = false;
                if !on {
                    slot.reading.goal_rad = None;
                }
                Ok(None)
            }
            Ok(false) | Err(BusError::Servo { .. }) => Ok(Some(unknown)),
            Err(error) => Err(error),
        }
    }
}
