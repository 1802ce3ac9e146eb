//! Labels that the judged detector proposed itself: by them it agrees with itself, however bad it is.

use plumbline_model::{Detection, PixelBox, counted};

use super::ModelEvaluation;
use crate::yolo_set::{LabeledBox, LabeledImage};

/// Edges of a proposed box come back from a label file within its rounding, px. A box that was drawn by hand,
/// or with its scene, has all four edges so near to those of a detector by accident only.
const SAME_EDGE_PX: f32 = 0.05;

/// From this share of the labels on they are no accident.
const NO_ACCIDENT: f64 = 0.05;

impl ModelEvaluation {
    /// How many labels stand exactly where this detector puts a box of that class.
    pub fn own_labels(&self) -> usize {
        let own = |(image, found): (&LabeledImage, &Vec<Detection>)| {
            image.boxes.iter().filter(|label| is_own(label, found)).count()
        };
        self.images.iter().zip(&self.found).map(own).sum()
    }

    /// What the scores are worth where it proposed labels itself, a sentence; `None` where it did not.
    pub fn judged_by_itself(&self) -> Option<String> {
        let labels = self.images.iter().map(|image| image.boxes.len()).sum();
        judged_by_itself(self.own_labels(), labels)
    }
}

/// What the scores of a detector are worth of whose labels `own` stand where it puts its own boxes, a
/// sentence; `None` where so few do that it can be an accident.
fn judged_by_itself(own: usize, labels: usize) -> Option<String> {
    let is_accident = own == 0 || (own as f64) < NO_ACCIDENT * labels as f64;
    (!is_accident).then(|| {
        let of = counted(labels, "label");
        format!(
            "judged by itself: {own} of {of} stand exactly where it puts its own boxes, so it proposed them. Its scores say how well it agrees with itself, not how good it is; judge it on boxes that somebody drew."
        )
    })
}

fn is_own(label: &LabeledBox, found: &[Detection]) -> bool {
    found.iter().any(|found| found.class == label.class && is_same(&found.area, &label.area))
}

fn is_same(a: &PixelBox, b: &PixelBox) -> bool {
    let edges = |area: &PixelBox| [area.x0_px, area.y0_px, area.x1_px, area.y1_px];
    edges(a).iter().zip(edges(b)).all(|(a, b)| (a - b).abs() <= SAME_EDGE_PX)
}
