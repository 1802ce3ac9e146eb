//! How surely two pixels say where a point is.

use nalgebra::{Matrix3, Matrix3x2, Vector3};
use plumbline_model::decompose;
use plumbline_model::{Eye, LeftCamera, ParameterCovariance, Pixel, Point, Raw, StereoCameras};
use plumbline_vision::locate::from_calibration;

/// Where both raw images show a point; `None` where an eye does not see it.
pub fn project_both(cameras: &StereoCameras, point_in_left: Point<LeftCamera>) -> Option<[Pixel<Raw>; 2]> {
    let in_right = cameras.right_from_left * point_in_left;
    let left = cameras.left.project(&point_in_left.coords.coords).ok()?;
    let right = cameras.right.project(&in_right.coords.coords).ok()?;
    (left.is_inside(cameras.left.size_px()) && right.is_inside(cameras.right.size_px()))
        .then_some([left, right])
}

/// Change of distance, straight ahead at `distance_m`, that moves the right image of a point by
/// one pixel, meters. `None` where an eye does not see that place.
pub fn depth_per_px_m(cameras: &StereoCameras, distance_m: f64) -> Option<f64> {
    // Ahead of the middle between the eyes, along the mean of their axes.
    let left_from_right = cameras.right_from_left.inverse();
    let axis = (Vector3::z() + left_from_right.rotation() * Vector3::z()).try_normalize(1e-9)?;
    let middle = 0.5 * left_from_right.translation_m();
    let at = |distance_m: f64| Point::<LeftCamera>::from(nalgebra::Point3::from(middle + axis * distance_m));
    let step_m = 1e-4 * distance_m;
    let [left, right] = project_both(cameras, at(distance_m))?;
    let [left_moved, right_moved] = project_both(cameras, at(distance_m + step_m))?;
    // Both images move; what counts is how much further one moves than the other.
    let moved_px = ((right_moved.vector() - right.vector()) - (left_moved.vector() - left.vector())).norm();
    (moved_px > 0.0).then(|| step_m / moved_px)
}

/// One standard deviation of a triangulated point along its worst direction, meters: from the
/// noise of the match (`match_sigma_px`, each coordinate of each eye) and, if known, from the
/// parameters of the calibration.
pub fn point_sigma_m(
    cameras: &StereoCameras,
    covariance: Option<&ParameterCovariance>,
    point_in_left: Point<LeftCamera>,
    match_sigma_px: f64,
) -> Option<f64> {
    let pixels = project_both(cameras, point_in_left)?;
    let mut sum = Matrix3::<f64>::zeros();
    for eye in Eye::BOTH {
        let by_pixel = by_pixel(cameras, pixels, eye)?;
        sum += by_pixel * by_pixel.transpose() * match_sigma_px.powi(2);
    }
    if let Some(covariance) = covariance {
        sum += from_calibration(cameras, covariance, pixels[0], pixels[1])?;
    }
    let largest = decompose::symmetric_eigenvalues(sum)?.max();
    (largest.is_finite() && largest >= 0.0).then(|| largest.sqrt())
}

/// d(point) / d(pixel of one eye), by central differences.
fn by_pixel(cameras: &StereoCameras, pixels: [Pixel<Raw>; 2], eye: Eye) -> Option<Matrix3x2<f64>> {
    const STEP_PX: f64 = 1e-3;
    let mut jacobian = Matrix3x2::zeros();
    for axis in 0..2 {
        let shifted = |sign: f64| {
            let mut shifted = pixels;
            let mut vector = shifted[eye.index()].vector();
            vector[axis] += sign * STEP_PX;
            shifted[eye.index()] = vector.into();
            cameras.triangulate(shifted[0], shifted[1]).map(|point| point.coords.coords)
        };
        jacobian.set_column(axis, &((shifted(1.0)? - shifted(-1.0)?) / (2.0 * STEP_PX)));
    }
    Some(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eyes::place::nominal_cameras;
    use nalgebra::DMatrix;
    use plumbline_model::{ModelKind, Pose};

    fn cameras() -> StereoCameras {
        let mut cameras = nominal_cameras((640, 480), ModelKind::Fisheye);
        cameras.right_from_left =
            Pose::from_rotation_vector(Vector3::new(0.01, -0.03, 0.02), Vector3::new(-0.07, 0.001, 0.002));
        cameras
    }

    #[test]
    fn depth_per_pixel_is_z_squared_over_f_times_baseline() {
        let parallel = nominal_cameras((640, 480), ModelKind::Pinhole);
        let expected_m = 0.45f64.powi(2) / (0.8 * 640.0 * 0.07);
        let measured_m = depth_per_px_m(&parallel, 0.45).expect("seen");
        assert!((measured_m / expected_m - 1.0).abs() < 1e-3, "{measured_m} instead of {expected_m}");
    }

    #[test]
    fn the_uncertainty_agrees_with_the_spread_of_noisy_matches() {
        let (cameras, point, sigma_px) = (cameras(), Point::<LeftCamera>::new(0.05, 0.1, 0.4), 0.1);
        let predicted_m = point_sigma_m(&cameras, None, point, sigma_px).expect("seen");
        let pixels = project_both(&cameras, point).expect("seen");
        // All corners of the noise hypercube have the same variance as the noise itself.
        let mut sum = Matrix3::<f64>::zeros();
        for corner in 0..16u32 {
            let sign = |bit: u32| if corner >> bit & 1 == 1 { sigma_px } else { -sigma_px };
            let noisy = [
                Pixel::new(pixels[0].u_px + sign(0), pixels[0].v_px + sign(1)),
                Pixel::new(pixels[1].u_px + sign(2), pixels[1].v_px + sign(3)),
            ];
            let error = cameras.triangulate(noisy[0], noisy[1]).expect("in front").coords - point.coords;
            sum += error * error.transpose() / 16.0;
        }
        let spread_m = decompose::symmetric_eigenvalues(sum).expect("finite").max().sqrt();
        assert!((predicted_m / spread_m - 1.0).abs() < 0.02, "{predicted_m} against {spread_m}");
    }

    #[test]
    fn an_uncertain_baseline_makes_far_points_uncertain_in_proportion() {
        let cameras = nominal_cameras((640, 480), ModelKind::Fisheye);
        let mut matrix = DMatrix::zeros(22, 22);
        matrix[(19, 19)] = 0.0007f64.powi(2);
        let covariance = ParameterCovariance { matrix };
        let point = Point::<LeftCamera>::new(0.0, 0.0, 0.4);
        let sigma_m = point_sigma_m(&cameras, Some(&covariance), point, 0.0).expect("seen");
        // 1 % of baseline is 1 % of everything.
        assert!((sigma_m - 0.004).abs() < 2e-5, "{sigma_m}");
    }
}
