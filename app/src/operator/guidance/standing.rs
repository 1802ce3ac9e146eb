//! Where the work on models stands.

use std::sync::Arc;

use plumbline_engine::view::ModelsView;

use crate::operator::snapshot::models::{CorrectionModel, Method};

/// Where the work on models stands, for the bottom line.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// Nothing to learn from.
    NothingTouched,
    /// The chosen session cannot be used: why.
    Unusable(String),
    /// Sessions are there, none is chosen.
    NotChosen,
    /// So many touches wait.
    Recorded(usize),
    /// Models are being trained.
    Training,
    /// The best proposal, and its mean error on unseen touches, m.
    Proposed(Method, Option<f64>),
    /// In use.
    InUse(Method),
}

/// Where the work on models stands.
pub fn standing(models: &ModelsView) -> Standing {
    if models.training {
        return Standing::Training;
    }
    if let Some(proposed) = best_proposal(models).filter(|_| !is_decided(models)) {
        return proposed;
    }
    if let Some(model) = &models.in_use {
        return Standing::InUse(model.method());
    }
    match &models.data {
        Some(Ok(data)) => Standing::Recorded(data.len()),
        Some(Err(why)) => Standing::Unusable(why.to_string()),
        None if models.session.is_some() => Standing::NotChosen,
        None if models.sessions.iter().any(|session| session.problem.is_none()) => Standing::NotChosen,
        None => Standing::NothingTouched,
    }
}

/// Whether one of the models that were proposed together is in use: the others stay proposed, to be
/// looked at, but nothing has to be decided any more.
fn is_decided(models: &ModelsView) -> bool {
    let (Some(comparison), Some(in_use)) = (&models.comparison, &models.in_use) else { return false };
    let judged = |model: &CorrectionModel| {
        let own = model.provenance().cross_validation.as_ref();
        own.is_some() && comparison.of(model.method()) == own
    };
    judged(in_use) && models.proposals.iter().all(|model| judged(model) && model.method() != in_use.method())
}

/// Of several the one with the least error on unseen touches; an imported one may have none.
fn best_proposal(models: &ModelsView) -> Option<Standing> {
    let error_m = |model: &CorrectionModel| {
        model.provenance().cross_validation.as_ref().map(|held_out| held_out.errors.mean_2d_m)
    };
    let or_last = |model: &CorrectionModel| error_m(model).unwrap_or(f64::INFINITY);
    let best = models.proposals.iter().min_by(|a, b| or_last(a).total_cmp(&or_last(b)))?;
    // What is simpler and cannot be told apart from it is as good.
    let is_alike = |model: &&Arc<CorrectionModel>| {
        let compared = models.comparison.as_ref();
        let difference = compared.and_then(|compared| compared.difference_m(model.method(), best.method()));
        model.method() < best.method() && difference.is_some_and(|(_, [low, _])| low <= 0.0)
    };
    let simplest = models.proposals.iter().filter(is_alike).min_by_key(|model| model.method());
    let chosen = simplest.unwrap_or(best);
    Some(Standing::Proposed(chosen.method(), error_m(chosen)))
}

/// How far targets are missed without a model, m, where what a proposal leaves on touches that it had not seen may as
/// well be as large; and whether it is larger for certain.
pub fn no_better(models: &ModelsView, method: Method) -> Option<(f64, bool)> {
    let model = models.proposals.iter().find(|model| model.method() == method)?;
    let without_m = model.provenance().without?.mean_2d_m;
    let held_out = model.provenance().cross_validation.as_ref()?;
    Some((without_m, is_no_better(without_m, held_out.mean_2d_interval_m)?))
}

/// `None`: it is better; else whether it is worse for certain.
fn is_no_better(without_m: f64, [low_m, high_m]: [f64; 2]) -> Option<bool> {
    (high_m >= without_m).then_some(low_m > without_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_better_where_its_whole_interval_is() {
        assert_eq!(is_no_better(7.6e-3, [0.9e-3, 3.8e-3]), None);
        assert_eq!(is_no_better(7.6e-3, [5.1e-3, 9.9e-3]), Some(false));
        assert_eq!(is_no_better(2.0e-3, [4.5e-3, 5.5e-3]), Some(true));
    }
}
