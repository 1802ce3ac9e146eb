//! The gate of how warm the eyes are.

use super::view::{Gate, GateState, Need};
use crate::ground::warming::Warmth;

/// Nothing where it is not known how long they have been on, or were when they were calibrated. It warns
/// and does not refuse: M5 looks for hand and object with the same eyes and knows how high things stand.
pub(super) fn warmth(on_min: Option<f64>, calibrated_min: Option<f64>) -> Option<Gate> {
    let (on_min, calibrated_min) = (on_min?, calibrated_min?);
    let doubt = |text: String| Some(Gate { of: Need::Warmth, state: GateState::Doubtful, text });
    match Warmth::of(on_min, calibrated_min) {
        Warmth::Colder { wait_min } => doubt(format!(
            "The eyes have been on for {on_min:.0} min and were calibrated after {calibrated_min:.0} min: places are \
             off until they are nearly as warm. Wait {wait_min:.0} min."
        )),
        Warmth::Warmer => doubt(format!(
            "The eyes have been on for {on_min:.0} min and were calibrated after {calibrated_min:.0} min, colder than \
             they are now: places are off. Calibrate them again."
        )),
        Warmth::Alike => {
            let text = "The eyes are about as warm as when they were calibrated.".to_owned();
            Some(Gate { of: Need::Warmth, state: GateState::Open, text })
        }
    }
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
    fn what_is_not_known_is_not_guessed() {
        assert_eq!(said(30.0, 25.0).0, GateState::Open);
        assert!(warmth(None, Some(20.0)).is_none() && warmth(Some(20.0), None).is_none());
    }
}
