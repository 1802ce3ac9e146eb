//! Grasping: what can be grasped and how, the attempt under way, what became of others.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use plumbline_grasp::Failure;
pub use plumbline_grasp::record::{Iteration as GraspIteration, Outcome as GraspOutcome, Step as GraspStep};
pub use plumbline_grasp::see::Seen as SeenThing;
pub use plumbline_grasp::{Hand as GraspHand, HandChoice, Method as GraspMethod};
use plumbline_model::robot::Posture;

use super::command::{GraspTarget, HandStep};
use crate::ground::step::StepState;

/// Grasping.
#[derive(Clone, Debug, Default)]
pub struct GraspView {
    /// For the rail.
    pub step: StepState,
    /// Methods, and what some lack.
    pub methods: Arc<[MethodView]>,
    /// The chosen one.
    pub method: Option<GraspMethod>,
    /// With which hands may be grasped.
    pub hands: Arc<[HandChoice]>,
    /// The chosen one.
    pub hand: HandChoice,
    /// Classes of things that can be held.
    pub classes: Arc<[&'static str]>,
    /// What is grasped.
    pub target: GraspTarget,
    /// Whether attempts hold by themselves after each step.
    pub stops_after_each: bool,
    /// What was grasped and is in a hand still.
    pub held: Option<InHand>,
    /// How far its fingers have bent on around it since it was grasped, where that is so much that it may slip out, rad.
    pub gives_way_rad: Option<f64>,
    /// How the hand was left, where that matters to what is done next; `None`: it does not, or it was moved since.
    pub hand_waits: Option<HandWaits>,
    /// Which hand may hold something, where it is not known that it does.
    pub may_hold: Option<GraspHand>,
    /// The step of a hand that was asked for last, where it could not be made, and why.
    pub not_made: Option<StepNotMade>,
    /// Whether the hand was moved by itself since the last attempt: why that failed says nothing of now.
    pub hand_moved: bool,
    /// What is looked at before anything moves.
    pub gates: Arc<[Gate]>,
    /// What is done just now.
    pub phase: GraspPhase,
    /// What would be sent; `None` before it was planned.
    pub plan: Option<Arc<PlannedGrasp>>,
    /// The attempt under way, else the last one of this run of the program.
    pub run: Option<Arc<GraspRun>>,
    /// What became of attempts, newest first.
    pub attempts: Arc<[AttemptView]>,
}

impl GraspView {
    /// Why nothing can be grasped now, and what to do: the first gate that is shut.
    pub fn trouble(&self) -> Option<&str> {
        self.shut().map(|gate| gate.text.as_str())
    }

    /// The first gate that is shut.
    pub fn shut(&self) -> Option<&Gate> {
        self.gates.iter().find(|gate| gate.state == GateState::Shut)
    }

    /// Between which steps the attempt holds by itself, until it is told to go on.
    pub fn between(&self) -> Option<BetweenSteps> {
        let holds = matches!(self.phase, GraspPhase::Grasping { paused: true, ending: false });
        self.run.as_ref().filter(|_| holds)?.between
    }
}

/// A step of a hand that could not be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepNotMade {
    /// Which.
    pub step: HandStep,
    /// Why: the end of a sentence.
    pub why: String,
}

impl HandWaits {
    /// Whether its fingers may be around something.
    pub fn may_hold(self) -> bool {
        matches!(self, Self::Around | Self::Carries | Self::Offers)
    }
}

/// How a hand was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandWaits {
    /// Its fingers may be around something: it is opened first.
    Around,
    /// The same in the air: what it may carry is put down first.
    Carries,
    /// What it may carry is held out to be taken: it is opened once somebody has it.
    Offers,
    /// It is open, around something or low between things: it is lifted first.
    Low,
    /// It stands over the table, where it hides what is grasped next, and cannot be told from the picture before.
    InView,
}

/// Where an attempt holds by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BetweenSteps {
    /// What was done last.
    pub done: GraspStep,
    /// What is done when it goes on; after a look at the hand it may be another one.
    pub next: GraspStep,
}

/// Something in a hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InHand {
    /// What.
    pub object: String,
    /// In which.
    pub hand: GraspHand,
}

