//! What can be asked for by name of the 9 by 4 evaluation.

use std::borrow::Cow;

use plumbline_engine::view::GridDoing;
use plumbline_engine::{Command, DriftCommand, GridCommand, View};
use serde::Serialize;

/// What is laid unless something else is chosen: as published.
pub const USUAL_THING: &str = "Tomato";

/// Of the 9 by 4 evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GridAction {
    /// Begins with the usual thing.
    Begin,
    /// The thing lies where it was asked for.
    Placed,
    /// Leaves the place out.
    LeaveOut,
    /// Ends; what was measured stays.
    End,
    /// Chooses the folder of a session to show.
    Open,
}

impl GridAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 5] = [Self::Begin, Self::Placed, Self::LeaveOut, Self::End, Self::Open];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Begin => "Begin the 9×4 evaluation",
            Self::Placed => "The thing lies at its place of the grid",
            Self::LeaveOut => "Leave this place of the grid out",
            Self::End => "End the 9×4 evaluation",
            Self::Open => "Open an evaluation…",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let grid = &view.drift.grid;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        let doing = grid.under_way().map(|run| run.doing);
        match self {
            Self::Begin => grid.unable.map(Cow::Borrowed),
            Self::Placed => when(
                matches!(doing, Some(GridDoing::Asks | GridDoing::NotSeen)),
                "nothing has to be laid down",
            ),
            Self::LeaveOut | Self::End => when(doing.is_some(), "no evaluation is under way"),
            Self::Open => None,
        }
    }

    /// The command that it stands for; `None` where the window has to ask first.
    pub fn command(self) -> Option<Command> {
        let command = match self {
            Self::Begin => GridCommand::Begin { object: USUAL_THING.to_owned() },
            Self::Placed => GridCommand::Placed,
            Self::LeaveOut => GridCommand::LeaveOut,
            Self::End => GridCommand::End,
            Self::Open => return None,
        };
        Some(DriftCommand::Grid(command).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_evaluation_the_reason_is_said() {
        for action in [GridAction::LeaveOut, GridAction::End] {
            assert_eq!(action.refusal(&View::default()).as_deref(), Some("no evaluation is under way"));
        }
        assert_eq!(GridAction::Open.command(), None);
    }
}
