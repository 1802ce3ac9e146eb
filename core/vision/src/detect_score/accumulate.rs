//! From judged boxes, the surest first, to precision over recall.

use super::matching::Judged;

/// Points of recall at which precision is read.
pub(super) const RECALL_POINTS: usize = 101;

/// Precision and recall of one class at one overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Curve {
    /// Mean precision over the points of recall.
    pub average_precision: f64,
    /// Recall of all boxes together.
    pub recall: f64,
}

/// Reads the curve at one overlap. `weight` says how often an image counts; `things` is the
/// number of things that count, weighted; not 0.
pub(super) fn curve(
    judged: &[Judged],
    bit: usize,
    things: f64,
    weight: impl Fn(u32) -> f64,
    precision: &mut Vec<[f64; 2]>,
) -> Curve {
    // Recall and precision after every right box: between two of them recall stays and precision
    // falls, so no other point is ever read.
    precision.clear();
    let (mut right, mut wrong) = (0.0, 0.0);
    for judged in judged.iter().filter(|judged| judged.ignored >> bit & 1 == 0) {
        let weight = weight(judged.image);
        if judged.matched >> bit & 1 == 1 {
            right += weight;
            if weight > 0.0 {
                precision.push([right / things, right / (wrong + right + f64::EPSILON)]);
            }
        } else {
            wrong += weight;
        }
    }
    // What is reached at a higher recall is reached at a lower one too.
    let mut best = 0.0_f64;
    for point in precision.iter_mut().rev() {
        best = best.max(point[1]);
        point[1] = best;
    }
    let (mut sum, mut next) = (0.0, 0);
    for step in 0..RECALL_POINTS {
        let wanted = if step + 1 == RECALL_POINTS { 1.0 } else { step as f64 * 0.01 };
        while next < precision.len() && precision[next][0] < wanted {
            next += 1;
        }
        sum += precision.get(next).map_or(0.0, |point| point[1]);
    }
    Curve { average_precision: sum / RECALL_POINTS as f64, recall: right / things }
}
