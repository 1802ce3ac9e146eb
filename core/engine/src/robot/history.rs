//! Load and temperature of every servo over the last minutes.

use std::collections::VecDeque;
use std::sync::Arc;

use plumbline_hardware::joints::JointReading;

use super::view::JointSample;

/// One sample per servo this often, s.
const EVERY_S: f64 = 1.0;
/// So many are kept: ten minutes.
const KEPT: usize = 600;

/// Load and temperature of every servo over the last minutes.
#[derive(Clone, Debug)]
pub struct Histories {
    servos: Vec<VecDeque<JointSample>>,
    shared: Vec<Arc<[JointSample]>>,
    last_s: Option<f64>,
}

impl Histories {
    /// For so many servos.
    pub fn new(servos: usize) -> Self {
        Self { servos: vec![VecDeque::new(); servos], shared: vec![Arc::from([]); servos], last_s: None }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::new(self.servos.len());
    }

    /// Takes a sample if it is time for one.
    pub fn note(&mut self, at_s: f64, joints: &[JointReading]) {
        if self.last_s.is_some_and(|last_s| at_s < last_s + EVERY_S) {
            return;
        }
        self.last_s = Some(at_s);
        for (i, (history, reading)) in self.servos.iter_mut().zip(joints).enumerate() {
            history.push_back(JointSample { at_s, load: reading.load, temperature_c: reading.temperature_c });
            if history.len() > KEPT {
                history.pop_front();
            }
            self.shared[i] = history.iter().copied().collect();
        }
    }

    /// The samples of a servo, oldest first.
    pub fn of(&self, servo: usize) -> Arc<[JointSample]> {
        self.shared.get(servo).cloned().unwrap_or_default()
    }
}
