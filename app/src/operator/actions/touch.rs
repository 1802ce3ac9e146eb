//! What can be asked for by name of touching the screen.

use std::borrow::Cow;

use plumbline_engine::view::{ContactSource, HandWaits, MotionState, TouchPhase};
use plumbline_engine::{Command, TouchCommand, View};
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{Finger, PlanOptions, Purpose, TouchArea};
use serde::Serialize;

use crate::operator::touch_monitor::window_problem;
use crate::operator::words::robot::is_limp;

/// Of touching the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TouchAction {
    /// Plans touches. Moves nothing.
    Plan(Preset),
    /// Begins the planned run. The arm moves.
    Start,
    /// Holds after the touch that is under way.
    Pause,
    /// Goes on where it was. The arm moves.
    Resume,
    /// Leaves the touch out that is under way or next.
    Skip,
    /// Says that screen and hand are as the plan asks.
    Prepared,
    /// Ends the run with what there is.
    Finish,
    /// Forgets the plan.
    Close,
    /// Goes on with the newest run that was not finished.
    OpenUnfinished,
    /// Makes the proposed place of the screen the one in use.
    AcceptScreen,
    /// Forgets the proposed place.
    DiscardScreen,
    /// Goes back to the place in the rig file.
    NominalScreen,
    /// Opens the touch window, or closes it.
    ToggleWindow,
}

/// Plans that are good to start with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Where the screen lies.
    Corners,
    /// The least a model can be trained on.
    Quick,
    /// A first calibration.
    First,
    /// Sides, heights and weights, to tell causes apart.
    Rich,
    /// New targets, to see how well a model reaches.
    Check,
}

/// Panels err at their edges and fingers slip off there: this much is left out.
const MARGIN_M: f64 = 0.02;
/// What is reached is taken this much smaller on each side.
const REACH_INSET_M: f64 = 0.006;
/// Targets of a check.
const CHECKED: usize = 20;
/// Random targets of a check lie elsewhere than those of training.
pub(super) const CHECK_SEED: u64 = 7;

impl Preset {
    /// All of them, in the order of work.
    pub const ALL: [Self; 5] = [Self::Corners, Self::Quick, Self::First, Self::Rich, Self::Check];

    /// Its options on this screen.
    pub fn options(self, area: TouchArea) -> PlanOptions {
        match self {
            Self::Corners => PlanOptions::place_screen(area),
            Self::Quick => PlanOptions::quick(area),
            Self::First => PlanOptions::first(area),
            Self::Rich => PlanOptions::rich(area),
            Self::Check => PlanOptions::check_reach(area, CHECKED, CHECK_SEED),
        }
    }
}

/// Targets that are drawn by chance are others than those of the checks before, also of those before a restart.
pub(super) fn other_targets(view: &View, options: PlanOptions) -> PlanOptions {
    if options.purpose != Purpose::Check {
        return options;
    }
    let made = view.gap.sessions.iter().filter(|session| session.is_check).count() as u64;
    let before = view.touch.plan.as_ref().map(|plan| &plan.options);
    let planned = before.filter(|before| before.purpose == Purpose::Check);
    let next = planned.map_or(options.seed, |before| before.seed.wrapping_add(1));
    PlanOptions { seed: next.max(options.seed.wrapping_add(made)), ..options }
}

/// What a finger reaches of the screen, as far as that is known; else all of it but its border.
pub fn usual_area(view: &View, finger: Finger) -> Option<TouchArea> {
    let screen = screen_of(view)?;
    let whole = TouchArea::within(screen, MARGIN_M);
    let Some(reach) = view.touch.reach[finger as usize] else { return Some(whole) };
    // The real screen lies some millimeters beside where reach was looked for.
    let inset = screen.pitch_m().map(|pitch_m| (REACH_INSET_M / pitch_m).round());
    let inner = |reach: [f64; 2], inset: f64| [(reach[0] + inset).round(), (reach[1] - inset).round()];
    let area = TouchArea { u_px: inner(reach.u_px, inset[0]), v_px: inner(reach.v_px, inset[1]) };
    let has_size = area.u_px[0] < area.u_px[1] && area.v_px[0] < area.v_px[1];
    Some(if has_size { area } else { reach })
}

/// The screen that is touched: as it is taken to lie, else as the rig file has it.
pub fn screen_of(view: &View) -> Option<&Touchscreen> {
    let nominal = || view.robot.rig.as_ref().map(|rig| &rig.touchscreen);
    view.touch.screen.as_ref().or_else(nominal)
}

type Refusal = Option<Cow<'static, str>>;

fn when(possible: bool, why: &'static str) -> Refusal {
    (!possible).then_some(Cow::Borrowed(why))
}

/// Whether a run has been begun and not ended.
pub fn is_under_way(phase: &TouchPhase) -> bool {
    matches!(phase, TouchPhase::Waiting { .. } | TouchPhase::Running { .. } | TouchPhase::Paused { .. })
}

