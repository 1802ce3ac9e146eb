//! What a search says of a case, and how right each of its names is.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::answer::{Answer, Hidden};

/// What `plumbline gap --json` prints, as far as it is judged.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Verdict {
    /// `no-gap`, `named`, `class` or `not-in-library`.
    pub verdict: String,
    /// Effects that were found.
    #[serde(default)]
    pub effects: Vec<Found>,
    /// How probable it is that much is a little off, where that is told.
    #[serde(default)]
    pub many: Option<f64>,
    /// The gap on rows that were not used.
    #[serde(default)]
    pub held_out: BTreeMap<String, Value>,
    /// Time that it took, s.
    #[serde(default)]
    pub seconds: Option<f64>,
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Found {
    /// Its name.
    pub id: String,
    /// Where.
    pub site: String,
    /// Stated probability of the name.
    pub probability: f64,
    /// Parameters: numbers with `low` and `high`, or text.
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// What it does to the rows, in units of their noise, where it says so.
    #[serde(default)]
    pub size_sigmas: Option<f64>,
    /// Every `id@site` that it could be, too.
    #[serde(default)]
    pub class: Vec<String>,
    /// Every `id@site` that may be there beside it, as a part of it.
    #[serde(default)]
    pub beside: Vec<String>,
}

impl Found {
    pub(crate) fn name(&self) -> String {
        plain(&format!("{}@{}", self.id, self.site))
    }

    pub(crate) fn may_be(&self, name: &str) -> bool {
        self.name() == name || self.class.iter().any(|member| plain(member) == name)
    }
}

impl Verdict {
    /// Whether it gives names.
    pub fn names(&self) -> bool {
        matches!(self.verdict.as_str(), "named" | "class")
    }

    pub(crate) fn closure(&self) -> Option<f64> {
        self.held_out.get("closure")?.as_f64()
    }
}

/// An effect without a site is written with or without the sign.
pub(crate) fn plain(name: &str) -> String {
    name.trim_end_matches('@').to_owned()
}

/// How right a name is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rightness {
    /// The name is of what is there.
    pub is_exact: bool,
    /// One of its class is.
    pub is_among: bool,
}

/// How right each of the effects of a verdict is, in their order.
pub fn rightness(answer: &Answer, verdict: &Verdict) -> Vec<Rightness> {
    let there: Vec<String> = answer
        .hidden
        .iter()
        .map(Hidden::named)
        .chain(answer.dirt.iter().chain(&answer.also).cloned())
        .map(|n| plain(&n))
        .collect();
    // A name in the place of what is hidden is not right because a trace of it is there as well.
    let own = |found: &Found| answer.hidden.iter().any(|hidden| plain(&hidden.named()) == found.name());
    let is_trace = |found: &Found| answer.dirt.iter().any(|dirt| plain(dirt) == found.name());
    let stands_for = |found: &Found| {
        let unnamed = answer.hidden.iter().map(|hidden| plain(&hidden.named()));
        let mut unnamed =
            unnamed.filter(|hidden| verdict.effects.iter().all(|other| other.name() != *hidden));
        unnamed.any(|hidden| found.may_be(&hidden))
    };
    let of = |found: &Found| {
        let is_in_its_place = !own(found) && is_trace(found) && stands_for(found);
        Rightness {
            is_exact: there.contains(&found.name()) && !is_in_its_place,
            is_among: there.iter().any(|name| found.may_be(name)),
        }
    };
    verdict.effects.iter().map(of).collect()
}
