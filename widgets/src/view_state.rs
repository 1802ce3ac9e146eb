//! Where a view looks, and how image pixels map to the screen.

use egui::{Pos2, Rect, Vec2, vec2};

/// Largest magnification, in points per image pixel.
const MOST_POINTS_PER_PX: f64 = 96.0;

/// Zoom and position of one view, or of several linked ones: give the same state to each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewState {
    /// `None` while the image, or the part of it where something is seen, fits the view.
    looking_at: Option<LookingAt>,
    /// Where something is seen; grows with what comes.
    seen: Option<SeenPart>,
    /// The whole image was asked for, black borders and all.
    whole: bool,
}

/// The part of an image outside of which it is dark.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SeenPart {
    size_px: [usize; 2],
    /// First and last column, first and last row.
    columns_px: [f64; 2],
    rows_px: [f64; 2],
}

/// A part that leaves out less than this of the image, along both sides, is no part.
const WORTH_LEAVING_OUT: f64 = 0.06;

#[derive(Clone, Copy, Debug, PartialEq)]
struct LookingAt {
    center_px: [f64; 2],
    points_per_px: f64,
}

/// Maps image pixels to the screen and back. (0, 0) is the center of the top-left pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageTransform {
    /// Top-left corner of the top-left pixel on the screen.
    pub origin: Pos2,
    /// Size of an image pixel on the screen, in points.
    pub points_per_px: f64,
    /// Image size in pixels.
    pub size_px: [usize; 2],
}

impl ImageTransform {
    /// Fits an image into a rectangle, centered.
    pub fn fit(size_px: [usize; 2], view: Rect) -> Self {
        let [w, h] = size_px.map(|n| n.max(1) as f64);
        let points_per_px = (f64::from(view.width()) / w).min(f64::from(view.height()) / h).max(1e-6);
        Self::centered(size_px, view, [(w - 1.0) / 2.0, (h - 1.0) / 2.0], points_per_px)
    }

    fn centered(size_px: [usize; 2], view: Rect, center_px: [f64; 2], points_per_px: f64) -> Self {
        let offset = center_px.map(|c| ((c + 0.5) * points_per_px) as f32);
        let origin = view.center() - vec2(offset[0], offset[1]);
        Self { origin, points_per_px, size_px }
    }

    /// Position on the screen of a pixel position.
    pub fn to_screen(&self, at_px: [f64; 2]) -> Pos2 {
        let [x, y] = at_px.map(|c| ((c + 0.5) * self.points_per_px) as f32);
        self.origin + vec2(x, y)
    }

    /// Pixel position under a position on the screen; may lie outside the image.
    pub fn to_image(&self, at: Pos2) -> [f64; 2] {
        let offset = at - self.origin;
        [offset.x, offset.y].map(|c| f64::from(c) / self.points_per_px - 0.5)
    }

    /// The image on the screen.
    pub fn image_rect(&self) -> Rect {
        let size = self.size_px.map(|n| (n as f64 * self.points_per_px) as f32);
        Rect::from_min_size(self.origin, vec2(size[0], size[1]))
    }

    /// Whether a pixel position lies on the image, its outer half pixels included.
    pub fn contains(&self, at_px: [f64; 2]) -> bool {
        (0..2).all(|i| (-0.5..self.size_px[i] as f64 - 0.5).contains(&at_px[i]))
    }

    /// The pixel (column, row) that covers a position; `None` outside the image.
    pub fn pixel_at(&self, at_px: [f64; 2]) -> Option<[usize; 2]> {
        self.contains(at_px).then(|| at_px.map(|c| (c + 0.5).floor().max(0.0) as usize))
    }

    /// Columns and rows that are visible in a clip rectangle, as half-open ranges.
    pub fn visible(&self, clip: Rect) -> [std::ops::Range<usize>; 2] {
        let (first, last) = (self.to_image(clip.min), self.to_image(clip.max));
        [0, 1].map(|i| {
            let n = self.size_px[i];
            let from = (first[i] + 0.5).floor().clamp(0.0, n as f64) as usize;
            let to = (last[i] + 0.5).ceil().clamp(0.0, n as f64) as usize;
            from..to
        })
    }
}

