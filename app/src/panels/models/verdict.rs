//! Which model is best, and whether that can be told.

use plumbline_engine::view::{ModelMap, ModelsView};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::seen::Seen;

use crate::operator::snapshot::models::{
    Comparison, CorrectionModel, Errors, Method, Repeats, TouchData, spread_of_repeats,
};

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
    /// Methods that cannot be told apart from the best.
    pub alike: Vec<Method>,
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
        let alike = match (&models.comparison, best) {
            (Some(comparison), Some(best)) => alike(comparison, judged[best].method),
            _ => Vec::new(),
        };
        Self {
            best,
            alike,
            without_m: models.map.as_ref().and_then(|map| map.without_m),
            noise: data.and_then(|data| spread_of_repeats(data)),
            apart,
            judged,
        }
    }

    /// The simplest method that cannot be told apart from the best; `None`: the best one is.
    pub fn simplest(&self) -> Option<Method> {
        let best = self.judged[self.best?].method;
        self.alike.iter().copied().min().filter(|simplest| *simplest < best)
    }

    /// "M3 is best: 4.40 mm on touches that it had not seen, against 21.3 mm without a model."
    pub fn headline(&self) -> Option<String> {
        let best = &self.judged[self.best?];
        let against = self
            .without_m
            .map_or_else(String::new, |m| format!(", against {} without a model", format::mm(m)));
        let mean = format::mm(best.errors.mean_2d_m);
        if let Some(without_m) = self.without_m.filter(|without_m| best.interval_m[1] >= *without_m) {
            let so = match best.interval_m[0] > without_m {
                true => "which is less",
                false => "which cannot be told apart from that",
            };
            return Some(format!(
                "{} misses by {mean} on touches that it had not seen; without a model it is {}, {so}.",
                best.method.name(),
                format::mm(without_m)
            ));
        }
        Some(if self.judged.len() == 1 {
            format!("{} misses by {mean} on touches that it had not seen{against}.", best.method.name())
        } else {
            match self.simplest() {
                Some(simpler) => format!(
                    "{} errs least, {mean} on touches that it had not seen{against}; {} is simpler and cannot be told \
                     apart from it: use that one.",
                    best.method.name(),
                    simpler.name()
                ),
                None => format!(
                    "{} is best: {mean} on touches that it had not seen{against}.",
                    best.method.name()
                ),
            }
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

/// Methods that cannot be told apart from the best one: the interval of the difference holds nothing.
fn alike(comparison: &Comparison, best: Method) -> Vec<Method> {
    let is_alike = |other: &Method| {
        *other != best && comparison.difference_m(*other, best).is_some_and(|(_, [low, _])| low <= 0.0)
    };
    Method::ALL.into_iter().filter(is_alike).collect()
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
