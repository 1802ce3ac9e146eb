//! The noise floor: how far repeats of the same measurement scatter.

use plumbline_effects::{Observation, What};

/// Noise of one measurement, per kind and natural coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Floor {
    /// Kinds that were measured.
    pub kinds: Vec<KindFloor>,
    /// Whether it comes from repeats; else from near neighbors, or a guess, and its scale is
    /// estimated again along with the effects.
    pub from_repeats: bool,
}

/// Noise of one kind of measurement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KindFloor {
    /// Which.
    pub what: What,
    /// Standard deviation of ONE measurement, per natural coordinate, in its unit; positive.
    pub sd: Vec<f64>,
    /// Degrees of freedom behind it, per coordinate.
    pub degrees_of_freedom: f64,
    /// Median of the instrument's own standard deviations, m, where every row has one: rows that it
    /// measured worse count less.
    pub sigma_m: Option<f64>,
}

impl KindFloor {
    /// Standard deviation of a coordinate of one row.
    pub fn of_row(&self, row: &Observation, coordinate: usize) -> f64 {
        let sd = self.sd[coordinate];
        match (self.sigma_m, row.sigma_m) {
            (Some(usual), Some(own)) if row.what.is_pose() && coordinate < 3 => sd * own / usual,
            _ => sd,
        }
    }
}

impl Floor {
    /// Of a kind; `None` when it was not measured.
    pub fn of(&self, what: What) -> Option<&KindFloor> {
        self.kinds.iter().find(|kind| kind.what == what)
    }
}
