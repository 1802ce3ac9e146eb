//! What can be asked for by name of correction models.

use std::borrow::Cow;

use plumbline_engine::correction::Method;
use plumbline_engine::{Command, ModelsCommand, View};

/// Of correction models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelsAction {
    /// Looks anew which sessions there are.
    ListSessions,
    /// Trains all three and compares them.
    TrainAll,
    /// Puts the proposal that is shown in use.
    AcceptShown,
    /// Forgets the proposals.
    Discard,
    /// Back to the model before.
    Undo,
    /// Uses no model.
    UseNone,
}

impl ModelsAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 6] =
        [Self::ListSessions, Self::TrainAll, Self::AcceptShown, Self::Discard, Self::Undo, Self::UseNone];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::ListSessions => "Look for touch sessions",
            Self::TrainAll => "Train M1, M2 and M3",
            Self::AcceptShown => "Accept the shown model",
            Self::Discard => "Discard the proposed models",
            Self::Undo => "Go back to the model before",
            Self::UseNone => "Use no model",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let models = &view.models;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::ListSessions => None,
            Self::TrainAll if models.training => Some("models are being trained".into()),
            Self::TrainAll => match &models.data {
                None => Some("no session with touches is chosen".into()),
                Some(Err(why)) => Some(why.clone().into()),
                Some(Ok(_)) => None,
            },
            Self::AcceptShown => when(shown_proposal(view).is_some(), "nothing is proposed"),
            Self::Discard => when(!models.proposals.is_empty(), "nothing is proposed"),
            Self::Undo => when(!models.earlier.is_empty(), "there was no other model before"),
            Self::UseNone => when(models.in_use.is_some(), "no model is in use"),
        }
    }

    /// The command that it stands for.
    pub fn command(self, view: &View) -> Option<Command> {
        Some(
            match self {
                Self::ListSessions => ModelsCommand::ListSessions,
                Self::TrainAll => {
                    ModelsCommand::Train { methods: Method::ALL.to_vec(), seed: 1, published_recipe: false }
                }
                Self::AcceptShown => ModelsCommand::Accept(shown_proposal(view)?),
                Self::Discard => ModelsCommand::Discard,
                Self::Undo => ModelsCommand::Undo,
                Self::UseNone => ModelsCommand::UseNone,
            }
            .into(),
        )
    }
}

/// The method whose map is shown, when it is proposed.
fn shown_proposal(view: &View) -> Option<Method> {
    let models = &view.models;
    models
        .map
        .as_ref()
        .filter(|map| map.proposed)
        .and_then(|map| map.method)
        .or(models.shown.filter(|_| !models.proposals.is_empty()))
}
