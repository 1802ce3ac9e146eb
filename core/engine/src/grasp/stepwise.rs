//! One step after the other: an attempt that holds by itself after each of them.
//!
//! It holds by the same reins by which the operator makes it pause, and goes on by them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use plumbline_grasp::Step;

use super::progress::Progress;
use super::view::{BetweenSteps, GraspRun, LampState};
use crate::robot::Reins;

/// Whether attempts hold after each step. Clones share it: changed while an attempt is under way, it counts from
/// its next step on.
#[derive(Clone, Debug, Default)]
pub struct StopAfterEach(Arc<AtomicBool>);

impl StopAfterEach {
    /// From now on, or no longer.
    pub fn set(&self, on: bool) {
        self.0.store(on, Ordering::Release);
    }

    /// Whether they do.
    pub fn is_on(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }

    /// A step is done and the next one would begin: pulls the reins where it shall hold. Whether it does.
    pub fn hold_between(&self, between: BetweenSteps, progress: &Progress, reins: &Reins) -> bool {
        if !self.is_on() || stays(between.next) || reins.is_ended() {
            return false;
        }
        progress.change(|run| {
            run.between = Some(between);
            done(run, between.next);
            reins.hold_tight(true);
        });
        true
    }
}

/// Lets an attempt go on that holds, for whatever reason.
pub fn go_on(progress: Option<&Progress>, reins: &Reins) {
    let loosen = || reins.hold_tight(false);
    match progress {
        // While the attempt cannot come to hold again: what it then says must not be wiped away.
        Some(progress) => progress.change(|run| {
            run.between = None;
            loosen();
        }),
        None => loosen(),
    }
}

/// Steps before which nobody need be asked: nothing has moved yet, and nothing moves by them.
fn stays(step: Step) -> bool {
    matches!(step, Step::Ready | Step::Look | Step::Plan)
}

/// The step under way is done, unless it is the one that goes on.
fn done(run: &mut GraspRun, next: Step) {
    for (step, lamp) in &mut run.lamps {
        if *lamp == LampState::Lit && *step != next {
            *lamp = LampState::Done;
        }
    }
}

#[cfg(test)]
mod tests {
    use plumbline_grasp::Method;

    use super::*;

    fn between(done: Step, next: Step) -> BetweenSteps {
        BetweenSteps { done, next }
    }

    /// An attempt with this step under way.
    fn under_way(step: Step) -> Progress {
        let progress = Progress::new(Method::M5, "Tomato");
        progress.change(|run| {
            let lamp = run.lamps.iter_mut().find(|(other, _)| *other == step).expect("one of its steps");
            lamp.1 = LampState::Lit;
        });
        progress
    }

    fn lamp(progress: &Progress, step: Step) -> LampState {
        let run = progress.run();
        run.lamps.iter().find(|(other, _)| *other == step).expect("one of its steps").1
    }

    #[test]
    fn it_holds_where_it_is_wanted_says_where_and_goes_on_by_the_same_reins() {
        let (stops, reins, progress) =
            (StopAfterEach::default(), Reins::default(), under_way(Step::Approach));
        let at = between(Step::Approach, Step::Align);
        assert!(!stops.hold_between(at, &progress, &reins) && !reins.is_tight(), "nobody wants it");
        stops.clone().set(true);
        assert!(stops.hold_between(at, &progress, &reins) && reins.is_tight());
        assert_eq!(progress.run().between, Some(at));
        assert_eq!(lamp(&progress, Step::Approach), LampState::Done);
        go_on(Some(&progress), &reins);
        assert!(!reins.is_tight() && progress.run().between.is_none());
        stops.set(false);
        assert!(!stops.hold_between(between(Step::Align, Step::Lower), &progress, &reins), "not any more");
    }

    #[test]
    fn between_two_looks_at_the_hand_it_is_aligned_still() {
        let (stops, reins, progress) = (StopAfterEach::default(), Reins::default(), under_way(Step::Align));
        stops.set(true);
        assert!(stops.hold_between(between(Step::Align, Step::Align), &progress, &reins));
        assert_eq!(lamp(&progress, Step::Align), LampState::Lit);
    }

    #[test]
    fn nobody_is_asked_before_what_moves_nothing_nor_when_it_ends() {
        let (stops, reins, progress) = (StopAfterEach::default(), Reins::default(), under_way(Step::Look));
        stops.set(true);
        for next in [Step::Look, Step::Plan] {
            assert!(!stops.hold_between(between(Step::Ready, next), &progress, &reins));
        }
        reins.end();
        assert!(!stops.hold_between(between(Step::Plan, Step::Approach), &progress, &reins));
        assert!(!reins.is_tight() && progress.run().between.is_none());
    }
}
