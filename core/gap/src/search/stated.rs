//! What evidence says of a name, and how probable the name is told to be.
//!
//! Calibrated on names of development cases of the blind test by their log loss (Platt 1999; Guo et al. 2017): 770 of touches
//! (`lean`, `worn`), 288 of poses (`arms`) and 500 of eyes. `core/gap/README.md` has the figures.

use plumbline_effects::Kind;

/// How often a name is wrong where something unknown is at work beside it.
const MISLED: f64 = 0.7;
/// How probable it is at least that something unknown is at work that no rival resembles. Names of touches and poses that
/// everything speaks for were right in 99 of a hundred cases, those of eyes in 94 to 96.
const UNSEEN: f64 = 0.012;
const UNSEEN_OF_EYES: f64 = 0.06;
/// Names of touches and poses that less speaks for are right more often than divided evidence says: by this in log odds.
const SURER: f64 = 0.3;

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

    /// How probable a name is by this evidence (0 to 1), so that it is right as often. Rises with it; what is sure stays sure.
    pub fn told(self, by_evidence: f64) -> f64 {
        match self {
            Self::Eyes => by_evidence,
            Self::Arm => {
                let better = SURER.exp() * by_evidence;
                better / (better + (1.0 - by_evidence))
            }
        }
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

    #[test]
    fn a_name_that_more_speaks_for_is_told_to_be_more_probable() {
        for source in ALL {
            let told: Vec<f64> = (0..=100).map(|percent| source.told(f64::from(percent) / 100.0)).collect();
            assert!(told.is_sorted() && told[0] == 0.0 && told[100] == 1.0, "{told:?}");
        }
        assert!(Source::Arm.told(0.5) > 0.55 && Source::Eyes.told(0.5) == 0.5);
    }
}
