//! The words on a view: its name, what the pointer is on, and how old the picture is.

use std::sync::Arc;

use egui::{Align2, Galley, Painter, Pos2, Rect, Ui, Vec2, vec2};

use super::pixels::color_text;
use super::{ImageTransform, ImageView, seen};
use crate::arrow_key::ArrowKey;
use crate::format;
use crate::glyph::{self, Glyph};
use crate::overlay::Overlay;
use crate::texture::Picture;
use crate::theme::{self, ON_IMAGE, RIM, Role};

const INSET: f32 = 8.0;

/// The words that stand on a view whatever the pointer is on.
pub(super) struct Captions {
    chips: Vec<Chip>,
    button: Option<Rect>,
}

impl Captions {
    pub fn of(view: &ImageView<'_>, ui: &Ui, rect: Rect, has_button: bool) -> Self {
        let corner = inner(rect);
        let label =
            view.caption.then(|| Chip::new(ui, rect, corner.left_top(), Align2::LEFT_TOP, view.label, None));
        let old = view.stale.or(view.note).map(|sentence| {
            // Below its name, and below the button at the right: the sentence may need the whole width.
            let below = if view.caption || has_button { 26.0 } else { 0.0 };
            let at = corner.left_top() + vec2(0.0, below);
            Chip::new(ui, rect, at, Align2::LEFT_TOP, sentence, Some(Role::Warning))
        });
        let button = has_button.then(|| seen::place(rect));
        Self { chips: label.into_iter().chain(old).collect(), button }
    }

    /// What they cover: words of marks go elsewhere.
    pub fn rects(&self) -> Vec<Rect> {
        self.chips.iter().map(|chip| chip.rect).chain(self.button).collect()
    }
}

fn inner(rect: Rect) -> Rect {
    Rect::from_min_max(rect.min + Vec2::splat(INSET), rect.max - Vec2::splat(INSET))
}

pub(super) fn paint(
    view: &ImageView<'_>,
    ui: &Ui,
    rect: Rect,
    transform: &ImageTransform,
    picture: &Picture,
    hover_px: Option<[f64; 2]>,
    captions: Captions,
) {
    let corner = inner(rect);
    let painter = ui.painter_at(rect);
    captions.chips.into_iter().for_each(|chip| chip.paint(&painter));
    let said = hover_px.map(|at_px| {
        let text = readout(view, transform, picture, at_px);
        let chip = Chip::new(ui, rect, corner.left_bottom(), Align2::LEFT_BOTTOM, &text, None);
        let said = chip.rect;
        chip.paint(&painter);
        said
    });
    let points_per_px =
        view.overlay.and_then(Overlay::arrow_scale).map(|scale| transform.points_per_px * scale);
    if let Some(key) = points_per_px.and_then(|points| ArrowKey::of(points, "px", 0.25 * rect.width())) {
        let font = theme::font(ui, &egui::TextStyle::Small);
        let at = |corner| Align2::RIGHT_BOTTOM.anchor_size(corner, key.size(&painter, &font));
        let room = at(corner.right_bottom());
        // In a narrow picture it gives way to what is said of the pixel under the pointer.
        let room = match said.filter(|said| said.intersects(room)) {
            Some(said) => at(egui::pos2(corner.right(), said.top() - 4.0)),
            None => room,
        };
        key.paint(&painter, room, &font, RIM, ON_IMAGE.text_strong);
    }
}

/// "(312.4, 87.0)   120 80 33   3.2×".
fn readout(view: &ImageView<'_>, transform: &ImageTransform, picture: &Picture, at_px: [f64; 2]) -> String {
    let mut text = format::pixel_position(at_px);
    if let Some([column, row]) = transform.pixel_at(at_px) {
        let value = match view.value_text {
            Some(value_text) => value_text(column, row),
            None => Some(color_text(picture.image()[(column, row)], " ")),
        };
        text.push_str("   ");
        text.push_str(&value.unwrap_or_else(|| "no value".to_owned()));
    }
    text.push_str(&format!("   {}×", format::significant(transform.points_per_px, 2)));
    text
}

/// Words on a dark ground, with a mark before a warning.
struct Chip {
    rect: Rect,
    galley: Arc<Galley>,
    warning: Option<Role>,
}

impl Chip {
    fn new(ui: &Ui, clip: Rect, at: Pos2, anchor: Align2, text: &str, warning: Option<Role>) -> Self {
        let font = theme::font(ui, &egui::TextStyle::Small);
        let mark_width = Self::mark_width(warning);
        let wrap = (clip.width() - 2.0 * INSET - mark_width - 12.0).max(40.0);
        let galley = ui.painter_at(clip).layout(text.to_owned(), font, ON_IMAGE.text_strong, wrap);
        let rect = anchor.anchor_size(at, galley.size() + vec2(12.0 + mark_width, 6.0));
        Self { rect, galley, warning }
    }

    fn mark_width(warning: Option<Role>) -> f32 {
        if warning.is_some() { 16.0 } else { 0.0 }
    }

    fn paint(self, painter: &Painter) {
        let Self { rect, galley, warning } = self;
        painter.rect_filled(rect, 4.0, RIM);
        if let Some(role) = warning {
            let middle = galley.rows.first().map_or(7.0, |row| row.height() / 2.0);
            let center = rect.left_top() + vec2(13.0, 3.0 + middle);
            glyph::paint(painter, center, 10.0, Glyph::Warning, role.color(&ON_IMAGE));
        }
        painter.galley(rect.min + vec2(6.0 + Self::mark_width(warning), 3.0), galley, ON_IMAGE.text_strong);
    }
}
