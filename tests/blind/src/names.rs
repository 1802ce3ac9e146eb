//! A line of JSON about each name that was given.

use serde::Serialize;
use serde_json::Value;

use crate::answer::{Answer, Plan, Source};
use crate::recipe::Family;
use crate::verdict::{Found, Rightness, Verdict, rightness};

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
