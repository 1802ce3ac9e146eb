//! From angles to a point with its covariance. Nothing here takes memory.

use nalgebra::{Matrix3, Matrix4x3, SMatrix, Vector3};
use plumbline_model::{ParameterCovariance, StereoCameras};

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

use super::types::Estimate;

/// Most parameters of two lenses and the pose between them.
const MOST_PARAMETERS: usize = 2 * plumbline_model::camera::MAX_PARAMETERS + 6;

/// Standard deviations of what a point is computed from, rad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sigmas {
    pub plane_rad: f64,
    pub along_rad: f64,
    pub disparity_rad: f64,
}

/// The point at a disparity along a left ray, with the covariance of its measurement; `None` if
/// there is none in front of the eyes.
pub(super) fn triangulate(
    geometry: &EpipolarGeometry,
    ray: &EpipolarRay,
    disparity_rad: f64,
    sigmas: &Sigmas,
) -> Option<Estimate> {
    let point = geometry.point(ray, disparity_rad)?;
    // Differences of a hundredth of a standard deviation: straight enough, far above rounding.
    let step = |sigma: f64| 0.01 * sigma.max(1e-6);
    let (dp, da, dd) = (step(sigmas.plane_rad), step(sigmas.along_rad), step(sigmas.disparity_rad));
    let by = |plane: f64, along: f64, disparity: f64, sigma_per_step: f64| {
        let ray = EpipolarRay { plane_rad: ray.plane_rad + plane, along_rad: ray.along_rad + along };
        let moved = geometry.point(&ray, disparity_rad + disparity)?;
        Some((moved.coords - point.coords) * sigma_per_step)
    };
    let by_plane = by(dp, 0.0, 0.0, sigmas.plane_rad / dp)?;
    let by_along = by(0.0, da, 0.0, sigmas.along_rad / da)?;
    let by_disparity = by(0.0, 0.0, dd, sigmas.disparity_rad / dd)?;
    let covariance_m2 = by_plane * by_plane.transpose()
        + by_along * by_along.transpose()
        + by_disparity * by_disparity.transpose();
    Some(Estimate { point, covariance_m2 })
}

/// Covariance (m²) of a point that comes from the calibration's parameters: to first order, the
/// least-squares triangulation of its own two pixels. `None` where an eye cannot see the point or
/// the covariance is not one of these cameras.
pub(super) fn by_calibration(
    cameras: &StereoCameras,
    parameters: &ParameterCovariance,
    point: &Vector3<f64>,
) -> Option<Matrix3<f64>> {
    let n_left = cameras.left.model.kind().parameter_count();
    let n_right = cameras.right.model.kind().parameter_count();
    let n = n_left + n_right + 6;
    if parameters.matrix.shape() != (n, n) {
        return None;
    }
    let right_from_left = &cameras.right_from_left.isometry;
    let turned = right_from_left.rotation * point;
    let left = cameras.left.model.project_with_jacobian(point).ok()?;
    let right =
        cameras.right.model.project_with_jacobian(&(turned + right_from_left.translation.vector)).ok()?;

    let mut by_point = Matrix4x3::<f64>::zeros();
    by_point.fixed_rows_mut::<2>(0).copy_from(&left.by_point);
    let right_by_left = right.by_point * right_from_left.rotation.to_rotation_matrix();
    by_point.fixed_rows_mut::<2>(2).copy_from(&right_by_left);

    let mut by_parameter = SMatrix::<f64, 4, MOST_PARAMETERS>::zeros();
    for k in 0..n_left {
        by_parameter.fixed_view_mut::<2, 1>(0, k).copy_from(&left.by_parameter.column(k));
    }
    for k in 0..n_right {
        by_parameter.fixed_view_mut::<2, 1>(2, n_left + k).copy_from(&right.by_parameter.column(k));
    }
    let rig = n_left + n_right;
    // A small turn on the left side moves the turned point by turn × point.
    let by_turn = right.by_point * -turned.cross_matrix();
    by_parameter.fixed_view_mut::<2, 3>(2, rig).copy_from(&by_turn);
    by_parameter.fixed_view_mut::<2, 3>(2, rig + 3).copy_from(&right.by_point);

    // The point moves so that its pixels stay where they were seen.
    let normal = (by_point.transpose() * by_point).try_inverse()?;
    let slope = -(normal * by_point.transpose()) * by_parameter;
    let mut covariance = Matrix3::zeros();
    for i in 0..n {
        for j in 0..n {
            let c = parameters.matrix[(i, j)];
            covariance += slope.column(i) * slope.column(j).transpose() * c;
        }
    }
    Some(covariance)
}

/// Makes the covariance larger by that of a shift along a direction.
pub(super) fn add_along(covariance_m2: &mut Matrix3<f64>, direction: &Vector3<f64>, sigma_m: f64) {
    *covariance_m2 += direction * direction.transpose() * sigma_m.powi(2);
}
