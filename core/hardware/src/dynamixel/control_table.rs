//! Registers of the servo models, read from the files in `control_tables`, and the one place
//! where raw values become SI values and back.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::OnceLock;

use plumbline_model::robot::servo::{self, FULL, LAST_TICK, SIGN_BIT, TICKS_PER_TURN};
use serde::Deserialize;

/// A position as the servo counts it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticks(pub u16);

/// What is kept in a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "named as in the makers' manuals")]
pub enum Item {
    ModelNumber,
    FirmwareVersion,
    Id,
    BaudRate,
    ReturnDelayTime,
    CwAngleLimit,
    CcwAngleLimit,
    TemperatureLimit,
    MinVoltageLimit,
    MaxVoltageLimit,
    MaxTorque,
    StatusReturnLevel,
    AlarmLed,
    Shutdown,
    MultiTurnOffset,
    ResolutionDivider,
    GainLock,
    TorqueEnable,
    Led,
    DGain,
    IGain,
    PGain,
    GoalPosition,
    MovingSpeed,
    TorqueLimit,
    PresentPosition,
    PresentSpeed,
    PresentLoad,
    PresentVoltage,
    PresentTemperature,
    Registered,
    Moving,
    Lock,
    HardwareError,
    Punch,
    OverloadFilterThreshold,
    OverloadFilterValue,
    PresentCurrent,
    TorqueControlMode,
    GoalTorque,
    CurrentLimit,
    GoalAcceleration,
    PalmSensorInstalled,
    PalmInfrared,
    PalmCapacitive,
    #[serde(rename = "palm_capacitive_2")]
    PalmCapacitive2,
    GearTrain,
    Electronics,
}

/// Who may change a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Access {
    /// The servo only.
    #[serde(rename = "r")]
    Read,
    /// The host too.
    #[serde(rename = "rw")]
    ReadWrite,
}

/// Unit of a register's SI value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// A code, a gain, a flag.
    #[default]
    Raw,
    /// Angle of the motor, zero in the middle of its range.
    Rad,
    /// Speed of the motor.
    RadianPerSecond,
    /// Acceleration of the motor.
    RadianPerSecondSquared,
    /// Part of the largest.
    Fraction,
    /// Volt.
    Volt,
    /// Degrees Celsius.
    Celsius,
    /// Ampere.
    Ampere,
    /// Seconds.
    #[serde(rename = "s")]
    Second,
}

/// How a number is written in a register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coding {
    /// As it is.
    #[default]
    Unsigned,
    /// Ten bits of size, bit 10 set when negative (clockwise).
    #[serde(rename = "sign_bit_10")]
    SignBit10,
}

impl Unit {
    /// SI value of one count where the table does not say otherwise.
    fn usual_scale(self) -> f64 {
        match self {
            Self::Raw | Self::Celsius | Self::Ampere => 1.0,
            Self::Rad => servo::TICK_RAD,
            Self::RadianPerSecond => servo::SPEED_RAD_S,
            Self::RadianPerSecondSquared => servo::ACCELERATION_RAD_S2,
            Self::Fraction => servo::FRACTION,
            Self::Volt => servo::VOLTAGE_V,
            Self::Second => servo::RETURN_DELAY_S,
        }
    }

    /// Count that stands for zero where the table does not say otherwise.
    fn usual_zero(self) -> u16 {
        if self == Self::Rad { servo::MIDDLE_TICK } else { 0 }
    }
}

/// One register.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "Line")]
pub struct Register {
    /// Where it begins.
    pub address: u16,
    /// Bytes, low byte first: 1 or 2.
    pub size: u16,
    /// Who may change it.
    pub access: Access,
    /// Unit of the SI value.
    pub unit: Unit,
    /// SI value of one count.
    pub scale: f64,
    /// Count that stands for zero.
    pub zero: u16,
    /// How the number is written.
    pub coding: Coding,
}

/// A register as its file tells it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    address: u16,
    size: u16,
    access: Access,
    #[serde(default)]
    unit: Unit,
    scale: Option<f64>,
    zero: Option<u16>,
    #[serde(default)]
    coding: Coding,
}

impl From<Line> for Register {
    fn from(line: Line) -> Self {
        let Line { address, size, access, unit, scale, zero, coding } = line;
        let scale = scale.unwrap_or_else(|| unit.usual_scale());
        let zero = zero.unwrap_or_else(|| unit.usual_zero());
        Self { address, size, access, unit, scale, zero, coding }
    }
}

impl Register {
    /// Largest number that fits.
    fn largest(&self) -> u16 {
        match (self.coding, self.size) {
            (Coding::SignBit10, _) => FULL,
            (_, 1) => 0xFF,
            _ => u16::MAX,
        }
    }