impl ViewState {
    /// Shows the whole image.
    pub fn fit(&mut self) {
        self.looking_at = None;
    }

    /// Whether nothing was zoomed.
    pub fn is_fit(&self) -> bool {
        self.looking_at.is_none()
    }

    /// Tells where in an image of this size something is seen, outside of which it is dark: columns and rows,
    /// first and last. What was seen before stays in the part, so that it does not flicker.
    pub fn see(&mut self, size_px: [usize; 2], [columns_px, rows_px]: [[f64; 2]; 2]) {
        let before = self.seen.filter(|seen| seen.size_px == size_px);
        let grown = |before: Option<[f64; 2]>, now: [f64; 2]| {
            before.map_or(now, |before| [before[0].min(now[0]), before[1].max(now[1])])
        };
        self.seen = Some(SeenPart {
            size_px,
            columns_px: grown(before.map(|seen| seen.columns_px), columns_px),
            rows_px: grown(before.map(|seen| seen.rows_px), rows_px),
        });
    }

    /// The part that fits the view in place of the whole image, where there is one worth it.
    fn part(&self, size_px: [usize; 2]) -> Option<SeenPart> {
        let seen = self.seen.filter(|seen| seen.size_px == size_px)?;
        let share = |[first, last]: [f64; 2], n: usize| (last - first + 1.0) / n.max(1) as f64;
        let (across, down) = (share(seen.columns_px, size_px[0]), share(seen.rows_px, size_px[1]));
        (across.min(down) < 1.0 - WORTH_LEAVING_OUT).then_some(seen)
    }

    /// Whether only a part of an image of this size is shown; `None`: there is no part worth it.
    pub fn shows_part(&self, size_px: [usize; 2]) -> Option<bool> {
        self.part(size_px).map(|_| !self.whole)
    }

    /// Shows the whole image, or only where something is seen.
    pub fn show_whole(&mut self, whole: bool) {
        (self.whole, self.looking_at) = (whole, None);
    }

    /// Puts a pixel into the center, at so many points per image pixel.
    pub fn look_at(&mut self, center_px: [f64; 2], points_per_px: f64) {
        self.looking_at = Some(LookingAt { center_px, points_per_px: points_per_px.min(MOST_POINTS_PER_PX) });
    }

    /// The mapping for an image of this size in this rectangle.
    pub fn transform(&self, size_px: [usize; 2], view: Rect) -> ImageTransform {
        match self.looking_at {
            None => self.fitted(size_px, view),
            Some(LookingAt { center_px, points_per_px }) => {
                ImageTransform::centered(size_px, view, center_px, points_per_px)
            }
        }
    }

    /// Without any zoom.
    fn fitted(&self, size_px: [usize; 2], view: Rect) -> ImageTransform {
        let Some(part) = self.part(size_px).filter(|_| !self.whole) else {
            return ImageTransform::fit(size_px, view);
        };
        let size = |[first, last]: [f64; 2]| (last - first + 1.0).max(1.0);
        let across = f64::from(view.width()) / size(part.columns_px);
        let down = f64::from(view.height()) / size(part.rows_px);
        let middle = |[first, last]: [f64; 2]| (first + last) / 2.0;
        let center_px = [middle(part.columns_px), middle(part.rows_px)];
        ImageTransform::centered(size_px, view, center_px, across.min(down).max(1e-6))
    }

    /// Magnifies by `factor` while the pixel under `pointer` stays where it is. Zooming out ends
    /// with the whole image.
    pub fn zoom(&mut self, factor: f64, pointer: Pos2, size_px: [usize; 2], view: Rect) {
        let before = self.transform(size_px, view);
        let fit = self.fitted(size_px, view).points_per_px;
        let points_per_px = (before.points_per_px * factor).min(MOST_POINTS_PER_PX.max(fit));
        if points_per_px <= fit * 1.001 {
            // Zooming out once more ends with the whole image.
            self.whole |= self.is_fit() && factor < 1.0;
            self.fit();
            return;
        }
        let anchor = before.to_image(pointer);
        let from_center = pointer - view.center();
        let center_px = [
            anchor[0] - f64::from(from_center.x) / points_per_px,
            anchor[1] - f64::from(from_center.y) / points_per_px,
        ];
        self.set(center_px, points_per_px, size_px);
    }

