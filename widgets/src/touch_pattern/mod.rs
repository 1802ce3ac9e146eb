//! The touchscreen as a drawing: what will be touched, what was touched, and by how much it
//! missed. u to the right, v downward, as the image stands on the glass; that is also how the
//! robot sees it, which sits below.

mod area;
mod paint;
mod target;

pub use target::{TargetLook, paint_felt, paint_target};

use egui::{Pos2, Rect, Response, Sense, Ui, Vec2, WidgetInfo, pos2, vec2};

use crate::own_part::own_sides;
use crate::theme::space;

/// What became of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchMarkState {
    /// To come.
    Planned,
    /// Under way, or the next one.
    Next,
    /// Touched.
    Touched,
    /// No contact came.
    Missed,
    /// Left out.
    Skipped,
    /// Touched, but does not count.
    Rejected,
    /// Out of reach.
    Unreachable,
}

/// One touch on the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchMark {
    /// Its number, from 1.
    pub number: usize,
    /// The pixel to be touched.
    pub target_px: [f64; 2],
    /// Touched minus target, px; `None` without a touch.
    pub error_px: Option<[f64; 2]>,
    /// What became of it.
    pub state: TouchMarkState,
    /// What hovering says, after its number.
    pub about: String,
}

/// The part of the screen that is touched, px: first and last column, first and last row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternArea {
    /// First and last column.
    pub u_px: [f64; 2],
    /// First and last row.
    pub v_px: [f64; 2],
}

/// The drawing.
pub struct TouchPattern<'a> {
    label: &'a str,
    size_px: [u32; 2],
    pixel_aspect: f64,
    marks: &'a [TouchMark],
    area: Option<PatternArea>,
    editable: bool,
    selected: Option<usize>,
    error_scale: f64,
    pixel_width_m: Option<f64>,
    height: Option<f32>,
}

/// What happened to the drawing.
pub struct TouchPatternResponse {
    /// All of it.
    pub response: Response,
    /// The touch under the pointer, by number.
    pub hovered: Option<usize>,
    /// The touch that was clicked, by number.
    pub clicked: Option<usize>,
    /// The area as it is being dragged, whole pixels.
    pub area: Option<PatternArea>,
}

/// More touches than this get no label of their own; they are still found by the pointer.
const MOST_LABELS: usize = 400;
/// A touch is found by the pointer within this many points.
const NEAR_PT: f32 = 9.0;

/// Maps pixels of the touchscreen to the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatternTransform {
    rect: Rect,
    size_px: [f64; 2],
}

impl PatternTransform {
    pub(crate) fn to_drawing(self, at_px: [f64; 2]) -> Pos2 {
        let part = |at: f64, count: f64| ((at + 0.5) / count) as f32;
        let [width, height] = self.size_px;
        pos2(
            self.rect.left() + part(at_px[0], width) * self.rect.width(),
            self.rect.top() + part(at_px[1], height) * self.rect.height(),
        )
    }

    pub(crate) fn to_px(self, at: Pos2) -> [f64; 2] {
        let [width, height] = self.size_px;
        let across = f64::from((at.x - self.rect.left()) / self.rect.width());
        let down = f64::from((at.y - self.rect.top()) / self.rect.height());
        [across * width - 0.5, down * height - 0.5]
    }

    /// A vector in pixels, in points.
    pub(crate) fn vector(self, by_px: [f64; 2]) -> Vec2 {
        let [width, height] = self.size_px;
        vec2((by_px[0] / width) as f32 * self.rect.width(), (by_px[1] / height) as f32 * self.rect.height())
    }
}

impl<'a> TouchPattern<'a> {
    /// A screen of so many pixels; `pixel_aspect` is the width of a pixel over its height.
    pub fn new(label: &'a str, size_px: [u32; 2], pixel_aspect: f64, marks: &'a [TouchMark]) -> Self {
        Self {
            label,
            size_px,
            pixel_aspect,
            marks,
            area: None,
            editable: false,
            selected: None,
            error_scale: 1.0,
            pixel_width_m: None,
            height: None,
        }
    }

    /// The outlined part.
    pub fn area(mut self, area: Option<PatternArea>) -> Self {
        self.area = area;
        self
    }

    /// Whether the area can be dragged: its borders, all of it, or a new one beside it.
    pub fn editable(mut self, editable: bool) -> Self {
        self.editable = editable;
        self
    }

    /// The touch that is chosen, by number.
    pub fn selected(mut self, number: Option<usize>) -> Self {
        self.selected = number;
        self
    }

    /// Magnification of the error arrows.
    pub fn error_scale(mut self, scale: f64) -> Self {
        self.error_scale = scale;
        self
    }

    /// How wide a pixel is, so that the scale of the arrows is said as a length.
    pub fn pixel_width_m(mut self, width_m: f64) -> Self {
        self.pixel_width_m = Some(width_m);
        self
    }

    /// At most this height in points, instead of all that is available.
    pub fn height(mut self, height: f32) -> Self {
        self.height = Some(height);
        self
    }

