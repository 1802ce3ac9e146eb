//! What a calibrated mount is worth: errors of located points before and after.

use plumbline_model::frame::{Head, LeftCamera};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Pixel, Point, Pose, Raw, Robot, StereoCameras};

/// A point seen by both eyes whose place is known by other means.
#[derive(Clone, Debug, PartialEq)]
pub struct LocatedPoint {
    /// All joints, by their encoders.
    pub posture: Posture,
    /// Where the left eye sees it.
    pub left: Pixel<Raw>,
    /// Where the right eye sees it.
    pub right: Pixel<Raw>,
    /// Where it is.
    pub truth: Point<Robot>,
}

/// Localization errors with two mounts, on the same points.
#[derive(Clone, Debug, PartialEq)]
pub struct Improvement {
    /// Distance to the truth per point with the rig's own mount, m; `None` where the rays of the
    /// two eyes do not meet.
    pub before_m: Vec<Option<f64>>,
    /// Same with the other mount.
    pub after_m: Vec<Option<f64>>,
    /// Rms of `before_m`.
    pub before_rms_m: f64,
    /// Rms of `after_m`.
    pub after_rms_m: f64,
}

/// Locates points by triangulation with the rig's mount and with another one; `None` if the rays
/// of no point meet.
pub fn localization_improvement(
    rig: &Rig,
    cameras: &StereoCameras,
    head_from_left: &Pose<Head, LeftCamera>,
    points: &[LocatedPoint],
) -> Option<Improvement> {
    let errors = |mount: &Pose<Head, LeftCamera>| -> Vec<Option<f64>> {
        points
            .iter()
            .map(|point| {
                let in_left = cameras.triangulate(point.left, point.right)?;
                let head = rig.description.forward(&point.posture).of(rig.eyes.link).isometry;
                let in_robot = Pose::<Robot, Head>::new(head) * *mount * in_left;
                Some(in_robot.distance_m(&point.truth))
            })
            .collect()
    };
    let (before_m, after_m) = (errors(&rig.eyes.head_from_left), errors(head_from_left));
    Some(Improvement { before_rms_m: rms(&before_m)?, after_rms_m: rms(&after_m)?, before_m, after_m })
}

fn rms(errors: &[Option<f64>]) -> Option<f64> {
    let squares: Vec<f64> = errors.iter().flatten().map(|e| e * e).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}
