//! The newest states, to know where the joints were when an image was taken.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::robot::Posture;

use super::reading::JointState;

/// States kept: about four seconds.
const LENGTH: usize = 256;
/// Beyond the newest reading an angle is held for this long, not extrapolated.
const HOLD: Duration = Duration::from_millis(40);

/// A joint whose reading is older does not answer.
const SILENT: Duration = Duration::from_millis(500);

/// The newest states, oldest first.
#[derive(Debug, Default)]
pub(super) struct StateRing(VecDeque<Arc<JointState>>);

impl StateRing {
    pub fn push(&mut self, state: Arc<JointState>) {
        if self.0.len() == LENGTH {
            self.0.pop_front();
        }
        self.0.push_back(state);
    }

    pub fn newest(&self) -> Option<&Arc<JointState>> {
        self.0.back()
    }

    /// Every joint at a moment, linear between its two readings around it. Joints without a servo,
    /// or whose servo does not answer, stand as in the newest state. `None` when the moment is not
    /// covered by readings.
    pub fn posture_at(&self, at: Instant) -> Option<Posture> {
        let newest = self.0.back()?;
        let mut posture = newest.measured.clone()?;
        for (i, reading) in newest.joints.iter().enumerate() {
            if reading.age.is_none_or(|age| age > SILENT) {
                continue;
            }
            posture[reading.joint] = self.angle_at(i, at)?;
        }
        Some(posture)
    }

    /// What was commanded at a moment, linear between the ends of the two cycles around it; what was
    /// commanded last stays so. Goals are sent in the cycle whose end is its time: the joints
    /// were told up to a cycle earlier. `None` when the moment is older than the states.
    pub fn commanded_at(&self, at: Instant) -> Option<Posture> {
        let mut after: Option<&JointState> = None;
        for state in self.0.iter().rev() {
            let sent_at = state.stamp.captured_at;
            if sent_at > at {
                after = Some(state);
                continue;
            }
            let commanded = state.commanded.clone()?;
            let Some(next) =
                after.and_then(|after| Some((after.stamp.captured_at, after.commanded.as_ref()?)))
            else {
                return (at.duration_since(sent_at) <= SILENT).then_some(commanded);
            };
            let span_s = next.0.duration_since(sent_at).as_secs_f64();
            let part = if span_s > 0.0 { at.duration_since(sent_at).as_secs_f64() / span_s } else { 1.0 };
            return Some(commanded.toward(next.1, part));
        }
        None
    }

    fn angle_at(&self, i: usize, at: Instant) -> Option<f64> {
        let mut after: Option<(Instant, f64)> = None;
        for state in self.0.iter().rev() {
            let reading = state.joints.get(i)?;
            let (read_at, angle_rad) = (reading.read_at?, reading.angle_rad?);
            if read_at <= at {
                let Some((after_at, after_rad)) = after else {
                    return (at.duration_since(read_at) <= HOLD).then_some(angle_rad);
                };
                let span_s = after_at.duration_since(read_at).as_secs_f64();
                let part = if span_s > 0.0 { at.duration_since(read_at).as_secs_f64() / span_s } else { 1.0 };
                return Some(angle_rad + part * (after_rad - angle_rad));
            }
            after = Some((read_at, angle_rad));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::image_pair::Stamp;
    use plumbline_model::robot::JointIndex;

    use super::*;
    use crate::joints::JointReading;

    const STEP: Duration = Duration::from_millis(16);

    /// One joint that is commanded to its number of cycles and lags one behind.
    fn ring(began: Instant, cycles: u32) -> StateRing {
        let mut ring = StateRing::default();
        for cycle in 0..cycles {
            let at = began + STEP * cycle;
            let angle_rad = f64::from(cycle) - 1.0;
            let mut reading = JointReading::new(JointIndex(0), 1);
            (reading.angle_rad, reading.read_at) = (Some(angle_rad), Some(at));
            reading.age = Some(Duration::ZERO);
            ring.push(Arc::new(JointState {
                measured: Some(Posture::new(vec![angle_rad])),
                commanded: Some(Posture::new(vec![f64::from(cycle)])),
                ..JointState::new(Stamp { seq: u64::from(cycle), captured_at: at }, [reading])
            }));
        }
        ring
    }

    #[test]
    fn between_two_cycles_commanded_and_measured_angles_are_interpolated() {
        let began = Instant::now();
        let ring = ring(began, 10);
        for (at_steps, commanded) in [(0.0, 0.0), (2.25, 2.25), (8.5, 8.5), (9.0, 9.0), (10.0, 9.0)] {
            let at = began + STEP.mul_f64(at_steps);
            let found = ring.commanded_at(at).unwrap_or_else(|| panic!("covered at {at_steps}"));
            assert!((found[JointIndex(0)] - commanded).abs() < 1e-6, "{at_steps}: {found:?}");
        }
        let measured = ring.posture_at(began + STEP.mul_f64(2.25)).expect("covered");
        assert!((measured[JointIndex(0)] - 1.25).abs() < 1e-6, "{measured:?}");
    }

    #[test]
    fn a_moment_that_no_state_covers_has_no_commanded_angles() {
        let began = Instant::now() + Duration::from_secs(10);
        let few = ring(began, 3);
        assert_eq!(few.commanded_at(began - Duration::from_millis(1)), None);
        assert_eq!(
            few.commanded_at(began + Duration::from_secs(2)),
            None,
            "nobody has heard of the arm since"
        );
        let many = ring(began, 2 * LENGTH as u32);
        assert_eq!(many.commanded_at(began + STEP), None, "long forgotten");
        assert_eq!(StateRing::default().commanded_at(began), None);
    }
}
