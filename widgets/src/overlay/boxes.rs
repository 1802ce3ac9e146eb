//! Boxes around things, with words that stay readable: a word that would lie on another one moves.

use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, TextStyle, Vec2, vec2};

use crate::theme::{ON_IMAGE, RIM, size};
use crate::view_state::ImageTransform;

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
const PADDING: Vec2 = vec2(6.0, 1.0);
/// Words go away from their box by up to this many lines to find room.
const LINES_AWAY: usize = 6;
/// And by up to this many where nothing nearer is free of other boxes.
const FARTHEST: f32 = 9.0;
/// Steps in which room is looked for there, in widths of the words.
const ACROSS: f32 = 6.0;
/// How much worse words on another box are than words one line farther away.
const ON_A_BOX: f32 = 3.0;

/// Draws them all, chosen ones on top, and gives the chosen ones the first choice of a place for
/// their words, beside what is `taken`.
pub(super) fn paint(boxes: &[LabeledBox], painter: &Painter, transform: &ImageTransform, taken: &[Rect]) {
    let mut order: Vec<&LabeledBox> = boxes.iter().filter(|shown| !shown.outline_px.is_empty()).collect();
    order.sort_by_key(|shown| shown.emphasis != Emphasis::Chosen);
    for shown in order.iter().rev() {
        outline(shown, painter, transform);
    }
    let around: Vec<Rect> = order.iter().map(|shown| surrounding(shown, transform)).collect();
    let mut taken = taken.to_vec();
    for (i, shown) in order.iter().enumerate() {
        words(shown, i, &around, painter, &mut taken);
    }
}

