//! What can be asked for by name of grasping.

use std::borrow::Cow;

use plumbline_engine::view::{GateState, GraspPhase, Need};
use plumbline_engine::{Command, GraspCommand, HandStep, View};
use serde::Serialize;

use super::led_by;
use crate::operator::words::grasp::made_room;

/// Of grasping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GraspAction {
    /// Looks, and shows what would be sent. Moves nothing.
    Plan,
    /// Forgets what is shown.
    Forget,
    /// Grasps. The arm moves.
    Grasp,
    /// Holds wherever it is.
    Pause,
    /// Goes on where it was. The arm moves.
    Resume,
    /// Ends what is under way; the arm holds.
    End,
    /// Attempts hold after each step, or no longer.
    StopAfterEach,
    /// One step of the hand by itself. The arm moves.
    Hand(HandStep),
    /// The operator saw that the object was held.
    Held,
    /// The operator saw that it was not.
    NotHeld,
}

type Refusal = Option<Cow<'static, str>>;

/// While the arm goes home.
const GOES_HOME: GraspPhase = GraspPhase::Hand { step: HandStep::Home, paused: false };

impl GraspAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 15] = [
        Self::Plan,
        Self::Forget,
        Self::Grasp,
        Self::Pause,
        Self::Resume,
        Self::End,
        Self::StopAfterEach,
        Self::Hand(HandStep::Open),
        Self::Hand(HandStep::Close),
        Self::Hand(HandStep::Lift),
        Self::Hand(HandStep::Place),
        Self::Hand(HandStep::Give),
        Self::Hand(HandStep::Home),
        Self::Held,
        Self::NotHeld,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Plan => "Plan a grasp",
            Self::Forget => "Forget the planned grasp",
            Self::Grasp => "Grasp",
            Self::Pause => "Pause the grasp",
            Self::Resume => "Go on grasping",
            Self::End => "End the grasp, hold the arm",
            Self::StopAfterEach => "Stop after each step of a grasp, or not",
            Self::Hand(HandStep::Open) => "Open the grasping hand",
            Self::Hand(HandStep::Close) => "Close the grasping hand",
            Self::Hand(HandStep::Lift) => "Lift the grasping hand",
            Self::Hand(HandStep::Place) => "Put down what is held",
            Self::Hand(HandStep::Give) => "Hold out what is held, to be taken",
            Self::Hand(HandStep::Home) => "Bring the grasping arm home",
            Self::Held => "It was held",
            Self::NotHeld => "It was not held",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Refusal {
        let grasp = &view.grasp;
        let under_way = grasp.phase != GraspPhase::Idle;
        let when = |possible: bool, why: &'static str| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::Hand(HandStep::Home) if grasp.phase == GOES_HOME => Some("the arm goes home".into()),
            Self::Hand(HandStep::Home) if under_way => None,
            Self::Plan | Self::Grasp | Self::Hand(_) if under_way => Some("something is under way".into()),
            Self::Plan | Self::Grasp => {
                // What made room is not there to be seen.
                grasp.trouble().map(said).or_else(|| made_room(view).as_deref().map(said))
            }
            Self::Hand(_) => arm_trouble(view),
            Self::Forget => when(grasp.plan.is_some() && !under_way, "nothing is planned"),
            Self::Pause => when(grasp.phase.moves() && !grasp.phase.is_paused(), "nothing moves"),
            Self::Resume => when(grasp.phase.is_paused(), "nothing is paused"),
            Self::End => when(under_way, "nothing is under way"),
            // Also in the middle of an attempt.
            Self::StopAfterEach => None,
            Self::Held | Self::NotHeld => when(judged(view).is_some(), "no grasp has ended yet"),
        }
    }

    /// The command that it stands for.
    pub fn command(self, view: &View) -> Option<Command> {
        let judge = |held| Some(GraspCommand::Judge { attempt: judged(view)?, held });
        Some(
            match self {
                Self::Plan => GraspCommand::Plan,
                Self::Forget => GraspCommand::Forget,
                Self::Grasp => GraspCommand::Grasp,
                Self::Pause => GraspCommand::Pause,
                Self::Resume => GraspCommand::Resume,
                Self::End => GraspCommand::End,
                Self::StopAfterEach => GraspCommand::StopAfterEachStep(!view.grasp.stops_after_each),
                Self::Hand(step) => GraspCommand::Hand(step),
                Self::Held => judge(true)?,
                Self::NotHeld => judge(false)?,
            }
            .into(),
        )
    }
}

/// The attempt that waits for the operator's word, by name: the last one, once it has ended.
fn judged(view: &View) -> Option<String> {
    let run = view.grasp.run.as_ref().filter(|run| run.outcome.is_some() && !run.name.is_empty())?;
    Some(run.name.clone())
}

/// The first gate of the arm that is shut.
fn arm_trouble(view: &View) -> Refusal {
    if let Some(why) = led_by(view) {
        return Some(why.into());
    }
    let mut gates = view.grasp.gates.iter();
    let shut = gates.find(|gate| gate.state == GateState::Shut && Need::OF_A_HAND.contains(&gate.of));
    shut.map(|gate| said(&gate.text))
}

/// As the end of a sentence of somebody else.
fn said(text: &str) -> Cow<'static, str> {
    Cow::Owned(text.trim_end_matches('.').to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{Connection, GraspView, RobotView, ToyView, TwinView};
    use plumbline_model::frame::{Point, Robot};

    use super::*;

    #[test]
    fn before_anything_was_grasped_the_reasons_are_said() {
        let view = View::default();
        let why = |action: GraspAction| action.refusal(&view).expect("cannot be done");
        assert_eq!(why(GraspAction::Pause), "nothing moves");
        assert_eq!(why(GraspAction::End), "nothing is under way");
        assert_eq!(why(GraspAction::Held), "no grasp has ended yet");
        assert_eq!(GraspAction::Held.command(&view), None);
    }

    #[test]
    fn what_made_room_is_not_looked_for() {
        let toy = |place: Option<Point<Robot>>| ToyView {
            name: "tomato".to_owned(),
            place,
            radius_m: 0.03,
            rgb: [200, 40, 30],
        };
        let why = |place| {
            let toys = vec![toy(place)];
            let twin =
                TwinView { running: true, toys, made_room: vec!["tomato".to_owned()], ..TwinView::default() };
            let robot = RobotView {
                connection: Connection::Connected { to: "it".to_owned(), twin: true },
                ..RobotView::default()
            };
            let grasp = GraspView { classes: Arc::from(["Tomato"]), ..GraspView::default() };
            let view = View {
                grasp: Arc::new(grasp),
                twin: Arc::new(twin),
                robot: Arc::new(robot),
                ..View::default()
            };
            GraspAction::Plan.refusal(&view)
        };
        assert!(why(None).is_some_and(|why| why.contains("made room for touches")));
        assert_eq!(why(Some(Point::new(0.4, 0.0, 0.08))), None);
    }

    #[test]
    fn the_switch_is_turned_to_what_it_is_not() {
        for on in [false, true] {
            let grasp = GraspView { stops_after_each: on, ..GraspView::default() };
            let view = View { grasp: Arc::new(grasp), ..View::default() };
            assert_eq!(GraspAction::StopAfterEach.refusal(&view), None);
            let turned = GraspAction::StopAfterEach.command(&view);
            assert_eq!(turned, Some(GraspCommand::StopAfterEachStep(!on).into()));
        }
    }
}
