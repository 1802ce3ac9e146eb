//! What can be made to go wrong on the twin's bus.

use serde::{Deserialize, Serialize};
use strum::{EnumString, IntoStaticStr, VariantArray};

/// A fault of the servo bus. Those that say "sometimes" hit about one answer in eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[derive(EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Fault {
    /// Some answers do not come.
    Dropped,
    /// Some answers come too late.
    Late,
    /// Some answers have a wrong bit.
    Garbled,
    /// Some answers end early.
    Cut,
    /// Some answers have a wrong checksum.
    WrongChecksum,
    /// Some answers carry the id of another servo.
    WrongId,
    /// The adapter returns the host's own bytes.
    Echo,
    /// One servo (the elbow of the first arm) is not there.
    MissingServo,
    /// Two servos answer to the id of the first arm's elbow.
    TwoWithOneId,
    /// One servo (the elbow of the first arm) grows hot.
    HotServo,
    /// The power of all servos is off: they neither hear nor answer nor hold.
    PowerCut,
    /// The power of one servo (the elbow of the first arm) is off.
    ElbowPowerCut,
    /// The port is gone.
    PortClosed,
    /// The port vanishes in the middle of the next answer.
    PortClosedMidAnswer,
}

impl Fault {
    /// All of them.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// Short name.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The fault of a short name.
    pub fn from_name(name: &str) -> Option<Self> {
        name.parse().ok()
    }

    /// What happens, for people.
    pub fn about(self) -> &'static str {
        match self {
            Self::Dropped => "Some answers of servos do not come.",
            Self::Late => "Some answers of servos come 30 ms late.",
            Self::Garbled => "Some answers of servos arrive with a wrong bit.",
            Self::Cut => "Some answers of servos end early.",
            Self::WrongChecksum => "Some answers of servos have a wrong checksum.",
            Self::WrongId => "Some answers carry the id of another servo.",
            Self::Echo => "The adapter returns the program's own bytes.",
            Self::MissingServo => "The servo of the elbow is unplugged.",
            Self::TwoWithOneId => "Two servos answer to the id of the elbow.",
            Self::HotServo => "The servo of the elbow grows hot.",
            Self::PowerCut => "The power of all servos is off. Switched on again, they are limp.",
            Self::ElbowPowerCut => "The power of the elbow's servo is off. Switched on again, it is limp.",
            Self::PortClosed => "The port is unplugged.",
            Self::PortClosedMidAnswer => "The port is unplugged in the middle of an answer.",
        }
    }

    /// How long a late answer takes, s.
    pub(crate) const LATE_S: f64 = 0.030;
    /// One answer in so many is hit.
    pub(crate) const ONE_IN: u32 = 8;
    /// How fast the hot servo warms, K/s.
    pub(crate) const HEATING_K_PER_S: f64 = 1.5;
}
