//! The 256 colors of each map.

use std::sync::OnceLock;

use egui::Color32;

use super::Colormap;

type Table = [Color32; 256];

/// Viridis (Smith, van der Walt, Firing; CC0) at 33 equal steps; between them linear, at most
/// 2/255 off.
const VIRIDIS: [u32; 33] = [
    0x440154, 0x470D60, 0x48186A, 0x482374, 0x472D7B, 0x453681, 0x424086, 0x3F4989, 0x3B528B, 0x375A8D,
    0x33638D, 0x2F6A8E, 0x2C728E, 0x297A8E, 0x26818E, 0x23898E, 0x21908C, 0x1F988B, 0x1F9F88, 0x21A685,
    0x28AE80, 0x31B57B, 0x3EBC74, 0x4CC26C, 0x5DC963, 0x6ECE58, 0x82D34C, 0x96D83F, 0xABDC32, 0xC0DF24,
    0xD5E21A, 0xEAE51A, 0xFDE725,
];

/// Hue in degrees at the ends of the spectrum.
const SPECTRUM_HUE: [f64; 2] = [292.0, 52.0];
/// (position, lightness, chroma) in between: rises to yellow, falls towards orange.
const SPECTRUM: [(f64, f64, f64); 6] = [
    (0.0, 0.34, 0.13),
    (0.2, 0.55, 0.13),
    (0.45, 0.74, 0.115),
    (0.7, 0.88, 0.15),
    (0.85, 0.80, 0.155),
    (1.0, 0.60, 0.145),
];

/// Oklab of the difference map at equal steps; the middle is a light gray that stands out from
/// both themes.
const DIFFERENCE: [[f64; 3]; 5] =
    [[0.42, -0.02, -0.13], [0.68, -0.03, -0.09], [0.91, 0.0, 0.0], [0.74, 0.05, 0.11], [0.50, 0.06, 0.10]];

pub(super) fn of(map: Colormap) -> &'static Table {
    static TABLES: [OnceLock<Table>; 4] = [const { OnceLock::new() }; 4];
    let (slot, make): (usize, fn(f64) -> Color32) = match map {
        Colormap::Viridis => (0, viridis),
        Colormap::Spectrum => (1, spectrum),
        Colormap::Gray => (2, |t| Color32::from_gray((255.0 * t).round() as u8)),
        Colormap::Difference => (3, difference),
    };
    TABLES[slot].get_or_init(|| std::array::from_fn(|i| make(i as f64 / 255.0)))
}

fn viridis(t: f64) -> Color32 {
    let at = t * (VIRIDIS.len() - 1) as f64;
    let below = (at as usize).min(VIRIDIS.len() - 2);
    let part = at - below as f64;
    let channel = |shift: u32| {
        let [a, b] = [VIRIDIS[below], VIRIDIS[below + 1]].map(|hex| f64::from(hex >> shift & 0xFF));
        (a + (b - a) * part).round() as u8
    };
    Color32::from_rgb(channel(16), channel(8), channel(0))
}

fn spectrum(t: f64) -> Color32 {
    let hue = (SPECTRUM_HUE[0] + (SPECTRUM_HUE[1] - SPECTRUM_HUE[0]) * t).to_radians();
    let next = SPECTRUM.iter().position(|node| node.0 >= t).unwrap_or(SPECTRUM.len() - 1).max(1);
    let (a, b) = (SPECTRUM[next - 1], SPECTRUM[next]);
    let part = (t - a.0) / (b.0 - a.0);
    let (lightness, chroma) = (a.1 + (b.1 - a.1) * part, a.2 + (b.2 - a.2) * part);
    from_oklab([lightness, chroma * hue.cos(), chroma * hue.sin()])
}

fn difference(t: f64) -> Color32 {
    let at = t * (DIFFERENCE.len() - 1) as f64;
    let below = (at as usize).min(DIFFERENCE.len() - 2);
    let part = at - below as f64;
    from_oklab(std::array::from_fn(|k| {
        DIFFERENCE[below][k] + (DIFFERENCE[below + 1][k] - DIFFERENCE[below][k]) * part
    }))
}

/// From Oklab (Ottosson 2020) to sRGB bytes. Colors just outside sRGB go to its edge.
fn from_oklab([l, a, b]: [f64; 3]) -> Color32 {
    let cone = |ka: f64, kb: f64| (l + ka * a + kb * b).powi(3);
    let (l, m, s) = (
        cone(0.3963377774, 0.2158037573),
        cone(-0.1055613458, -0.0638541728),
        cone(-0.0894841775, -1.2914855480),
    );
    let byte = |linear: f64| {
        let c = if linear <= 0.0031308 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (255.0 * c).round() as u8
    };
    Color32::from_rgb(
        byte(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        byte(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        byte(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s),
    )
}
