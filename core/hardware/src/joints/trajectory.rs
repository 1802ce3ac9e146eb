//! A straight line in joint space with minimal jerk: s(τ) = 10 τ³ − 15 τ⁴ + 6 τ⁵ (Flash and Hogan
//! 1985). Starts and ends at rest; the peak speed is 15/8 of the mean.

use plumbline_model::robot::{JointIndex, Posture};

/// Peak speed over mean speed.
pub(super) const PEAK_OVER_MEAN: f64 = 1.875;

/// A planned move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trajectory {
    pub start: Posture,
    pub end: Posture,
    pub joints: Vec<JointIndex>,
    pub duration_s: f64,
}

impl Trajectory {
    /// Posture at a share (0 to 1) of the time.
    pub fn at(&self, fraction: f64) -> Posture {
        let t = fraction.clamp(0.0, 1.0);
        self.start.toward(&self.end, t * t * t * (10.0 + t * (6.0 * t - 15.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_and_ends_at_rest_and_peaks_in_the_middle() {
        let line = Trajectory {
            start: Posture::new(vec![0.2, 0.0]),
            end: Posture::new(vec![1.2, 0.0]),
            joints: vec![JointIndex(0)],
            duration_s: 2.0,
        };
        let speed =
            |t: f64| (line.at(t + 1e-6)[JointIndex(0)] - line.at(t - 1e-6)[JointIndex(0)]) / 2e-6 / 2.0;
        assert_eq!(line.at(0.0)[JointIndex(0)], 0.2);
        assert!((line.at(1.0)[JointIndex(0)] - 1.2).abs() < 1e-12);
        assert!(speed(2e-6).abs() < 1e-6 && speed(1.0 - 2e-6).abs() < 1e-6);
        assert!((speed(0.5) - PEAK_OVER_MEAN * 0.5).abs() < 1e-6);
        for i in 1..100 {
            assert!(speed(f64::from(i) / 100.0) <= PEAK_OVER_MEAN * 0.5 + 1e-6);
        }
    }
}