    /// SI value of a raw one.
    pub fn si(&self, raw: u16) -> f64 {
        let count = match self.coding {
            Coding::Unsigned => f64::from(raw) - f64::from(self.zero),
            Coding::SignBit10 => f64::from(raw & FULL) * if raw & SIGN_BIT == 0 { 1.0 } else { -1.0 },
        };
        count * self.scale
    }

    /// Nearest raw value; `None` when it does not fit or is not a number.
    pub fn raw(&self, si: f64) -> Option<u16> {
        let count = (si / self.scale).round();
        let (size, sign) = match self.coding {
            Coding::Unsigned => (count + f64::from(self.zero), 0),
            Coding::SignBit10 => (count.abs(), if count < 0.0 { SIGN_BIT } else { 0 }),
        };
        // NaN fails the comparison.
        let fits = size >= 0.0 && size <= f64::from(self.largest());
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "kept only if it fits; floats saturate"
        )]
        fits.then_some(size as u16 | sign)
    }

    /// Bytes of a raw value.
    pub fn bytes(&self, raw: u16) -> Vec<u8> {
        raw.to_le_bytes()[..usize::from(self.size.min(2))].to_vec()
    }

    /// Raw value out of `data`, which begins at the address `first`; `None` when it is not in there.
    pub fn in_data(&self, first: u16, data: &[u8]) -> Option<u16> {
        let begin = usize::from(self.address.checked_sub(first)?);
        match data.get(begin..begin + usize::from(self.size))? {
            [byte] => Some(u16::from(*byte)),
            [low, high] => Some(u16::from_le_bytes([*low, *high])),
            _ => None,
        }
    }
}

/// All registers of a model.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlTable {
    /// As rig files call it.
    pub model: String,
    /// As the servo tells it.
    pub number: u16,
    /// Whether it is a motor.
    pub moves: bool,
    /// Whether it answers a bulk read.
    pub bulk_read: bool,
    registers: BTreeMap<Item, Register>,
}

const FILES: [&str; 4] = [
    include_str!("../../control_tables/mx_64.toml"),
    include_str!("../../control_tables/mx_28.toml"),
    include_str!("../../control_tables/seed28.toml"),
    include_str!("../../control_tables/eros_board.toml"),
];

impl ControlTable {
    /// All known models.
    pub fn all() -> &'static [Self] {
        static TABLES: OnceLock<Vec<ControlTable>> = OnceLock::new();
        TABLES.get_or_init(|| {
            let read =
                |file: &str| toml::from_str(file).expect("the tables are part of the program, and tested");
            FILES.into_iter().map(read).collect()
        })
    }

    /// The table of a model by its name, whatever follows the name and in either case: servos are
    /// also called "MX-64T" or "SR-EROSBRD-".
    pub fn of_model(name: &str) -> Option<&'static Self> {
        let plain = |text: &str| text.to_uppercase().replace(['-', '_', ' '], "");
        let bare = |text: &str| plain(text).trim_start_matches("SR").to_owned();
        let name = bare(name);
        Self::all().iter().find(|table| name.starts_with(&bare(&table.model)))
    }

    /// The table of a model by its number.
    pub fn of_number(number: u16) -> Option<&'static Self> {
        Self::all().iter().find(|table| table.number == number)
    }

    /// A register, if the model has it.
    pub fn register(&self, item: Item) -> Option<&Register> {
        self.registers.get(&item)
    }

    /// All registers, by their meaning.
    pub fn registers(&self) -> impl Iterator<Item = (Item, &Register)> {
        self.registers.iter().map(|(item, register)| (*item, register))
    }

    /// Bytes from address 0 to the last register: the memory of a servo.
    pub fn memory_bytes(&self) -> usize {
        self.registers.values().map(|r| usize::from(r.address + r.size)).max().unwrap_or(0)
    }

    /// Angle of the motor (rad), zero in the middle of its range.
    pub fn motor_rad(&self, ticks: Ticks) -> Option<f64> {
        Some(self.register(Item::PresentPosition)?.si(ticks.0))
    }

    /// Nearest position to a motor angle (rad); `None` when it is more than one tick out
    /// of range, or not a number. Half a turn is one tick more than there is, and counts as the
    /// last one.
    pub fn ticks(&self, motor_rad: f64) -> Option<Ticks> {
        match self.register(Item::GoalPosition)?.raw(motor_rad)? {
            TICKS_PER_TURN => Some(Ticks(LAST_TICK)),
            ticks => (ticks <= LAST_TICK).then_some(Ticks(ticks)),
        }
    }
}

impl fmt::Display for ControlTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.model)
    }
}
