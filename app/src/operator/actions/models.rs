//! What can be asked for by name of correction models.

use std::borrow::Cow;

use plumbline_engine::{Command, GraspTable, ModelsCommand, View};
use plumbline_widgets::format;
use serde::Serialize;

use super::touch::{Preset, TouchAction};
use crate::operator::snapshot::models::{FEWEST_FOR_A_NETWORK, Method};

/// Of correction models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelsAction {
    /// Looks anew which sessions there are.
    ListSessions,
    /// Trains all three and compares them.
    TrainAll,
    /// Chooses the folder of a session.
    OpenSession,
    /// Puts the proposal that is shown in use.
    AcceptShown,
    /// Puts a proposal in use.
    Accept(Method),
    /// Shows the map and numbers of a model.
    Show(Method),
    /// Goes to touching, with the model in use and new targets.
    Check,
    /// Reads a model file (asks which).
    Import,
    /// Writes a model file (asks where to).
    Export {
        /// Which; a proposal goes before the one in use.
        method: Method,
        /// As ONNX rather than as JSON.
        onnx: bool,
    },
    /// Reads a table from a CSV file (asks which).
    ImportTable(GraspTable),
    /// Writes a table to a CSV file (asks where to).
    ExportTable(GraspTable),
    /// Forgets the proposals.
    Discard,
    /// Back to the model before.
    Undo,
    /// Uses no model.
    UseNone,
}

impl ModelsAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 13] = [
        Self::ListSessions,
        Self::OpenSession,
        Self::TrainAll,
        Self::AcceptShown,
        Self::Check,
        Self::Discard,
        Self::Undo,
        Self::UseNone,
        Self::Import,
        Self::ImportTable(GraspTable::Height),
        Self::ImportTable(GraspTable::Yaw),
        Self::ExportTable(GraspTable::Height),
        Self::ExportTable(GraspTable::Yaw),
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::ListSessions => "Look for touch sessions",
            Self::TrainAll => "Train M1, M2 and M3",
            Self::OpenSession => "Open a session with touches…",
            Self::AcceptShown => "Accept the shown model",
            Self::Accept(Method::M1) => "Use M1",
            Self::Accept(Method::M2) => "Use M2",
            Self::Accept(Method::M3) => "Use M3",
            Self::Show(Method::M1) => "Show M1",
            Self::Show(Method::M2) => "Show M2",
            Self::Show(Method::M3) => "Show M3",
            Self::Check => "Check the model in use with new touches",
            Self::Import => "Import a model…",
            Self::Export { onnx: false, .. } => "Export the model as JSON…",
            Self::Export { onnx: true, .. } => "Export the model as ONNX…",
            Self::ImportTable(GraspTable::Height) => "Import grasp heights from CSV…",
            Self::ImportTable(GraspTable::Yaw) => "Import yaw angles from CSV…",
            Self::ExportTable(GraspTable::Height) => "Export grasp heights as CSV…",
            Self::ExportTable(GraspTable::Yaw) => "Export yaw angles as CSV…",
            Self::Discard => "Discard the proposed models",
            Self::Undo => "Undo the correction model in use",
            Self::UseNone => "Use no model",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let models = &view.models;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::ListSessions | Self::OpenSession | Self::Import | Self::ImportTable(_) => None,
            Self::TrainAll => training_refusal(view, &Method::ALL),
            Self::Accept(method) => when(is_proposed(view, method), "this model is not proposed"),
            Self::Show(method) | Self::Export { method, .. } => {
                let in_use = models.in_use.as_ref().is_some_and(|model| model.method() == method);
                when(in_use || is_proposed(view, method), "this model was not trained")
            }
            Self::Check if models.in_use.is_none() => Some("no model is in use".into()),
            Self::Check => TouchAction::Plan(Preset::Check).refusal(view),
            Self::ExportTable(GraspTable::Height) => {
                when(models.tables.height.is_some(), "there are no grasp heights")
            }
            Self::ExportTable(GraspTable::Yaw) => {
                when(models.tables.yaw.is_some(), "there are no yaw angles")
            }
            Self::AcceptShown => when(shown_proposal(view).is_some(), "nothing is proposed"),
            Self::Discard => when(!models.proposals.is_empty(), "nothing is proposed"),
            Self::Undo => when(!models.earlier.is_empty(), "there was no other model before"),
            Self::UseNone => when(models.in_use.is_some(), "no model is in use"),
        }
    }

    /// The command that it stands for; `None` where the window has to ask or to go first.
    pub fn command(self, view: &View) -> Option<Command> {
        Some(
            match self {
                Self::ListSessions => ModelsCommand::ListSessions,
                Self::TrainAll => {
                    ModelsCommand::Train { methods: Method::ALL.to_vec(), seed: 1, published_recipe: false }
                }
                Self::AcceptShown => ModelsCommand::Accept(shown_proposal(view)?),
                Self::Accept(method) => ModelsCommand::Accept(method),
                Self::Show(method) => ModelsCommand::Show(method),
                Self::OpenSession
                | Self::Check
                | Self::Import
                | Self::Export { .. }
                | Self::ImportTable(_)
                | Self::ExportTable(_) => return None,
                Self::Discard => ModelsCommand::Discard,
                Self::Undo => ModelsCommand::Undo,
                Self::UseNone => ModelsCommand::UseNone,
            }
            .into(),
        )
    }
}

/// Why these cannot be trained now. M1 alone does with fewer touches than the others.
pub fn training_refusal(view: &View, methods: &[Method]) -> Option<Cow<'static, str>> {
    if view.models.training {
        return Some("models are being trained".into());
    }
    match &view.models.data {
        None => Some("no session with touches is chosen".into()),
        Some(Err(why)) => Some(why.to_string().into()),
        Some(Ok(_)) => methods.iter().find_map(|method| too_few_for(view, *method)).map(Into::into),
    }
}

/// Why a method has too few touches to learn from; `None`: it has enough, or it is not known how many there are.
pub fn too_few_for(view: &View, method: Method) -> Option<String> {
    let touches = view.models.data.as_ref()?.as_ref().ok()?.len();
    (method != Method::M1 && touches < FEWEST_FOR_A_NETWORK).then(|| too_few(touches))
}

/// Why touches do for M1 alone.
pub fn too_few(touches: usize) -> String {
    format!(
        "{} are too few for M2 and M3, which need {FEWEST_FOR_A_NETWORK}: touch more, or train M1 alone",
        format::count(touches, "touch")
    )
}

fn is_proposed(view: &View, method: Method) -> bool {
    view.models.proposals.iter().any(|model| model.method() == method)
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
