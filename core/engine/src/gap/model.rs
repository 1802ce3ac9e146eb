//! The model in use for people: its name, its effects, its steps.

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Step, StepKind};
use plumbline_report::HistoryEntry;

use super::view::{AddedEffect, GapModelView, ModelStep};
use crate::rig_models;

/// "nominal", "nominal + 2 effects", "nominal + 2 effects and small shares".
pub fn name(model: &RigModel) -> String {
    let counted = |n: usize| plumbline_model::counted(n, "effect");
    match model.named_and_shares() {
        (0, 0) => "nominal".to_owned(),
        (0, shares) => format!("nominal + small shares of {}", counted(shares)),
        (named, 0) => format!("nominal + {}", counted(named)),
        (named, _) => format!("nominal + {} and small shares", counted(named)),
    }
}

/// Those that were named in this model, and how many others came with them.
fn titles(step: &Step, model: &RigModel) -> String {
    let has_name = |name: &&String| {
        let mut effects = model.effects().iter();
        effects.find(|effect| effect.name() == **name).is_none_or(|effect| model.is_named(effect))
    };
    let named: Vec<&str> = step.effects.iter().filter(has_name).map(String::as_str).collect();
    match (named.len(), step.effects.len() - named.len()) {
        (_, 0) => named.join(", "),
        (0, shares) => format!("small shares of {}", plumbline_model::counted(shares, "effect")),
        (_, shares) => format!("{} and small shares of {shares}", named.join(", ")),
    }
}

/// Every effect with its values, so that it can be told whether a model is still the same.
pub fn parts(model: &RigModel) -> Vec<String> {
    model.effects().iter().map(|effect| format!("{} {:?}", effect.name(), effect.values)).collect()
}

/// The gaps of the models so far, as a report shows them.
pub fn report_history(model: &RigModel) -> Vec<HistoryEntry> {
    let mut history: Vec<HistoryEntry> = vec![];
    for (step, gap) in rig_models::history(model) {
        if history.is_empty() {
            history.push(HistoryEntry { name: "nominal".to_owned(), gap: gap.before });
        }
        history.push(HistoryEntry { name: format!("{} added", titles(step, model)), gap: gap.after });
    }
    history
}

/// What the window shows of a model.
pub fn view(model: &RigModel) -> GapModelView {
    let effects = model.effects().iter().map(|effect| AddedEffect {
        name: effect.name(),
        is_named: model.is_named(effect),
        title: if effect.title.is_empty() { effect.name() } else { effect.title.clone() },
        parameters: effect.parameters.iter().map(|p| (p.name.clone(), p.value, [p.low, p.high])).collect(),
    });
    GapModelView {
        name: name(model),
        effects: effects.collect(),
        history: model.history.iter().map(|of| step(of, model)).collect(),
        can_undo: model.can_undo(),
    }
}

fn step(step: &Step, model: &RigModel) -> ModelStep {
    let what = match step.kind {
        StepKind::Added => "added",
        StepKind::Removed => "taken out",
        StepKind::Undone => "taken back",
    };
    ModelStep {
        at: step.at,
        title: format!("{} {what}", titles(step, model)),
        undone: step.undone || step.kind == StepKind::Undone,
        errors: step.gap.as_ref().map(|gap| [gap.before, gap.after, gap.floor]),
        in_pixels: step.gap.as_ref().is_some_and(|gap| gap.unit == "px"),
        sessions: step.sessions.clone(),
    }
}
