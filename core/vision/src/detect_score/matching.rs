//! Which box of a detector is which thing: per image and class, the surest box first.

use super::{FoundBox, IouThresholds, ScoreBox, SizeRange, TruthBox};

/// Overlaps up to this many; one bit each.
pub(super) type Bits = u16;

/// A box of a detector, judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judged {
    /// Number of its image.
    pub image: u32,
    /// 0 for the surest of its image and class.
    pub rank: u32,
    /// How sure the detector was.
    pub confidence: f64,
    /// Per overlap, whether it is a thing.
    pub matched: Bits,
    /// Per overlap, whether it counts neither way.
    pub ignored: Bits,
}

/// Boxes and things of one class on one image.
pub(super) struct ClassOnImage<'a> {
    image: u32,
    truth: Vec<&'a TruthBox>,
    found: Vec<&'a FoundBox>,
    /// Per box, per thing.
    overlaps: Vec<Vec<f64>>,
}

impl<'a> ClassOnImage<'a> {
    /// Takes the surest boxes, at most so many.
    pub fn new(image: usize, truth: Vec<&'a TruthBox>, mut found: Vec<&'a FoundBox>, most: usize) -> Self {
        // Stable: equally sure boxes keep their order.
        found.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        found.truncate(most);
        let overlap = |found: &ScoreBox, truth: &TruthBox| {
            if truth.crowd { found.part_in(&truth.area) } else { found.iou(&truth.area) }
        };
        let overlaps = found
            .iter()
            .map(|found| truth.iter().map(|truth| overlap(&found.area, truth)).collect())
            .collect();
        Self { image: image as u32, truth, found, overlaps }
    }

    /// Judges the boxes for one range of sizes; also says how many things count there.
    pub fn judge(&self, size: SizeRange, iou: &IouThresholds, judged: &mut Vec<Judged>) -> usize {
        let ignored: Vec<bool> =
            self.truth.iter().map(|truth| truth.crowd || size.excludes(truth.size_px2())).collect();
        // Things that count before things that do not.
        let mut order: Vec<usize> = (0..self.truth.len()).collect();
        order.sort_by_key(|&thing| ignored[thing]);
        let first = judged.len();
        judged.extend(self.found.iter().enumerate().map(|(rank, found)| Judged {
            image: self.image,
            rank: rank as u32,
            confidence: found.confidence,
            matched: 0,
            ignored: 0,
        }));
        for (bit, &threshold) in iou.values().iter().enumerate() {
            let mut taken = vec![false; self.truth.len()];
            for (found, judged) in judged[first..].iter_mut().enumerate() {
                match self.best(found, threshold, &order, &ignored, &taken) {
                    Some(thing) => {
                        taken[thing] = true;
                        judged.matched |= 1 << bit;
                        judged.ignored |= Bits::from(ignored[thing]) << bit;
                    }
                    None if size.excludes(self.found[found].area.area_px2()) => judged.ignored |= 1 << bit,
                    None => {}
                }
            }
        }
        ignored.iter().filter(|ignored| !**ignored).count()
    }

    /// The thing that a box is: the one it overlaps most, one that counts before any other.
    fn best(
        &self,
        found: usize,
        threshold: f64,
        order: &[usize],
        ignored: &[bool],
        taken: &[bool],
    ) -> Option<usize> {
        let mut needed = threshold.min(1.0 - 1e-10);
        let mut best: Option<usize> = None;
        for &thing in order {
            if taken[thing] && !self.truth[thing].crowd {
                continue;
            }
            if ignored[thing] && best.is_some_and(|best| !ignored[best]) {
                break;
            }
            // Of equal overlaps the later one, as the reference does.
            if self.overlaps[found][thing] >= needed {
                needed = self.overlaps[found][thing];
                best = Some(thing);
            }
        }
        best
    }
}
