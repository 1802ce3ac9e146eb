//! The noise floor: how far repeats of the same measurement scatter.

use plumbline_effects::measurements::Unit;
use plumbline_effects::{Observation, What};

use crate::finding::FloorSource;
use crate::statistics::robust_sd;

/// Nothing here is measured finer than this.
pub(crate) fn finest(unit: Unit) -> f64 {
    match unit {
        Unit::Meter => 2e-5,
        Unit::Radian => 2e-5,
        Unit::Pixel => 2e-3,
    }
}

/// How many times larger noise is than what a fit of so many columns leaves of it.
pub(crate) fn of_freedom(residuals: &[Option<Vec<f64>>], columns: usize) -> f64 {
    let total: usize = residuals.iter().flatten().map(Vec::len).sum();
    let free = (total as f64 - columns as f64).max(0.25 * total as f64);
    (total as f64 / free.max(1.0)).sqrt()
}

/// Noise of one measurement, per kind and natural coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Floor {
    /// Kinds that were measured.
    pub kinds: Vec<KindFloor>,
    /// Where it comes from, of the kind that knows it worst. Unless it is repeats, its scale is
    /// estimated again along with the effects.
    pub source: FloorSource,
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
    /// Whether repeats tell it.
    pub fn is_from_repeats(&self) -> bool {
        self.source == FloorSource::Repeats
    }

    /// What a model leaves, where nothing else tells the noise. `columns` were fitted to all rows;
    /// never more than it was, since a better model leaves less.
    pub fn refitted(&self, rows: &[Observation], residuals: &[Option<Vec<f64>>], columns: usize) -> Self {
        let inflate = of_freedom(residuals, columns);
        let mut next = self.clone();
        for kind in &mut next.kinds {
            let own = || {
                rows.iter()
                    .zip(residuals)
                    .filter(|(row, _)| row.what == kind.what)
                    .filter_map(|(_, r)| r.as_ref())
            };
            let fitted: Vec<f64> = (0..kind.what.len())
                .map(|c| inflate * robust_sd(own().filter_map(|residual| residual.get(c).copied())))
                .collect();
            for ((sd, fitted), (_, unit)) in kind.sd.iter_mut().zip(fitted).zip(kind.what.coordinates()) {
                *sd = sd.min(fitted.max(finest(*unit)));
            }
        }
        next
    }

    /// Largest ratio of its standard deviations to those of another one.
    pub fn shrunk_to(&self, other: &Self) -> f64 {
        let sd = |floor: &Self| floor.kinds.iter().flat_map(|kind| kind.sd.clone()).collect::<Vec<f64>>();
        sd(self).iter().zip(sd(other)).map(|(own, other)| own / other).fold(1.0, f64::min)
    }

    /// Of a kind; `None` when it was not measured.
    pub fn of(&self, what: What) -> Option<&KindFloor> {
        self.kinds.iter().find(|kind| kind.what == what)
    }
}
