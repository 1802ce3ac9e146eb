//! All of it on a robot or its twin, one after the other.

use jiff::Timestamp;
use plumbline_effects::RigModel;
use plumbline_fit::{ArmTouches, Name, SizedArm};
use plumbline_grasp::{Body, Hand};
use plumbline_model::JobContext;
use serde::{Deserialize, Serialize};

use crate::body::{self, SeenBody};
use crate::hands::{self, AROUND_M, Eyes, Looks, Miss, UNKNOWN_AROUND_M};
use crate::model::Sizing;
use crate::screen::{self, SeenScreen};
use crate::table::{self, TableBeside};
use crate::{HandEyeError, Start, Tie};

/// What the history of models says of the step.
pub const SENTENCE: &str = "The eyes looked at the robot's body, the screen and the hands.";

/// What is looked at, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The robot's own body. The head moves.
    Body,
    /// The frame of the touchscreen. The head moves.
    Screen,
    /// The table around it. Nothing moves.
    Table,
    /// A hand. Its arm moves.
    Hand(Hand),
}

/// What was seen of a part.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// `None`: its edges were not seen, or are not described.
    Body(Option<SeenBody>),
    /// `None`: its edges were not seen, or are not described.
    Screen(Option<Box<SeenScreen>>),
    /// `None`: it shows the eyes too little to match.
    Table(Option<TableBeside>),
    /// A hand, and what came of its arm.
    Hand(Hand, Outcome),
}

/// What came of an arm whose hand was looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It was sized.
    Sized(Figures),
    /// It stays as it was: why. Reads as a sentence.
    Stays(String),
}

impl Outcome {
    /// Of an arm that was sized.
    pub fn figures(&self) -> Option<&Figures> {
        match self {
            Self::Sized(figures) => Some(figures),
            Self::Stays(_) => None,
        }
    }
}

/// Told while it happens.
pub trait Watch {
    /// A look begins: its number from 0, and how many there are of the part.
    fn looks(&mut self, part: Part, number: usize, of: usize);
    /// A part is done.
    fn saw(&mut self, seen: &Seen);
    /// Nothing moves any more for a while: it is computed.
    fn computes(&mut self, what: &str);
}

/// How far a hand is seen from where its arm has it, on looks that nothing was sized with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Places at which it was looked at.
    pub looked: usize,
    /// Of those, places at which it was found.
    pub found: usize,
    /// Root mean square before, m; `None`: none of those that judge was found.
    pub before_m: Option<f64>,
    /// The same after.
    pub after_m: Option<f64>,
    /// Every look before: where the arm had the palm, and how far beside it was seen.
    pub before: Vec<Miss>,
    /// Every look with the model that came of it.
    pub after: Vec<Miss>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Tied {
    /// What was seen of what does not move.
    pub tie: Tie,
    /// The model: a proposal.
    pub model: RigModel,
    /// The hand of the arm that touched.
    pub touched: (Hand, Figures),
    /// The other hand; `None`: the robot has none.
    pub other: Option<(Hand, Outcome)>,
}

/// Looks at body, screen, table and hands, and sizes both arms. First the arms go home. The head and both arms
/// move; nothing is touched.
///
/// # Errors
/// When the robot does not carry it out, too little is seen of the hand that touched, or it is cancelled.
pub fn tie(
    robot: &mut dyn Body,
    start: &Start,
    touches: &ArmTouches<'_>,
    at: Timestamp,
    watch: &mut dyn Watch,
    context: &dyn JobContext,
) -> Result<Tied, HandEyeError> {
    start.mounted()?;
    let touched = if touches.tip == Hand::Left.index_tip() { Hand::Left } else { Hand::Right };
    let hands: Vec<Hand> =
        Hand::BOTH.into_iter().filter(|hand| start.described.arm(hand.name()).is_some()).collect();
    for hand in &hands {
        hands::home(robot, &hands::planner(&start.model, *hand)?)?;
    }
    let tie = look_around(robot, start, watch, context)?;
    watch.computes("comparing on touches held out");
    let sizing =
        Sizing::begin(start, touches, &tie, Name::of_model(start.model.added(), touches.tip), context)?
            .keeping_names();
    let first = sizing.touched(None)?;
    let known = start.with(sizing.model(&first, None, SENTENCE, at)?)?;

    let looks = take(robot, &known, touched, watch, context)?;
    watch.computes("sizing the arm's errors");
    let (arm, figures) = of_touched(&sizing, [start, &known], &looks, at, context)?;
    watch.saw(&Seen::Hand(touched, Outcome::Sized(figures.clone())));
    let known = start.with(sizing.model(&arm, None, SENTENCE, at)?)?;

    let mut other = None;
    let mut sized = None;
    for hand in hands.into_iter().filter(|hand| *hand != touched) {
        let looks = take(robot, &known, hand, watch, context)?;
        watch.computes("sizing the other arm's errors");
        let said = match of_other(&sizing, &arm, [start, &known], &looks, at, context) {
            Ok((arm, figures)) => {
                sized = Some((hand, arm));
                Outcome::Sized(figures)
            }
            Err(why @ HandEyeError::FewHands { .. }) => Outcome::Stays(why.to_string()),
            Err(error) => return Err(error),
        };
        watch.saw(&Seen::Hand(hand, said.clone()));
        other = Some((hand, said));
    }
    let sized = sized.as_ref().map(|(hand, arm)| (*hand, arm));
    Ok(Tied { tie, model: sizing.model(&arm, sized, SENTENCE, at)?, touched: (touched, figures), other })
}

