//! A part of a step of a hand, told as it goes on.

use std::cell::Cell;
use std::time::Duration;

use plumbline_model::JobContext;
use plumbline_model::robot::Posture;

use crate::robot::duration;

/// What a hand does for a while, and which share of its step that is.
#[derive(Clone, Debug)]
pub struct Leg {
    doing: &'static str,
    /// Where it begins and where it ends, of 1.
    share: [f64; 2],
    /// How long its way takes.
    lasts: Duration,
    /// For how long it has been on its way; while it is held, it is not.
    on_its_way: Cell<Duration>,
    /// What was told last: it never goes back.
    told: Cell<f64>,
}

impl Leg {
    /// One that has just begun.
    pub fn new(doing: &'static str, share: [f64; 2]) -> Self {
        let [begins, _] = share;
        let (lasts, on_its_way) = (Duration::ZERO, Cell::default());
        Self { doing, share, lasts, on_its_way, told: Cell::new(begins) }
    }

    /// It sets out, through these postures at this speed.
    pub fn sets_out(&mut self, from: &Posture, way: &[Posture], speed_rad_s: f64) {
        let starts = std::iter::once(from).chain(way);
        self.lasts = starts.zip(way).map(|(from, to)| duration(from.distance_rad(to), speed_rad_s)).sum();
        self.on_its_way.set(Duration::ZERO);
    }

    /// It goes on for so long.
    pub fn goes_on(&self, for_so_long: Duration) {
        self.on_its_way.set(self.on_its_way.get() + for_so_long);
    }

    /// Tells how far it is.
    pub fn report(&self, context: &dyn JobContext) {
        let [begins, ends] = self.share;
        let now = begins + gone(self.on_its_way.get(), self.lasts) * (ends - begins);
        self.told.set(self.told.get().max(now));
        context.report(self.told.get(), self.doing);
    }
}

/// The share of a way that is gone; what takes longer than it should is never told to be at its end.
fn gone(since: Duration, lasts: Duration) -> f64 {
    if lasts.is_zero() {
        return 0.0;
    }
    let share = since.as_secs_f64() / lasts.as_secs_f64();
    share.min(0.95)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_goes_on_evenly_and_ends_only_when_it_has() {
        let second = Duration::from_secs(1);
        let told = [0, 1, 2, 9].map(|seconds| gone(seconds * second, 4 * second));
        assert_eq!(told, [0.0, 0.25, 0.5, 0.95]);
        assert_eq!(gone(second, Duration::ZERO), 0.0);
    }
}
