//! The registers of one servo.

use plumbline_hardware::dynamixel::{Access, ControlTable, Item};
use plumbline_model::robot::servo::{FACTORY_P_GAIN, FULL, LAST_TICK};

/// Bits of the error byte of protocol 1.0.
pub(crate) mod error_bit {
    /// A goal outside of the angle limits.
    pub const ANGLE: u8 = 0x02;
    /// Too hot.
    pub const HOT: u8 = 0x04;
    /// An address or a value that does not exist.
    pub const RANGE: u8 = 0x08;
    /// An instruction arrived broken.
    pub const CHECKSUM: u8 = 0x10;
    /// Overloaded.
    pub const OVERLOAD: u8 = 0x20;
    /// An instruction that is not known.
    pub const INSTRUCTION: u8 = 0x40;
}

/// Bytes by address, with the table that says what they mean.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    table: &'static ControlTable,
    bytes: Vec<u8>,
    /// Written, waiting for the action.
    waiting: Option<(u16, Vec<u8>)>,
}

impl Memory {
    /// As from the factory, with an id.
    pub(crate) fn new(table: &'static ControlTable, id: u8) -> Self {
        let mut memory = Self { table, bytes: vec![0; table.memory_bytes()], waiting: None };
        memory.set(Item::ModelNumber, table.number);
        memory.set(Item::FirmwareVersion, 36);
        memory.set(Item::Id, u16::from(id));
        // 1 Mbaud; the return delay is set to none, as everyone does who reads many servos.
        memory.set(Item::BaudRate, 1);
        memory.set(Item::TemperatureLimit, 80);
        memory.set(Item::MinVoltageLimit, 60);
        memory.set(Item::MaxVoltageLimit, 160);
        memory.set(Item::MaxTorque, FULL);
        memory.set(Item::TorqueLimit, FULL);
        memory.set(Item::StatusReturnLevel, 2);
        memory.set(Item::AlarmLed, 36);
        memory.set(Item::Shutdown, 36);
        memory.set(Item::PGain, FACTORY_P_GAIN);
        memory.set(Item::CcwAngleLimit, LAST_TICK);
        memory
    }

