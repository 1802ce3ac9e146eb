//! The scale of drawn errors as an arrow: so long is so much. One stands in every picture with arrows, so that
//! they can be read without multiplying.

use egui::{Color32, FontId, Painter, Rect, Stroke, Vec2, vec2};

use crate::overlay;

/// It is drawn at most this long, points.
const MOST: f32 = 48.0;
/// Around and between arrow and words, points.
const ROOM: f32 = 6.0;
/// Finer than this nobody reads it.
const MOST_DECIMALS: i32 = 4;

/// An arrow of a round length, and what it stands for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ArrowKey {
    /// Its length, points.
    pub points: f32,
    /// "= 2 mm".
    pub text: String,
}

impl ArrowKey {
    /// `points_per_unit`: how long an error of one `unit` is drawn. 1, 2 or 5 times a power of ten, as long as
    /// there is room for it; `None` where no length can be said.
    pub fn of(points_per_unit: f64, unit: &str, room: f32) -> Option<Self> {
        let most = f64::from(room.min(MOST)) / points_per_unit;
        if !(most.is_finite() && most > 0.0) {
            return None;
        }
        let power = most.log10().floor();
        let decimals = -power as i32;
        if decimals > MOST_DECIMALS {
            return None;
        }
        let steps = [5.0, 2.0, 1.0].map(|factor| factor * 10f64.powf(power));
        let length = steps.into_iter().find(|step| *step <= most * (1.0 + 1e-9))?;
        let decimals = decimals.max(0) as usize;
        Some(Self {
            points: (length * points_per_unit) as f32,
            text: format!("= {length:.decimals$} {unit}"),
        })
    }

    /// How much room it takes.
    pub fn size(&self, painter: &Painter, font: &FontId) -> Vec2 {
        let words = painter.layout_no_wrap(self.text.clone(), font.clone(), Color32::WHITE).size();
        vec2(3.0 * ROOM + self.points + words.x, words.y + 4.0)
    }

    /// Draws it into the room that it takes.
    pub fn paint(&self, painter: &Painter, rect: Rect, font: &FontId, fill: Color32, ink: Color32) {
        painter.rect_filled(rect, 3.0, fill);
        let foot = rect.left_center() + vec2(ROOM, 0.0);
        overlay::arrow(painter, foot, vec2(self.points, 0.0), Stroke::new(1.5, ink), None);
        let words = painter.layout_no_wrap(self.text.clone(), font.clone(), ink);
        let at = foot + vec2(self.points + ROOM, -0.5 * words.size().y);
        painter.galley(at, words, ink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_round_and_as_long_as_the_errors_that_it_stands_for() {
        for (points_per_mm, text) in
            [(10.0, "= 2 mm"), (0.3, "= 100 mm"), (480.0, "= 0.1 mm"), (24.0, "= 2 mm")]
        {
            let key = ArrowKey::of(points_per_mm, "mm", 100.0).expect("a length");
            assert_eq!(key.text, text);
            let said: f64 = text.trim_matches(|c: char| !c.is_ascii_digit()).parse().expect("a number");
            assert!((f64::from(key.points) - said * points_per_mm).abs() < 1e-3, "{key:?}");
        }
    }

    #[test]
    fn it_keeps_to_its_room_and_can_be_seen() {
        for i in 1..400 {
            let points_per_mm = 1.05f64.powi(i) * 1e-4;
            for room in [20.0, 48.0, 300.0] {
                let Some(key) = ArrowKey::of(points_per_mm, "mm", room) else { continue };
                let most = room.min(MOST);
                assert!(key.points <= most + 1e-3 && key.points >= most / 2.5 - 1e-3, "{key:?} in {room}");
            }
        }
    }

    #[test]
    fn what_has_no_length_has_no_key() {
        for points_per_unit in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert_eq!(ArrowKey::of(points_per_unit, "mm", 48.0), None, "{points_per_unit}");
        }
    }
}
