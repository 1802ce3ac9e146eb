//! What the joints do while somebody leads: kept for who leads, once it is asked for.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use plumbline_hardware::joints::JointState;

/// So many states wait to be taken at most: more than a minute.
const WAITING: usize = 1000;

/// States on their way from the robot's thread to who leads. Clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Course(Arc<Mutex<Option<Waiting>>>);

#[derive(Debug)]
struct Waiting {
    every: Duration,
    noted_at: Option<Instant>,
    states: VecDeque<Arc<JointState>>,
    lost: usize,
}

impl Course {
    /// From now on states are kept, this far apart at least.
    pub fn keep(&self, every: Duration) {
        let waiting = Waiting { every, noted_at: None, states: VecDeque::new(), lost: 0 };
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(waiting);
    }

    /// A state of the joints; most are let go.
    pub fn note(&self, state: &Arc<JointState>) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(waiting) = waiting.as_mut() else { return };
        let at = state.stamp.captured_at;
        if waiting.noted_at.is_some_and(|noted_at| at < noted_at + waiting.every) {
            return;
        }
        waiting.noted_at = Some(at);
        if waiting.states.len() == WAITING {
            waiting.states.pop_front();
            waiting.lost += 1;
        }
        waiting.states.push_back(state.clone());
    }

    /// Those that were not taken yet, oldest first, and how many more there were than could wait.
    pub fn take(&self) -> (Vec<Arc<JointState>>, usize) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(waiting) = waiting.as_mut() else { return (vec![], 0) };
        (waiting.states.drain(..).collect(), std::mem::take(&mut waiting.lost))
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::robot::made_up;

    fn state(captured_at: Instant) -> Arc<JointState> {
        made_up::state(&Rig::built_in("nico").expect("valid"), captured_at, [0.0; 2], &[])
    }

    #[test]
    fn states_are_kept_once_asked_for_as_far_apart_as_asked_and_taken_once() {
        let (course, began) = (Course::default(), Instant::now());
        let at = |milliseconds| began + Duration::from_millis(milliseconds);
        course.note(&state(at(0)));
        assert_eq!(course.take().0.len(), 0, "nobody asked");
        course.keep(Duration::from_millis(80));
        // The same state is seen more than once, and states come more often than they are wanted.
        for milliseconds in [0, 0, 20, 40, 60, 80, 100, 170, 170, 200] {
            course.note(&state(at(milliseconds)));
        }
        let (states, lost) = course.take();
        let kept: Vec<Instant> = states.iter().map(|state| state.stamp.captured_at).collect();
        assert_eq!((kept, lost), (vec![at(0), at(80), at(170)], 0));
        assert!(course.take().0.is_empty());
    }

    #[test]
    fn what_nobody_takes_is_counted_and_the_newest_stay() {
        let (course, began) = (Course::default(), Instant::now());
        course.keep(Duration::from_millis(80));
        let at = |k: usize| began + Duration::from_millis(80 * k as u64);
        let one = state(began);
        for k in 0..WAITING + 3 {
            let stamp = plumbline_model::Stamp { captured_at: at(k), ..one.stamp };
            course.note(&Arc::new(JointState { stamp, ..(*one).clone() }));
        }
        let (states, lost) = course.take();
        assert_eq!((states.len(), lost), (WAITING, 3));
        assert_eq!(states[0].stamp.captured_at, at(3));
        assert_eq!(course.take().1, 0, "told once");
    }
}