/// Body, screen and table: the head alone moves.
fn look_around(
    robot: &mut dyn Body,
    start: &Start,
    watch: &mut dyn Watch,
    context: &dyn JobContext,
) -> Result<Tie, HandEyeError> {
    let (rig, mounted) = (start.model.rig().clone(), *start.mounted()?);
    let mut look = |number| watch.looks(Part::Body, number, SeenBody::LOOKS);
    let body = body::see(robot, &rig, &mounted, &mut look, context)?;
    watch.saw(&Seen::Body(body));
    let mut look = |number| watch.looks(Part::Screen, number, SeenScreen::LOOKS);
    let placed = start.model.touchscreen();
    let screen = screen::see(robot, &rig, mounted.rest_sigma_rad, placed, &mut look, context)?;
    watch.saw(&Seen::Screen(screen.clone().map(Box::new)));
    let mut table = None;
    if let Some(screen) = &screen {
        watch.looks(Part::Table, 0, 1);
        table = table::see(robot, &rig, &start.calibration, screen, placed)?;
        watch.saw(&Seen::Table(table));
    }
    Ok(Tie { body, screen, table })
}

fn take(
    robot: &mut dyn Body,
    known: &Start,
    hand: Hand,
    watch: &mut dyn Watch,
    context: &dyn JobContext,
) -> Result<Looks, HandEyeError> {
    let mut look = |number| watch.looks(Part::Hand(hand), number, Looks::MOST);
    Looks::take(robot, &known.model, hand, &mut look, context)
}

/// The arm that touched, sized anew with its hand; `known`: tied by body and screen alone. What is told was
/// measured on looks that were held back.
///
/// # Errors
/// When too few hands are found, or it is cancelled.
pub fn of_touched(
    sizing: &Sizing<'_>,
    [start, known]: [&Start; 2],
    looks: &Looks,
    at: Timestamp,
    context: &dyn JobContext,
) -> Result<(SizedArm, Figures), HandEyeError> {
    let mut eyes = Eyes::new(looks, start)?;
    let (every, (used, back)) = (looks.every(), looks.used_and_back());
    let before = eyes.misses(start, known, &every, AROUND_M[0])?;
    let seen = eyes.seen(known, &used, AROUND_M[0])?;
    let sizing = sizing.seen_by_hands(&seen);
    let arm = sizing.touched(Some(&seen))?;
    let mut known = start.with(sizing.model(&arm, None, SENTENCE, at)?)?;
    context.checkpoint()?;
    let seen = eyes.seen(&known, &used, AROUND_M[1])?;
    let sizing = sizing.seen_by_hands(&seen);
    let arm = sizing.touched(Some(&seen))?;
    known = start.with(sizing.model(&arm, None, SENTENCE, at)?)?;
    let after_m = hands::rms_m(&eyes.misses(&known, &known, &back, AROUND_M[0])?);
    let seen = eyes.seen(&known, &every, AROUND_M[1])?;
    let arm = sizing.touched(Some(&seen))?;
    known = start.with(sizing.model(&arm, None, SENTENCE, at)?)?;
    let after = eyes.misses(&known, &known, &every, AROUND_M[0])?;
    let (looked, found) = (looks.count(), seen.seen.len());
    Ok((arm, Figures { looked, found, before_m: judging(&before, &back), after_m, before, after }))
}

/// The other arm, sized by its hand, when the one that touched stands as in `known`.
///
/// # Errors
/// When too few hands are found, or it is cancelled.
pub fn of_other(
    sizing: &Sizing<'_>,
    touched: &SizedArm,
    [start, known]: [&Start; 2],
    looks: &Looks,
    at: Timestamp,
    context: &dyn JobContext,
) -> Result<(SizedArm, Figures), HandEyeError> {
    let (mut eyes, hand) = (Eyes::new(looks, known)?, looks.hand());
    let (every, (used, back)) = (looks.every(), looks.used_and_back());
    let before = eyes.misses(start, known, &every, UNKNOWN_AROUND_M)?;
    let lags = looks.lags(known)?;
    let (mut stands, mut after_m, mut sized) = (known.clone(), None, None);
    let rounds = [(&used, UNKNOWN_AROUND_M), (&used, AROUND_M[1]), (&every, AROUND_M[1])];
    for (round, (which, around_m)) in rounds.into_iter().enumerate() {
        context.checkpoint()?;
        let seen = eyes.seen(&stands, which, around_m)?;
        if round + 1 == rounds.len() {
            after_m = hands::rms_m(&eyes.misses(&stands, &stands, &back, AROUND_M[0])?);
        }
        let arm = sizing.other(touched, hand, &seen, &lags)?;
        stands = known.with(sizing.model(touched, Some((hand, &arm)), SENTENCE, at)?)?;
        sized = Some((arm, seen.seen.len()));
    }
    let (arm, found) = sized.ok_or(HandEyeError::Touches)?;
    let after = eyes.misses(&stands, &stands, &every, AROUND_M[0])?;
    let looked = looks.count();
    Ok((arm, Figures { looked, found, before_m: judging(&before, &back), after_m, before, after }))
}

/// Those of the looks that judge.
fn judging(misses: &[Miss], back: &[usize]) -> Option<f64> {
    let judging: Vec<Miss> = back.iter().filter_map(|i| misses.get(*i).cloned()).collect();
    hands::rms_m(&judging)
}
