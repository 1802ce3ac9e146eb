//! Where the eyes are over the table: the nominal geometry of NICO's head and the patch of
//! table that the robot works on.
//!
//! Assumes a head built as drawn: nobody has measured yet how the eyes sit in it (that is the
//! camera-mount calibration), so directions may be off by some degrees. Good enough to aim a
//! view; not good enough to report positions in the robot's frame as measured.

use nalgebra::{Matrix3, Vector3};

use crate::frame::{LeftCamera, Point, Pose, Robot};

/// Origin of the joint `head_z` (turns about +z) in the torso, meters.
const HEAD_Z_ORIGIN_M: [f64; 3] = [-0.025, 0.0, 0.23];
/// Origin of the joint `head_y` (turns about −y: positive looks up) above `head_z`, meters.
const HEAD_Y_ORIGIN_M: [f64; 3] = [0.0, 0.0, 0.105];
/// Optical center of the left eye in the head, meters.
const LEFT_EYE_IN_HEAD_M: [f64; 3] = [0.08, 0.035, 0.095];
/// `head_y` while the robot works on the table: 30° down, radians.
pub const WORKING_HEAD_Y_RAD: f64 = -std::f64::consts::FRAC_PI_6;

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

impl Default for Workspace {
    /// The head at work over the published table: 0.2 to 0.6 m ahead, 0.45 m to either side.
    fn default() -> Self {
        Self {
            robot_from_left: robot_from_left(0.0, WORKING_HEAD_Y_RAD),
            table_height_m: 0.054,
            x_range_m: [0.2, 0.6],
            y_range_m: [-0.45, 0.45],
            headroom_m: 0.15,
        }
    }
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

/// Place of the left eye for the two head angles (rad; `head_y_rad` positive looks up),
/// from the nominal dimensions of the head.
pub fn robot_from_left(head_z_rad: f64, head_y_rad: f64) -> Pose<Robot, LeftCamera> {
    // The three links between torso and eye have no frames of their own: nobody else needs them.
    let turn = |rotation_rad: Vector3<f64>, origin_m: [f64; 3]| {
        Pose::<Robot, Robot>::from_rotation_vector(rotation_rad, Vector3::from(origin_m))
    };
    let torso_from_neck = turn(Vector3::z() * head_z_rad, HEAD_Z_ORIGIN_M);
    let neck_from_head = turn(-Vector3::y() * head_y_rad, HEAD_Y_ORIGIN_M);
    // The optical axis is the head's x, image right is its −y, image down its −z.
    let axes = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    let head_from_left = Pose::<Robot, LeftCamera>::from_matrix(&axes, Vector3::from(LEFT_EYE_IN_HEAD_M));
    torso_from_neck * neck_from_head * head_from_left
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!((axis(0.0, WORKING_HEAD_Y_RAD).z + 0.5).abs() < 1e-12);
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
