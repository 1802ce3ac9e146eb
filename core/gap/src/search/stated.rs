//! How probable a name is that everything speaks for.
//!
//! Calibrated on names of many seeds of the blind test: 1550 of touches (`lean`, `worn`), 860 of poses (`arms`) and 1500 of eyes. One
//! seed is too few for that: names of `worn` that everything speaks for were right in 100 of a hundred cases of one seed and in 95
//! of another. `core/gap/README.md` has the figures.

/// How often a name is wrong where something unknown is at work beside it.
const MISLED: f64 = 0.7;
/// How probable it is at least that something unknown is at work that no rival resembles. Names that everything speaks for
/// were right in 98 to 99 of a hundred cases.
const UNSEEN: f64 = 0.015;

/// How probable a name that is sure otherwise is, when something unknown is at work with this probability.
pub(crate) fn still_right(unknown: f64) -> f64 {
    1.0 - MISLED * unknown.max(UNSEEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_surer_than_that_nothing_unknown_resembles_it() {
        let sure = still_right(0.0);
        assert!(sure > 0.95 && sure < 0.995, "{sure}");
        assert_eq!(sure, still_right(1e-3));
        assert!(still_right(0.4) < 0.75 && still_right(1.0) > 0.0);
    }
}
