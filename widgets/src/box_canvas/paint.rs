//! How the canvas looks.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, TextStyle, Ui, pos2, vec2};
use plumbline_model::PixelBox;

use super::{BoxCanvas, CanvasBox, CanvasState};
use crate::image_view::ImageTransform;
use crate::overlay::boxes::room;
use crate::texture::Sampling;
use crate::theme::{self, CROSSHAIR, RIM, readable_on};

/// From this magnification on, in physical pixels per image pixel, pixels are drawn as squares.
const HARD_PIXELS_FROM: f64 = 4.0;
/// Side of a handle, points.
const HANDLE: f32 = 7.0;

/// A box on the screen.
fn on_screen(area: &PixelBox, transform: &ImageTransform) -> Rect {
    let at = |x: f32, y: f32| transform.to_screen([f64::from(x) - 0.5, f64::from(y) - 0.5]);
    Rect::from_min_max(at(area.x0_px, area.y0_px), at(area.x1_px, area.y1_px))
}

pub(super) fn paint(
    ui: &Ui,
    rect: Rect,
    canvas: &BoxCanvas<'_>,
    transform: &ImageTransform,
    state: &CanvasState,
    pointer_px: Option<[f32; 2]>,
) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, tokens.backdrop);
    let magnification = transform.points_per_px * f64::from(ui.pixels_per_point());
    let sampling = if magnification >= HARD_PIXELS_FROM { Sampling::Pixels } else { Sampling::Smooth };
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    let texture = canvas.picture.texture(ui.ctx(), sampling);
    painter.image(texture, transform.image_rect(), whole, Color32::WHITE);
    let under_way = canvas.under_way(state);
    let moved = |index| under_way.filter(|placed| placed.index == Some(index)).map(|placed| placed.area);
    let boxes = canvas.boxes.iter().enumerate();
    let around: Vec<Rect> =
        boxes.clone().map(|(i, shown)| on_screen(&moved(i).unwrap_or(shown.area), transform)).collect();
    for ((index, shown), rect) in boxes.zip(&around) {
        paint_box(&painter, *rect, shown, state.chosen == Some(index), canvas.draw.is_some());
    }
    tags(ui, &painter, canvas.boxes, &around, state.chosen);
    if let (Some(placed), Some(color)) = (under_way.filter(|placed| placed.index.is_none()), canvas.draw) {
        frame(&painter, on_screen(&placed.area, transform), color, 1.5, false);
    }
    let drawing = state.holding.is_some() || state.chosen.is_none();
    if let (Some([x, y]), true, true) = (pointer_px, canvas.draw.is_some(), drawing) {
        crosshair(&painter, rect, transform, [x, y]);
    }
}

/// Lines through the pointer, by which the edges of a thing are met.
fn crosshair(painter: &Painter, rect: Rect, transform: &ImageTransform, [x, y]: [f32; 2]) {
    let at = transform.to_screen([f64::from(x) - 0.5, f64::from(y) - 0.5]);
    let image = transform.image_rect().intersect(rect);
    if image.contains(at) {
        let line = Stroke::new(1.0, CROSSHAIR);
        painter.hline(image.x_range(), at.y, line);
        painter.vline(at.x, image.y_range(), line);
    }
}

fn paint_box(painter: &Painter, rect: Rect, shown: &CanvasBox, chosen: bool, editable: bool) {
    if chosen {
        painter.rect_filled(rect, 0.0, shown.color.gamma_multiply(0.16));
    }
    frame(painter, rect, shown.color, if chosen { 2.5 } else { 1.5 }, shown.dashed);
    if chosen && editable {
        for handle in handles(rect) {
            let square = Rect::from_center_size(handle, vec2(HANDLE, HANDLE));
            painter.rect_filled(square, 1.0, Color32::WHITE);
            painter.rect_stroke(square, 1.0, Stroke::new(1.0, RIM), StrokeKind::Outside);
        }
    }
}

/// The outline of a box alone, on an image that is mapped like this.
pub fn box_frame(painter: &Painter, transform: &ImageTransform, shown: &CanvasBox, width_pt: f32) {
    frame(painter, on_screen(&shown.area, transform), shown.color, width_pt, shown.dashed);
}

/// An outline that is seen on bright and on dark pictures.
fn frame(painter: &Painter, rect: Rect, color: Color32, width: f32, dashed: bool) {
    let rim = Stroke::new(width + 2.0, RIM.gamma_multiply(0.7));
    let line = Stroke::new(width, color);
    if !dashed {
        painter.rect_stroke(rect, 0.0, rim, StrokeKind::Middle);
        painter.rect_stroke(rect, 0.0, line, StrokeKind::Middle);
        return;
    }
    let corners =
        [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    painter.extend(Shape::dashed_line(&corners, rim, 6.0, 4.0));
    painter.extend(Shape::dashed_line(&corners, line, 6.0, 4.0));
}

fn handles(rect: Rect) -> [Pos2; 8] {
    [
        rect.left_top(),
        rect.center_top(),
        rect.right_top(),
        rect.right_center(),
        rect.right_bottom(),
        rect.center_bottom(),
        rect.left_bottom(),
        rect.left_center(),
    ]
}

/// What the boxes are, none over another: that of the chosen box has the first choice of a place.
fn tags(ui: &Ui, painter: &Painter, boxes: &[CanvasBox], around: &[Rect], chosen: Option<usize>) {
    let font = TextStyle::Small.resolve(ui.style());
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by_key(|index| Some(*index) != chosen);
    let mut taken = Vec::new();
    for index in order {
        let shown = &boxes[index];
        let text = if shown.odd { format!("{}  !", shown.text) } else { shown.text.clone() };
        let color = readable_on(shown.color);
        let galley = painter.layout_no_wrap(text, font.clone(), color);
        let size = galley.size() + vec2(6.0, 2.0);
        if let Some(place) = room(painter, index, around, size, shown.color, &mut taken) {
            painter.rect_filled(place, 2.0, shown.color);
            painter.galley(place.min + vec2(3.0, 1.0), galley, color);
        }
    }
}
