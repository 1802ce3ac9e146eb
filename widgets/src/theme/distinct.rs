//! The promises of the palette: meanings stay apart for every common kind of color vision, and
//! text can be read.

use egui::Color32;

use super::{DARK, LIGHT, Role, Tokens};

/// Smallest distance in Oklab (times 100) between any two meanings.
const LEAST_DISTANCE: f64 = 7.0;

const MEANINGS: [Role; 8] = [
    Role::Measured,
    Role::Predicted,
    Role::Difference,
    Role::HeldOut,
    Role::NoiseFloor,
    Role::Accepted,
    Role::Warning,
    Role::Danger,
];

/// Linear RGB as seen with a deficiency of full severity (Machado, Oliveira, Fernandes 2009).
const VISION: [(&str, [[f64; 3]; 3]); 4] = [
    ("normal vision", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    ),
    (
        "deuteranopia",
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    ),
    (
        "tritanopia",
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ),
];

fn linear(color: Color32) -> [f64; 3] {
    [color.r(), color.g(), color.b()].map(|byte| {
        let c = f64::from(byte) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

fn through(matrix: &[[f64; 3]; 3], c: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2])
}

fn oklab(c: [f64; 3]) -> [f64; 3] {
    let lms = through(
        &[
            [0.4122214708, 0.5363325363, 0.0514459929],
            [0.2119034982, 0.6806995451, 0.1073969566],
            [0.0883024619, 0.2817188376, 0.6299787005],
        ],
        c.map(|x| x.clamp(0.0, 1.0)),
    )
    .map(f64::cbrt);
    through(
        &[
            [0.2104542553, 0.7936177850, -0.0040720468],
            [1.9779984951, -2.4285922050, 0.4505937099],
            [0.0259040371, 0.7827717662, -0.8086757660],
        ],
        lms,
    )
}

fn luminance(color: Color32) -> f64 {
    let [r, g, b] = linear(color);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Contrast ratio as WCAG 2 defines it, 1 to 21.
fn contrast(a: Color32, b: Color32) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn meanings_stay_apart_with_every_color_vision() {
    for (theme, tokens) in [("dark", &DARK), ("light", &LIGHT)] {
        for (vision, matrix) in &VISION {
            let seen = MEANINGS.map(|role| oklab(through(matrix, linear(role.color(tokens)))));
            for (i, a) in seen.iter().enumerate() {
                for (j, b) in seen.iter().enumerate().skip(i + 1) {
                    let apart = 100.0 * (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                    assert!(
                        apart >= LEAST_DISTANCE,
                        "{theme}, {vision}: {:?} and {:?} are {apart:.1} apart",
                        MEANINGS[i],
                        MEANINGS[j]
                    );
                }
            }
        }
    }
}

#[test]
fn text_and_marks_can_be_read() {
    for (theme, t) in [("dark", &DARK), ("light", &LIGHT)] {
        let read = |what: &str, front: Color32, back: Color32, least: f64| {
            let found = contrast(front, back);
            assert!(found >= least, "{theme}: {what} has contrast {found:.2}, needs {least}");
        };
        for back in [t.panel, t.background, t.raised, t.selected] {
            read("text", t.text, back, 7.0);
            read("weak text", t.text_weak, back, 4.5);
        }
        read("accent button", t.on_accent, t.accent, 7.0);
        read("stop", t.on_stop, t.stop, 4.5);
        read("stop under the pointer", t.on_stop, t.stop_hover, 4.0);
        read("warning text", t.warning, t.panel, 4.5);
        for role in MEANINGS {
            read(&format!("{role:?}"), role.color(t), t.panel, 3.0);
        }
    }
}

#[test]
fn only_danger_is_red() {
    let hue_deg = |color| {
        let [_, a, b] = oklab(linear(color));
        b.atan2(a).to_degrees().rem_euclid(360.0)
    };
    let is_red = |color| (10.0..=40.0).contains(&hue_deg(color)) && oklab(linear(color))[1] > 0.08;
    for tokens in [&DARK, &LIGHT] {
        let Tokens { danger, stop, .. } = tokens;
        assert!(is_red(*danger) && is_red(*stop));
        for role in Role::ALL.into_iter().filter(|role| *role != Role::Danger) {
            assert!(!is_red(role.color(tokens)), "{role:?} is red");
        }
    }
}
