//! Where the eyes were in the robot, as Foxglove's `FrameTransforms`.

use foxglove::messages::{FrameTransform, FrameTransforms, Quaternion, Vector3};
use jiff::Timestamp;
use plumbline_model::{Eye, LeftCamera, Pose, RightCamera, Robot};

use crate::messages::{frame_of, time};

/// The frame of the robot: torso; x forward, y left, z up.
const ROBOT: &str = "robot";

/// Where both eyes are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyePlaces {
    /// The left eye in the robot, as the model in use has it.
    pub robot_from_left: Pose<Robot, LeftCamera>,
    /// The right eye against the left one.
    pub right_from_left: Pose<RightCamera, LeftCamera>,
}

/// The robot holds the left eye, and that one the right one.
pub(crate) fn transforms(at: Timestamp, places: &EyePlaces) -> FrameTransforms {
    let [left, right] = [Eye::Left, Eye::Right].map(frame_of);
    let left_from_right = places.right_from_left.inverse();
    let transform = |parent: &str, child: &str, translation_m: [f64; 3], [x, y, z, w]: [f64; 4]| {
        let [along_x, along_y, along_z] = translation_m;
        FrameTransform {
            timestamp: time(at),
            parent_frame_id: parent.to_owned(),
            child_frame_id: child.to_owned(),
            translation: Some(Vector3 { x: along_x, y: along_y, z: along_z }),
            rotation: Some(Quaternion { x, y, z, w }),
        }
    };
    let robot = &places.robot_from_left.isometry;
    let between = &left_from_right.isometry;
    FrameTransforms {
        transforms: vec![
            transform(ROBOT, left, robot.translation.vector.into(), robot.rotation.coords.into()),
            transform(left, right, between.translation.vector.into(), between.rotation.coords.into()),
        ],
    }
}

/// Where the left eye was in the robot, as rows of a matrix 4 by 4 that takes points (m) of the left eye there;
/// `None`: it does not say so.
pub(crate) fn robot_from_left(told: &FrameTransforms) -> Option<[[f64; 4]; 4]> {
    let is_left = |transform: &&FrameTransform| {
        transform.parent_frame_id == ROBOT && transform.child_frame_id == frame_of(Eye::Left)
    };
    let transform = told.transforms.iter().find(is_left)?;
    let (at, turn) = (transform.translation.as_ref()?, transform.rotation.as_ref()?);
    let norm = (turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w).sqrt();
    let numbers = [at.x, at.y, at.z, norm];
    if !numbers.iter().all(|number| number.is_finite()) || (norm - 1.0).abs() > 1e-3 {
        return None;
    }
    let [x, y, z, w] = [turn.x, turn.y, turn.z, turn.w].map(|part| part / norm);
    Some([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w), at.x],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w), at.y],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y), at.z],
        [0.0, 0.0, 0.0, 1.0],
    ])
}
