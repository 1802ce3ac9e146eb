//! What can be asked for by name of tying the arms to the eyes.

use std::borrow::Cow;

use plumbline_engine::{Command, HandEyeCommand, View};
use serde::Serialize;

/// Of tying the arms to the eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HandEyeAction {
    /// Looks at body, screen and hands. The head and both arms move.
    Look,
    /// Ends the look; the arm holds.
    End,
    /// Puts the proposal in use.
    Accept,
    /// Forgets the proposal.
    Discard,
}

impl HandEyeAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 4] = [Self::Look, Self::End, Self::Accept, Self::Discard];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Look => "Look at the hands",
            Self::End => "End the look at the hands",
            Self::Accept => "Tie the arms to the eyes",
            Self::Discard => "Discard what the eyes saw of the hands",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let handeye = &view.handeye;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::Look if handeye.is_looking => Some("the eyes are looking already".into()),
            Self::Look => handeye.trouble().map(|why| Cow::Owned(why.to_owned())),
            Self::End => when(handeye.is_looking, "nothing is looked at"),
            Self::Accept | Self::Discard => when(handeye.proposal.is_some(), "nothing is proposed"),
        }
    }

    /// The command that it stands for.
    pub fn command(self) -> Command {
        match self {
            Self::Look => HandEyeCommand::Look,
            Self::End => HandEyeCommand::End,
            Self::Accept => HandEyeCommand::Accept,
            Self::Discard => HandEyeCommand::Discard,
        }
        .into()
    }
}
