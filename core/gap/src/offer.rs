//! What has no name may be added all the same as a part of the gap, where rows that were not used surely get nearer by it.

use plumbline_effects::Present;

use crate::finding::{NamedEffect, Shown, Verdict};
use crate::search::{BEYOND_PLAUSIBLE, BOUND, Found};

/// What closes less of the gap is no part of it.
const LEAST_PART: f64 = 0.15;
/// What is larger than plausible is offered where surely more than this closes …
const LEAST_SURE: f64 = 0.25;
/// … and no value is so many times its usual size: between the poses that were measured even that may help, beside them it
/// leads astray.
const FURTHEST: f64 = 2.0 * BOUND;

/// Whether there is a part to add. What is larger than plausible and may be added as that is so from then on, which
/// `warnings` say.
pub(crate) fn offer(found: &mut Found, shown: &mut Shown, warnings: &mut Vec<String>) -> bool {
    if found.verdict != Verdict::NotInLibrary || found.effects.is_empty() {
        return false;
    }
    let is_addable = |effect: &NamedEffect| effect.not_addable.is_none();
    if found.effects.iter().all(is_addable) {
        return shown.closes_a_part(true);
    }
    let by_part = found.effects.iter().any(is_addable) && shown.closes_a_part(false);
    let part_after = shown.part.as_ref().filter(|_| by_part).map(|part| part.after);
    let is_better = part_after.is_none_or(|after| shown.after < after);
    if !is_better || !shown.surely_closes() || !may_be_offered(found) {
        return by_part;
    }
    for effect in found.effects.iter_mut().filter(|effect| !is_addable(effect)) {
        warnings
            .push(format!("{}, by more than is plausible: it stands for something else, too", effect.title));
        effect.not_addable = None;
    }
    shown.part = None;
    true
}

/// Whether nothing speaks against what was found but that it is larger than plausible, and by how much is no matter.
fn may_be_offered(found: &Found) -> bool {
    let is_only_large =
        |effect: &NamedEffect| effect.not_addable.as_deref().is_none_or(|why| why == BEYOND_PLAUSIBLE);
    let is_near = |present: &Present| {
        let parameters = present.effect.parameters();
        present.values.iter().zip(parameters).all(|(value, one)| value.abs() <= FURTHEST * one.typical)
    };
    found.effects.iter().all(is_only_large) && found.assumed.effects.iter().all(is_near)
}

impl Shown {
    /// Whether what may be added certainly closes a part of the gap, where it was judged; `is_all`: that is all that was
    /// found.
    fn closes_a_part(&self, is_all: bool) -> bool {
        match &self.part {
            Some(part) => {
                let before = self.unseen.as_ref().map(|unseen| unseen.before);
                let holds_elsewhere =
                    before.is_none_or(|before| part.unseen_after.is_some_and(|after| after < before));
                closes(part.closure, part.closure_range, 0.0) && holds_elsewhere
            }
            // What was held out was predicted with all of them.
            None => is_all && closes(self.closure, self.closure_range, 0.0) && self.holds_elsewhere(),
        }
    }

    /// Whether all that was found closes a large part of the gap for sure.
    fn surely_closes(&self) -> bool {
        closes(self.closure, self.closure_range, LEAST_SURE) && self.holds_elsewhere()
    }

    /// Whether all that was found helps on a condition that was held out as a whole.
    fn holds_elsewhere(&self) -> bool {
        self.unseen.as_ref().is_none_or(|unseen| unseen.after < unseen.before)
    }
}

fn closes(closure: Option<f64>, range: Option<[f64; 2]>, surely: f64) -> bool {
    closure.is_some_and(|closure| closure > LEAST_PART) && range.is_some_and(|[low, _]| low > surely)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::{Part, ShownUnit, Unseen};

    /// All that was found closes 60 % of a gap of 3 mm.
    fn shown(low: f64) -> Shown {
        Shown {
            blocks: "5 folds".to_owned(),
            rows: 60,
            unit: ShownUnit::Meter,
            before: 3e-3,
            after: 1.5e-3,
            floor: 0.5e-3,
            closure: Some(0.6),
            closure_range: Some([low, 0.7]),
            worst_tenth: [6e-3, 3e-3],
            inside_95: 0.95,
            unseen: None,
            part: None,
            covariates: vec![],
            telling: vec![],
        }
    }

    fn unseen(after: f64) -> Option<Unseen> {
        Some(Unseen { what: "with a weight".to_owned(), rows: 20, before: 3e-3, after, floor: 5e-4 })
    }

    #[test]
    fn what_may_be_added_is_judged_by_itself() {
        let all = shown(0.5);
        assert!(all.closes_a_part(true) && !all.closes_a_part(false), "judged with what may not be added");
        let part = |closure: f64, low: f64| Part {
            after: 2.0e-3,
            closure: Some(closure),
            closure_range: Some([low, 0.9]),
            unseen_after: None,
        };
        let divided = |part: Part| Shown { part: Some(part), ..all.clone() };
        assert!(divided(part(0.4, 0.2)).closes_a_part(false));
        assert!(!divided(part(0.1, 0.05)).closes_a_part(false), "too little to be a part");
        assert!(!divided(part(0.4, -0.1)).closes_a_part(false), "by chance");
        let there = |after: Option<f64>| Shown {
            unseen: unseen(1e-3),
            ..divided(Part { unseen_after: after, ..part(0.4, 0.2) })
        };
        assert!(there(Some(2e-3)).closes_a_part(false));
        assert!(!there(Some(4e-3)).closes_a_part(false) && !there(None).closes_a_part(false), "not there");
    }

    #[test]
    fn what_is_larger_than_plausible_has_to_help_surely_and_elsewhere() {
        assert!(shown(0.5).surely_closes());
        assert!(!shown(0.2).surely_closes(), "enough for what is plausible only");
        let elsewhere = |after: f64| Shown { unseen: unseen(after), ..shown(0.5) };
        assert!(elsewhere(2e-3).surely_closes() && !elsewhere(4e-3).surely_closes());
    }
}
