//! Tying the arms to the eyes.

use std::sync::Arc;

use jiff::Timestamp;
pub use plumbline_handeye::body::SeenBody as HandEyeBody;
pub use plumbline_handeye::hands::Miss as HandMiss;
pub use plumbline_handeye::screen::SeenScreen as HandEyeScreen;
pub use plumbline_handeye::table::TableBeside as HandEyeTable;
pub use plumbline_handeye::{
    Figures as HandFigures, Outcome as HandOutcome, Part as HandEyePart, Seen as HandEyeSeen,
};

use crate::grasp::view::{Gate, GateState, GraspHand};
use crate::ground::step::StepState;

/// Tying the arms to the eyes.
#[derive(Clone, Debug, Default)]
pub struct HandEyeView {
    /// For the rail.
    pub step: StepState,
    /// What is looked at before anything moves.
    pub gates: Arc<[Gate]>,
    /// The look under way: each part and how far it is; empty before the first look of this run of the program.
    pub parts: Arc<[PartView]>,
    /// Whether a look is under way.
    pub is_looking: bool,
    /// Whether it was asked to end.
    pub is_ending: bool,
    /// What came of the last look, and waits to be accepted.
    pub proposal: Option<Arc<HandEyeSummary>>,
    /// What the model in use came of; `None`: the arms are not tied to the eyes.
    pub in_use: Option<Arc<HandEyeSummary>>,
    /// What was in use, and is no more: why, and what to do.
    pub stale: Option<String>,
}

impl HandEyeView {
    /// Why nothing can be looked at now, and what to do: the first gate that is shut.
    pub fn trouble(&self) -> Option<&str> {
        self.first(GateState::Shut).map(|gate| gate.text.as_str())
    }

    /// What makes a look doubtful, and what to do: the first such gate.
    pub fn doubt(&self) -> Option<&Gate> {
        self.first(GateState::Doubtful)
    }

    fn first(&self, state: GateState) -> Option<&Gate> {
        self.gates.iter().find(|gate| gate.state == state)
    }
}

/// A part, and how far it is.
#[derive(Clone, Debug, PartialEq)]
pub struct PartView {
    /// Which.
    pub part: HandEyePart,
    /// How far.
    pub state: PartState,
}

/// How far a part is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum PartState {
    /// It comes later.
    #[default]
    Waits,
    /// It is looked at: this look, from 1, of so many at most.
    Looks(usize, usize),
    /// What was seen of it.
    Done(HandEyeSeen),
}

/// What came of a look.
#[derive(Clone, Debug, PartialEq)]
pub struct HandEyeSummary {
    /// When it was begun.
    pub at: Timestamp,
    /// The robot's body; `None`: not seen.
    pub body: Option<HandEyeBody>,
    /// The screen's frame; `None`: not seen.
    pub screen: Option<HandEyeScreen>,
    /// The table around it; `None`: not matched.
    pub table: Option<HandEyeTable>,
    /// Hands, the one that touched first, and what came of their arms.
    pub hands: Vec<(GraspHand, HandOutcome)>,
}

impl HandEyeSummary {
    /// How far a hand is seen from where its arm has it, rms on looks that were not used, before and after, m: of the
    /// hand that is worse after.
    pub fn error_m(&self) -> Option<[f64; 2]> {
        self.worse().map(|(_, error_m)| error_m)
    }

    /// The same, and which hand that is.
    pub fn worse(&self) -> Option<(GraspHand, [f64; 2])> {
        let errors = self.hands.iter().filter_map(|(hand, outcome)| {
            let figures = outcome.figures()?;
            Some((*hand, [figures.before_m?, figures.after_m?]))
        });
        errors.max_by(|(_, [_, a_m]), (_, [_, b_m])| a_m.total_cmp(b_m))
    }
}