    pub(crate) fn table(&self) -> &'static ControlTable {
        self.table
    }

    /// Raw value of a register; `None` when the model has none.
    pub(crate) fn get(&self, item: Item) -> Option<u16> {
        self.table.register(item)?.in_data(0, &self.bytes)
    }

    /// SI value of a register.
    pub(crate) fn si(&self, item: Item) -> Option<f64> {
        Some(self.table.register(item)?.si(self.get(item)?))
    }

    /// Sets a register from inside; models without it ignore that.
    pub(crate) fn set(&mut self, item: Item, raw: u16) {
        let Some(register) = self.table.register(item) else { return };
        let begin = usize::from(register.address);
        for (byte, value) in self.bytes[begin..].iter_mut().zip(register.bytes(raw)) {
            *byte = value;
        }
    }

    /// Sets a register to the nearest value there is, from inside.
    pub(crate) fn set_si(&mut self, item: Item, si: f64) {
        let Some(register) = self.table.register(item) else { return };
        let most = register.si(if register.size == 1 { 0xFF } else { FULL });
        let raw = register.raw(si).or_else(|| register.raw(si.clamp(-most, most)));
        if let Some(raw) = raw {
            self.set(item, raw);
        }
    }

    /// What the host reads; `Err` is the error byte.
    pub(crate) fn read(&self, address: u16, length: u16) -> Result<Vec<u8>, u8> {
        let begin = usize::from(address);
        self.bytes.get(begin..begin + usize::from(length)).map(<[u8]>::to_vec).ok_or(error_bit::RANGE)
    }

    /// What the host writes; `Err` is the error byte, and nothing is stored then.
    pub(crate) fn write(&mut self, address: u16, data: &[u8]) -> Result<(), u8> {
        let end = usize::from(address) + data.len();
        if data.is_empty() || end > self.bytes.len() || !self.writable(address, data.len()) {
            return Err(error_bit::RANGE);
        }
        let mut later = self.clone();
        later.bytes[usize::from(address)..end].copy_from_slice(data);
        let covers = |item| {
            self.table.register(item).is_some_and(|r| r.address < end as u16 && r.address + r.size > address)
        };
        if covers(Item::GoalPosition) && !later.goal_allowed() {
            return Err(error_bit::ANGLE);
        }
        if covers(Item::TorqueEnable) && later.get(Item::TorqueEnable).is_some_and(|on| on > 1) {
            return Err(error_bit::RANGE);
        }
        self.bytes = later.bytes;
        Ok(())
    }

    /// Keeps what the host writes for the action.
    pub(crate) fn keep(&mut self, address: u16, data: &[u8]) -> Result<(), u8> {
        self.clone().write(address, data)?;
        self.waiting = Some((address, data.to_vec()));
        self.set(Item::Registered, 1);
        Ok(())
    }

    /// Stores what was kept.
    pub(crate) fn act(&mut self) {
        self.set(Item::Registered, 0);
        if let Some((address, data)) = self.waiting.take() {
            // It was checked when it was kept; limits that changed since then win.
            let _ = self.write(address, &data);
        }
    }

    /// All bytes lie in registers that the host may change, or between registers.
    fn writable(&self, address: u16, length: usize) -> bool {
        let end = usize::from(address) + length;
        !self.table.registers().any(|(_, register)| {
            let begin = usize::from(register.address);
            register.access == Access::Read
                && begin < end
                && begin + usize::from(register.size) > usize::from(address)
        })
    }

    fn goal_allowed(&self) -> bool {
        let Some(goal) = self.get(Item::GoalPosition) else { return true };
        let low = self.get(Item::CwAngleLimit).unwrap_or(0);
        let high = self.get(Item::CcwAngleLimit).unwrap_or(LAST_TICK);
        (low..=high).contains(&goal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mx64() -> Memory {
        Memory::new(ControlTable::of_model("MX-64").expect("known"), 5)
    }

    #[test]
    fn it_says_who_it_is() {
        let memory = mx64();
        assert_eq!(memory.read(0, 4), Ok(vec![0x36, 0x01, 36, 5]), "310, little end first");
    }

    #[test]
    fn read_only_and_missing_registers_are_not_written() {
        let mut memory = mx64();
        assert_eq!(memory.write(36, &[0, 8]), Err(error_bit::RANGE), "present position");
        assert_eq!(memory.write(400, &[1]), Err(error_bit::RANGE));
        assert_eq!(memory.read(200, 2), Err(error_bit::RANGE));
        assert_eq!(memory.write(24, &[7]), Err(error_bit::RANGE), "torque is on or off");
    }

    #[test]
    fn a_goal_outside_of_the_limits_is_refused_and_changes_nothing() {
        let mut memory = mx64();
        memory.set(Item::CwAngleLimit, 1000);
        memory.set(Item::CcwAngleLimit, 3000);
        assert_eq!(memory.write(30, &2000u16.to_le_bytes()), Ok(()));
        assert_eq!(memory.write(30, &3001u16.to_le_bytes()), Err(error_bit::ANGLE));
        assert_eq!(memory.get(Item::GoalPosition), Some(2000));
    }

    #[test]
    fn what_is_kept_is_stored_at_the_action() {
        let mut memory = mx64();
        assert_eq!(memory.keep(30, &1234u16.to_le_bytes()), Ok(()));
        assert_eq!((memory.get(Item::Registered), memory.get(Item::GoalPosition)), (Some(1), Some(0)));
        memory.act();
        assert_eq!((memory.get(Item::Registered), memory.get(Item::GoalPosition)), (Some(0), Some(1234)));
    }
}
