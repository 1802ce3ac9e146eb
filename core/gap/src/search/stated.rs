//! How probable a name is that everything speaks for.
//!
//! Calibrated on names of eleven seeds of the blind test: 1550 of touches (`lean`, `worn`), 860 of poses (`arms`) and 1000 of eyes. One
//! seed is too few for that: names of `worn` that everything speaks for were right in 100 of a hundred cases of one seed and in 95
//! of another. `core/gap/README.md` has the figures.

use plumbline_effects::Kind;

/// How often a name is wrong where something unknown is at work beside it.
const MISLED: f64 = 0.7;
/// How probable it is at least that something unknown is at work that no rival resembles. Names of touches and poses that
/// everything speaks for were right in 98 to 99 of a hundred cases, those of eyes in 95 to 96.
const UNSEEN: f64 = 0.015;
const UNSEEN_OF_EYES: f64 = 0.05;

/// What a name is about, as far as its probability goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// Where the arm gets.
    Arm,
    /// What the eyes see.
    Eyes,
}

impl Source {
    pub fn of(kind: Kind) -> Self {
        if kind.is_of_eyes() { Self::Eyes } else { Self::Arm }
    }

    /// How probable a name that is sure otherwise is, when something unknown is at work with this probability.
    pub fn still_right(self, unknown: f64) -> f64 {
        let unseen = match self {
            Self::Arm => UNSEEN,
            Self::Eyes => UNSEEN_OF_EYES,
        };
        1.0 - MISLED * unknown.max(unseen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Source; 2] = [Source::Arm, Source::Eyes];

    #[test]
    fn no_name_is_surer_than_that_nothing_unknown_resembles_it() {
        for source in ALL {
            let sure = source.still_right(0.0);
            assert!(sure > 0.95 && sure < 0.995, "{source:?}: {sure}");
            assert_eq!(sure, source.still_right(1e-3));
            assert!(source.still_right(0.4) < 0.75 && source.still_right(1.0) > 0.0);
        }
        assert!(Source::Eyes.still_right(0.0) < Source::Arm.still_right(0.0));
    }
}
