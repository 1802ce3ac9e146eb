//! Which model is best, and whether that can be told.

use plumbline_engine::correction::{
    Comparison, CorrectionModel, Errors, Method, Repeats, TouchData, distance_2d_m, spread_of_repeats,
};
use plumbline_engine::view::{MapTouch, ModelMap, ModelsView};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::seen::Seen;

/// A method on touches that it was not trained on.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Which.
    pub method: Method,
    /// Over all held-out touches.
    pub errors: Errors,
    /// 95 % interval of the mean in the plane, m.
    pub interval_m: [f64; 2],
}

/// What is told about all methods; made once per comparison.
#[derive(Debug, Default)]
pub struct Facts {
    /// The methods in their order.
    pub judged: Vec<Judged>,
    /// By its place in `judged`.
    pub best: Option<usize>,
    /// Mean error without a model, m.
    pub without_m: Option<f64>,
    /// Spread of repeats: the noise floor.
    pub noise: Option<Repeats>,
    /// A sentence per method that is not the best: whether it can be told apart.
    pub apart: Vec<String>,
}

/// What the facts are made from.
#[derive(Debug, PartialEq)]
pub struct Basis {
    comparison: Seen<Comparison>,
    data: Seen<TouchData>,
    map: Seen<ModelMap>,
    in_use: Seen<CorrectionModel>,
}

impl Basis {
    /// As the view has it now.
    pub fn of(models: &ModelsView) -> Self {
        Self {
            comparison: Seen::of_any(models.comparison.as_ref()),
            data: Seen::of_any(models.data.as_ref().and_then(|data| data.as_ref().ok())),
            map: Seen::of_any(models.map.as_ref()),
            in_use: Seen::of_any(models.in_use.as_ref()),
        }
    }
}

impl Facts {
    /// Of what the view has now.
    pub fn of(models: &ModelsView) -> Self {
        let data = models.data.as_ref().and_then(|data| data.as_ref().ok());
        let judged = judged(models);
        let least =
            judged.iter().enumerate().min_by(|a, b| a.1.errors.mean_2d_m.total_cmp(&b.1.errors.mean_2d_m));
        let best = least.map(|(i, _)| i);
        let apart = match (&models.comparison, best) {
            (Some(comparison), Some(best)) => apart(comparison, judged[best].method),
            _ => Vec::new(),
        };
        Self {
            best,
            without_m: models.map.as_ref().and_then(|map| without_model_m(&map.touches)),
            noise: data.and_then(|data| spread_of_repeats(data)),
            apart,
            judged,
        }
    }

    /// "M3 is best: 4.40 mm on touches that it had not seen, against 21.3 mm without a model."
    pub fn headline(&self) -> Option<String> {
        let best = &self.judged[self.best?];
        let against = self
            .without_m
            .map_or_else(String::new, |m| format!(", against {} without a model", format::mm(m)));
        let mean = format::mm(best.errors.mean_2d_m);
        Some(if self.judged.len() == 1 {
            format!("{} misses by {mean} on touches that it had not seen{against}.", best.method.name())
        } else {
            format!("{} is best: {mean} on touches that it had not seen{against}.", best.method.name())
        })
    }
}

fn judged(models: &ModelsView) -> Vec<Judged> {
    if let Some(comparison) = &models.comparison {
        let of = |method: Method| {
            let held_out = comparison.of(method)?;
            Some(Judged { method, errors: held_out.errors, interval_m: held_out.mean_2d_interval_m })
        };
        return Method::ALL.into_iter().filter_map(of).collect();
    }
    // After a restart there is only what the model in use keeps of itself.
    let in_use = models.in_use.as_ref().and_then(|model| {
        let held_out = model.provenance().cross_validation.as_ref()?;
        let interval_m = held_out.mean_2d_interval_m;
        Some(Judged { method: model.method(), errors: held_out.errors, interval_m })
    });
    in_use.into_iter().collect()
}

fn without_model_m(touches: &[MapTouch]) -> Option<f64> {
    let sum: f64 = touches.iter().map(|touch| distance_2d_m(&touch.before_m)).sum();
    (!touches.is_empty()).then(|| sum / touches.len() as f64)
}

/// Whether the other methods can be told apart from the best one, a sentence each.
fn apart(comparison: &Comparison, best: Method) -> Vec<String> {
    let sentence = |other: Method| {
        let (mean, [low, high]) = comparison.difference_m(other, best)?;
        let (other, best) = (other.name(), best.name());
        let range = format!("{} to {}", Quantity::Length.number(low), Quantity::Length.text(high));
        Some(if low <= 0.0 {
            format!("{other} cannot be told apart from {best}: it misses by {range} more (95 %).")
        } else {
            format!("{other} is worse than {best} by {}, {range} (95 %).", format::mm(mean))
        })
    };
    Method::ALL.into_iter().filter(|method| *method != best).filter_map(sentence).collect()
}

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
        Some(Err(why)) => Standing::Unusable(why.clone()),
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
    Some(Standing::Proposed(best.method(), error_m(best)))
}
