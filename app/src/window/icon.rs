//! The window's icon: a plumb line with its bob.

use egui::IconData;

const SIDE: usize = 64;
const GROUND: [f32; 3] = [21.0, 25.0, 29.0];
const LINE: [f32; 3] = [237.0, 240.0, 243.0];
const BOB: [f32; 3] = [63.0, 199.0, 244.0];

/// 64×64 RGBA, drawn with soft edges.
pub(super) fn icon() -> IconData {
    let mut rgba = Vec::with_capacity(4 * SIDE * SIDE);
    for row in 0..SIDE {
        for column in 0..SIDE {
            let (x, y) = (column as f32 + 0.5 - 32.0, row as f32 + 0.5 - 32.0);
            let line = inside((x.abs() - 1.6).max(y - 8.0).max(-24.0 - y));
            let bob = inside(bob(x, y));
            for channel in 0..3 {
                let under = mix(GROUND[channel], LINE[channel], line);
                rgba.push(mix(under, BOB[channel], bob) as u8);
            }
            rgba.push((255.0 * inside(rounded_square(x, y))) as u8);
        }
    }
    IconData { rgba, width: SIDE as u32, height: SIDE as u32 }
}

/// Signed distance to a bob: a kite, wide above and pointed below.
fn bob(x: f32, y: f32) -> f32 {
    let (from_top, from_tip) = (y - 2.0, 26.0 - y);
    let half_width = (1.4 * from_top).min(0.68 * from_tip);
    (x.abs() - half_width) * 0.75
}

fn rounded_square(x: f32, y: f32) -> f32 {
    let corner = 14.0;
    let (dx, dy) = (x.abs() - (31.0 - corner), y.abs() - (31.0 - corner));
    dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0) - corner
}

/// 1 inside, 0 outside, in between over one pixel.
fn inside(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

fn mix(a: f32, b: f32, part: f32) -> f32 {
    a + (b - a) * part
}
