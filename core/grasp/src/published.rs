//! What the published methods know beside their networks: the heights of the open hand over the table and
//! how its palm is turned, both measured by hand at about 45 places and interpolated between them
//! (J. Gavura, I. Farkaš, "Optimization of sim-to-real transfer in the humanoid robot NICO", 2026).

use plumbline_correction::tables::{HeightSurface, HeightTable, TableError};

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
    over_finger_m: Option<f64>,
}

impl HandHeights {
    /// From places at which the hand was lowered. The places at which the fingertip met the glass
    /// (`fingertips_m`, where it was sent, robot frame) tell how much higher than it the hand has the table:
    /// the mean over them. (Published as a constant between the height of the finger and that of the palm.)
    ///
    /// # Errors
    /// When the table cannot be used.
    pub fn new(
        table: &HeightTable,
        fingertips_m: impl IntoIterator<Item = [f64; 3]>,
    ) -> Result<Self, TableError> {
        let surface = table.surface()?;
        let mut over_m = vec![];
        for [x_m, y_m, z_m] in fingertips_m {
            let hand = surface.interpolate(x_m, y_m)?;
            if hand.inside {
                over_m.push(hand.value - z_m);
            }
        }
        let count = over_m.len() as f64;
        let over_finger_m = (!over_m.is_empty()).then(|| over_m.iter().sum::<f64>() / count);
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

    /// How much higher the hand has the table than the fingertip has it, m. `None`: no touch lies where the
    /// hand was lowered.
    pub fn over_finger_m(&self) -> Option<f64> {
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

    fn plane() -> HeightTable {
        let points = (0..45).map(|k| {
            let (x_m, y_m) = (0.15 + 0.07 * f64::from(k % 5), -0.42 + 0.09 * f64::from(k / 5));
            HeightPoint { x_m, y_m, height_m: 0.05 + 0.06 * (x_m - 0.3) }
        });
        HeightTable::new(points.collect()).expect("a table")
    }

    #[test]
    fn heights_are_those_of_the_places_where_the_hand_was_lowered() {
        let heights = HandHeights::new(&plane(), []).expect("usable");
        let (height_m, inside) = heights.at(0.33, -0.1).expect("a place");
        assert!(inside && (height_m - 0.0518).abs() < 1e-3, "{height_m}");
        assert!(!heights.at(0.9, -0.1).expect("a place").1);
        assert!(heights.at(f64::NAN, 0.0).is_err());
        assert_eq!(heights.over_finger_m(), None);
    }

    #[test]
    fn the_hand_is_so_much_over_the_finger_as_touches_where_it_was_lowered_say() {
        let far = [0.9, 0.0, 0.5];
        let heights =
            HandHeights::new(&plane(), [[0.3, 0.0, 0.04], [0.3, -0.1, 0.044], far]).expect("usable");
        let over_m = heights.over_finger_m().expect("touches inside");
        assert!((over_m - 0.008).abs() < 5e-4, "{over_m}");
        assert_eq!(HandHeights::new(&plane(), [far]).expect("usable").over_finger_m(), None);
    }

    #[test]
    fn published_palm_and_finger_heights_are_as_far_apart_as_the_published_constant_says() {
        let folders = ["nico-tables", "nico-touch"].map(plumbline_model::measured_data::folder);
        let [Ok(tables), Ok(touches)] = folders else {
            return folders.into_iter().filter_map(Result::err).for_each(|reason| eprintln!("{reason}"));
        };
        let table = HeightTable::read(&tables.join("rh_z.csv")).expect("a good file");
        let text = std::fs::read_to_string(touches.join("touch-245/touches.csv")).expect("there");
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().expect("a header");
        let columns = ["target_x_m", "target_y_m", "target_z_m"]
            .map(|name| header.iter().position(|column| *column == name).expect("a column"));
        let sent_m: Vec<[f64; 3]> =
            lines.map(|row| columns.map(|column| row[column].parse().expect("a number"))).collect();
        assert_eq!(sent_m.len(), 245);
        let over_m = HandHeights::new(&table, sent_m).expect("usable").over_finger_m().expect("inside");
        // Published: 40 mm over the network's height, or 1 mm under the table's.
        assert!((over_m - 0.041).abs() < 0.008, "{over_m}");
    }
}
