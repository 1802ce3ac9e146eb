//! Whether the eyes are as warm as when they were calibrated: lenses turn in their mounts while they get
//! warm.

use plumbline_effects::robot_model::{WARMING_S, warm_share};

/// A difference of more than this share of the whole way is worth a word: on the lab's twin, whose eyes
/// turn against each other by 10 mrad on the whole way, this share is 4 mm of depth at 0.45 m.
const SHARE: f64 = 0.15;
/// Less than this share of the way is not seen beside what else moves them.
const PASSES_SHARE: f64 = 0.05;

/// How warm the eyes are, beside how warm they were when they were calibrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warmth {
    /// About as warm.
    Alike,
    /// Colder.
    Colder {
        /// They are about as warm after so many minutes more.
        wait_min: f64,
    },
    /// Warmer.
    Warmer,
}

impl Warmth {
    /// Of eyes that have been on for so many minutes, calibrated after so many.
    pub fn of(on_min: f64, calibrated_min: f64) -> Self {
        let off = share(on_min) - share(calibrated_min);
        if off < -SHARE {
            let enough_min = -WARMING_S / 60.0 * (1.0 - (share(calibrated_min) - SHARE)).ln();
            Self::Colder { wait_min: (enough_min - on_min).ceil().max(1.0) }
        } else if off > SHARE {
            Self::Warmer
        } else {
            Self::Alike
        }
    }
}

/// Whether eyes that have been on for so many minutes still come nearer to how they were when they were calibrated: what
/// they see otherwise now may pass by itself.
pub fn still_gets_as_warm(on_min: f64, calibrated_min: f64) -> bool {
    share(calibrated_min) - share(on_min) > PASSES_SHARE
}

/// Whether eyes that have been on for so many minutes still see otherwise than they will when they are warm.
pub fn is_cold(on_min: f64) -> bool {
    1.0 - share(on_min) > SHARE
}

/// In how many minutes eyes that have been on for so many are about as warm as they get; `None`: they are.
pub fn cold_for_min(on_min: f64) -> Option<f64> {
    let enough_min = -WARMING_S / 60.0 * SHARE.ln();
    is_cold(on_min).then(|| (enough_min - on_min).ceil().max(1.0))
}

/// Share of the way from cold to warm.
fn share(on_min: f64) -> f64 {
    warm_share(60.0 * on_min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_waits_as_long_as_was_said_has_eyes_as_warm_as_then() {
        for (on_min, calibrated_min) in [(0.0, 25.0), (2.0, 25.0), (1.0, 8.0), (5.0, 300.0)] {
            let Warmth::Colder { wait_min } = Warmth::of(on_min, calibrated_min) else {
                panic!("{on_min} {calibrated_min}")
            };
            assert_eq!(
                Warmth::of(on_min + wait_min, calibrated_min),
                Warmth::Alike,
                "{on_min} {calibrated_min}"
            );
            assert!(wait_min >= 1.0 && on_min + wait_min < calibrated_min, "{wait_min}");
        }
    }

    #[test]
    fn eyes_are_cold_until_they_are_nearly_as_warm_as_they_get() {
        assert!(is_cold(0.0) && is_cold(3.0) && is_cold(12.0));
        assert!(!is_cold(13.0) && !is_cold(600.0));
        for on_min in [0.0, 3.0, 12.5] {
            let wait_min = cold_for_min(on_min).expect("they are cold");
            assert!(!is_cold(on_min + wait_min) && is_cold(on_min + wait_min - 1.5), "{on_min}: {wait_min}");
        }
        assert_eq!(cold_for_min(13.0), None);
    }

    #[test]
    fn what_may_pass_by_itself_does_so_some_minutes_after_they_are_about_as_warm() {
        assert_eq!(Warmth::of(13.0, 25.0), Warmth::Alike);
        assert!(still_gets_as_warm(13.0, 25.0) && !still_gets_as_warm(20.0, 25.0));
        assert!(!still_gets_as_warm(40.0, 3.0), "warmer than then, they do not come back");
    }

    #[test]
    fn alike_and_warmer() {
        for (on_min, calibrated_min) in [(30.0, 25.0), (3.0, 3.5), (600.0, 20.0)] {
            assert_eq!(Warmth::of(on_min, calibrated_min), Warmth::Alike, "{on_min} {calibrated_min}");
        }
        assert_eq!(Warmth::of(40.0, 3.0), Warmth::Warmer);
    }
}
