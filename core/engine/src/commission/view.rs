//! Commissioning: the steps, which comes next, and what all of it took.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

/// Fewer touches tell too little of what makes the arm miss.
pub const LEAST_TOUCHES: usize = 12;
/// Fewer touches check nothing.
pub const LEAST_CHECKED: usize = 4;

/// Commissioning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommissionView {
    /// Whether it was read what was done before; until then nothing is known.
    pub is_known: bool,
    /// Whether the operator is led.
    pub is_on: bool,
    /// When it was begun; `None`: never in this world.
    pub began: Option<Timestamp>,
    /// All steps in their order; empty before anything is known.
    pub steps: Arc<[CommissionStepView]>,
    /// What it took so far.
    pub spent: CommissionSpent,
}

impl CommissionView {
    /// The step that is to be done; `None` when all are done, or nothing is known.
    pub fn now(&self) -> Option<CommissionStep> {
        self.steps.iter().find(|view| view.state == CommissionState::Now).map(|view| view.step)
    }

    /// Whether every step is done.
    pub fn is_done(&self) -> bool {
        !self.steps.is_empty() && self.steps.iter().all(|view| view.done().is_some())
    }

    /// Whether no step was ever done here.
    pub fn is_untouched(&self) -> bool {
        self.is_known && self.began.is_none() && self.steps.iter().all(|view| view.done().is_none())
    }

    /// What came of a step.
    pub fn of(&self, step: CommissionStep) -> Option<&CommissionDone> {
        self.steps.iter().find(|view| view.step == step)?.done()
    }
}

/// What commissioning took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommissionSpent {
    /// While the program was open and all was not done yet.
    pub time: Duration,
    /// Contacts with the screen.
    pub touches: usize,
    /// Times that the board was looked at: pairs that were captured of it, and head poses from which it was
    /// seen on the table.
    pub views: usize,
}

/// The steps, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CommissionStep {
    /// The lenses, and how the eyes stand to each other.
    Eyes,
    /// How the eyes sit in the head.
    Mount,
    /// Where the screen lies.
    Screen,
    /// Touches that the rest is learned from.
    Touches,
    /// What makes the arm miss, found and added to its model.
    Effects,
    /// The eyes look at the hands, which ties the arms to them.
    Hands,
    /// New touches, sent with that model.
    Check,
    /// The first good grasp.
    Grasp,
}

impl CommissionStep {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Eyes,
        Self::Mount,
        Self::Screen,
        Self::Touches,
        Self::Effects,
        Self::Hands,
        Self::Check,
        Self::Grasp,
    ];

    /// Its place in the order, from 1.
    pub fn number(self) -> usize {
        Self::ALL.iter().position(|step| *step == self).map_or(0, |at| at + 1)
    }
}

/// How a step stands.
#[derive(Clone, Debug, PartialEq)]
pub struct CommissionStepView {
    /// Which.
    pub step: CommissionStep,
    /// How it stands.
    pub state: CommissionState,
}

impl CommissionStepView {
    /// What came of it; `None` before it is done.
    pub fn done(&self) -> Option<&CommissionDone> {
        match &self.state {
            CommissionState::Done(done) => Some(done),
            _ => None,
        }
    }
}

/// How a step stands.
#[derive(Clone, Debug, PartialEq)]
pub enum CommissionState {
    /// Done.
    Done(CommissionDone),
    /// To be done now.
    Now,
    /// Waits for an earlier one.
    Waits(CommissionStep),
}

/// What came of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct CommissionDone {
    /// When; `None` where nobody wrote it down.
    pub at: Option<Timestamp>,
    /// How good it is, or how much of it there is.
    pub figure: CommissionFigure,
}

/// A figure of a step that is done.
#[derive(Clone, Debug, PartialEq)]
pub enum CommissionFigure {
    /// Of a calibration whose file does not say.
    Unknown,
    /// What is left over in the images, rms, px.
    Pixels(f64),
    /// How far the fingertip is from the glass that was placed by so many touches, rms, m.
    Placed {
        /// rms, m.
        rms_m: f64,
        /// Touches.
        touches: usize,
        /// Something speaks against it.
        is_doubtful: bool,
    },
    /// Touches.
    Touches(usize),
    /// Effects in the model in use, by name for people; empty: none is needed.
    Effects(Vec<String>),
    /// The touches show something that no effect of the library explains.
    NotInLibrary,
    /// How far a hand is seen from where its arm has it, rms on looks that were not used, m.
    Seen {
        /// Before it was tied to the eyes.
        before_m: f64,
        /// After.
        after_m: f64,
    },
    /// How far new touches miss, mean, m; `None` of a single one.
    Missed {
        /// Mean, m.
        mean_m: Option<f64>,
        /// Touches.
        touches: usize,
    },
    /// What was held.
    Held(String),
}
