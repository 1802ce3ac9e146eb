//! Whether the eyes are as warm as when they were calibrated: lenses turn in their mounts while they get
//! warm.

use super::view::{Gate, GateState};

/// Name of the gate.
const NAME: &str = "Warmth";
/// Housings of eyes reach their temperature with about this time constant, min: twenty minutes are 95 %
/// of the way.
const WARMING_MIN: f64 = 6.7;
/// A difference of more than this share of the whole way is worth a word: on the lab's twin, whose eyes
/// turn against each other by 10 mrad on the whole way, this share is 4 mm of depth at 0.45 m.
const SHARE: f64 = 0.15;

/// Nothing where it is not known how long they have been on, or were when they were calibrated. It warns
/// and does not refuse: M5 looks for hand and object with the same eyes and knows how high things stand.
pub(super) fn warmth(on_min: Option<f64>, calibrated_min: Option<f64>) -> Option<Gate> {
    let (on_min, calibrated_min) = (on_min?, calibrated_min?);
    let off = share(on_min) - share(calibrated_min);
    let doubt = |text: String| Some(Gate { name: NAME, state: GateState::Doubtful, text });
    if off < -SHARE {
        let enough_min = -WARMING_MIN * (1.0 - (share(calibrated_min) - SHARE)).ln();
        let wait_min = (enough_min - on_min).ceil().max(1.0);
        return doubt(format!(
            "The eyes have been on for {on_min:.0} min and were calibrated after {calibrated_min:.0} min: places are \
             off until they are as warm. Wait {wait_min:.0} min."
        ));
    }
    if off > SHARE {
        return doubt(format!(
            "The eyes have been on for {on_min:.0} min and were calibrated after {calibrated_min:.0} min, colder than \
             they are now: places are off. Calibrate them again."
        ));
    }
    let text = "The eyes are about as warm as when they were calibrated.".to_owned();
    Some(Gate { name: NAME, state: GateState::Open, text })
}

/// Share of the way from cold to warm.
fn share(on_min: f64) -> f64 {
    1.0 - (-on_min / WARMING_MIN).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(on_min: f64, calibrated_min: f64) -> (GateState, String) {
        let gate = warmth(Some(on_min), Some(calibrated_min)).expect("both are known");
        (gate.state, gate.text)
    }

    #[test]
    fn cold_eyes_with_a_calibration_made_warm_are_told_how_long_to_wait() {
        let (state, text) = said(2.0, 25.0);
        assert_eq!(state, GateState::Doubtful);
        assert!(text.contains("on for 2 min") && text.contains("Wait 10 min"), "{text}");
        // After that time nothing is said any more.
        assert_eq!(said(12.0, 25.0).0, GateState::Open);
    }

    #[test]
    fn warm_eyes_with_a_calibration_made_cold_are_to_be_calibrated_again() {
        let (state, text) = said(40.0, 3.0);
        assert_eq!(state, GateState::Doubtful);
        assert!(text.contains("Calibrate them again"), "{text}");
    }

    #[test]
    fn eyes_that_are_as_warm_pass_and_what_is_not_known_is_not_guessed() {
        for (on_min, calibrated_min) in [(30.0, 25.0), (3.0, 3.5), (600.0, 20.0)] {
            assert_eq!(said(on_min, calibrated_min).0, GateState::Open, "{on_min} {calibrated_min}");
        }
        assert!(warmth(None, Some(20.0)).is_none() && warmth(Some(20.0), None).is_none());
    }
}
