//! What of the images of a set is looked at, and what of them counts.

use plumbline_model::{Detection, PixelBox};

use super::{FoundBox, ScoredImage, TruthBox};
use crate::detect::{Part, Region};
use crate::yolo_set::LabeledImage;

/// What of every image is looked at, and what of it counts.
///
/// A look at a part finds nothing elsewhere, and is not asked for it. Two looks are compared by what lies
/// in the part that both have seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LookedAt {
    /// What the network is given.
    pub part: Part,
    /// Where things count; `None`: everywhere. Things that reach over its edges are neither missed nor
    /// found, and neither are boxes whose middle is outside.
    pub within: Option<Region>,
}

impl LookedAt {
    /// An image as it is scored.
    pub(super) fn scored(&self, image: &LabeledImage, found: &[Detection]) -> ScoredImage {
        let counts = |area: &PixelBox| self.within.is_none_or(|region| region.holds(area));
        let begins = |area: &PixelBox| self.within.is_none_or(|region| region.holds(&middle(area)));
        let truth = image.boxes.iter().map(|labeled| TruthBox {
            crowd: !counts(&labeled.area),
            ..TruthBox::new(labeled.class, labeled.area)
        });
        let found = found.iter().filter(|found| begins(&found.area)).map(|found| FoundBox {
            class: found.class,
            confidence: f64::from(found.confidence),
            area: found.area.into(),
        });
        ScoredImage { truth: truth.collect(), found: found.collect() }
    }
}

/// The middle of a box, as a box without extent.
fn middle(area: &PixelBox) -> PixelBox {
    let (u, v) = (0.5 * (area.x0_px + area.x1_px), 0.5 * (area.y0_px + area.y1_px));
    PixelBox::new(u, v, u, v)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use plumbline_model::ClassIndex;

    use super::*;
    use crate::detect_score::{IouThresholds, average_precision};
    use crate::yolo_set::LabeledBox;

    fn at(x_px: f32, y_px: f32) -> PixelBox {
        PixelBox::new(x_px, y_px, x_px + 20.0, y_px + 20.0)
    }

    #[test]
    fn what_lies_outside_or_over_the_edge_counts_neither_way() {
        let region = Region { x_px: 100, y_px: 100, width_px: 200, height_px: 100 };
        let things = [at(150.0, 150.0), at(290.0, 150.0), at(10.0, 10.0)];
        let boxes = things.map(|area| LabeledBox { class: ClassIndex(0), area }).to_vec();
        let path = PathBuf::from("left_1.jpg");
        let image = LabeledImage { scene: "1".to_owned(), path, size_px: (640, 480), boxes, split: None };
        let class = ClassIndex(0);
        let said = |area| Detection { class, confidence: 0.9, area };
        // Inside; what is cut at the edge; and a wrong one where nobody was asked to look.
        let found =
            [said(at(150.0, 150.0)), said(PixelBox::new(290.0, 150.0, 300.0, 170.0)), said(at(500.0, 9.0))];
        let ap = |looked_at: LookedAt| {
            let scored = looked_at.scored(&image, &found);
            average_precision(&[scored], 1, &IouThresholds::coco()).overall.ap.expect("a thing is there")
        };
        let within = LookedAt { within: Some(region), ..LookedAt::default() };
        assert!((ap(within) - 1.0).abs() < 1e-9, "{}", ap(within));
        assert!(ap(LookedAt::default()) < 0.5);
    }
}
