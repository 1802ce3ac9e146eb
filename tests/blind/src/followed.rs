//! Where it leads to do the experiments that a search asks for: what was promised, and what came of it.

use std::fmt::Write as _;

use crate::answer::Answer;
use crate::score::{Share, VISIBLE};
use crate::verdict::{Found, Verdict};

/// Edges of the bins of promised probabilities.
const EDGES: [f64; 4] = [0.5, 0.7, 0.9, 0.97];

/// One experiment that was asked for and done.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The probability that the right names were promised to have after it.
    pub promised: f64,
    /// The mean probability that the names of what is hidden have after it; zero of those that are not named.
    pub stated: f64,
    /// Whether all of them, and nothing else, are named after it.
    pub is_right: bool,
}

/// A case that was followed.
#[derive(Clone, Debug)]
pub struct Case {
    /// How it was answered before any experiment, and after each.
    pub outcomes: Vec<Outcome>,
    /// Experiments that were done, in turn.
    pub steps: Vec<Step>,
}

/// How a case was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Whether everything that is named has one name.
    pub is_one_name: bool,
    /// Whether that is all that is hidden, and nothing else.
    pub is_right: bool,
}

impl Outcome {
    /// Of a verdict.
    pub fn of(answer: &Answer, verdict: &Verdict) -> Self {
        let hidden: Vec<String> = answer.hidden.iter().map(crate::answer::Hidden::named).collect();
        let name = |found: &Found| format!("{}@{}", found.id, found.site);
        let all = hidden.iter().all(|hidden| verdict.effects.iter().any(|found| name(found) == *hidden));
        let allowed = |found: &Found| {
            let beside = hidden.iter().chain(&answer.dirt).chain(&answer.also);
            beside.into_iter().any(|there| *there == name(found))
        };
        Self {
            is_one_name: verdict.verdict == "named" && !verdict.effects.is_empty(),
            is_right: verdict.names() && all && verdict.effects.iter().all(allowed),
        }
    }
}

/// The mean probability that a verdict gives to the names of what is hidden.
pub fn stated(answer: &Answer, verdict: &Verdict) -> f64 {
    let of = |hidden: &crate::answer::Hidden| {
        let own = |found: &&Found| found.id == hidden.id && found.site == hidden.site;
        verdict.effects.iter().find(own).map_or(0.0, |found| found.probability)
    };
    answer.hidden.iter().map(of).sum::<f64>() / answer.hidden.len().max(1) as f64
}

/// Whether a case is one that names are expected of: something is hidden, the library has it, and it is large enough.
pub fn is_judged(answer: &Answer) -> bool {
    let is_seen =
        |hidden: &crate::answer::Hidden| hidden.size_sigmas >= VISIBLE && !hidden.id.starts_with('(');
    !answer.hidden.is_empty() && answer.hidden.iter().all(is_seen)
}

/// The table of cases that were followed.
pub fn markdown(cases: &[Case]) -> String {
    let mut text = String::from(
        "| after experiments | one name | one name, and it is right | right |\n|---|---|---|---|\n",
    );
    let most = cases.iter().map(|case| case.steps.len()).max().unwrap_or(0);
    for done in 0..=most {
        // A case that asks for nothing more keeps its answer.
        let outcomes: Vec<Outcome> = cases
            .iter()
            .filter_map(|case| case.outcomes.get(done).or(case.outcomes.last()).copied())
            .collect();
        let share = |has: &dyn Fn(&Outcome) -> bool| {
            let share = Share { hits: outcomes.iter().filter(|o| has(o)).count(), of: outcomes.len() };
            let [low, high] = share.interval();
            let value = 100.0 * share.value().unwrap_or(f64::NAN);
            format!("{value:.0} % ({} of {}; {:.0}–{:.0} %)", share.hits, share.of, 100.0 * low, 100.0 * high)
        };
        let _ = writeln!(
            text,
            "| {done} | {} | {} | {} |",
            share(&|o| o.is_one_name),
            share(&|o| o.is_one_name && o.is_right),
            share(&|o| o.is_right)
        );
    }
    let steps: Vec<&Step> = cases.iter().flat_map(|case| &case.steps).collect();
    text.push_str("\n| promised | experiments | promised, mean | stated after it, mean | right after it |\n|---|---|---|---|---|\n");
    let bin = |step: &Step| EDGES.iter().filter(|edge| step.promised >= **edge).count();
    for k in 0..=EDGES.len() {
        let low = if k == 0 { 0.0 } else { EDGES[k - 1] };
        let high = EDGES.get(k).copied().unwrap_or(1.0);
        let own: Vec<&Step> = steps.iter().copied().filter(|step| bin(step) == k).collect();
        line(&mut text, &format!("{low:.2}–{high:.2}"), &own);
    }
    line(&mut text, "all", &steps);
    text
}

fn line(text: &mut String, what: &str, steps: &[&Step]) {
    let mean =
        |of: &dyn Fn(&Step) -> f64| steps.iter().map(|step| of(step)).sum::<f64>() / steps.len() as f64;
    if steps.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "| {what} | {} | {:.2} | {:.2} | {:.2} |",
        steps.len(),
        mean(&|step| step.promised),
        mean(&|step| step.stated),
        mean(&|step| f64::from(u8::from(step.is_right)))
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(outcomes: &[(bool, bool)], promised: &[f64]) -> Case {
        Case {
            outcomes: outcomes
                .iter()
                .map(|&(is_one_name, is_right)| Outcome { is_one_name, is_right })
                .collect(),
            steps: promised
                .iter()
                .zip(&outcomes[1..])
                .map(|(&promised, &(_, is_right))| Step { promised, stated: 0.5, is_right })
                .collect(),
        }
    }

    #[test]
    fn who_needs_no_experiment_counts_as_answered_after_every_one() {
        let cases = [case(&[(true, true)], &[]), case(&[(false, false), (true, true)], &[0.8])];
        let text = markdown(&cases);
        assert!(text.contains("| 0 | 50 % (1 of 2;"), "{text}");
        assert!(text.contains("| 1 | 100 % (2 of 2;"), "{text}");
    }

    #[test]
    fn promises_are_held_against_what_came_of_them() {
        let cases =
            [case(&[(false, false), (true, false)], &[0.8]), case(&[(false, false), (true, true)], &[0.8])];
        let text = markdown(&cases);
        assert!(text.contains("| 0.70–0.90 | 2 | 0.80 | 0.50 | 0.50 |"), "{text}");
        assert!(text.contains("| all | 2 | 0.80 | 0.50 | 0.50 |"), "{text}");
    }
}
