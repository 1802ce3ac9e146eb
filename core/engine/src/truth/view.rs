//! Measured less true, for the window alone.

use std::sync::Arc;

/// Truth mode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruthView {
    /// Whether it is on.
    pub is_on: bool,
    /// Why there is nothing to compare with although it is on, a sentence.
    pub waits_because: Option<String>,
    /// One per thing that is compared, grouped.
    pub rows: Arc<[TruthRow]>,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TruthOf {
    /// Where the detector puts a toy.
    Toy,
    /// Where the finger is taken to be.
    Finger,
    /// Where the eyes are taken to sit and look.
    Mount,
    /// How a joint's angle is known.
    Zero,
    /// How a joint's axis is known.
    Axis,
}

impl TruthOf {
    /// All, in their order.
    pub const ALL: [Self; 5] = [Self::Toy, Self::Finger, Self::Mount, Self::Zero, Self::Axis];

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Toy => "Toys",
            Self::Finger => "Tip",
            Self::Mount => "Mount",
            Self::Zero => "Zeros",
            Self::Axis => "Axes",
        }
    }
}

/// Measured less true of one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthRow {
    /// What is compared.
    pub of: TruthOf,
    /// Which: "Tomato", "right elbow".
    pub name: String,
    /// Measured less true place, robot axes, m; `None`: it has none.
    pub off_m: Option<[f64; 3]>,
    /// Measured less true angle, rad; a zero has a sign, a direction has none.
    pub off_rad: Option<f64>,
}

impl TruthRow {
    /// How far it is off, m.
    pub fn distance_m(&self) -> Option<f64> {
        self.off_m.map(|[x, y, z]| x.hypot(y).hypot(z))
    }
}

impl TruthView {
    /// The row of a kind that is off most: by its place where it has one, else by its angle.
    pub fn worst(&self, of: TruthOf) -> Option<&TruthRow> {
        let off = |row: &TruthRow| row.distance_m().or(row.off_rad.map(f64::abs)).unwrap_or_default();
        self.rows.iter().filter(|row| row.of == of).max_by(|a, b| off(a).total_cmp(&off(b)))
    }
}
