//! How far repeats of the same command spread: below this no model can get.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::data::{Touch, TouchData, pixel_pitch_m};

/// Spread of touches that repeat the same command from the same side, within their groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeats {
    /// Groups of at least two touches.
    pub groups: usize,
    /// Touches in them.
    pub touches: usize,
    /// Standard deviation of the touched place along the screen's u and v, m.
    pub sd_m: [f64; 2],
    /// Root of the mean squared distance from the group's mean in the plane, m, corrected for
    /// the mean having been estimated.
    pub rms_2d_m: f64,
}

/// The noise floor: spread of repeats, in meters on the glass. `None` when no group has two
/// touches.
pub fn spread_of_repeats(data: &TouchData) -> Option<Repeats> {
    let mut groups = BTreeMap::<&str, Vec<&Touch>>::new();
    for touch in &data.touches {
        if let Some(group) = &touch.group {
            groups.entry(group).or_default().push(touch);
        }
    }
    groups.retain(|_, touches| touches.len() >= 2);
    let pitch_m = pixel_pitch_m(&data.screen);
    let (mut squares, mut touches) = ([0.0; 2], 0);
    for group in groups.values() {
        let places = group.iter().map(|touch| touch.pixel.vector().component_mul(&pitch_m));
        let mean = places.clone().sum::<Vector2<f64>>() / group.len() as f64;
        for offset in places.map(|place| place - mean) {
            squares[0] += offset.x * offset.x;
            squares[1] += offset.y * offset.y;
        }
        touches += group.len();
    }
    if groups.is_empty() {
        return None;
    }
    let free = (touches - groups.len()) as f64;
    let variance = squares.map(|sum| sum / free);
    Some(Repeats {
        groups: groups.len(),
        touches,
        sd_m: variance.map(f64::sqrt),
        rms_2d_m: (variance[0] + variance[1]).sqrt(),
    })
}
