//! What the mount of the eyes adds to the uncertainty of a place.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Point3, Vector3};
use plumbline_model::robot::{Posture, Rig};

/// How well it is known how the eyes sit on the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted {
    /// Covariance of the left eye's place in the head: rotation vector (rad), translation (m), axes of
    /// the head, the eye turns about itself.
    pub covariance: Matrix6<f64>,
    /// The head comes to rest elsewhere each time: standard deviation of its angles (pan, tilt), rad. Where nobody
    /// measured the mount, that of the zeros of its joints.
    pub rest_sigma_rad: [f64; 2],
}

/// Step of differences of the head's angles, rad.
const STEP_RAD: f64 = 1e-4;

impl Mounted {
    /// Covariance (robot axes, m²) that it gives to a point of the left eye's frame.
    pub(super) fn covariance_m2(&self, rig: &Rig, posture: &Posture, in_left: &Vector3<f64>) -> Matrix3<f64> {
        let eyes = &rig.eyes;
        let robot_from_left = rig.robot_from_left(posture).isometry;
        let mount = eyes.head_from_left.isometry;
        let robot_from_head = (robot_from_left * mount.inverse()).rotation.to_rotation_matrix();
        // The eye turns about itself.
        let arm = mount.rotation * in_left;
        let mut by_mount = Matrix3x6::zeros();
        by_mount.fixed_view_mut::<3, 3>(0, 0).copy_from(&-arm.cross_matrix());
        by_mount.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        let by_mount = robot_from_head.matrix() * by_mount;
        let mut covariance_m2 = by_mount * self.covariance * by_mount.transpose();
        let at = |posture: &Posture| rig.robot_from_left(posture).isometry * Point3::from(*in_left);
        for (joint, sigma_rad) in [eyes.pan, eyes.tilt].into_iter().zip(self.rest_sigma_rad) {
            let mut ahead = posture.clone();
            ahead[joint] += STEP_RAD;
            let by_angle = (at(&ahead) - at(posture)) * (sigma_rad / STEP_RAD);
            covariance_m2 += by_angle * by_angle.transpose();
        }
        covariance_m2
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::Point;

    use super::*;
    use crate::RobotModel;
    use crate::robot_model::SeenUnder;

    #[test]
    fn a_mount_that_is_known_to_a_milliradian_makes_places_uncertain_by_that_times_their_distance() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let posture = rig.home();
        let place = |mounted: Option<Mounted>| {
            let model = RobotModel::nominal(rig.clone()).with_mounted(mounted);
            let in_left = Point::new(0.0, 0.0, 0.5);
            model.place(&in_left, &Matrix3::zeros(), &posture, &SeenUnder::default()).expect("a place")
        };
        assert_eq!(place(None).covariance_m2, Matrix3::zeros());
        let mut covariance = Matrix6::zeros();
        covariance.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(1e-6);
        let turned = place(Some(Mounted { covariance, rest_sigma_rad: [0.0; 2] }));
        // Two directions across the line of sight; along it a turn about the eye changes nothing.
        assert!((turned.covariance_m2.trace().sqrt() - 0.0005 * f64::sqrt(2.0)).abs() < 1e-6);
        assert_eq!(turned.point, place(None).point);
        let shifted = Mounted { covariance: Matrix6::identity() * 1e-6, rest_sigma_rad: [0.0; 2] };
        assert!(place(Some(shifted)).covariance_m2.trace() > turned.covariance_m2.trace() + 2.9e-6);
        let resting = place(Some(Mounted { covariance: Matrix6::zeros(), rest_sigma_rad: [0.001, 0.0] }));
        // The neck's axis is some centimeters off the eye.
        assert!((0.0003..0.0009).contains(&resting.sigma_m()), "{}", resting.sigma_m());
    }
}
