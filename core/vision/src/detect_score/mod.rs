//! How good a detector is: average precision by the rule of COCO, what is taken for what, and how
//! far such a number can be trusted.
//!
//! The rule is that of the COCO challenge (Lin et al., *Microsoft COCO: Common Objects in
//! Context*, ECCV 2014) as its reference tool computes it: 101 points of recall, IoU from 0.50 to
//! 0.95, four ranges of area, at most 1, 10 and 100 boxes per image and class, crowds that count
//! neither way. A class that is nowhere to be found in the truth has no score, not the score 0.

mod accumulate;
mod confusion;
mod csv_text;
mod interval;
mod look;
mod matching;
mod operating;
mod own;
mod run;
mod summary;
#[cfg(test)]
mod tests;

use plumbline_model::{ClassIndex, PixelBox};

pub use confusion::{Cell, CellEntry, ConfusionMatrix, ConfusionOptions};
pub use csv_text::{matrix_csv, scores_csv};
pub use interval::{Interval, IntervalOptions, Intervals, ScoreIntervals};
pub use look::LookedAt;
pub use operating::OperatingPoint;
pub use run::{
    Detect, EvaluateError, EvaluateOptions, MedianTiming, ModelEvaluation, NameAgreement, PartOfJob,
    SkippedImage, evaluate,
};
pub use summary::{ClassScores, Scores, Summary, average_precision};

/// A box by its first corner and its size, as COCO files have it, in double precision: whether
/// an overlap is 0.5 or just below must not hang on rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScoreBox {
    /// Left edge, px.
    pub x_px: f64,
    /// Top edge, px.
    pub y_px: f64,
    /// Width, px.
    pub width_px: f64,
    /// Height, px.
    pub height_px: f64,
}

impl ScoreBox {
    /// Area, px².
    pub fn area_px2(&self) -> f64 {
        self.width_px * self.height_px
    }

    /// Area that both cover, px².
    fn common_px2(&self, other: &Self) -> f64 {
        let overlap = |a: f64, a_size: f64, b: f64, b_size: f64| (a + a_size).min(b + b_size) - a.max(b);
        let width_px = overlap(self.x_px, self.width_px, other.x_px, other.width_px);
        let height_px = overlap(self.y_px, self.height_px, other.y_px, other.height_px);
        if width_px <= 0.0 || height_px <= 0.0 { 0.0 } else { width_px * height_px }
    }

    /// Intersection over union; 0 where there is nothing in common.
    pub fn iou(&self, other: &Self) -> f64 {
        let common = self.common_px2(other);
        if common > 0.0 { common / (self.area_px2() + other.area_px2() - common) } else { 0.0 }
    }

    /// The part of this box that lies in a crowd, which is what counts there.
    fn part_in(&self, crowd: &Self) -> f64 {
        let common = self.common_px2(crowd);
        if common > 0.0 { common / self.area_px2() } else { 0.0 }
    }
}

impl From<PixelBox> for ScoreBox {
    fn from(area: PixelBox) -> Self {
        let [x0, y0, x1, y1] = [area.x0_px, area.y0_px, area.x1_px, area.y1_px].map(f64::from);
        Self { x_px: x0, y_px: y0, width_px: x1 - x0, height_px: y1 - y0 }
    }
}

/// A thing that is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthBox {
    /// What it is.
    pub class: ClassIndex,
    /// Where.
    pub area: ScoreBox,
    /// Area of the thing itself where that is known (an outline), px²; it decides which range of
    /// sizes the thing belongs to.
    pub thing_px2: Option<f64>,
    /// A group that nobody labeled one by one: boxes in it are neither right nor wrong.
    pub crowd: bool,
}

impl TruthBox {
    /// A thing with a box and nothing more.
    pub fn new(class: ClassIndex, area: impl Into<ScoreBox>) -> Self {
        Self { class, area: area.into(), thing_px2: None, crowd: false }
    }

    fn size_px2(&self) -> f64 {
        self.thing_px2.unwrap_or_else(|| self.area.area_px2())
    }
}

/// A box of a detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundBox {
    /// What it is said to be, in the classes of the truth.
    pub class: ClassIndex,
    /// How sure the detector is.
    pub confidence: f64,
    /// Where.
    pub area: ScoreBox,
}

/// An image: what is there, and what was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScoredImage {
    /// What is there.
    pub truth: Vec<TruthBox>,
    /// What was found. Of equally sure boxes the first counts as surer.
    pub found: Vec<FoundBox>,
}

/// Overlaps at which a box counts as right.
#[derive(Clone, Debug, PartialEq)]
pub struct IouThresholds(Vec<f64>);

impl IouThresholds {
    /// 0.50, 0.55, … 0.95: the mean over them is the score called mAP50–95.
    pub fn coco() -> Self {
        let step = (0.95 - 0.5) / 9.0;
        let mut thresholds: Vec<f64> = (0..10).map(|i| f64::from(i) * step + 0.5).collect();
        thresholds[9] = 0.95;
        Self(thresholds)
    }

    /// One overlap only.
    pub fn one(iou: f64) -> Self {
        Self(vec![iou])
    }

    /// The overlaps, rising.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Number of an overlap in the list.
    fn index_of(&self, iou: f64) -> Option<usize> {
        self.0.iter().position(|value| (value - iou).abs() < 1e-9)
    }
}

impl Default for IouThresholds {
    fn default() -> Self {
        Self::coco()
    }
}

/// Ranges of sizes, by area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeRange {
    /// All.
    All,
    /// Up to 32 × 32 px.
    Small,
    /// Between.
    Medium,
    /// From 96 × 96 px.
    Large,
}

impl SizeRange {
    /// All four.
    pub const EACH: [Self; 4] = [Self::All, Self::Small, Self::Medium, Self::Large];

    /// Least and greatest area, px², both included.
    pub fn limits_px2(self) -> (f64, f64) {
        let (small, large, end) = (32.0 * 32.0, 96.0 * 96.0, 1e10);
        match self {
            Self::All => (0.0, end),
            Self::Small => (0.0, small),
            Self::Medium => (small, large),
            Self::Large => (large, end),
        }
    }

    fn excludes(self, area_px2: f64) -> bool {
        let (least, greatest) = self.limits_px2();
        area_px2 < least || area_px2 > greatest
    }
}
