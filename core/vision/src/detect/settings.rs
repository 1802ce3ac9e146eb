//! What is asked of a detector: where it runs, and which boxes count.

use std::fmt;
use std::time::Duration;

use plumbline_model::detection::ClassIndex;
use serde::{Deserialize, Serialize};

use super::DetectError;

/// What computes the network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Provider {
    /// The processor; always there.
    #[default]
    Cpu,
    /// A graphics card of NVIDIA.
    Cuda,
    /// The same with TensorRT.
    TensorRt,
    /// Any graphics card under Windows.
    DirectMl,
    /// Apple's accelerators.
    CoreMl,
}

impl Provider {
    /// All, the one that is always there first.
    pub const ALL: [Self; 5] = [Self::Cpu, Self::Cuda, Self::TensorRt, Self::DirectMl, Self::CoreMl];
}

impl fmt::Display for Provider {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cpu => "the processor",
            Self::Cuda => "CUDA",
            Self::TensorRt => "TensorRT",
            Self::DirectMl => "DirectML",
            Self::CoreMl => "CoreML",
        })
    }
}

/// How a detector is run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DetectorOptions {
    /// What computes it.
    pub provider: Provider,
    /// Use the processor where `provider` cannot be used, and say so in
    /// [`DetectorInfo::provider_note`](super::DetectorInfo::provider_note); else that is an error.
    #[serde(default)]
    pub or_processor: bool,
    /// Threads on the processor; `None` takes one per core.
    pub threads: Option<usize>,
    /// Threads sleep while they wait for each other, so that other work gets the processor; alone,
    /// the network takes a little longer.
    #[serde(default)]
    pub shares_processor: bool,
}

/// Which boxes of a detector count.
///
/// The defaults are those of the field's `predict` command: confidence 0.25, intersection over
/// union 0.7, 300 boxes, all classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectSettings {
    /// Boxes count above this confidence, 0–1.
    pub confidence: f32,
    /// A box that overlaps a surer one of its class by more than this intersection over union
    /// is the same thing seen twice, 0–1.
    pub iou: f32,
    /// At most this many boxes, the surest first.
    pub most: usize,
    /// Boxes of other classes do not count.
    pub classes: ClassFilter,
    /// Confidence of single classes in place of `confidence`, by class number; classes past the
    /// end, and `None`, take `confidence`.
    #[serde(default)]
    pub per_class_confidence: Vec<Option<f32>>,
    /// Every class above its threshold makes a box, instead of the surest class only: how raw
    /// heads are judged for average precision. End-to-end heads have one class a box anyway.
    #[serde(default)]
    pub several_classes_per_box: bool,
}

impl Default for DetectSettings {
    fn default() -> Self {
        Self {
            confidence: 0.25,
            iou: 0.7,
            most: 300,
            classes: ClassFilter::All,
            per_class_confidence: Vec::new(),
            several_classes_per_box: false,
        }
    }
}

impl DetectSettings {
    /// As models are judged for average precision: nearly every box, every class of it.
    pub fn for_scores() -> Self {
        Self { confidence: 0.001, several_classes_per_box: true, ..Self::default() }
    }

    /// The confidence above which boxes of a class count; `None` where the class is filtered out.
    pub fn threshold(&self, class: ClassIndex) -> Option<f32> {
        let own = self.per_class_confidence.get(class.0).copied().flatten();
        self.classes.contains(class).then(|| own.unwrap_or(self.confidence))
    }

    /// Refuses thresholds out of range.
    pub(super) fn check(&self) -> Result<(), DetectError> {
        let own = self.per_class_confidence.iter().flatten().map(|value| ("confidence", *value));
        for (name, value) in [("confidence", self.confidence), ("overlap", self.iou)].into_iter().chain(own) {
            if !(0.0..=1.0).contains(&value) {
                return Err(DetectError::Threshold { name, value });
            }
        }
        Ok(())
    }
}

/// Which classes count.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClassFilter {
    /// All.
    #[default]
    All,
    /// Those whose bit is set: class `64 i + j` is bit `j` of word `i`.
    Only(Vec<u64>),
}

impl ClassFilter {
    /// Some classes.
    pub fn only(classes: impl IntoIterator<Item = ClassIndex>) -> Self {
        let mut words = Vec::new();
        for ClassIndex(class) in classes {
            if words.len() <= class / 64 {
                words.resize(class / 64 + 1, 0);
            }
            words[class / 64] |= 1u64 << (class % 64);
        }
        Self::Only(words)
    }

    /// Whether a class counts.
    pub fn contains(&self, ClassIndex(class): ClassIndex) -> bool {
        match self {
            Self::All => true,
            Self::Only(words) => words.get(class / 64).is_some_and(|word| word >> (class % 64) & 1 == 1),
        }
    }
}

/// Where the time of one image went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DetectTiming {
    /// Letterbox and conversion of the pixels.
    pub before: Duration,
    /// The network alone.
    pub network: Duration,
    /// Reading the head, suppression, back to the pixels of the image.
    pub after: Duration,
}

impl DetectTiming {
    /// All of it.
    pub fn total(&self) -> Duration {
        self.before + self.network + self.after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_holds_what_was_put_in() {
        let filter = ClassFilter::only([ClassIndex(0), ClassIndex(64), ClassIndex(79)]);
        let held: Vec<usize> = (0..200).filter(|class| filter.contains(ClassIndex(*class))).collect();
        assert_eq!(held, [0, 64, 79]);
        assert!(!ClassFilter::only([]).contains(ClassIndex(0)));
        assert!(ClassFilter::All.contains(ClassIndex(10_000)));
    }

    #[test]
    fn a_class_may_have_a_threshold_of_its_own() {
        let settings = DetectSettings {
            confidence: 0.5,
            per_class_confidence: vec![None, Some(0.1)],
            classes: ClassFilter::only([ClassIndex(0), ClassIndex(1), ClassIndex(5)]),
            ..DetectSettings::default()
        };
        let thresholds = [0, 1, 2, 5].map(|class| settings.threshold(ClassIndex(class)));
        assert_eq!(thresholds, [Some(0.5), Some(0.1), None, Some(0.5)]);
    }

    #[test]
    fn thresholds_out_of_range_are_refused() {
        for settings in [
            DetectSettings { confidence: -0.1, ..DetectSettings::default() },
            DetectSettings { iou: 1.5, ..DetectSettings::default() },
            DetectSettings { per_class_confidence: vec![Some(f32::NAN)], ..DetectSettings::default() },
        ] {
            let error = settings.check().expect_err("out of range").to_string();
            assert!(error.contains("between 0 and 1"), "{error}");
        }
        assert!(DetectSettings::for_scores().check().is_ok());
    }
}
