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