impl TouchAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 17] = [
        Self::Plan(Preset::Corners),
        Self::Plan(Preset::Quick),
        Self::Plan(Preset::First),
        Self::Plan(Preset::Rich),
        Self::Plan(Preset::Check),
        Self::Start,
        Self::Pause,
        Self::Resume,
        Self::Skip,
        Self::Prepared,
        Self::Finish,
        Self::Close,
        Self::OpenUnfinished,
        Self::AcceptScreen,
        Self::DiscardScreen,
        Self::NominalScreen,
        Self::ToggleWindow,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Plan(Preset::Corners) => "Plan: place the screen",
            Self::Plan(Preset::Quick) => "Plan: quick training",
            Self::Plan(Preset::First) => "Plan: first calibration",
            Self::Plan(Preset::Rich) => "Plan: tell causes apart",
            Self::Plan(Preset::Check) => "Plan: check a model",
            Self::Start => "Touch the planned targets",
            Self::Pause => "Pause touching",
            Self::Resume => "Go on touching",
            Self::Skip => "Skip this touch",
            Self::Prepared => "Screen and weight are as asked",
            Self::Finish => "Finish touching",
            Self::Close => "Close the run",
            Self::OpenUnfinished => "Open the unfinished run",
            Self::AcceptScreen => "Use this place of the screen",
            Self::DiscardScreen => "Discard the proposed place of the screen",
            Self::NominalScreen => "Use the place of the screen as described",
            Self::ToggleWindow => "Touch window",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Refusal {
        let touch = &view.touch;
        match self {
            Self::Plan(_) => plan_refusal(view),
            Self::Start => start_refusal(view),
            Self::Resume => resume_refusal(view),
            Self::Pause if matches!(touch.phase, TouchPhase::Running { number: None, .. }) => {
                Some("no touch is left, and the run ends by itself; Esc or space stops the arm".into())
            }
            Self::Pause => {
                when(matches!(touch.phase, TouchPhase::Running { .. }), "nothing is being touched")
            }
            Self::Skip if matches!(touch.phase, TouchPhase::Running { number: None, .. }) => {
                Some("no touch is left".into())
            }
            Self::Skip | Self::Finish => when(is_under_way(&touch.phase), "no run is under way"),
            Self::Prepared => when(
                matches!(touch.phase, TouchPhase::Waiting { prepare: Some(_), .. }),
                "nothing has to be prepared",
            ),
            Self::Close if is_under_way(&touch.phase) => Some("a run is under way: finish it first".into()),
            Self::Close => when(touch.plan.is_some() || touch.session.is_some(), "no run is open"),
            Self::OpenUnfinished if is_under_way(&touch.phase) => Some("a run is under way".into()),
            Self::OpenUnfinished => when(!touch.unfinished.is_empty(), "all runs were finished"),
            Self::AcceptScreen | Self::DiscardScreen => {
                when(touch.placement_proposal.is_some(), "no place of the screen is proposed")
            }
            Self::NominalScreen => when(touch.placement.is_some(), "the described place is in use"),
            Self::ToggleWindow => {
                when(screen_of(view).is_some(), "the robot's description has no touchscreen")
            }
        }
    }

    /// The command that it stands for; `None` where the window does it by itself.
    pub fn command(self, view: &View) -> Option<Command> {
        let touch = &view.touch;
        Some(
            match self {
                Self::Plan(preset) => {
                    TouchCommand::Plan(other_targets(view, preset.options(usual_area(view, Finger::Right)?)))
                }
                Self::Start => TouchCommand::Start,
                Self::Pause => TouchCommand::Pause,
                Self::Resume => TouchCommand::Resume,
                Self::Skip => TouchCommand::Skip,
                Self::Prepared => {
                    let TouchPhase::Waiting { prepare: Some((screen_height_m, payload_kg)), .. } =
                        touch.phase
                    else {
                        return None;
                    };
                    TouchCommand::Prepared { screen_height_m, payload_kg }
                }
                Self::Finish => TouchCommand::Finish,
                Self::Close => TouchCommand::Close,
                Self::OpenUnfinished => {
                    TouchCommand::Open { session: touch.unfinished.first()?.session.clone() }
                }
                Self::AcceptScreen => TouchCommand::AcceptPlacement,
                Self::DiscardScreen => TouchCommand::DiscardPlacement,
                Self::NominalScreen => TouchCommand::UseNominalPlacement,
                Self::ToggleWindow => return None,
            }
            .into(),
        )
    }
}

fn plan_refusal(view: &View) -> Refusal {
    match &view.touch.phase {
        TouchPhase::Planning => Some("a plan is being made".into()),
        phase if is_under_way(phase) => Some("a run is under way: finish it first".into()),
        _ => when(screen_of(view).is_some(), "the robot's description has no touchscreen"),
    }
}

/// What keeps the arm from touching.
fn arm_refusal(view: &View) -> Refusal {
    if !view.robot.connection.is_connected() {
        return Some("no robot is connected".into());
    }
    if view.robot.stopped {
        return Some("STOP is latched: release it first".into());
    }
    if matches!(view.robot.motion, MotionState::Moving { .. }) {
        return Some("the arm moves: wait until it stands".into());
    }
    window_refusal(view)
}

