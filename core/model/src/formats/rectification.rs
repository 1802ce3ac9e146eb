//! The plain rectification that ROS and OpenCV files carry: a virtual pair of pinholes with the
//! baseline as x axis, looking where both eyes look on average.

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::stereo::StereoCameras;

/// A rectified pair, as `stereoRectify` describes one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rectification {
    /// Rotation from the left camera to its rectified view.
    pub rectified_from_left: Matrix3<f64>,
    /// Rotation from the right camera to its rectified view.
    pub rectified_from_right: Matrix3<f64>,
    /// Focal length of both rectified views, pixels.
    pub focal_px: f64,
    /// Principal point of both rectified views, pixels.
    pub center_px: [f64; 2],
    /// Distance between the eyes, meters.
    pub baseline_m: f64,
}

impl Rectification {
    /// Of a calibrated pair whose eyes look roughly the same way.
    pub fn of(cameras: &StereoCameras) -> Self {
        let right_from_left = cameras.right_from_left.rotation();
        let baseline = cameras.right_from_left.inverse().translation_m();
        let x = baseline.normalize();
        // Row 2 of the rotation is the right eye's optical axis, seen from the left eye.
        let forward = (Vector3::z() + right_from_left.row(2).transpose()).normalize();
        let y = forward.cross(&x).normalize();
        let z = x.cross(&y);
        let rectified_from_left = Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]);
        let focal = |camera: &crate::camera::Camera| {
            let (fx, fy) = camera.model.focal_px();
            0.5 * (fx + fy)
        };
        Self {
            rectified_from_left,
            rectified_from_right: rectified_from_left * right_from_left.transpose(),
            focal_px: 0.5 * (focal(&cameras.left) + focal(&cameras.right)),
            center_px: [
                0.5 * (f64::from(cameras.left.width_px) - 1.0),
                0.5 * (f64::from(cameras.left.height_px) - 1.0),
            ],
            baseline_m: baseline.norm(),
        }
    }

    /// 3×4 projection matrices (left, right), row by row; the right one hides −f·baseline in its
    /// last column.
    pub fn projections(&self) -> [[f64; 12]; 2] {
        let (f, [cx, cy]) = (self.focal_px, self.center_px);
        [0.0, -f * self.baseline_m].map(|tx| [f, 0.0, cx, tx, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0])
    }

    /// OpenCV's Q: from (u, v, disparity, 1) to a point in the rectified left view.
    pub fn disparity_to_depth(&self) -> Matrix4<f64> {
        let [cx, cy] = self.center_px;
        #[rustfmt::skip]
        let q = Matrix4::new(
            1.0, 0.0, 0.0, -cx,
            0.0, 1.0, 0.0, -cy,
            0.0, 0.0, 0.0, self.focal_px,
            0.0, 0.0, 1.0 / self.baseline_m, 0.0,
        );
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::testing::nico_like;

    #[test]
    fn points_share_their_row_and_q_gives_their_depth() {
        let cameras = nico_like();
        let rectified = Rectification::of(&cameras);
        let in_left = Vector3::new(0.05, -0.1, 0.4);
        let in_right = cameras.right_from_left.isometry * nalgebra::Point3::from(in_left);
        let a = rectified.rectified_from_left * in_left;
        let b = rectified.rectified_from_right * in_right.coords;
        assert!((a - b - Vector3::new(rectified.baseline_m, 0.0, 0.0)).norm() < 1e-15, "{a} {b}");

        let (f, [cx, cy]) = (rectified.focal_px, rectified.center_px);
        let disparity = f * (a.x / a.z - b.x / b.z);
        let pixel = nalgebra::Vector4::new(f * a.x / a.z + cx, f * a.y / a.z + cy, disparity, 1.0);
        let point = rectified.disparity_to_depth() * pixel;
        assert!((point.xyz() / point.w - a).norm() < 1e-12);
    }

    #[test]
    fn eyes_without_toe_in_need_no_turning() {
        let mut cameras = nico_like();
        cameras.right_from_left =
            crate::frame::Pose::from_rotation_vector(Vector3::zeros(), Vector3::new(-0.07, 0.0, 0.0));
        let rectified = Rectification::of(&cameras);
        assert!((rectified.rectified_from_left - Matrix3::identity()).amax() < 1e-15);
        assert_eq!(rectified.projections()[1][3], -rectified.focal_px * 0.07);
    }
}
