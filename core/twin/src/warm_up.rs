//! The eyes warm up: heat flows from their electronics to the housing and on to the room, and
//! the housing turns the lenses as it expands.

use nalgebra::{UnitQuaternion, Vector3};

use crate::scenario::HeatReality;

/// Longest step of the integration, s; a fifth of the shortest time constant that is allowed.
const STEP_S: f64 = 1.0;

/// Temperatures of the eyes above the room, and since when they are on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WarmUp {
    reality: HeatReality,
    electronics_k: f64,
    housing_k: f64,
    on_s: f64,
}

impl WarmUp {
    /// Cold eyes, just switched on.
    pub(crate) fn cold(reality: HeatReality) -> Self {
        Self { reality, electronics_k: 0.0, housing_k: 0.0, on_s: 0.0 }
    }

    /// Switched off, cooled, and on again.
    pub(crate) fn reset(&mut self) {
        *self = Self::cold(self.reality);
    }

    /// Time passes.
    pub(crate) fn pass(&mut self, duration_s: f64) {
        let steps = (duration_s / STEP_S).ceil().max(1.0);
        let dt_s = duration_s / steps;
        let r = &self.reality;
        for _ in 0..steps as usize {
            let inner_w = r.inner_w_per_k * (self.electronics_k - self.housing_k);
            let outer_w = r.outer_w_per_k * self.housing_k;
            self.electronics_k += dt_s * (r.power_w - inner_w) / r.electronics_j_per_k;
            self.housing_k += dt_s * (inner_w - outer_w) / r.housing_j_per_k;
        }
        self.on_s += duration_s;
    }

    /// Since when the eyes are on, s.
    pub(crate) fn on_s(&self) -> f64 {
        self.on_s
    }

    /// Turns of the left and the right eye, axes of the eye.
    pub(crate) fn turns(&self) -> (UnitQuaternion<f64>, UnitQuaternion<f64>) {
        let turn = |per_k: [f64; 3]| UnitQuaternion::from_scaled_axis(Vector3::from(per_k) * self.housing_k);
        (turn(self.reality.left_rad_per_k), turn(self.reality.right_rad_per_k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eyes() -> WarmUp {
        WarmUp::cold(HeatReality { left_rad_per_k: [0.0, 1e-3, 0.0], ..HeatReality::default() })
    }

    #[test]
    fn it_starts_slowly_and_ends_where_power_and_conductance_balance() {
        let mut warm = eyes();
        let angle = |warm: &WarmUp| warm.turns().0.angle();
        warm.pass(20.0);
        let early_rate = angle(&warm) / 20.0;
        warm.pass(60.0);
        let later_rate = (angle(&warm) - early_rate * 20.0) / 60.0;
        assert!(later_rate > 1.5 * early_rate, "heat reaches the housing late");
        warm.pass(3600.0 * 3.0);
        let expected = 1e-3 * 1.2 / 0.12;
        assert!((angle(&warm) - expected).abs() < 1e-6 * expected + 1e-9);
    }

    #[test]
    fn the_result_does_not_depend_on_how_time_is_cut() {
        let (mut once, mut often) = (eyes(), eyes());
        once.pass(300.0);
        for _ in 0..3000 {
            often.pass(0.1);
        }
        let difference = (once.turns().0.angle() - often.turns().0.angle()).abs();
        assert!(difference < 0.02 * often.turns().0.angle());
        assert!((once.on_s() - often.on_s()).abs() < 1e-6);
    }
}
