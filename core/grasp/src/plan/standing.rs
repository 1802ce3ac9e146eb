//! Where things stand, and where a palm belongs over them.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use plumbline_model::{Point, Robot};

// In the middle of how far off things may be and still be lifted (`tests/tolerance.rs`): about 6 mm along and
// across the hand, 10 to 16 mm from the palm to the middle of a tomato. Nearer to the palm the thumb pushes it
// across the hand, farther it slips out below: 3 to 5 mm off along and across, of 132 hands 121 lift it with the
// palm at 8 mm, 132 at 10, 131 at 12 and 129 at 14. Of two robots
// whose palms are tilted by 3° to 5° without knowing it (drawn-502, drawn-602; `brought_there_exactly…`), asked ten
// seconds later, of 44 hands 33 hold a thing that is 6 mm nearer to the fingertips than here, 42 and 43 one that is 2 mm
// to either side, 39 one that is 5 mm nearer to the palm, and 43 hold 3 mm lower.

/// Things belong so much nearer to the fingers than the middle of the palm, m…
const INTO_FINGERS_M: f64 = 0.015;
/// …and so much away from the thumb: toward the right of a right hand, m.
const FROM_THUMB_M: f64 = 0.004;
/// …and the palm closes so much below the top of a thing, m.
const BELOW_TOP_M: f64 = 0.016;

/// What is to be grasped, on what it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Middle of the object over its support: x and y, m.
    pub xy_m: [f64; 2],
    /// Height of what it stands on, m.
    pub support_m: f64,
    /// Height of the object, m.
    pub height_m: f64,
    /// The palm closes so much lower than it usually does, m.
    pub lower_m: f64,
}

impl Standing {
    /// Height of its middle, m.
    pub fn middle_m(&self) -> f64 {
        self.support_m + 0.5 * self.height_m
    }

    /// Where the palm of a right (or a left) hand that faces straight down belongs when the fingers close,
    /// for a heading of the hand.
    pub fn palm(&self, heading_rad: f64, is_left: bool) -> Point<Robot> {
        self.palm_turned(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad), is_left)
    }

    /// The same for a palm that is turned somehow: x along the fingers, z out of the back of the hand.
    pub fn palm_turned(&self, robot_from_palm: &UnitQuaternion<f64>, is_left: bool) -> Point<Robot> {
        let middle = Vector3::new(self.xy_m[0], self.xy_m[1], self.middle_m());
        let over_m = 0.5 * self.height_m - BELOW_TOP_M - self.lower_m;
        let from_thumb_m = if is_left { FROM_THUMB_M } else { -FROM_THUMB_M };
        let in_hand = Vector3::new(INTO_FINGERS_M, from_thumb_m, -over_m);
        Point::from(Point3::from(middle - robot_from_palm * in_hand))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_palm_that_closes_lower_stays_over_the_same_place() {
        let usual = Standing { xy_m: [0.3, -0.1], support_m: 0.05, height_m: 0.054, lower_m: 0.0 };
        let lower = Standing { lower_m: 0.004, ..usual };
        let [a, b] = [usual, lower].map(|standing| standing.palm(0.4, false).coords.coords);
        assert!((a - b - Vector3::new(0.0, 0.0, 0.004)).norm() < 1e-12, "{a} {b}");
        assert!((usual.middle_m() - lower.middle_m()).abs() < 1e-12);
    }
}
