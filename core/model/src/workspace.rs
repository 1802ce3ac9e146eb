//! What the eyes have to see, and from where: the patch of table that the robot works on.
//!
//! Assumes a head built as drawn unless its mount was calibrated, so directions may be off by
//! some degrees. Good enough to aim a view; not good enough to report positions in the robot's
//! frame as measured.

use crate::frame::{LeftCamera, Point, Pose, Robot};

/// The part of the table that the eyes have to see, and from where they see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace {
    /// Place of the left eye.
    pub robot_from_left: Pose<Robot, LeftCamera>,
    /// Height of the table's top in the robot's frame, meters.
    pub table_height_m: f64,
    /// Nearest and farthest x of the patch (forward), meters.
    pub x_range_m: [f64; 2],
    /// Rightmost and leftmost y of the patch (y points left), meters.
    pub y_range_m: [f64; 2],
    /// Height above the table that objects and hands take up, meters.
    pub headroom_m: f64,
}

impl Workspace {
    /// The four corners of the patch at `height_m` above the table, in the left camera's frame.
    pub fn corners_in_left(&self, height_m: f64) -> [Point<LeftCamera>; 4] {
        let left_from_robot = self.robot_from_left.inverse();
        let ([x0, x1], [y0, y1]) = (self.x_range_m, self.y_range_m);
        let z = self.table_height_m + height_m;
        [(x0, y0), (x0, y1), (x1, y1), (x1, y0)].map(|(x, y)| left_from_robot * Point::new(x, y, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Rig;

    fn robot_from_left(head_z_rad: f64, head_y_rad: f64) -> Pose<Robot, LeftCamera> {
        let rig = Rig::built_in("nico").expect("the rig that comes with the program");
        rig.robot_from_left(&rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[head_z_rad, head_y_rad]))
    }

    #[test]
    fn a_level_head_looks_forward() {
        let robot_from_left = robot_from_left(0.0, 0.0);
        let ahead = robot_from_left * Point::new(0.0, 0.0, 1.0);
        let eye = robot_from_left * Point::new(0.0, 0.0, 0.0);
        assert!(eye.distance_m(&Point::new(0.055, 0.035, 0.43)) < 1e-12);
        assert!(ahead.distance_m(&Point::new(1.055, 0.035, 0.43)) < 1e-12);
    }

    #[test]
    fn negative_head_y_looks_down_and_positive_head_z_looks_left() {
        let axis = |z, y| {
            let pose = robot_from_left(z, y);
            (pose * Point::new(0.0, 0.0, 1.0)).coords - (pose * Point::new(0.0, 0.0, 0.0)).coords
        };
        assert!((axis(0.0, -std::f64::consts::FRAC_PI_6).z + 0.5).abs() < 1e-12);
        assert!((axis(0.3, 0.0).y - 0.3f64.sin()).abs() < 1e-12);
    }

    #[test]
    fn at_work_the_eye_is_above_the_near_edge_of_the_table() {
        // By hand: 0.335 + 0.095 cos 30° − 0.08 sin 30°, and −0.025 + 0.08 cos 30° + 0.095 sin 30°.
        let eye = Workspace::default().robot_from_left * Point::new(0.0, 0.0, 0.0);
        assert!(eye.distance_m(&Point::new(0.091_782, 0.035, 0.377_272)) < 1e-6, "{eye:?}");
    }

    #[test]
    fn the_corners_of_the_patch_lie_below_and_ahead() {
        let workspace = Workspace::default();
        for (height_m, expected_z) in [(0.0, 0.054), (0.15, 0.204)] {
            for corner in workspace.corners_in_left(height_m) {
                assert!(corner.coords.z > 0.0, "{corner:?} is behind the eye");
                let in_robot = workspace.robot_from_left * corner;
                assert!((in_robot.coords.z - expected_z).abs() < 1e-12);
            }
        }
    }
}
