//! Whether a move comes forward: a joint that something blocks may creep on, tick by tick, and heats up
//! meanwhile, without ever standing still.

/// A move that comes forward by less than this share of what it should is blocked. A twin on a computer that is busy with
/// much else comes forward by a tenth.
const LEAST_SHARE: f64 = 0.04;

/// How far a move came, beside how far it should have come. Only time in which it was meant to come forward
/// counts: not cycles that a busy computer was late for, nor waiting for readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Progress {
    /// Time looked at, s.
    since_s: f64,
    /// Share of the move that this time is.
    due: f64,
    /// Share of the move that was made in it.
    made: f64,
}

impl Progress {
    /// Notes a step of this time, s, that was meant to be this share of the move, and how much was made of it.
    pub fn note(&mut self, dt_s: f64, due: f64, made: f64) {
        self.since_s += dt_s;
        self.due += due;
        self.made += made;
    }

    /// Time in which the move hardly came forward, s, once it is longer than this; what came forward is looked at
    /// anew.
    pub fn creeps_for_s(&mut self, longest_s: f64) -> Option<f64> {
        if self.since_s < longest_s {
            return None;
        }
        let looked_at = std::mem::take(self);
        (looked_at.made < LEAST_SHARE * looked_at.due).then_some(looked_at.since_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(made_of_due: f64) -> Progress {
        let mut progress = Progress::default();
        for _ in 0..100 {
            progress.note(0.016, 0.004, 0.004 * made_of_due);
        }
        progress
    }

    #[test]
    fn what_creeps_is_told_from_what_is_slow() {
        assert_eq!(noted(0.02).creeps_for_s(1.5), Some(noted(0.02).since_s));
        assert_eq!(noted(0.1).creeps_for_s(1.5), None);
        assert_eq!(noted(0.0).creeps_for_s(2.0), None, "not yet");
    }

    #[test]
    fn a_move_that_came_forward_is_looked_at_anew() {
        let mut progress = noted(1.0);
        assert_eq!(progress.creeps_for_s(1.5), None);
        assert_eq!(progress, Progress::default());
    }
}
