//! How a look goes on, for the window.

use std::sync::{Arc, Mutex, PoisonError};

use plumbline_grasp::Hand;
use plumbline_handeye::body::SeenBody;
use plumbline_handeye::hands::Looks;
use plumbline_handeye::screen::SeenScreen;
use plumbline_handeye::{Part, Seen, Watch};
use plumbline_model::robot::Rig;
use plumbline_model::{Cancelled, JobContext};

use super::view::{PartState, PartView};

/// The parts of a look. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Mutex<Vec<PartView>>>);

impl Progress {
    /// Of a look that begins.
    pub fn new(rig: &Rig) -> Self {
        let hands = Hand::BOTH.into_iter().filter(|hand| rig.arm(hand.name()).is_some()).map(Part::Hand);
        let parts = [Part::Body, Part::Screen, Part::Table].into_iter().chain(hands);
        let waits = |part| PartView { part, state: PartState::Waits };
        Self(Arc::new(Mutex::new(parts.map(waits).collect())))
    }

    /// As it is now.
    pub fn parts(&self) -> Vec<PartView> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, part: Part, state: PartState) {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = parts.iter_mut().find(|known| known.part == part) {
            known.state = state;
        }
    }
}

/// A look at a hand takes as long as so many others: the arm brings it there first.
const OF_A_HAND: usize = 3;

/// Tells the window how far it is.
pub struct Watcher<'a> {
    /// For the window.
    pub progress: Progress,
    /// The job.
    pub context: &'a dyn JobContext,
    /// Looks so far, those at a hand for as many as they take.
    pub looks: usize,
}

impl Watcher<'_> {
    fn report(&self, doing: &str) {
        let all = SeenBody::LOOKS + SeenScreen::LOOKS + 1 + 2 * Looks::MOST * OF_A_HAND;
        self.context.report((self.looks as f64 / all as f64).min(1.0), doing);
    }
}

impl Watch for Watcher<'_> {
    fn looks(&mut self, part: Part, number: usize, of: usize) {
        self.progress.set(part, PartState::Looks(number + 1, of));
        self.report(match part {
            Part::Body => "looking at the robot's body",
            Part::Screen => "looking at the screen",
            Part::Table => "looking at the table",
            Part::Hand(Hand::Right) => "looking at the right hand",
            Part::Hand(Hand::Left) => "looking at the left hand",
        });
        self.looks += if matches!(part, Part::Hand(_)) { OF_A_HAND } else { 1 };
    }

    fn saw(&mut self, seen: &Seen) {
        let part = match seen {
            Seen::Body(_) => Part::Body,
            Seen::Screen(_) => Part::Screen,
            Seen::Table(_) => Part::Table,
            Seen::Hand(hand, _) => Part::Hand(*hand),
        };
        self.progress.set(part, PartState::Done(seen.clone()));
    }

    fn computes(&mut self, what: &str) {
        self.report(what);
    }
}

/// A part of a job that says how far it is otherwise: what it reports would run from none to all once more.
pub struct Unreported<'a>(pub &'a dyn JobContext);

impl JobContext for Unreported<'_> {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        self.0.checkpoint()
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}
