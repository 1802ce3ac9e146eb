//! The pipeline published for this robot.
//!
//! It rectifies the whole fisheye view to 640×480 px at a focal length of only 35 px, matches with
//! OpenCV's three-way semi-global matcher over 192 disparities in both directions, smooths with the
//! weighted-least-squares filter and reprojects.

use image::GrayImage;
use opencv::calib3d::{
    StereoMatcherTrait, StereoSGBM, StereoSGBM_MODE_SGBM_3WAY, fisheye_init_undistort_rectify_map,
    fisheye_stereo_rectify, reproject_image_to_3d,
};
use opencv::core::{BORDER_CONSTANT, CV_16SC2, CV_32F, Mat, MatTraitConst, Ptr, Rect, Scalar, Size};
use opencv::imgproc::{INTER_LINEAR, remap};
use opencv::prelude::{DisparityFilterTrait, DisparityWLSFilterTrait};
use opencv::ximgproc::{DisparityWLSFilter, create_disparity_wls_filter, create_right_matcher};
use plumbline_model::{CameraModel, Eye, StereoCameras};

use super::{ComparisonError, PUBLISHED_F_PX};
use crate::mat;
use crate::rectify::Pair;

/// Column of their axes, left and right.
const PUBLISHED_CX_PX: [f64; 2] = [300.237, 246.677];
/// Row of their axes.
const PUBLISHED_CY_PX: f64 = 233.738;

/// Rows of numbers as OpenCV wants them.
fn matrix<const ROWS: usize>(rows: &[[f64; 4]; ROWS]) -> Result<Mat, opencv::Error> {
    Mat::from_slice(rows.as_flattened())?.reshape(1, ROWS as i32)?.try_clone()
}

/// The published pipeline.
pub struct PublishedPipeline {
    maps: Pair<[Mat; 2]>,
    q: Mat,
    left: Ptr<StereoSGBM>,
    right: Ptr<opencv::calib3d::StereoMatcher>,
    filter: Ptr<DisparityWLSFilter>,
}

impl PublishedPipeline {
    /// Its rectification (balance 0, field of view scaled by 0.6) and its matcher.
    pub fn new(cameras: &StereoCameras) -> Result<Self, ComparisonError> {
        let size = Size::new(cameras.left.width_px as i32, cameras.left.height_px as i32);
        let (k_left, d_left) = intrinsics(cameras, Eye::Left)?;
        let (k_right, d_right) = intrinsics(cameras, Eye::Right)?;
        let rotation = cameras.right_from_left.rotation();
        // Column-major memory of the transpose is row-major memory of the matrix.
        let r = Mat::from_slice(rotation.transpose().as_slice())?.reshape(1, 3)?.try_clone()?;
        let t = Mat::from_slice(cameras.right_from_left.translation_m().as_slice())?
            .reshape(1, 3)?
            .try_clone()?;
        let [mut r1, mut r2, mut unused_p1, mut unused_p2, mut unused_q] =
            std::array::from_fn(|_| Mat::default());
        fisheye_stereo_rectify(
            &k_left,
            &d_left,
            &k_right,
            &d_right,
            size,
            &r,
            &t,
            &mut r1,
            &mut r2,
            &mut unused_p1,
            &mut unused_p2,
            &mut unused_q,
            0,
            size,
            0.0,
            0.6,
        )?;
        // The projection is the published one: what OpenCV proposes for a lens that sees 90° off
        // its axis differs from version to version, down to a focal length of one pixel.
        let (f, cy) = (PUBLISHED_F_PX, PUBLISHED_CY_PX);
        let [cx_left, cx_right] = PUBLISHED_CX_PX;
        let baseline_m = cameras.baseline_m();
        let p = |cx: f64, shift: f64| matrix(&[[f, 0.0, cx, shift], [0.0, f, cy, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        let (p1, p2) = (p(cx_left, 0.0)?, p(cx_right, -f * baseline_m)?);
        let q = matrix(&[
            [1.0, 0.0, 0.0, -cx_left],
            [0.0, 1.0, 0.0, -cy],
            [0.0, 0.0, 0.0, f],
            [0.0, 0.0, 1.0 / baseline_m, -(cx_left - cx_right) / baseline_m],
        ])?;
        let maps = |k: &Mat, d: &Mat, r: &Mat, p: &Mat| -> Result<[Mat; 2], opencv::Error> {
            let [mut whole, mut fraction] = [Mat::default(), Mat::default()];
            fisheye_init_undistort_rectify_map(k, d, r, p, size, CV_16SC2, &mut whole, &mut fraction)?;
            Ok([whole, fraction])
        };
        let maps =
            Pair { left: maps(&k_left, &d_left, &r1, &p1)?, right: maps(&k_right, &d_right, &r2, &p2)? };
        let sgbm = || StereoSGBM::create(0, 192, 5, 600, 2400, 1, 0, 15, 200, 2, StereoSGBM_MODE_SGBM_3WAY);
        let left = sgbm()?;
        let right = create_right_matcher(sgbm()?.into())?;
        let mut filter = create_disparity_wls_filter(sgbm()?.into())?;
        filter.set_lambda(8000.0)?;
        filter.set_sigma_color(1.5)?;
        Ok(Self { maps, q, left, right, filter })
    }

    /// Rectifies, matches, filters and places one raw gray pair: x, y, z per pixel.
    pub fn run(&mut self, left: &GrayImage, right: &GrayImage) -> Result<Mat, opencv::Error> {
        let view = |image: &GrayImage, [whole, fraction]: &[Mat; 2]| -> Result<Mat, opencv::Error> {
            let mut view = Mat::default();
            remap(
                &mat::gray(image)?,
                &mut view,
                whole,
                fraction,
                INTER_LINEAR,
                BORDER_CONSTANT,
                Scalar::default(),
            )?;
            Ok(view)
        };
        let (left, right) = (view(left, &self.maps.left)?, view(right, &self.maps.right)?);
        let [mut left_disparity, mut right_disparity, mut filtered, mut scaled, mut points] =
            std::array::from_fn(|_| Mat::default());
        self.left.compute(&left, &right, &mut left_disparity)?;
        self.right.compute(&right, &left, &mut right_disparity)?;
        let everywhere = Rect::default();
        self.filter.filter(&left_disparity, &left, &mut filtered, &right_disparity, everywhere, &right)?;
        filtered.convert_to(&mut scaled, CV_32F, 1.0 / 16.0, 0.0)?;
        reproject_image_to_3d(&scaled, &mut points, &self.q, false, -1)?;
        Ok(points)
    }
}

/// Camera matrix and distortion as OpenCV wants them.
fn intrinsics(cameras: &StereoCameras, eye: Eye) -> Result<(Mat, Mat), ComparisonError> {
    let CameraModel::Fisheye(m) = cameras.camera(eye).model else { return Err(ComparisonError::NotFisheye) };
    let k = [m.fx_px, m.skew_px, m.cx_px, 0.0, m.fy_px, m.cy_px, 0.0, 0.0, 1.0];
    let k = Mat::from_slice(&k)?.reshape(1, 3)?.try_clone()?;
    let d = Mat::from_slice(&m.k)?.reshape(1, 4)?.try_clone()?;
    Ok((k, d))
}
