//! What is wrong with boxes: too small, over the edge, doubled.

use plumbline_model::ClassNames;

use super::history::{LEAST_SIDE_PX, is_double};
use super::view::{LabelBox, LabelProblem};

/// A box may reach over the edge by rounding, px.
const EDGE_TOLERANCE_PX: f32 = 0.01;

/// What should be looked at on one image.
pub fn problems(
    image: &str,
    boxes: &[LabelBox],
    size_px: (u32, u32),
    names: &ClassNames,
) -> Vec<LabelProblem> {
    let mut found = Vec::new();
    let mut say = |index: usize, text: String| {
        found.push(LabelProblem { image: image.to_owned(), index: Some(index), text });
    };
    for (i, label) in boxes.iter().enumerate() {
        let (area, name) = (&label.area, names.get(label.class).unwrap_or("box"));
        let (w, h) = (area.width_px(), area.height_px());
        if w < LEAST_SIDE_PX || h < LEAST_SIDE_PX {
            say(i, format!("{name}: only {w:.1} × {h:.1} px. Draw it again or delete it."));
        }
        let (right, bottom) = (size_px.0 as f32 + EDGE_TOLERANCE_PX, size_px.1 as f32 + EDGE_TOLERANCE_PX);
        let over = area.x0_px < -EDGE_TOLERANCE_PX
            || area.y0_px < -EDGE_TOLERANCE_PX
            || area.x1_px > right
            || area.y1_px > bottom;
        if over {
            say(i, format!("{name}: reaches over the edge of the image. Move its edge."));
        }
        if let Some(j) = boxes[..i].iter().position(|other| is_double(other, label)) {
            say(i, format!("{name}: the same as box {}. Delete one of them.", j + 1));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use plumbline_model::{ClassIndex, PixelBox};

    use super::*;

    fn label(class: usize, area: [f32; 4]) -> LabelBox {
        LabelBox { class: ClassIndex(class), area: PixelBox::new(area[0], area[1], area[2], area[3]) }
    }

    #[test]
    fn small_overreaching_and_doubled_boxes_are_named_and_good_ones_are_not() {
        let boxes = [
            label(0, [10.0, 10.0, 50.0, 50.0]),
            label(1, [10.0, 10.0, 50.0, 50.0]),
            label(0, [10.2, 10.0, 50.0, 50.1]),
            label(7, [100.0, 100.0, 101.0, 130.0]),
            label(3, [600.0, 10.0, 660.0, 50.0]),
        ];
        let found = problems("left_1", &boxes, (640, 480), &ClassNames::published());
        let said: Vec<(Option<usize>, bool)> =
            found.iter().map(|p| (p.index, p.text.contains("Banana: the same as box 1"))).collect();
        assert_eq!(said, [(Some(2), true), (Some(3), false), (Some(4), false)]);
        assert!(found[1].text.contains("Tomato: only 1.0 × 30.0 px"));
        assert!(found[2].text.contains("Mushroom: reaches over the edge"));
    }
}
