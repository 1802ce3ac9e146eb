//! The model in use for people: its name, its effects, its steps.

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Step, StepKind};
use plumbline_report::HistoryEntry;

use super::view::{AddedEffect, GapModelView, ModelStep};
use crate::rig_models;

/// "nominal", "nominal + 2 effects".
pub fn name(model: &RigModel) -> String {
    match model.effects().len() {
        0 => "nominal".to_owned(),
        1 => "nominal + 1 effect".to_owned(),
        n => format!("nominal + {n} effects"),
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
        history
            .push(HistoryEntry { name: format!("{} added", titles(model, step).join("; ")), gap: gap.after });
    }
    history
}

/// What the window shows of a model.
pub fn view(model: &RigModel) -> GapModelView {
    let effects = model.effects().iter().map(|effect| AddedEffect {
        name: effect.name(),
        title: if effect.title.is_empty() { effect.name() } else { effect.title.clone() },
        parameters: effect.parameters.iter().map(|p| (p.name.clone(), p.value, [p.low, p.high])).collect(),
    });
    GapModelView {
        name: name(model),
        effects: effects.collect(),
        history: model.history.iter().map(|taken| step(model, taken)).collect(),
        can_undo: model.can_undo(),
    }
}

/// What a step was done to, for people: titles as the search gave them.
fn titles(model: &RigModel, step: &Step) -> Vec<String> {
    let before = model.history.iter().flat_map(|step| &step.before.effects);
    let known: Vec<_> =
        model.effects().iter().chain(before).filter(|effect| !effect.title.is_empty()).collect();
    let title = |name: &String| match known.iter().find(|effect| effect.name() == *name) {
        Some(effect) => effect.title.clone(),
        None => plain(name),
    };
    step.effects.iter().map(title).collect()
}

/// `joint-zero@r_elbow_y` where nobody kept a title: "joint zero of r elbow y".
fn plain(name: &str) -> String {
    let words = |text: &str| text.replace(['-', '_'], " ");
    match name.split_once('@') {
        Some((id, site)) if !site.is_empty() => format!("{} of {}", words(id), words(site)),
        _ => words(name.trim_end_matches('@')),
    }
}

fn step(model: &RigModel, step: &Step) -> ModelStep {
    let what = match step.kind {
        StepKind::Added => "added",
        StepKind::Removed => "taken out",
        StepKind::Undone => "taken back",
    };
    ModelStep {
        at: step.at,
        title: format!("{} {what}", titles(model, step).join("; ")),
        undone: step.undone || step.kind == StepKind::Undone,
        errors: step.gap.as_ref().map(|gap| [gap.before, gap.after, gap.floor]),
        in_pixels: step.gap.as_ref().is_some_and(|gap| gap.unit == "px"),
        sessions: step.sessions.clone(),
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;
    use crate::rig_models::made_up::model_with;

    #[test]
    fn steps_are_told_in_words_and_not_by_ids() {
        let model = model_with(&default_rig(), &[("axis-skew", "r_elbow_y", &[0.01, 0.0])]);
        assert_eq!(view(&model).history[0].title, "axis skew of r elbow y added");
        let mut titled = model;
        titled.contents.effects[0].title = "Right elbow: axis not square".to_owned();
        assert_eq!(view(&titled).history[0].title, "Right elbow: axis not square added");
    }
}
