//! The words on a view: its name, what the pointer is on, and how old the picture is.

use egui::{Align2, Pos2, Rect, Ui, Vec2, vec2};

use super::pixels::color_text;
use super::{ImageTransform, ImageView};
use crate::arrow_key::ArrowKey;
use crate::format;
use crate::glyph::{self, Glyph};
use crate::overlay::Overlay;
use crate::texture::Picture;
use crate::theme::{self, ON_IMAGE, RIM, Role};

const INSET: f32 = 8.0;

pub(super) fn paint(
    view: &ImageView<'_>,
    ui: &Ui,
    rect: Rect,
    transform: &ImageTransform,
    picture: &Picture,
    hover_px: Option<[f64; 2]>,
    has_button: bool,
) {
    let corner = Rect::from_min_max(rect.min + Vec2::splat(INSET), rect.max - Vec2::splat(INSET));
    if view.caption {
        chip(ui, rect, corner.left_top(), Align2::LEFT_TOP, view.label, None);
    }
    if let Some(sentence) = view.stale.or(view.note) {
        // Below its name, and below the button at the right: the sentence may need the whole width.
        let below = if view.caption || has_button { 26.0 } else { 0.0 };
        let at = corner.left_top() + vec2(0.0, below);
        chip(ui, rect, at, Align2::LEFT_TOP, sentence, Some(Role::Warning));
    }
    let said = hover_px.map(|at_px| {
        let text = readout(view, transform, picture, at_px);
        chip(ui, rect, corner.left_bottom(), Align2::LEFT_BOTTOM, &text, None)
    });
    let points_per_px =
        view.overlay.and_then(Overlay::arrow_scale).map(|scale| transform.points_per_px * scale);
    if let Some(key) = points_per_px.and_then(|points| ArrowKey::of(points, "px", 0.25 * rect.width())) {
        let (painter, font) = (ui.painter_at(rect), theme::font(ui, &egui::TextStyle::Small));
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

fn chip(ui: &Ui, clip: Rect, at: Pos2, anchor: Align2, text: &str, warning: Option<Role>) -> Rect {
    let painter = ui.painter_at(clip);
    let font = theme::font(ui, &egui::TextStyle::Small);
    let mark_width = if warning.is_some() { 16.0 } else { 0.0 };
    let wrap = (clip.width() - 2.0 * INSET - mark_width - 12.0).max(40.0);
    let galley = painter.layout(text.to_owned(), font, ON_IMAGE.text_strong, wrap);
    let rect = anchor.anchor_size(at, galley.size() + vec2(12.0 + mark_width, 6.0));
    painter.rect_filled(rect, 4.0, RIM);
    if let Some(role) = warning {
        let center =
            rect.left_top() + vec2(13.0, 3.0 + galley.rows.first().map_or(7.0, |row| row.height() / 2.0));
        glyph::paint(&painter, center, 10.0, Glyph::Warning, role.color(&ON_IMAGE));
    }
    painter.galley(rect.min + vec2(6.0 + mark_width, 3.0), galley, ON_IMAGE.text_strong);
    rect
}
