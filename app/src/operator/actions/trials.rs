//! What can be asked for by name of the experiment with grasps.

use std::borrow::Cow;

use plumbline_engine::view::TrialsPhase;
use plumbline_engine::{Command, TrialsCommand, TrialsFormat, View};
use serde::Serialize;

/// Of the experiment with grasps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrialsAction {
    /// Goes on with the attempt that is next. The arm moves.
    GoOn,
    /// Holds after the attempt that is under way.
    Pause,
    /// The thing lies where it was asked for. The arm moves.
    Placed,
    /// Shows no experiment.
    Close,
    /// Writes what came of it (asks where to).
    Export(TrialsFormat),
}

impl TrialsAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 7] = [
        Self::GoOn,
        Self::Pause,
        Self::Placed,
        Self::Close,
        Self::Export(TrialsFormat::Csv),
        Self::Export(TrialsFormat::Html),
        Self::Export(TrialsFormat::Pdf),
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::GoOn => "Go on with the experiment",
            Self::Pause => "Pause the experiment after this attempt",
            Self::Placed => "The thing lies there",
            Self::Close => "Close the experiment",
            Self::Export(TrialsFormat::Csv) => "Export the experiment as CSV…",
            Self::Export(TrialsFormat::Html) => "Export the experiment as HTML…",
            Self::Export(TrialsFormat::Pdf) => "Export the experiment as PDF…",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let trials = &view.trials;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        let Some(shown) = &trials.shown else { return Some("no experiment is open".into()) };
        let stands = matches!(trials.phase, TrialsPhase::Idle | TrialsPhase::Paused { .. });
        match self {
            Self::GoOn if shown.made == shown.all => Some("all its attempts are made".into()),
            Self::GoOn if !view.robot.connection.is_connected() => Some("no robot is connected".into()),
            Self::GoOn if view.robot.stopped => Some("STOP is latched: release it first".into()),
            Self::GoOn => when(stands, "it is under way"),
            Self::Pause => when(!stands, "nothing of it is under way"),
            Self::Placed => {
                when(matches!(trials.phase, TrialsPhase::Asks { .. }), "nothing has to be laid down")
            }
            Self::Close => when(stands, "an attempt is under way: pause it first"),
            Self::Export(_) => when(shown.made > 0, "no attempt was made yet"),
        }
    }

    /// The command that it stands for; `None` where the window has to ask first.
    pub fn command(self) -> Option<Command> {
        Some(
            match self {
                Self::GoOn => TrialsCommand::GoOn,
                Self::Pause => TrialsCommand::Pause,
                Self::Placed => TrialsCommand::Placed,
                Self::Close => TrialsCommand::Close,
                Self::Export(_) => return None,
            }
            .into(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_experiment_the_reason_is_said() {
        for action in TrialsAction::ALL {
            assert_eq!(action.refusal(&View::default()).as_deref(), Some("no experiment is open"));
        }
    }
}