    /// Moves the image by so many points on the screen.
    pub fn pan(&mut self, by: Vec2, size_px: [usize; 2], view: Rect) {
        let now = self.transform(size_px, view);
        let center = now.to_image(view.center() - by);
        self.set(center, now.points_per_px, size_px);
    }

    /// Keeps the center on the image, so that it cannot be lost.
    fn set(&mut self, center_px: [f64; 2], points_per_px: f64, size_px: [usize; 2]) {
        let center_px = [0, 1].map(|i| center_px[i].clamp(-0.5, (size_px[i] as f64 - 0.5).max(-0.5)));
        self.looking_at = Some(LookingAt { center_px, points_per_px });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    fn view_of(width: f32, height: f32) -> Rect {
        Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height))
    }

    const SIZE: [usize; 2] = [640, 480];

    #[test]
    fn pixel_zero_is_the_center_of_the_top_left_pixel() {
        let transform = ImageTransform::fit(SIZE, view_of(1280.0, 960.0));
        assert_eq!(transform.points_per_px, 2.0);
        assert_eq!(transform.to_screen([0.0, 0.0]), pos2(11.0, 21.0));
        assert_eq!(transform.to_image(pos2(10.0, 20.0)), [-0.5, -0.5]);
        assert_eq!(transform.pixel_at([-0.5, 479.49]), Some([0, 479]));
        assert_eq!(transform.pixel_at([639.5, 0.0]), None);
    }

    #[test]
    fn the_whole_image_fits_and_keeps_its_aspect() {
        for view in [view_of(1000.0, 200.0), view_of(200.0, 1000.0)] {
            let image = ImageTransform::fit(SIZE, view).image_rect();
            assert!(view.expand(0.01).contains_rect(image), "{image:?} in {view:?}");
            assert!((image.aspect_ratio() - 4.0 / 3.0).abs() < 1e-4);
            assert!((image.center() - view.center()).length() < 0.01);
        }
    }

    #[test]
    fn zoom_keeps_the_pixel_under_the_pointer() {
        let view = view_of(800.0, 600.0);
        let pointer = pos2(300.0, 250.0);
        let mut state = ViewState::default();
        let before = state.transform(SIZE, view).to_image(pointer);
        for factor in [1.5, 2.0, 3.0, 0.5] {
            state.zoom(factor, pointer, SIZE, view);
            let after = state.transform(SIZE, view).to_image(pointer);
            assert!((before[0] - after[0]).hypot(before[1] - after[1]) < 1e-3, "{before:?} {after:?}");
        }
    }

    #[test]
    fn zooming_out_ends_with_the_whole_image() {
        let view = view_of(800.0, 600.0);
        let mut state = ViewState::default();
        state.zoom(4.0, view.center(), SIZE, view);
        assert!(!state.is_fit());
        state.zoom(0.01, view.center(), SIZE, view);
        assert!(state.is_fit());
    }

    #[test]
    fn the_image_cannot_be_dragged_away() {
        let view = view_of(800.0, 600.0);
        let mut state = ViewState::default();
        state.zoom(2.0, view.center(), SIZE, view);
        state.pan(vec2(1e6, -1e6), SIZE, view);
        assert!(state.transform(SIZE, view).image_rect().intersects(view));
    }

    #[test]
    fn panning_moves_by_what_the_hand_moved() {
        let view = view_of(800.0, 600.0);
        let mut state = ViewState::default();
        state.zoom(5.0, view.center(), SIZE, view);
        let before = state.transform(SIZE, view).to_screen([300.0, 200.0]);
        state.pan(vec2(30.0, -12.0), SIZE, view);
        let after = state.transform(SIZE, view).to_screen([300.0, 200.0]);
        assert!((after - before - vec2(30.0, -12.0)).length() < 1e-2);
    }

    #[test]
    fn visible_pixels_are_those_in_the_clip() {
        let transform = ImageTransform { origin: pos2(0.0, 0.0), points_per_px: 10.0, size_px: [5, 5] };
        let clip = Rect::from_min_max(pos2(12.0, -30.0), pos2(29.0, 90.0));
        assert_eq!(transform.visible(clip), [1..3, 0..5]);
    }
}
