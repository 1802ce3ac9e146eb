//! Names in the scene.

use egui::{Pos2, Rect, TextStyle, Ui, vec2};

use super::camera::View;
use super::scene::{Scene, Tint};
use crate::theme;

/// Labels of the scene; `hidden` says whether a solid is in front. None covers another, and what is called alike at
/// the same place (a thing, and what was seen of it) is written once.
pub(super) fn labels(ui: &Ui, rect: Rect, view: &View, scene: &Scene, hidden: impl Fn(Pos2, f64) -> bool) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    let font = theme::font(ui, &TextStyle::Small);
    let mut taken: Vec<(Rect, &str)> = Vec::new();
    for label in &scene.labels {
        let Some((place, depth_m)) = view.project(&label.at_m) else { continue };
        let strength = if hidden(place, depth_m) { 0.4 } else { 1.0 };
        let color = match label.tint {
            Tint::Neutral | Tint::Screen | Tint::Table => tokens.text,
            tint => tint.ink(tokens),
        };
        let galley = painter.layout_no_wrap(label.text.clone(), font.clone(), color.gamma_multiply(strength));
        let size = galley.size() + vec2(8.0, 2.0);
        let wanted = Rect::from_center_size(rect.min + place.to_vec2(), size);
        let Some(back) = room_for(wanted, &label.text, &taken) else { continue };
        taken.push((back, &label.text));
        // What gave way says whose name it is.
        if !back.contains(wanted.center()) {
            let ink = color.gamma_multiply(0.6 * strength);
            painter.line_segment([wanted.center(), back.clamp(wanted.center())], (1.0, ink));
        }
        painter.rect_filled(back, 3.0, tokens.panel.gamma_multiply(0.7 * strength));
        painter.galley(back.min + vec2(4.0, 1.0), galley, color);
    }
}

/// Where a label goes that would like to be there: over or under what is in its way, as near as there is room;
/// `None`: the same is written there.
fn room_for(wanted: Rect, text: &str, taken: &[(Rect, &str)]) -> Option<Rect> {
    const STEPS: [f32; 7] = [0.0, -1.0, 1.0, -2.0, 2.0, -3.0, 3.0];
    let is_near = |other: &Rect| {
        let apart = (other.center() - wanted.center()).abs();
        apart.x < 0.75 * wanted.width() && apart.y < 3.0 * wanted.height()
    };
    if taken.iter().any(|(other, said)| said.eq_ignore_ascii_case(text) && is_near(other)) {
        return None;
    }
    let moved = |step: &f32| wanted.translate(vec2(0.0, step * wanted.height()));
    let free = |place: &Rect| taken.iter().all(|(other, _)| !other.shrink(0.5).intersects(*place));
    Some(STEPS.iter().map(moved).find(free).unwrap_or(wanted))
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    fn label(x: f32, y: f32) -> Rect {
        Rect::from_center_size(pos2(x, y), vec2(50.0, 16.0))
    }

    #[test]
    fn a_label_keeps_its_place_or_goes_to_the_nearest_one_that_is_free() {
        let (tomato, cup) = (label(100.0, 100.0), label(110.0, 104.0));
        assert_eq!(room_for(tomato, "Tomato", &[]), Some(tomato));
        let moved = room_for(cup, "Cup", &[(tomato, "Tomato")]).expect("another name");
        assert!(!moved.shrink(0.5).intersects(tomato) && (moved.center() - cup.center()).length() < 33.0);
        // Where everything is taken, it is not left out.
        let column: Vec<(Rect, &str)> =
            (-9..9).map(|k| (label(100.0, 100.0 + 8.0 * k as f32), "Tomato")).collect();
        assert_eq!(room_for(label(130.0, 100.0), "Cup", &column), Some(label(130.0, 100.0)));
    }

    #[test]
    fn the_same_word_is_written_once_for_one_place_and_twice_for_two() {
        let said = [(label(100.0, 100.0), "Tomato")];
        assert_eq!(room_for(label(103.0, 130.0), "tomato", &said), None);
        assert_eq!(room_for(label(160.0, 100.0), "Tomato", &said), Some(label(160.0, 100.0)));
    }
}