/// A method, and what it lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodView {
    /// Which.
    pub method: GraspMethod,
    /// How it brings the hand to the object, in a few words.
    pub about: &'static str,
    /// What it lacks and how to get it, a sentence; `None`: nothing.
    pub lacks: Option<String>,
}

/// Something that is looked at before anything moves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gate {
    /// What it looks at.
    pub of: Need,
    /// Whether it lets pass.
    pub state: GateState,
    /// What is so, and what to do where it is shut. A sentence.
    pub text: String,
}

/// What is looked at before anything moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Whether a robot is connected.
    Robot,
    /// Whether STOP is pressed.
    Stop,
    /// Whether something else moves it.
    Run,
    /// Whether the joints of the arm hold and are known.
    Arm,
    /// Whether a joint pushes against something.
    Load,
    /// Whether the arm stands where it was sent.
    Rest,
    /// Whether both eyes deliver.
    Eyes,
    /// How well places on the table are known.
    Places,
    /// How warm the eyes are.
    Warmth,
    /// Whether the method has what it needs.
    Method,
    /// Whether the thing stands where the method was trained.
    Area,
    /// Whether a hand is free: it is shut while one holds something.
    Hand,
    /// Whether there is what the arm was learned from.
    Touches,
}

impl Need {
    /// What a step of a hand alone needs: neither eyes nor a method.
    pub const OF_A_HAND: [Self; 3] = [Self::Robot, Self::Stop, Self::Arm];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robot => "Robot",
            Self::Stop => "STOP",
            Self::Run => "Run",
            Self::Arm => "Arm",
            Self::Load => "Load",
            Self::Rest => "Rest",
            Self::Eyes => "Eyes",
            Self::Places => "Places",
            Self::Warmth => "Warmth",
            Self::Method => "Method",
            Self::Area => "Area",
            Self::Hand => "Hand",
            Self::Touches => "Touches",
        }
    }
}

/// Whether a gate lets pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GateState {
    /// All is well.
    Open,
    /// It may go on, but the operator should know.
    Doubtful,
    /// Nothing moves.
    Shut,
}

/// What is done just now.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum GraspPhase {
    /// Nothing.
    #[default]
    Idle,
    /// Looks and plans.
    Planning,
    /// Grasps.
    Grasping {
        /// Held by the operator.
        paused: bool,
        /// Asked to end.
        ending: bool,
    },
    /// A step of the hand by itself.
    Hand {
        /// Which.
        step: HandStep,
        /// Held by the operator.
        paused: bool,
    },
}

impl GraspPhase {
    /// Whether the arm moves, or may move, or was made to stand.
    pub fn moves(&self) -> bool {
        matches!(self, Self::Grasping { .. } | Self::Hand { .. })
    }

    /// Whether it was made to stand.
    pub fn is_paused(&self) -> bool {
        matches!(self, Self::Grasping { paused: true, .. } | Self::Hand { paused: true, .. })
    }
}

/// What would be sent.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedGrasp {
    /// By which method.
    pub method: GraspMethod,
    /// With which hand.
    pub hand: GraspHand,
    /// The model of the robot that it was planned with, for people: "as described", "with 2 effects".
    pub model: String,
    /// What would be grasped.
    pub object: String,
    /// Where it stands, robot frame, m.
    pub at_m: [f64; 2],
    /// Standard deviation of that in the worst direction over the table, m.
    pub sigma_m: Option<f64>,
    /// Azimuth of the fingers, rad.
    pub heading_rad: f64,
    /// Cosine of the palm's inclination where it closes, 1 when it faces straight down.
    pub level: f64,
    /// The whole motion: where it begins, above the object, where it closes, lifted.
    pub postures: Arc<[Posture]>,
    /// Where the palm goes, robot frame, m.
    pub palm_way_m: Arc<[[f64; 3]]>,
    /// Joints that turn, for people, and by how much in all (rad), most first.
    pub turns: Arc<[(String, f64)]>,
    /// How long all of it takes, without looking.
    pub duration: Duration,
}

/// How a step of an attempt is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LampState {
    /// Not begun.
    #[default]
    Dark,
    /// Under way.
    Lit,
    /// Done.
    Done,
    /// It ended here.
    Failed,
}

