//! Colors of classes on images. None of them is red, which belongs to danger.

use egui::{Color32, Painter, Rect, Stroke, StrokeKind};
use plumbline_model::detection::PUBLISHED_CLASSES;

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// The published classes in their order, then others.
const COLORS: [Color32; 12] = [
    rgb(0xF0E442),
    rgb(0xA6D854),
    rgb(0x56B4E9),
    rgb(0xC49A6C),
    rgb(0xE4E7EA),
    rgb(0xF28E2B),
    rgb(0x9D8CFF),
    rgb(0xFF7AC0),
    rgb(0x2FBF8F),
    rgb(0x40D0E0),
    rgb(0xD0A0E8),
    rgb(0x9AA86A),
];

/// The color of a class: a published one has the same color in every data set, whatever its number.
pub fn class_color(name: &str, number: usize) -> Color32 {
    let published = PUBLISHED_CLASSES.iter().position(|known| *known == name);
    let others = COLORS.len() - PUBLISHED_CLASSES.len();
    published.map_or_else(|| COLORS[PUBLISHED_CLASSES.len() + number % others], |class| COLORS[class])
}

/// A class in words for people. Only those of the published names that are none are told otherwise: any other name is
/// the one that whoever trained the detector gave it.
pub fn class_words(name: &str) -> &str {
    match name {
        "LeftHand" => "Left hand",
        "RightHand" => "Right hand",
        name => name,
    }
}

/// A patch of a class's color, edged so that a light color is seen on a light ground.
pub fn class_swatch(painter: &Painter, rect: Rect, color: Color32, edge: Color32) {
    painter.rect(rect, 2.0, color, Stroke::new(1.0, edge), StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hands_are_told_in_words_and_a_name_of_somebody_else_as_it_is() {
        for name in PUBLISHED_CLASSES {
            assert!(!class_words(name)[1..].contains(char::is_uppercase), "{name}");
        }
        assert_eq!(class_words("SoftBall"), "SoftBall");
    }

    #[test]
    fn a_published_class_keeps_its_color_and_differs_from_the_others() {
        assert_eq!(class_color("Tomato", 0), class_color("Tomato", 7));
        let colors: std::collections::HashSet<[u8; 4]> =
            PUBLISHED_CLASSES.iter().map(|name| class_color(name, 0).to_array()).collect();
        assert_eq!(colors.len(), PUBLISHED_CLASSES.len());
        assert_ne!(class_color("Cup", 0), class_color("Cup", 1));
    }
}