/// A real touchscreen is felt by the touch window, which has to fill it.
fn window_refusal(view: &View) -> Refusal {
    if view.touch.source != ContactSource::Window {
        return None;
    }
    match (&view.touch.window, screen_of(view)) {
        (None, _) => Some("the touch window is closed: open it on the touch monitor".into()),
        (Some(window), Some(screen)) => window_problem(window, screen).map(Cow::Owned),
        (Some(_), None) => None,
    }
}

/// Whether the touch window has to be opened before anything can be touched.
pub fn needs_window(view: &View) -> bool {
    view.touch.source == ContactSource::Window && view.touch.window.is_none()
}

fn start_refusal(view: &View) -> Refusal {
    let touch = &view.touch;
    match &touch.phase {
        TouchPhase::Planned => {}
        TouchPhase::Planning => return Some("the plan is being made".into()),
        phase if is_under_way(phase) => return Some("a run is under way".into()),
        _ => return Some("nothing is planned".into()),
    }
    if touch.plan.as_ref().is_none_or(|plan| plan.reachable == 0) {
        return Some("no target can be reached: choose another area".into());
    }
    full_hand(view).or_else(|| limp(view)).or_else(|| arm_refusal(view))
}

/// Why hands that hold something, or may, do not touch: a finger that touches would drop it, onto the screen.
pub fn full_hand(view: &View) -> Refusal {
    if view.grasp.hand_waits.is_some_and(HandWaits::may_hold) {
        return Some("fingers may be around something: open the hand first, on the screen Grasp".into());
    }
    let held = view.grasp.held.as_ref()?;
    let (hand, object) = (held.hand.name(), held.object.to_lowercase());
    Some(format!("the {hand} hand holds the {object}: put it down first, on the screen Grasp").into())
}

/// Limp joints sink: nothing is begun from there.
fn limp(view: &View) -> Refusal {
    is_limp(&view.robot).then(|| "the joints are limp: hold all joints first, on the screen Robot".into())
}

fn resume_refusal(view: &View) -> Refusal {
    match view.touch.phase {
        TouchPhase::Paused { .. } => full_hand(view).or_else(|| limp(view)).or_else(|| arm_refusal(view)),
        // Waits for the disk: writing needs no arm.
        TouchPhase::Waiting { prepare: None, .. } => None,
        _ => Some("no run is paused".into()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{GapSession, GapView, GraspHand, GraspView, InHand, TouchView};

    use super::*;

    #[test]
    fn nothing_is_touched_with_a_full_hand() {
        let held = InHand { object: "Tomato".to_owned(), hand: GraspHand::Right };
        let grasp = Arc::new(GraspView { held: Some(held), ..GraspView::default() });
        let touch = TouchView { phase: TouchPhase::Paused { why: None }, ..TouchView::default() };
        let view = View { grasp, touch: Arc::new(touch), ..View::default() };
        let why = TouchAction::Resume.refusal(&view).expect("refused");
        assert_eq!(why, "the right hand holds the tomato: put it down first, on the screen Grasp");
    }

    #[test]
    fn without_a_robot_the_reasons_are_said() {
        let view = View::default();
        let why = |action: TouchAction| action.refusal(&view).expect("cannot be done");
        assert!(why(TouchAction::Plan(Preset::First)).contains("no touchscreen"));
        assert_eq!(why(TouchAction::Start), "nothing is planned");
        assert_eq!(why(TouchAction::AcceptScreen), "no place of the screen is proposed");
        assert_eq!(TouchAction::Plan(Preset::Quick).command(&view), None);
    }

    #[test]
    fn a_check_has_other_targets_than_all_before_it_also_after_a_restart() {
        let session = |name: &str| GapSession {
            folder: name.into(),
            name: name.to_owned(),
            started: None,
            is_check: name.ends_with("_check"),
            touches: 20,
            poses: 0,
            localizations: 0,
            problem: None,
        };
        let of = |sessions: &[&str], purpose| {
            let sessions = sessions.iter().map(|name| session(name)).collect();
            let view = View { gap: Arc::new(GapView { sessions, ..GapView::default() }), ..View::default() };
            let area = TouchArea { u_px: [0.0, 100.0], v_px: [0.0, 100.0] };
            other_targets(&view, PlanOptions { purpose, ..PlanOptions::check_reach(area, 20, CHECK_SEED) })
                .seed
        };
        let checks = ["a_touch", "b_check", "c_corners", "d_check"];
        let seeds = [0, 2, 4].map(|count| of(&checks[..count], Purpose::Check));
        assert_eq!(seeds, [CHECK_SEED, CHECK_SEED + 1, CHECK_SEED + 2]);
        assert_eq!(of(&checks, Purpose::Train), CHECK_SEED, "what trains is the same each time");
    }
}
