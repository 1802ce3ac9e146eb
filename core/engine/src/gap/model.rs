//! The model in use for people: its name, its effects, its steps.

use plumbline_effects::rig_model::{Contents, Step, StepKind};
use plumbline_effects::{Kind, RigModel};
use plumbline_model::parameter_words;
use plumbline_report::HistoryEntry;

use super::view::{AddedEffect, GapModelView, ModelStep};
use crate::rig_models;

/// "nominal", "nominal + 2 effects", "nominal + 2 effects (7 joint by joint) and small shares".
pub fn name(model: &RigModel) -> String {
    match model.named_and_shares() {
        (0, 0) => "nominal".to_owned(),
        (0, shares) => {
            format!("nominal + small shares of {}", plumbline_model::counted(shares, "effect"))
        }
        (_, 0) => format!("nominal + {}", model.named_in_words()),
        (_, _) => format!("nominal + {} and small shares", model.named_in_words()),
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
        history.push(HistoryEntry { name: format!("{} added", titles(model, step)), gap: gap.after });
    }
    history
}

/// What the window shows of a model, and how far each of its effects moves what it is about
/// ([`super::at_tip::moved_m`]).
pub fn view(model: &RigModel, moved_m: &[Option<f64>]) -> GapModelView {
    let effects = model.effects().iter().enumerate().map(|(i, effect)| AddedEffect {
        name: effect.name(),
        is_named: model.is_named(effect),
        title: if effect.title.is_empty() { plain(&effect.name()) } else { effect.title.clone() },
        parameters: effect.parameters.iter().map(|p| (p.name.clone(), p.value, [p.low, p.high])).collect(),
        is_of_eyes: Kind::of_id(&effect.id).is_some_and(Kind::is_of_eyes),
        is_left_out: false,
        moved_m: moved_m.get(i).copied().flatten(),
    });
    GapModelView {
        name: name(model),
        effects: effects.collect(),
        history: model.history.iter().enumerate().map(|(i, taken)| step(model, i, taken)).collect(),
        can_undo: model.can_undo(),
        can_redo: model.can_redo(),
    }
}

/// What a step was done to, for people: titles as the search gave them, and how many effects came beside the
/// named ones.
fn titles(model: &RigModel, step: &Step) -> String {
    let before = model.history.iter().map(|step| &step.before);
    let contents: Vec<&Contents> = std::iter::once(&model.contents).chain(before).collect();
    let known = |name: &str| {
        let of =
            |contents: &'_ &Contents| contents.effects.iter().find(|effect| effect.name() == name).cloned();
        contents.iter().find_map(|contents| Some((of(contents)?, contents)))
    };
    let (mut named, mut shares) = (vec![], 0);
    for name in &step.effects {
        match known(name) {
            Some((effect, contents)) if !contents.is_named(&effect) => shares += 1,
            Some((effect, _)) if !effect.title.is_empty() => named.push(effect.title),
            _ => named.push(plain(name)),
        }
    }
    let of_shares = format!("small shares of {}", plumbline_model::counted(shares, "effect"));
    match (named.is_empty(), shares) {
        (_, 0) => named.join("; "),
        (true, _) => of_shares,
        (false, _) => format!("{} and {of_shares}", named.join("; ")),
    }
}

/// `joint-zero@r_elbow_y` where nobody kept a title: "joint zero of the right elbow y".
fn plain(name: &str) -> String {
    let words = |id: &str| id.replace('-', " ");
    match name.split_once('@') {
        Some((id, site)) if !site.is_empty() => {
            format!("{} of {}", words(id), parameter_words::the(&parameter_words::place(site)))
        }
        _ => words(name.trim_end_matches('@')),
    }
}

fn step(model: &RigModel, place: usize, step: &Step) -> ModelStep {
    let what = match step.kind {
        StepKind::Added => "added",
        StepKind::Removed => "taken out",
        StepKind::Undone => "taken back",
    };
    ModelStep {
        at: step.at,
        title: format!("{} {what}", titles(model, step)),
        undone: step.undone || step.kind == StepKind::Undone,
        errors: step.gap.as_ref().map(|gap| [gap.before, gap.after, gap.floor]),
        is_rms: model.is_rms(place),
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
        let shown = view(&model, &[Some(2e-4)]);
        assert_eq!(shown.history[0].title, "axis skew of the right elbow y added");
        assert_eq!(shown.effects[0].title, "axis skew of the right elbow y");
        assert!(shown.effects[0].is_small() && !shown.effects[0].is_of_eyes);
        let mut titled = model;
        titled.contents.effects[0].title = "Right elbow: axis not square".to_owned();
        let shown = view(&titled, &[]);
        assert_eq!(shown.history[0].title, "Right elbow: axis not square added");
        assert!(!shown.effects[0].is_small(), "what is not known is not called small");
    }
}
