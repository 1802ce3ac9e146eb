//! What a search says of a name and of its case, for who looks for what goes with being wrong.

use plumbline_gap::finding::{Finding, NamedEffect};
use serde_json::{Value, json};

/// Candidates less probable than this are not listed.
const LEAST: f64 = 0.001;

/// One for each effect, in their order.
pub fn told(finding: &Finding) -> Vec<Value> {
    let comparison = &finding.comparison;
    let candidates: Vec<Value> = finding
        .candidates
        .iter()
        .filter(|candidate| candidate.probability >= LEAST)
        .map(|one| json!([format!("{}@{}", one.id, one.site), one.probability, one.score_sigmas]))
        .collect();
    let what: Vec<Value> = comparison.kinds.iter().map(|kind| json!(kind.what)).collect();
    let case = json!({
        "what": what,
        "noise_from": comparison.floor_from().word(),
        "has_repeats": comparison.floor_from_repeats,
        "rows_kept": comparison.rows_kept,
        "cells": comparison.cells,
        "gap_sigmas": comparison.size_sigmas,
        "unknown": finding.unexplained.probability,
        "left_p": finding.unexplained.p_value,
        "left_share": finding.unexplained.share,
        "candidates": candidates,
    });
    finding.effects.iter().map(|effect| with_effect(case.clone(), effect)).collect()
}

fn with_effect(mut case: Value, effect: &NamedEffect) -> Value {
    let class = effect.class.iter().map(|one| json!([format!("{}@{}", one.id, one.site), one.probability]));
    case["class_probability"] = json!(effect.class_probability);
    case["class"] = class.collect();
    case["runner_up"] = json!(effect.runner_up);
    case["not_addable"] = json!(effect.not_addable);
    case
}
