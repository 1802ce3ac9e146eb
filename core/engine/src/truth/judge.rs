//! Asks the twin what is really so: nobody else in the engine does. What was asked can be put in from
//! outside this room, but not be taken out.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use nalgebra::Isometry3;
use plumbline_model::robot::Posture;
use plumbline_twin::Twin;

/// So often, no more: what is shown is read by people.
const EVERY: Duration = Duration::from_millis(250);

/// What is really so at one moment.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    /// Place of every link and mark, by link of the description, robot frame.
    pub robot_from_link: Vec<Option<Isometry3<f64>>>,
    /// Place of the left eye, robot frame.
    pub robot_from_left: Isometry3<f64>,
    /// Place of the right eye, robot frame.
    pub robot_from_right: Isometry3<f64>,
    /// Joint angles as the encoders have them.
    pub encoders: Posture,
    /// Name of each toy that is out, and its place.
    pub toys: Vec<(&'static str, Isometry3<f64>)>,
}

#[derive(Debug, Default)]
struct Shared {
    is_wanted: AtomicBool,
    facts: Mutex<Option<Facts>>,
    asked: Mutex<Option<Instant>>,
}

/// The writing end: whoever owns the twin shows it the twin now and then.
#[derive(Clone, Debug, Default)]
pub struct TruthPlug {
    shared: Arc<Shared>,
}

impl TruthPlug {
    /// Looks at the twin, if truth mode is on and it was not looked at just now; `None`: none runs.
    pub fn look(&self, twin: Option<&Twin>, now: Instant) {
        let Some(twin) = twin.filter(|_| self.shared.is_wanted.load(Ordering::Relaxed)) else {
            *lock(&self.shared.facts) = None;
            return;
        };
        let mut asked = lock(&self.shared.asked);
        if asked.is_some_and(|asked| now.saturating_duration_since(asked) < EVERY) {
            return;
        }
        *asked = Some(now);
        let truth = twin.truth_for_judging();
        let toys = truth.toys.into_iter().filter_map(|(toy, place)| Some((toy.name(), place?)));
        *lock(&self.shared.facts) = Some(Facts {
            robot_from_link: truth.robot_from_link,
            robot_from_left: truth.eyes.robot_from_left.isometry,
            robot_from_right: truth.eyes.robot_from_right.isometry,
            encoders: truth.encoders,
            toys: toys.collect(),
        });
    }

    /// Whether truth mode is on.
    pub(super) fn want(&self, is_wanted: bool) {
        self.shared.is_wanted.store(is_wanted, Ordering::Relaxed);
        if !is_wanted {
            *lock(&self.shared.facts) = None;
        }
    }

    /// What was seen last, in this room only.
    pub(super) fn facts(&self) -> Option<Facts> {
        lock(&self.shared.facts).clone()
    }
}

/// Nobody panics with it, and a fact is whole or not there.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