/// An attempt under way, or the last one.
#[derive(Clone, Debug, Default)]
pub struct GraspRun {
    /// Name of its folder.
    pub name: String,
    /// By which method.
    pub method: Option<GraspMethod>,
    /// With which hand; `None` before that is planned.
    pub hand: Option<GraspHand>,
    /// What is grasped.
    pub object: String,
    /// Its steps in their order.
    pub lamps: Vec<(GraspStep, LampState)>,
    /// Between which steps it came to hold by itself; `None` once it has been told to go on.
    pub between: Option<BetweenSteps>,
    /// Which try it is, from 1, and how many there may be.
    pub tries: [usize; 2],
    /// Why the try before failed, while the arm goes back to try again.
    pub again: Option<String>,
    /// Looks at the hand.
    pub iterations: Vec<GraspIteration>,
    /// What was seen last, and at which step.
    pub seen: Vec<SeenThing>,
    /// The thing that was chosen, by its place in `seen`.
    pub chosen: Option<usize>,
    /// Where the palm was found at the last look, in the left and in the right eye, raw px.
    pub hand_px: [Option<[f64; 2]>; 2],
    /// Where it belongs when it closes, as `hand_px`.
    pub wanted_px: [Option<[f64; 2]>; 2],
    /// What became of it; `None` while it goes on.
    pub outcome: Option<GraspOutcome>,
    /// What the operator said of it.
    pub told: Option<bool>,
    /// What became of a thing that was held since.
    pub since: SinceHeld,
    /// How far the fingers were kept open after the lift, rad.
    pub fingers_open_rad: Option<f64>,
    /// From its beginning to the end of the lift, without what it held by itself between steps, s.
    pub seconds: Option<f64>,
}

/// What became of a thing since it was found to be held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SinceHeld {
    /// Fingers and thumb press on it.
    #[default]
    Held,
    /// It slipped out of the hand so long after the grasp had ended.
    Slipped(Duration),
    /// The hand was told to let it go, or to do something else.
    LetGo,
    /// Nobody knows: the hand cannot be read any more.
    Unknown,
}

/// What became of an attempt.
#[derive(Clone, Debug, PartialEq)]
pub struct AttemptView {
    /// Name of its folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// When.
    pub began: Timestamp,
    /// By which method.
    pub method: GraspMethod,
    /// With which hand.
    pub hand: GraspHand,
    /// The model of the robot that was used, for people.
    pub model: String,
    /// What was grasped.
    pub object: String,
    /// What it took itself for; `None`: the program ended before.
    pub outcome: Option<GraspOutcome>,
    /// The step that was begun last.
    pub reached: Option<GraspStep>,
    /// What the operator said.
    pub told: Option<bool>,
    /// It was held, and slipped out of the hand so long after the grasp had ended.
    pub slipped_after: Option<Duration>,
    /// Distance of the hand from where it belongs at the last look, m.
    pub alignment_m: Option<f64>,
    /// Where the palm belongs when the hand closes, robot frame, m.
    pub closed_at_m: Option<[f64; 3]>,
    /// From its beginning to the end of the lift, s.
    pub seconds: Option<f64>,
}

impl AttemptView {
    /// Whether it was held and stayed: as the operator said, else as it took itself.
    pub fn is_success(&self) -> bool {
        self.told.unwrap_or(self.outcome == Some(GraspOutcome::Success) && self.slipped_after.is_none())
    }

    /// Whether it came to no end of its own: the operator, STOP, the robot or a failure of the program ended it, or
    /// nothing was risked. Nothing is told by it.
    pub fn is_broken_off(&self) -> bool {
        let halted = match &self.outcome {
            Some(outcome) => is_halted(outcome) || matches!(outcome, GraspOutcome::Refused { .. }),
            None => true,
        };
        self.told.is_none() && halted
    }
}

/// Whether nothing was grasped because what was to be was not seen.
pub fn is_unseen(outcome: &GraspOutcome) -> bool {
    matches!(outcome, GraspOutcome::Failed { failure: Failure::NotSeen, .. })
}

/// Whether an attempt was ended before anything could come of it.
pub fn is_halted(outcome: &GraspOutcome) -> bool {
    matches!(outcome, GraspOutcome::Failed { failure: Failure::Halted, .. })
}