fn surrounding(shown: &LabeledBox, transform: &ImageTransform) -> Rect {
    shown.outline_px.iter().fold(Rect::NOTHING, |mut rect, at| {
        rect.extend_with(transform.to_screen(*at));
        rect
    })
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

fn words(shown: &LabeledBox, i: usize, around: &[Rect], painter: &Painter, taken: &mut Vec<Rect>) {
    // While one is looked at, the words of the others would only hide what surrounds it.
    if shown.text.is_empty() || shown.emphasis == Emphasis::Faded {
        return;
    }
    let font = painter.ctx().global_style().text_styles.get(&TextStyle::Small).cloned();
    let font = font.unwrap_or_else(|| FontId::proportional(size::SMALL));
    let chosen = shown.emphasis == Emphasis::Chosen;
    let color = if chosen { ON_IMAGE.text_strong } else { shown.color };
    let galley = painter.layout_no_wrap(shown.text.clone(), font, color);
    let size = galley.size() + 2.0 * PADDING;
    let Some(place) = room(painter, i, around, size, shown.color, taken) else { return };
    painter.rect_filled(place, 3.0, RIM);
    if chosen {
        painter.rect_filled(Rect::from_min_size(place.min, vec2(3.0, place.height())), 1.0, shown.color);
    }
    painter.galley(place.min + PADDING, galley, color);
}

/// Takes room for words of this size for box `i`, and ties them to it by a line where they are not at
/// it. `None`: there is no room.
pub(crate) fn room(
    painter: &Painter,
    i: usize,
    around: &[Rect],
    size: Vec2,
    color: Color32,
    taken: &mut Vec<Rect>,
) -> Option<Rect> {
    let place = place(i, around, size, painter.clip_rect(), taken)?;
    if !place.expand(GAP + 1.0).intersects(around[i]) {
        let [from, to] = [around[i].clamp(place.center()), place.clamp(around[i].center())];
        for stroke in [Stroke::new(3.0, RIM), Stroke::new(1.0, color)] {
            painter.line_segment([from, to], stroke);
        }
    }
    taken.push(place);
    Some(place)
}

/// Where words of this size for box `i` go: of the places around it that are on the picture and on no
/// other words, the nearest that hides nothing of any box; where there is none, the nearest such place
/// farther away; where there is none either, one around it that hides little. `None` if the box is not on
/// the picture at all, or there is no room: better no word than two that cannot be read.
fn place(i: usize, around: &[Rect], size: Vec2, clip: Rect, taken: &[Rect]) -> Option<Rect> {
    let own = around[i];
    if !clip.intersects(own) {
        return None;
    }
    let is_free = |(_, rect): &(f32, Rect)| {
        clip.contains_rect(*rect) && !taken.iter().any(|other| other.intersects(*rect))
    };
    let hidden = |rect: &Rect| {
        let on = around.iter().map(|other| other.intersect(*rect)).filter(|common| common.is_positive());
        on.map(|common| common.area()).sum::<f32>() / size.x / size.y
    };
    let hides_nothing = |(_, rect): &(f32, Rect)| hidden(rect) == 0.0;
    let nearest =
        |places: &mut dyn Iterator<Item = (f32, Rect)>| places.min_by(|(a, _), (b, _)| a.total_cmp(b));
    let near: Vec<(f32, Rect)> = places(own, size).filter(is_free).collect();
    let found = nearest(&mut near.iter().copied().filter(hides_nothing))
        .or_else(|| nearest(&mut farther(own, size, clip).filter(is_free).filter(hides_nothing)))
        .or_else(|| nearest(&mut near.iter().map(|(away, rect)| (away + ON_A_BOX * hidden(rect), *rect))));
    found.map(|(_, rect)| rect)
}

/// Places all over the picture that are not too far from a box to be taken for its words, with how many
/// lines they are away from it.
fn farther(own: Rect, size: Vec2, clip: Rect) -> impl Iterator<Item = (f32, Rect)> {
    let step = vec2(size.x / ACROSS, (size.y + GAP) / 2.0);
    let count = (clip.size() / step).floor();
    let (columns, rows) = (count.x.max(0.0) as usize, count.y.max(0.0) as usize);
    let at = move |column: usize, row: usize| clip.min + vec2(column as f32 * step.x, row as f32 * step.y);
    let rects = (0..=rows).flat_map(move |row| (0..=columns).map(move |column| at(column, row)));
    let lines = move |rect: Rect| {
        let beside = (rect.left() - own.right()).max(own.left() - rect.right()).max(0.0);
        let beyond = (rect.top() - own.bottom()).max(own.top() - rect.bottom()).max(0.0);
        beside.hypot(beyond) / (size.y + GAP)
    };
    let rects = rects.map(move |min| Rect::from_min_size(min, size)).map(move |rect| (lines(rect), rect));
    rects.filter(|(away, _)| *away <= FARTHEST)
}

/// Places around a box, with how many lines they are away from it.
fn places(own: Rect, size: Vec2) -> impl Iterator<Item = (f32, Rect)> {
    let columns = [
        (0.0, own.left()),
        (0.1, own.right() - size.x),
        (0.2, own.center().x - size.x / 2.0),
        (0.6, own.right() + GAP),
        (0.6, own.left() - GAP - size.x),
    ];
    (0..LINES_AWAY).flat_map(move |line| {
        let step = line as f32 * (size.y + GAP);
        let rows = [(0.0, own.top() - GAP - size.y - step), (0.1, own.bottom() + GAP + step)];
        let beside = [own.right() + GAP, own.left() - GAP - size.x].map(|x| (0.3, x, own.top() + step));
        let beyond = rows.into_iter().flat_map(move |(a, y)| columns.map(|(b, x)| (a + b, x, y)));
        beyond
            .chain(beside)
            .map(move |(more, x, y)| (line as f32 + more, Rect::from_min_size(Pos2::new(x, y), size)))
    })
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
        let boxes: Vec<Rect> = (0..9).map(|i| around(150.0 + i as f32, 120.0 + i as f32)).collect();
        let mut taken = Vec::new();
        for i in 0..boxes.len() {
            taken.extend(place(i, &boxes, SIZE, CLIP, &taken));
        }
        assert_eq!(taken.len(), boxes.len(), "there is room for all");
        for (i, a) in taken.iter().enumerate() {
            assert!(CLIP.contains_rect(*a));
            assert!(taken[i + 1..].iter().all(|b| !a.intersects(*b)), "{taken:?}");
        }
    }

    #[test]
    fn words_do_not_hide_other_boxes_where_there_is_room_elsewhere() {
        // Another box stands right above.
        let boxes = [around(100.0, 100.0), Rect::from_min_size(pos2(90.0, 60.0), vec2(80.0, 38.0))];
        let place = place(0, &boxes, SIZE, CLIP, &[]).expect("there is room");
        assert!(!place.intersects(boxes[1]) && place.expand(GAP + 1.0).intersects(boxes[0]), "{place:?}");
    }

    /// Toys close together in the middle of a small picture, as on a table: every one has its words, and no
    /// words lie on a toy.
    #[test]
    fn words_of_close_toys_hide_none_of_them() {
        let toys = [
            (120.0, 130.0, 38.0, 30.0),
            (150.0, 112.0, 34.0, 40.0),
            (182.0, 128.0, 44.0, 32.0),
            (214.0, 108.0, 30.0, 38.0),
            (126.0, 164.0, 46.0, 26.0),
            (178.0, 166.0, 32.0, 34.0),
            (216.0, 150.0, 40.0, 44.0),
            (250.0, 128.0, 30.0, 30.0),
            (94.0, 150.0, 28.0, 40.0),
        ];
        let boxes = toys.map(|(x, y, width, height)| Rect::from_min_size(pos2(x, y), vec2(width, height)));
        let size = vec2(92.0, 16.0);
        let mut taken = Vec::new();
        for i in 0..boxes.len() {
            taken.push(place(i, &boxes, size, CLIP, &taken).expect("there is room"));
        }
        for (i, words) in taken.iter().enumerate() {
            let hidden = boxes.iter().position(|toy| toy.intersect(*words).is_positive());
            assert_eq!(hidden, None, "the words of {i} at {words:?}");
            assert!(taken[i + 1..].iter().all(|other| !other.intersects(*words)), "{taken:?}");
        }
    }

    #[test]
    fn where_there_is_no_room_elsewhere_words_hide_little() {
        // A picture full of boxes.
        let boxes: Vec<Rect> =
            (0..10).flat_map(|x| (0..8).map(move |y| around(40.0 * x as f32, 40.0 * y as f32))).collect();
        let place = place(33, &boxes, SIZE, CLIP, &[]).expect("better there than nowhere");
        assert!(!place.intersect(boxes[33]).is_positive(), "its own box is not hidden: {place:?}");
    }

    #[test]
    fn words_stay_on_the_picture() {
        for (x, y) in [(-20.0, -20.0), (380.0, -20.0), (-20.0, 280.0), (380.0, 280.0)] {
            let place = place(0, &[around(x, y)], SIZE, CLIP, &[]).expect("part of the box is seen");
            assert!(CLIP.contains_rect(place), "{place:?}");
        }
        let off = [around(500.0, 0.0)];
        assert_eq!(place(0, &off, SIZE, CLIP, &[]), None, "a box that is not seen has no words");
    }
}
