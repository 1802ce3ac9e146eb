//! Touching the screen: what is planned, what was touched, where the screen lies.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use plumbline_effects::observability::PlanScore;
use plumbline_model::robot::Posture;
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::touch_plan::{PlanOptions, Purpose, Side, TouchArea};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{Pixel, Point, Robot};

use super::command::{Correction, ScreenWindow};
use crate::ground::step::StepState;

/// Touching the screen.
#[derive(Clone, Debug, Default)]
pub struct TouchView {
    /// For the rail.
    pub step: StepState,
    /// What the run is doing.
    pub phase: TouchPhase,
    /// What to do next, a sentence.
    pub next: String,
    /// What was planned; `None` before.
    pub plan: Option<Arc<PlanView>>,
    /// The touches of the plan in its order, with what became of them.
    pub touches: Arc<[TouchState]>,
    /// Counts of `touches`.
    pub counts: TouchCounts,
    /// Time left at the pace so far.
    pub remaining: Option<Duration>,
    /// How often the run held because joints were not heard in time, and went on by itself or would.
    pub held: usize,
    /// Figures of what was touched so far; `None` before the second touch.
    pub figures: Option<TouchFigures>,
    /// The same of touches that were sent as the robot is described, beside corrected ones.
    pub figures_described: Option<TouchFigures>,
    /// Folder of the session that is written or shown.
    pub session: Option<PathBuf>,
    /// Runs that were begun and not finished, newest first.
    pub unfinished: Arc<[UnfinishedRun]>,
    /// The screen as it is taken to lie now.
    pub screen: Option<Touchscreen>,
    /// The largest rectangle of the screen that each finger reaches, the right one first, nothing in its
    /// way; `None`: not known yet, or none.
    pub reach: [Option<TouchArea>; 2],
    /// Its measured place in use; `None`: nominal, from the rig file.
    pub placement: Option<Arc<ScreenPlacement>>,
    /// A measured place that waits to be accepted.
    pub placement_proposal: Option<Arc<ScreenPlacement>>,
    /// Whether that place was measured by another run than the one that is shown.
    pub proposal_is_older: bool,
    /// With what targets are corrected before they are sent.
    pub correct_with: Option<Correction>,
    /// Where contacts come from.
    pub source: ContactSource,
    /// The touch window; `None` while it is closed.
    pub window: Option<ScreenWindow>,
    /// The newest contact, for showing it.
    pub last_contact: Option<ContactView>,
    /// Title of the arm whose hand stays on the screen or near it, while nothing moves it.
    pub near_screen: Option<String>,
}

/// Where contacts come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactSource {
    /// From nowhere: no robot is connected.
    #[default]
    None,
    /// The touch window on the touch monitor.
    Window,
    /// The glass of the twin.
    Twin,
}

/// What the run is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum TouchPhase {
    /// Nothing is planned.
    #[default]
    Idle,
    /// Plans, and looks what can be reached.
    Planning,
    /// Planned, nothing touched yet.
    Planned,
    /// The operator has to do something before it goes on (raise the screen, add the weight,
    /// release STOP, put the screen back): a sentence.
    Waiting {
        /// What.
        what: String,
        /// For [`crate::command::TouchCommand::Prepared`], when that is what is waited for.
        prepare: Option<(f64, f64)>,
    },
    /// Touches; the number of the planned touch and what the arm does just now.
    Running {
        /// From 1; `None` on the way home, where no touch waits for it.
        number: Option<usize>,
        /// "settling above target 35", for people.
        doing: String,
    },
    /// Holds between two touches.
    Paused {
        /// Why, if not because it was asked to.
        why: Option<String>,
    },
    /// All touches that can be done are done.
    Finished,
}

/// A plan and what is known of it before it runs.
#[derive(Clone, Debug)]
pub struct PlanView {
    /// What was asked.
    pub options: PlanOptions,
    /// Touches that can be reached.
    pub reachable: usize,
    /// Why others cannot, with how many, commonest first.
    pub refusals: Vec<(String, usize)>,
    /// How long it takes, estimated.
    pub duration: Duration,
    /// The model of the robot that targets were corrected with, for people: "with 2 effects"; empty
    /// where no effects corrected them.
    pub model: Arc<str>,
    /// What the plan will be able to tell apart; `None` when it could not be scored.
    pub score: Option<PlanScore>,
    /// Postures at the contacts that can be reached, for drawing; in the order of the plan.
    pub postures: Arc<[Option<Posture>]>,
}

/// A planned touch and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchState {
    /// From 1.
    pub number: usize,
    /// Pixel to be touched.
    pub target: Pixel<Screen>,
    /// Place of that pixel on the glass.
    pub target_place: Point<Robot>,
    /// The point that is sent: the place of the pixel, or what the model makes of it.
    pub sent: Point<Robot>,
    /// Whether the model that is used knows this part of the screen; true without a model.
    pub inside: bool,
    /// Label for blocking.
    pub set: String,
    /// Label of repeats.
    pub group: String,
    /// From where it is approached.
    pub side: Side,
    /// What became of it.
    pub outcome: TouchOutcome,
    /// Touched minus target, m along u and v; `None` without a touch.
    pub error_m: Option<[f64; 2]>,
    /// Pixel that was touched.
    pub touched: Option<Pixel<Screen>>,
}

/// What became of a planned touch.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum TouchOutcome {
    /// Not done yet.
    #[default]
    Waiting,
    /// Cannot be reached: why.
    Unreachable(String),
    /// Under way.
    UnderWay,
    /// Touched, and on disk.
    Touched,
    /// No contact: why.
    Missed(String),
    /// Left out by the operator.
    Skipped,
    /// Touched, but does not count.
    Rejected,
}

/// Numbers of touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TouchCounts {
    /// In the plan.
    pub planned: usize,
    /// Touched and counted.
    pub touched: usize,
    /// Without a contact.
    pub missed: usize,
    /// Left out.
    pub skipped: usize,
    /// Touched and not counted.
    pub rejected: usize,
    /// Out of reach.
    pub unreachable: usize,
}

/// Figures of what was touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchFigures {
    /// Touches that count.
    pub count: usize,
    /// Mean distance touched − target in the glass, m.
    pub mean_m: f64,
    /// 95 % interval of the mean, m.
    pub mean_interval_m: [f64; 2],
    /// Largest, m.
    pub largest_m: f64,
    /// Mean of touched − target along u and v, m.
    pub bias_m: [f64; 2],
    /// Spread of repeats in the glass (rms about the mean of their group), m: the noise floor;
    /// `None` without repeats.
    pub noise_m: Option<f64>,
    /// Repeats behind it.
    pub repeats: usize,
}

/// A run that was begun and not finished.
#[derive(Clone, Debug, PartialEq)]
pub struct UnfinishedRun {
    /// Session folder.
    pub session: PathBuf,
    /// When it was begun.
    pub started: jiff::Timestamp,
    /// For what.
    pub purpose: Purpose,
    /// Touched so far.
    pub touched: usize,
    /// Planned.
    pub planned: usize,
}

/// A contact, for showing it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactView {
    /// Where.
    pub pixel: Pixel<Screen>,
    /// Counts contacts.
    pub number: u64,
    /// Whether it still lasts.
    pub is_down: bool,
}