    /// Draws it, as large as the available space allows.
    pub fn show(self, ui: &mut Ui) -> TouchPatternResponse {
        let room = vec2(ui.available_width(), self.height.unwrap_or(ui.available_height()));
        let sense = if self.editable { Sense::click_and_drag() } else { Sense::click() };
        let (whole, response) = ui.allocate_exact_size(self.size(room), sense);
        let rect = Rect::from_min_max(whole.min, whole.max - vec2(0.0, paint::BELOW));
        let transform = PatternTransform { rect, size_px: self.size_px.map(f64::from) };
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        let dragged =
            self.area.filter(|_| self.editable).and_then(|area| area::drag(ui, &response, transform, area));
        let (hovered, clicked) = self.pointed_at(ui, transform, &response);
        if ui.is_rect_visible(whole) {
            let shown = dragged.or(self.area);
            paint::pattern(ui, transform, &self, shown, hovered);
            paint::focus(ui, rect, &response);
        }
        TouchPatternResponse { response, hovered, clicked, area: dragged }
    }

    /// The largest size with the screen's proportions that fits.
    fn size(&self, room: Vec2) -> Vec2 {
        let [width, height] = self.size_px.map(|count| f64::from(count.max(1)));
        let ratio = (height / (width * self.pixel_aspect.max(1e-3))) as f32;
        let room = (room - vec2(0.0, paint::BELOW)).max(vec2(120.0, 120.0 * ratio));
        vec2(room.x.min(room.y / ratio), room.y.min(room.x * ratio) + paint::BELOW)
    }

    /// The touches under the pointer: hovered, clicked. Each one is also a thing of its own for
    /// keyboard and screen reader, as long as they are not too many.
    fn pointed_at(
        &self,
        ui: &Ui,
        transform: PatternTransform,
        response: &Response,
    ) -> (Option<usize>, Option<usize>) {
        let mut clicked = None;
        let mut hovered = response.hover_pos().and_then(|at| self.near(transform, at));
        if response.clicked() {
            clicked = response.interact_pointer_pos().and_then(|at| self.near(transform, at));
        }
        let marks = if self.marks.len() > MOST_LABELS { &[] } else { self.marks };
        let at: Vec<Pos2> = marks.iter().map(|mark| transform.to_drawing(mark.target_px)).collect();
        for ((mark, at), side) in marks.iter().zip(&at).zip(own_sides(&at, space::M)) {
            let around = Rect::from_center_size(*at, Vec2::splat(side));
            // What sticks out of the drawing would take the clicks of what stands beside it.
            let rect = around.intersect(transform.rect);
            let touch = ui.interact(rect, response.id.with(("touch", mark.number)), Sense::click());
            touch.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, mark.text()));
            if touch.clicked() {
                let at = touch.interact_pointer_pos();
                clicked = at.and_then(|at| self.near(transform, at)).or(Some(mark.number));
            }
            if let Some(at) = touch.hover_pos() {
                hovered = self.near(transform, at);
            }
            if touch.has_focus() {
                hovered = Some(mark.number);
            }
        }
        (hovered, clicked)
    }

    /// The touch nearest to a place of the drawing.
    fn near(&self, transform: PatternTransform, at: Pos2) -> Option<usize> {
        let distance = |mark: &TouchMark| transform.to_drawing(mark.target_px).distance(at);
        let nearest = self.marks.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(nearest) <= NEAR_PT).then_some(nearest.number)
    }
}

impl TouchMark {
    /// "touch 12: touched, 2.31 mm".
    fn text(&self) -> String {
        format!("touch {}: {}", self.number, self.about)
    }
}

/// Of more than ten lengths so many are drawn no longer than wanted: one touch that slipped does not make all others
/// dots.
const MOST_FIT: f64 = 0.9;

/// A round magnification (1, 2, 5, 10, …) at which the largest of these lengths, but for the few that lie far off, is
/// about `wanted` long; 1 without lengths.
pub fn error_scale(lengths: impl Iterator<Item = f64>, wanted: f64) -> f64 {
    let mut lengths: Vec<f64> = lengths.filter(|length| length.is_finite()).collect();
    lengths.sort_by(f64::total_cmp);
    let last = (MOST_FIT * lengths.len().saturating_sub(1) as f64).ceil() as usize;
    let largest = lengths.get(last).copied().unwrap_or(0.0);
    let most = if largest > 0.0 { wanted / largest } else { 1.0 };
    let power = 10f64.powf(most.max(1.0).log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step <= most * (1.0 + 1e-9)).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform() -> PatternTransform {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(480.0, 270.0));
        PatternTransform { rect, size_px: [1920.0, 1080.0] }
    }

    #[test]
    fn pixels_and_places_of_the_drawing_are_inverse() {
        let there = transform().to_drawing([1500.0, 200.0]);
        let back = transform().to_px(there);
        assert!((back[0] - 1500.0).abs() < 1e-3 && (back[1] - 200.0).abs() < 1e-3, "{back:?}");
        // The outer corner of the first pixel is the corner of the drawing.
        assert_eq!(transform().to_drawing([-0.5, -0.5]), pos2(10.0, 20.0));
    }

    #[test]
    fn error_scales_are_round_and_never_make_errors_look_smaller() {
        assert_eq!(error_scale([1.0, 3.0].into_iter(), 40.0), 10.0);
        assert_eq!(error_scale([8.0].into_iter(), 40.0), 5.0);
        assert_eq!(error_scale([90.0].into_iter(), 40.0), 1.0);
        assert_eq!(error_scale([f64::NAN].into_iter(), 40.0), 1.0);
        assert_eq!(error_scale(std::iter::empty(), 40.0), 1.0);
        let slipped = (0..11).map(|i| if i == 5 { 90.0 } else { 3.0 });
        assert_eq!(error_scale(slipped, 40.0), 10.0, "one that slipped does not shrink all others");
    }
}
