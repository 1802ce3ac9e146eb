//! Average precision and recall per class and over all.

use plumbline_model::ClassIndex;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use super::accumulate::{Curve, curve};
use super::matching::{ClassOnImage, Judged};
use super::{IouThresholds, ScoredImage, SizeRange};

/// Boxes per image and class: for recall, and the last one for everything else.
const MOST: [u32; 3] = [1, 10, 100];

/// The twelve numbers of COCO. `None`: no such thing in the truth, or the overlap was not asked
/// for.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Average precision, mean over the overlaps: mAP50–95.
    pub ap: Option<f64>,
    /// Average precision at an overlap of 0.5: mAP50.
    pub ap50: Option<f64>,
    /// Average precision at an overlap of 0.75.
    pub ap75: Option<f64>,
    /// Average precision of things up to 32 × 32 px.
    pub ap_small: Option<f64>,
    /// Average precision of things between.
    pub ap_medium: Option<f64>,
    /// Average precision of things from 96 × 96 px.
    pub ap_large: Option<f64>,
    /// Recall with one box per image and class.
    pub ar_1: Option<f64>,
    /// Recall with ten.
    pub ar_10: Option<f64>,
    /// Recall with a hundred.
    pub ar_100: Option<f64>,
    /// Recall of things up to 32 × 32 px.
    pub ar_small: Option<f64>,
    /// Recall of things between.
    pub ar_medium: Option<f64>,
    /// Recall of things from 96 × 96 px.
    pub ar_large: Option<f64>,
}

impl Summary {
    /// The twelve in the order of the reference tool.
    pub fn in_order(&self) -> [Option<f64>; 12] {
        [
            self.ap,
            self.ap50,
            self.ap75,
            self.ap_small,
            self.ap_medium,
            self.ap_large,
            self.ar_1,
            self.ar_10,
            self.ar_100,
            self.ar_small,
            self.ar_medium,
            self.ar_large,
        ]
    }

    fn from_order(n: [Option<f64>; 12]) -> Self {
        Self {
            ap: n[0],
            ap50: n[1],
            ap75: n[2],
            ap_small: n[3],
            ap_medium: n[4],
            ap_large: n[5],
            ar_1: n[6],
            ar_10: n[7],
            ar_100: n[8],
            ar_small: n[9],
            ar_medium: n[10],
            ar_large: n[11],
        }
    }

    /// Number by number the mean of those that are there.
    pub fn mean<'a>(of: impl IntoIterator<Item = &'a Self>) -> Self {
        let all: Vec<[Option<f64>; 12]> = of.into_iter().map(Self::in_order).collect();
        Self::from_order(std::array::from_fn(|i| mean(all.iter().filter_map(|numbers| numbers[i]))))
    }
}

/// Mean of what is there; `None` of nothing.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0usize, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}

/// Scores of one class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassScores {
    /// The class.
    pub class: ClassIndex,
    /// Things of it that count.
    pub things: usize,
    /// Images with such a thing.
    pub images: usize,
    /// Its numbers.
    pub summary: Summary,
    /// Boxes, the surest first, all sizes.
    pub(super) judged: Vec<Judged>,
    /// Things that count, per image.
    pub(super) things_per_image: Vec<u32>,
}

/// Scores of a detector on a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    /// Mean over the classes that are in the truth.
    pub overall: Summary,
    /// Per class, in their order.
    pub per_class: Vec<ClassScores>,
    /// Overlaps that were asked for.
    pub iou: IouThresholds,
}

/// Average precision and recall of boxes found on images, by the rule of COCO, for classes
/// `0..classes`.
pub fn average_precision(images: &[ScoredImage], classes: usize, iou: &IouThresholds) -> Scores {
    let per_class: Vec<ClassScores> =
        (0..classes).into_par_iter().map(|class| of_class(images, ClassIndex(class), iou)).collect();
    Scores {
        overall: Summary::mean(per_class.iter().map(|class| &class.summary)),
        per_class,
        iou: iou.clone(),
    }
}

fn of_class(images: &[ScoredImage], class: ClassIndex, iou: &IouThresholds) -> ClassScores {
    let on_images: Vec<ClassOnImage<'_>> = images
        .iter()
        .enumerate()
        .map(|(index, image)| {
            let truth = image.truth.iter().filter(|truth| truth.class == class).collect();
            let found = image.found.iter().filter(|found| found.class == class).collect();
            ClassOnImage::new(index, truth, found, MOST[2] as usize)
        })
        .collect();
    let mut numbers = [None; 12];
    let mut all = (Vec::new(), Vec::new());
    for (range, size) in SizeRange::EACH.into_iter().enumerate() {
        let mut judged = Vec::new();
        let things: Vec<u32> =
            on_images.iter().map(|image| image.judge(size, iou, &mut judged) as u32).collect();
        // Stable: equally sure boxes stay in the order of their images.
        judged.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        let curves = curves(&judged, &things, iou);
        numbers[range_number(range, false)] = mean(curves.iter().map(|curve| curve.average_precision));
        numbers[range_number(range, true)] = mean(curves.iter().map(|curve| curve.recall));
        if size == SizeRange::All {
            for (number, threshold) in [(1, 0.5), (2, 0.75)] {
                let curve = iou.index_of(threshold).and_then(|bit| curves.get(bit));
                numbers[number] = curve.map(|curve| curve.average_precision);
            }
            for (number, most) in [(6, MOST[0]), (7, MOST[1])] {
                let surest: Vec<Judged> =
                    judged.iter().filter(|judged| judged.rank < most).copied().collect();
                numbers[number] = mean(self::curves(&surest, &things, iou).iter().map(|curve| curve.recall));
            }
            all = (judged, things);
        }
    }
    let (judged, things_per_image) = all;
    ClassScores {
        class,
        things: things_per_image.iter().sum::<u32>() as usize,
        images: things_per_image.iter().filter(|things| **things > 0).count(),
        summary: Summary::from_order(numbers),
        judged,
        things_per_image,
    }
}

/// Place among the twelve of a range's average precision or recall.
fn range_number(range: usize, recall: bool) -> usize {
    match (range, recall) {
        (0, false) => 0,
        (_, false) => 2 + range,
        (_, true) => 8 + range,
    }
}

/// One curve per overlap; none where there is nothing to find.
fn curves(judged: &[Judged], things_per_image: &[u32], iou: &IouThresholds) -> Vec<Curve> {
    let things: u32 = things_per_image.iter().sum();
    if things == 0 {
        return Vec::new();
    }
    let mut scratch = Vec::new();
    (0..iou.values().len()).map(|bit| curve(judged, bit, f64::from(things), |_| 1.0, &mut scratch)).collect()
}
