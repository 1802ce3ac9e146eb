//! The fonts of the page, and how wide text is.

use std::sync::OnceLock;

use ttf_parser::Face;

/// Inter, regular.
pub const REGULAR: &[u8] = include_bytes!("../../../assets/fonts/Inter-Regular.ttf");
/// Inter, semi-bold.
pub const SEMI_BOLD: &[u8] = include_bytes!("../../../assets/fonts/Inter-SemiBold.ttf");

/// Weight of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Weight {
    Regular,
    SemiBold,
}

impl Weight {
    pub fn data(self) -> &'static [u8] {
        match self {
            Self::Regular => REGULAR,
            Self::SemiBold => SEMI_BOLD,
        }
    }

    fn face(self) -> &'static Face<'static> {
        static REGULAR_FACE: OnceLock<Face<'static>> = OnceLock::new();
        static SEMI_BOLD_FACE: OnceLock<Face<'static>> = OnceLock::new();
        let face = match self {
            Self::Regular => &REGULAR_FACE,
            Self::SemiBold => &SEMI_BOLD_FACE,
        };
        face.get_or_init(|| Face::parse(self.data(), 0).expect("the fonts are part of the program"))
    }
}

/// Width of a line of text, without kerning, which makes it a little narrower.
pub fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let face = weight.face();
    let units: f64 = text
        .chars()
        .map(|c| face.glyph_index(c).and_then(|glyph| face.glyph_hor_advance(glyph)))
        // What the font does not have is drawn by another one, at most as wide as it is high.
        .map(|advance| advance.map_or(f64::from(face.units_per_em()), f64::from))
        .sum();
    units * size / f64::from(face.units_per_em())
}

/// Text that may stand in XML and on one line: control characters become spaces.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| {
            if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}' | '\u{2028}' | '\u{2029}') {
                ' '
            } else {
                c
            }
        })
        // Marks that turn the direction of what follows could make a name read as something else.
        .filter(|c| !matches!(c, '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}' | '\u{200E}' | '\u{200F}'))
        .collect()
}

/// As much of a text as fits, with an ellipsis where something is missing.
pub fn fit(text: &str, most: f64, size: f64, weight: Weight) -> String {
    let text = printable(text);
    if width(&text, size, weight) <= most {
        return text;
    }
    let mut kept = text;
    while kept.pop().is_some() {
        let shortened = format!("{}…", kept.trim_end());
        if width(&shortened, size, weight) <= most {
            return shortened;
        }
    }
    String::new()
}

/// Lines of a text, broken at spaces, and inside of words that are wider than a line. At most
/// `most` lines; the last one ends with an ellipsis if there is more.
pub fn wrap(text: &str, most_width: f64, size: f64, weight: Weight, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    let mut line = String::new();
    for word in printable(text).split([' ', '\t']).filter(|word| !word.is_empty()) {
        let joined = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if width(&joined, size, weight) <= most_width {
            line = joined;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for c in word.chars() {
            line.push(c);
            if width(&line, size, weight) > most_width && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::replace(&mut line, c.to_string()));
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > most {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            *last = fit(&format!("{last} …………"), most_width, size, weight);
            while last.ends_with("……") {
                last.pop();
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_no_wider_than_asked_and_lose_nothing() {
        let text = "The elbow's zero is off by two degrees, Donaudampfschifffahrtsgesellschaftskapitän.";
        for most in [40.0, 70.0, 300.0] {
            let lines = wrap(text, most, 8.0, Weight::Regular, 100);
            assert!(lines.iter().all(|line| width(line, 8.0, Weight::Regular) <= most), "{lines:?}");
            let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
            assert_eq!(letters(&lines.concat()), letters(text));
        }
    }

    #[test]
    fn what_does_not_fit_ends_with_an_ellipsis() {
        let lines = wrap("one two three four five six seven", 40.0, 8.0, Weight::Regular, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines[1].ends_with('…') && !lines[1].ends_with("……"), "{lines:?}");
        assert!(fit("r_shoulder_z_with_a_long_name", 50.0, 8.0, Weight::Regular).ends_with('…'));
        assert_eq!(fit("elbow", 50.0, 8.0, Weight::Regular), "elbow");
    }

    #[test]
    fn control_characters_and_turned_directions_are_not_printed() {
        assert_eq!(printable("a\u{0}b\nc\u{202E}d"), "a b cd");
    }
}
