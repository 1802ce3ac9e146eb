//! What the published methods know beside their networks: the heights of the open hand over the table and
//! how its palm is turned, both measured by hand at about 45 places and interpolated between them
//! (J. Gavura, I. Farkaš, "Optimization of sim-to-real transfer in the humanoid robot NICO", 2026).

use plumbline_correction::tables::{HeightSurface, HeightTable, TableError};
use plumbline_correction::{CorrectionModel, Method};

/// Factors of (x − 0.3 m)^i y^j, rad, for i from 0 to 3 and j from 0 to 3 − i: a cubic through the
/// published yaws at z = 7 cm. Over their places with x ≥ 0.15 m it is off by 0.05 rad rms, at most 0.14.
const YAW: [&[f64]; 4] = [&[1.03, 2.55, -6.99, -8.54], &[-2.61, -6.76, -6.47], &[-10.67, -6.26], &[13.11]];
/// Where those yaws were measured, m; beyond, the yaw is that of the nearest place.
const YAW_X_M: [f64; 2] = [0.15, 0.50];
const YAW_Y_M: [f64; 2] = [-0.45, 0.32];

/// Azimuth of a palm that faces down over a place of the table, as published, rad.
pub fn heading_rad(x_m: f64, y_m: f64) -> f64 {
    let x = x_m.clamp(YAW_X_M[0], YAW_X_M[1]) - 0.3;
    let y = y_m.clamp(YAW_Y_M[0], YAW_Y_M[1]);
    let in_y = |factors: &[f64]| factors.iter().rev().fold(0.0, |sum, factor| sum * y + factor);
    YAW.iter().rev().fold(0.0, |sum, factors| sum * x + in_y(factors))
}

/// Heights at which the table is for the hand of the robot as described: the lowest point of the open,
/// palm-down hand where it was sent, by that description, when the real hand met the table.
#[derive(Clone, Debug)]
pub struct HandHeights {
    surface: HeightSurface,
    over_finger_m: f64,
}

impl HandHeights {
    /// From places at which the hand was lowered. With an M3 that was learned from touches also how much
    /// higher than its fingertip the hand has the table (published as a constant of 4 cm between fingertip and
    /// palm): the mean over the places that the finger was sent to.
    ///
    /// # Errors
    /// When the table cannot be used.
    pub fn new(table: &HeightTable, m3: Option<&CorrectionModel>) -> Result<Self, TableError> {
        let surface = table.surface()?;
        let touches = m3.filter(|model| model.method() == Method::M3).map(|m3| &m3.provenance().touches);
        let mut over_m = vec![];
        for touch in touches.into_iter().flatten() {
            let [x_m, y_m, z_m] = touch.sent_m;
            let hand = surface.interpolate(x_m, y_m)?;
            if hand.inside {
                over_m.push(hand.value - z_m);
            }
        }
        let over_finger_m = over_m.iter().sum::<f64>() / over_m.len().max(1) as f64;
        Ok(Self { surface, over_finger_m })
    }

    /// Height of the table for the hand at a place of the robot as described, m; whether the hand was
    /// lowered around there.
    ///
    /// # Errors
    /// For a place that is not finite.
    pub fn at(&self, x_m: f64, y_m: f64) -> Result<(f64, bool), TableError> {
        let answer = self.surface.interpolate(x_m, y_m)?;
        Ok((answer.value, answer.inside))
    }

    /// How much higher the hand has the table than the fingertip has it, m.
    pub fn over_finger_m(&self) -> f64 {
        self.over_finger_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_correction::tables::HeightPoint;

    #[test]
    fn a_palm_points_ahead_far_from_the_shoulder_and_inward_near_it() {
        // Published at these places: 0.595, 0.165, −0.562, 1.29.
        for (x_m, y_m, published_rad) in
            [(0.426, 0.005, 0.595), (0.344, -0.216, 0.165), (0.388, -0.358, -0.562), (0.234, 0.205, 1.29)]
        {
            let off_rad = heading_rad(x_m, y_m) - published_rad;
            assert!(off_rad.abs() < 0.14, "{x_m} {y_m}: {off_rad}");
        }
        assert_eq!(heading_rad(0.05, 0.0), heading_rad(0.15, 0.0));
    }

    #[test]
    fn heights_are_those_of_the_places_where_the_hand_was_lowered() {
        let points = (0..45).map(|k| {
            let (x_m, y_m) = (0.15 + 0.07 * f64::from(k % 5), -0.42 + 0.09 * f64::from(k / 5));
            HeightPoint { x_m, y_m, height_m: 0.05 + 0.06 * (x_m - 0.3) }
        });
        let heights = HandHeights::new(&HeightTable::new(points.collect()).expect("a table"), None);
        let heights = heights.expect("usable");
        let (height_m, inside) = heights.at(0.33, -0.1).expect("a place");
        assert!(inside && (height_m - 0.0518).abs() < 1e-3, "{height_m}");
        assert!(!heights.at(0.9, -0.1).expect("a place").1);
        assert!(heights.at(f64::NAN, 0.0).is_err());
        assert_eq!(heights.over_finger_m(), 0.0);
    }
}
