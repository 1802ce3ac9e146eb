//! What a threshold on confidence does: how many of the boxes are right, and of the things found.

use plumbline_model::ClassIndex;
use serde::Serialize;

use super::summary::{ClassScores, Scores};

/// Precision and recall of one class with boxes from one confidence on, at an overlap of 0.5.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// Boxes from this confidence on count.
    pub confidence: f64,
    /// Boxes that are right.
    pub right: usize,
    /// Boxes that are wrong.
    pub wrong: usize,
    /// Things that no box is.
    pub missed: usize,
}

impl OperatingPoint {
    /// Part of the boxes that are right; `None` without boxes.
    pub fn precision(&self) -> Option<f64> {
        ratio(self.right, self.right + self.wrong)
    }

    /// Part of the things that are found; `None` without things.
    pub fn recall(&self) -> Option<f64> {
        ratio(self.right, self.right + self.missed)
    }

    /// Harmonic mean of precision and recall; `None` with neither boxes nor things.
    pub fn f1(&self) -> Option<f64> {
        ratio(2 * self.right, 2 * self.right + self.wrong + self.missed)
    }
}

fn ratio(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

impl Scores {
    /// The class with boxes from a confidence on. `None` if there is no such class, or 0.5 is not
    /// among the overlaps.
    pub fn at_confidence(&self, class: ClassIndex, confidence: f64) -> Option<OperatingPoint> {
        let bit = self.iou.index_of(0.5)?;
        let class = self.per_class.get(class.0)?;
        let counts = class.judged.partition_point(|judged| judged.confidence >= confidence);
        let mut point = OperatingPoint { confidence, right: 0, wrong: 0, missed: class.things };
        class.judged[..counts].iter().for_each(|judged| point.add(judged, bit));
        Some(point)
    }

    /// The confidence with the best balance of precision and recall (greatest F1; of equal ones
    /// the greatest confidence). `None` if there is nothing to find or nothing was found rightly.
    pub fn best_confidence(&self, class: ClassIndex) -> Option<OperatingPoint> {
        let bit = self.iou.index_of(0.5)?;
        let class: &ClassScores = self.per_class.get(class.0)?;
        let mut point = OperatingPoint { confidence: 1.0, right: 0, wrong: 0, missed: class.things };
        let mut best: Option<OperatingPoint> = None;
        let mut boxes = class.judged.iter().peekable();
        while let Some(judged) = boxes.next() {
            point.add(judged, bit);
            point.confidence = judged.confidence;
            // A threshold takes all equally sure boxes or none.
            let whole = boxes.peek().is_none_or(|next| next.confidence < judged.confidence);
            if whole && point.right > 0 && best.is_none_or(|best| point.f1() > best.f1()) {
                best = Some(point);
            }
        }
        best
    }
}

impl OperatingPoint {
    fn add(&mut self, judged: &super::matching::Judged, bit: usize) {
        if judged.ignored >> bit & 1 == 1 {
            return;
        }
        if judged.matched >> bit & 1 == 1 {
            self.right += 1;
            self.missed -= 1;
        } else {
            self.wrong += 1;
        }
    }
}
