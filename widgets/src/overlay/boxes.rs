//! Boxes around things, with words that stay readable: a word that would lie on another one moves.

use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, TextStyle, Vec2, vec2};

use crate::image_view::ImageTransform;
use crate::theme::{ON_IMAGE, RIM, size};

/// How much a box is to be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Emphasis {
    /// One of many.
    #[default]
    Usual,
    /// Pointed at, chosen, or the partner of that.
    Chosen,
    /// Another one is chosen.
    Faded,
}

/// A box around a thing.
#[derive(Clone, Debug, PartialEq)]
pub struct LabeledBox {
    /// Corners, or points along a bent outline, in order, image pixels.
    pub outline_px: Vec<[f64; 2]>,
    /// Words at it; empty for none.
    pub text: String,
    /// Color of the outline.
    pub color: Color32,
    /// How much it is to be seen.
    pub emphasis: Emphasis,
    /// Dashed: not of this picture, or seen by one eye only.
    pub dashed: bool,
}

/// Gap between a box and its words, points.
const GAP: f32 = 2.0;
const PADDING: Vec2 = vec2(4.0, 1.0);

/// Draws them all, chosen ones on top, and gives the chosen ones the first choice of a place for
/// their words.
pub(super) fn paint(boxes: &[LabeledBox], painter: &Painter, transform: &ImageTransform) {
    let mut order: Vec<&LabeledBox> = boxes.iter().collect();
    order.sort_by_key(|shown| shown.emphasis == Emphasis::Chosen);
    for shown in &order {
        outline(shown, painter, transform);
    }
    let mut taken: Vec<Rect> = Vec::new();
    for shown in order.iter().rev() {
        words(shown, painter, transform, &mut taken);
    }
}

fn outline(shown: &LabeledBox, painter: &Painter, transform: &ImageTransform) {
    let mut points: Vec<Pos2> = shown.outline_px.iter().map(|at| transform.to_screen(*at)).collect();
    let Some(first) = points.first().copied() else { return };
    points.push(first);
    let (width, color) = match shown.emphasis {
        Emphasis::Usual => (1.5, shown.color),
        Emphasis::Chosen => (2.5, shown.color),
        Emphasis::Faded => (1.0, shown.color.gamma_multiply(0.55)),
    };
    let rim = Stroke::new(width + 1.5, RIM);
    let stroke = Stroke::new(width, color);
    if shown.dashed {
        painter.extend(Shape::dashed_line(&points, rim, 7.0, 5.0));
        painter.extend(Shape::dashed_line(&points, stroke, 7.0, 5.0));
    } else {
        painter.line(points.clone(), rim);
        painter.line(points, stroke);
    }
}

fn words(shown: &LabeledBox, painter: &Painter, transform: &ImageTransform, taken: &mut Vec<Rect>) {
    if shown.text.is_empty() || shown.outline_px.is_empty() {
        return;
    }
    let points = shown.outline_px.iter().map(|at| transform.to_screen(*at));
    let around = points.fold(Rect::NOTHING, |mut rect, point| {
        rect.extend_with(point);
        rect
    });
    let font = painter.ctx().global_style().text_styles.get(&TextStyle::Small).cloned();
    let font = font.unwrap_or_else(|| FontId::proportional(size::SMALL));
    let color = match shown.emphasis {
        Emphasis::Chosen => ON_IMAGE.text_strong,
        Emphasis::Usual => shown.color,
        Emphasis::Faded => shown.color.gamma_multiply(0.7),
    };
    let galley = painter.layout_no_wrap(shown.text.clone(), font, color);
    let size = galley.size() + 2.0 * PADDING;
    let Some(place) = place(around, size, painter.clip_rect(), taken) else { return };
    painter.rect_filled(place, 3.0, RIM);
    if shown.emphasis == Emphasis::Chosen {
        painter.rect_filled(Rect::from_min_size(place.min, vec2(3.0, place.height())), 1.0, shown.color);
    }
    painter.galley(place.min + PADDING, galley, color);
    taken.push(place);
}

/// Where words of this size go: the first of some places around the box that is on the picture and
/// on no other words. `None` if the box is not on the picture at all, or there is no room: better
/// no word than two that cannot be read.
fn place(around: Rect, size: Vec2, clip: Rect, taken: &[Rect]) -> Option<Rect> {
    if !clip.intersects(around) {
        return None;
    }
    let above = around.top() - GAP - size.y;
    let below = around.bottom() + GAP;
    let (left, right) = (around.left(), around.right() - size.x);
    let middle = around.center().x - size.x / 2.0;
    let beside = around.right() + GAP;
    let before = around.left() - GAP - size.x;
    let candidates = [
        (left, above),
        (left, below),
        (right, above),
        (right, below),
        (middle, above),
        (middle, below),
        (beside, around.top()),
        (before, around.top()),
        (beside, around.bottom() - size.y),
        (before, around.bottom() - size.y),
        (left, around.top() + GAP),
        (left, above - size.y - GAP),
        (left, below + size.y + GAP),
    ];
    let rects = candidates.map(|(x, y)| Rect::from_min_size(Pos2::new(x, y), size));
    rects
        .into_iter()
        .find(|rect| clip.contains_rect(*rect) && !taken.iter().any(|other| other.intersects(*rect)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    const CLIP: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(400.0, 300.0) };
    const SIZE: Vec2 = vec2(60.0, 14.0);

    fn around(x: f32, y: f32) -> Rect {
        Rect::from_min_size(pos2(x, y), vec2(40.0, 40.0))
    }

    #[test]
    fn words_of_many_boxes_at_one_place_never_overlap() {
        let mut taken = Vec::new();
        for i in 0..9 {
            let shift = i as f32;
            if let Some(place) = place(around(150.0 + shift, 120.0 + shift), SIZE, CLIP, &taken) {
                taken.push(place);
            }
        }
        assert!(taken.len() >= 8, "{}", taken.len());
        for (i, a) in taken.iter().enumerate() {
            assert!(CLIP.contains_rect(*a));
            assert!(taken[i + 1..].iter().all(|b| !a.intersects(*b)), "{taken:?}");
        }
    }

    #[test]
    fn words_stay_on_the_picture() {
        for (x, y) in [(-20.0, -20.0), (380.0, -20.0), (-20.0, 280.0), (380.0, 280.0)] {
            let place = place(around(x, y), SIZE, CLIP, &[]).expect("part of the box is seen");
            assert!(CLIP.contains_rect(place), "{place:?}");
        }
        assert_eq!(place(around(500.0, 0.0), SIZE, CLIP, &[]), None, "a box that is not seen has no words");
    }
}
