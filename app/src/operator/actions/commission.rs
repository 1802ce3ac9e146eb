//! What can be asked for by name of commissioning.

use std::borrow::Cow;

use plumbline_engine::{
    Command, CommissionCommand, Correction, GraspCommand, GraspTarget, TouchCommand, TwinCommand, View,
};
use plumbline_model::touch_plan::{Finger, PlanOptions, Purpose};
use serde::Serialize;

use super::touch::{CHECK_SEED, Preset, TouchAction, other_targets, usual_area};
use crate::operator::guidance::{Press, course};

/// Of commissioning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommissionAction {
    /// Begins, or goes on where it was.
    Start,
    /// Does everything once more.
    StartAnew,
    /// Does what comes next on the way.
    Next,
    /// Leads no more.
    Leave,
    /// Plans touches of the corners, which measure where the screen lies.
    PlanCorners,
    /// Plans the touches that are learned from.
    PlanTouches,
    /// Plans the touches that check the model in use.
    PlanCheck,
    /// Chooses what is grasped first; the twin has it laid on its table.
    LayOut,
}

/// What is grasped first: round, and seen best by the shipped detector.
pub const FIRST_CLASS: &str = "Tomato";
/// Where it is laid: well within what the right arm reaches, beside nothing that lies on the twin's table. Robot frame, m.
pub const FIRST_PLACE_M: [f64; 2] = [0.31, -0.06];

type Refusal = Option<Cow<'static, str>>;

impl CommissionAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 8] = [
        Self::Start,
        Self::StartAnew,
        Self::Next,
        Self::Leave,
        Self::PlanCorners,
        Self::PlanTouches,
        Self::PlanCheck,
        Self::LayOut,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Start => "Begin commissioning, or go on with it",
            Self::StartAnew => "Commission once more, from the beginning",
            Self::Next => "Do what comes next in commissioning",
            Self::Leave => "Leave commissioning",
            Self::PlanCorners => "Plan the corners that commissioning touches",
            Self::PlanTouches => "Plan the touches that commissioning learns from",
            Self::PlanCheck => "Plan touches that check the model in use",
            Self::LayOut => "Choose the first thing to grasp",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Refusal {
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        let commission = &view.commission;
        match self {
            Self::Start | Self::StartAnew if !commission.is_known => {
                Some("how far it is was not read yet, or cannot be: the messages say why".into())
            }
            Self::Start => when(!commission.is_on, "it is under way"),
            Self::StartAnew => when(commission.began.is_some(), "it was never begun"),
            Self::Next => match course(view).map(|course| course.press) {
                None => Some("commissioning is not under way".into()),
                Some(Press::Wait { why, .. }) => Some(why.trim_end_matches('.').to_owned().into()),
                Some(Press::Do { .. }) => None,
            },
            Self::Leave => when(commission.is_on, "it is not under way"),
            Self::PlanCorners | Self::PlanTouches | Self::PlanCheck => {
                TouchAction::Plan(Preset::Check).refusal(view)
            }
            Self::LayOut => None,
        }
    }

    /// The commands that it stands for, one after the other.
    pub fn commands(self, view: &View) -> Vec<Command> {
        match self {
            Self::Start => vec![CommissionCommand::Start { anew: false }.into()],
            Self::StartAnew => vec![CommissionCommand::Start { anew: true }.into()],
            Self::Leave => vec![CommissionCommand::Leave.into()],
            Self::Next => vec![],
            Self::PlanCorners => few(view, Purpose::PlaceScreen).into_iter().collect(),
            Self::PlanTouches => {
                // What is learned from is sent as the robot is described.
                let plan = few(view, Purpose::Train);
                let plainly = view.touch.correct_with.map(|_| TouchCommand::CorrectWith(None).into());
                plainly.into_iter().chain(plan).collect()
            }
            Self::PlanCheck => {
                let correction = (!view.gap.model.effects.is_empty()).then_some(Correction::Effects);
                let plan = few(view, Purpose::Check);
                [Some(TouchCommand::CorrectWith(correction).into()), plan].into_iter().flatten().collect()
            }
            Self::LayOut => lay_out(view),
        }
    }
}

/// The plan of few touches for a purpose; `None` without a screen.
fn few(view: &View, purpose: Purpose) -> Option<Command> {
    let options = PlanOptions::few(usual_area(view, Finger::Right)?, purpose, CHECK_SEED);
    Some(TouchCommand::Plan(other_targets(view, options)).into())
}

fn lay_out(view: &View) -> Vec<Command> {
    let target = GraspTarget { class: Some(FIRST_CLASS.to_owned()), near_m: None };
    let mut commands: Vec<Command> = vec![];
    // Nothing else can be chosen while the arm goes home.
    if view.grasp.target != target {
        commands.push(GraspCommand::Target(target).into());
    }
    if view.twin.running {
        if view.twin.board.is_some() {
            commands.push(TwinCommand::HideBoard.into());
        }
        let [x_m, y_m] = FIRST_PLACE_M;
        commands.push(TwinCommand::PlaceToy { toy: FIRST_CLASS.to_lowercase(), x_m, y_m }.into());
    }
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn before_anything_is_known_nothing_is_begun() {
        let view = View::default();
        let why = |action: CommissionAction| action.refusal(&view).expect("cannot be done");
        assert!(why(CommissionAction::Start).contains("not read yet"));
        assert_eq!(why(CommissionAction::Next), "commissioning is not under way");
        assert_eq!(why(CommissionAction::Leave), "it is not under way");
    }

    #[test]
    fn without_effects_nothing_corrects_the_check() {
        let commands = CommissionAction::PlanCheck.commands(&View::default());
        assert_eq!(commands, [Command::from(TouchCommand::CorrectWith(None))]);
    }
}
