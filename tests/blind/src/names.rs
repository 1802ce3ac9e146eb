//! Which names that were given are right, and a line of JSON about each.

use serde::Serialize;
use serde_json::Value;

use crate::answer::{Answer, Hidden, Plan, Source};
use crate::recipe::Family;
use crate::score::{Found, Verdict, plain};

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

/// A name with all that may go with its being right or wrong.
#[derive(Clone, Debug, Serialize)]
pub struct Line<'a> {
    /// Whose case.
    pub generator: Source,
    /// Seed of all cases.
    pub seed: u64,
    /// Its number.
    pub case: usize,
    /// What kind of case.
    pub family: Family,
    /// Which plan.
    pub plan: Plan,
    /// Whether small things are wrong, too.
    pub has_dirt: bool,
    /// What is hidden, and how large.
    pub hidden: Vec<(String, f64)>,
    /// What is there and need not be found.
    pub traces: &'a [String],
    /// Rows of the session, and distinct ones.
    pub rows: usize,
    /// Distinct poses, sides, heights, weights, places.
    pub cells: usize,
    /// The verdict in a word.
    pub verdict: &'a str,
    /// Whether the verdict gives names. Without, what is listed is no name and does not count.
    pub is_given: bool,
    /// How many effects are listed.
    pub names: usize,
    /// Its kind.
    pub kind: &'a str,
    /// Where.
    pub site: &'a str,
    /// Stated probability.
    pub stated: f64,
    /// Whether it is right.
    #[serde(flatten)]
    pub right: Rightness,
    /// What it does to the rows, in units of their noise.
    pub size_sigmas: Option<f64>,
    /// Every `id@site` that it could be, too.
    pub class: &'a [String],
    /// What else the search says of it and of its case.
    pub search: &'a Value,
}

/// A line for each effect of a verdict; `search`: one for each of them.
pub fn lines<'a>(answer: &'a Answer, seed: u64, verdict: &'a Verdict, search: &'a [Value]) -> Vec<Line<'a>> {
    let right = rightness(answer, verdict);
    let line = |((found, right), search): ((&'a Found, Rightness), &'a Value)| Line {
        generator: answer.generator,
        seed,
        case: answer.case,
        family: answer.family,
        plan: answer.design,
        has_dirt: !answer.dirt.is_empty(),
        hidden: answer.hidden.iter().map(|hidden| (hidden.named(), hidden.size_sigmas)).collect(),
        traces: &answer.dirt,
        rows: answer.rows,
        cells: answer.cells,
        verdict: &verdict.verdict,
        is_given: verdict.names(),
        names: verdict.effects.len(),
        kind: &found.id,
        site: &found.site,
        stated: found.probability,
        right,
        size_sigmas: found.size_sigmas,
        class: &found.class,
        search,
    };
    verdict.effects.iter().zip(right).zip(search).map(line).collect()
}
