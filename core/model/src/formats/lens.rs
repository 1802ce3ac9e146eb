//! From camera matrix and distortion coefficients, as most programs store them, to a lens and
//! back; and the checks that every calibration of another program must pass.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::ReadOptions;
use super::error::{FormatError, Place};
use crate::camera::{Camera, CameraModel, Fisheye, ModelKind, Pinhole};
use crate::frame::{LeftCamera, Pose, RightCamera};
use crate::pixel::Eye;
use crate::plausible;
use crate::stereo::StereoCameras;

/// Farther apart than this (m) no pair of eyes sits; the file is then in another unit.
pub const LARGEST_PLAUSIBLE_BASELINE_M: f64 = plausible::BASELINE_M.most;

/// Closer together than this (m) two optical centers are one.
const SMALLEST_BASELINE_M: f64 = plausible::BASELINE_M.least;

/// Matrices printed with five digits miss being rotations by less than this.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// The numbers of a lens and the places where they stand, for messages.
#[derive(Clone, Debug)]
pub struct LensNumbers {
    /// Which formula the coefficients belong to.
    pub kind: ModelKind,
    /// fx, skew, cx; 0, fy, cy; 0, 0, 1.
    pub matrix: Matrix3<f64>,
    /// Where the matrix stands.
    pub matrix_place: Place,
    /// k1 k2 k3 k4 of a fisheye; k1 k2 p1 p2 [k3 …] of a pinhole.
    pub distortion: Vec<f64>,
    /// Where the coefficients stand.
    pub distortion_place: Place,
}

impl LensNumbers {
    /// The camera with an image of this size, if the numbers make one.
    pub fn camera(&self, width_px: u32, height_px: u32) -> Result<Camera, FormatError> {
        let camera = Camera { model: self.model()?, width_px, height_px };
        match camera.check_plausible() {
            Ok(()) => Ok(camera),
            Err(what) => {
                let of_coefficients =
                    [plausible::FISHEYE_K, plausible::PINHOLE_K].iter().any(|k| k.name == what.quantity.name);
                let place = if of_coefficients { &self.distortion_place } else { &self.matrix_place };
                Err(FormatError::Implausible { place: place.clone(), what: Box::new(what) })
            }
        }
    }

    /// The lens, if the numbers make one.
    pub fn model(&self) -> Result<CameraModel, FormatError> {
        let m = &self.matrix;
        let wrong = |expected: &str, found: String| FormatError::OutOfRange {
            place: self.matrix_place.clone(),
            expected: expected.to_owned(),
            found,
        };
        if !(m[(0, 0)] > 0.0 && m[(1, 1)] > 0.0) {
            return Err(wrong(
                "a camera matrix with focal lengths greater than zero",
                format!("{} and {}", m[(0, 0)], m[(1, 1)]),
            ));
        }
        if [m[(1, 0)], m[(2, 0)], m[(2, 1)], m[(2, 2)] - 1.0].iter().any(|&x| x != 0.0) {
            return Err(wrong(
                "a camera matrix (fx s cx; 0 fy cy; 0 0 1), row by row",
                format!("{:?}", m.transpose().as_slice()),
            ));
        }
        match self.kind {
            ModelKind::Fisheye => self.fisheye(),
            ModelKind::Pinhole => self.pinhole(wrong),
        }
    }

    fn fisheye(&self) -> Result<CameraModel, FormatError> {
        let k = <[f64; 4]>::try_from(self.distortion.as_slice())
            .map_err(|_| self.wrong_count("4 coefficients (k1 k2 k3 k4)"))?;
        let m = &self.matrix;
        Ok(CameraModel::Fisheye(Fisheye {
            fx_px: m[(0, 0)],
            fy_px: m[(1, 1)],
            cx_px: m[(0, 2)],
            cy_px: m[(1, 2)],
            skew_px: m[(0, 1)],
            k,
        }))
    }

    fn pinhole(&self, wrong: impl Fn(&str, String) -> FormatError) -> Result<CameraModel, FormatError> {
        let (m, d) = (&self.matrix, &self.distortion);
        if m[(0, 1)] != 0.0 {
            return Err(wrong("a pinhole camera matrix without skew", format!("skew {}", m[(0, 1)])));
        }
        if !matches!(d.len(), 0 | 4 | 5 | 8 | 12 | 14) {
            return Err(self.wrong_count("4 or 5 coefficients (k1 k2 p1 p2 k3)"));
        }
        if d.iter().skip(5).any(|&k| k != 0.0) {
            return Err(FormatError::UnsupportedModel {
                place: self.distortion_place.clone(),
                found: format!("rational or thin-prism pinhole with {} coefficients", d.len()),
                supported: "fisheye with k1 k2 k3 k4 and pinhole with k1 k2 p1 p2 k3",
            });
        }
        let k = |i: usize| d.get(i).copied().unwrap_or(0.0);
        Ok(CameraModel::Pinhole(Pinhole {
            fx_px: m[(0, 0)],
            fy_px: m[(1, 1)],
            cx_px: m[(0, 2)],
            cy_px: m[(1, 2)],
            k1: k(0),
            k2: k(1),
            p1: k(2),
            p2: k(3),
            k3: k(4),
        }))
    }

    fn wrong_count(&self, expected: &str) -> FormatError {
        FormatError::WrongSize {
            place: self.distortion_place.clone(),
            expected: expected.to_owned(),
            found: self.distortion.len().to_string(),
        }
    }
}

/// Camera matrix of a lens, its skew included.
pub fn camera_matrix(camera: &Camera) -> Matrix3<f64> {
    let (fx, fy) = camera.model.focal_px();
    let center = camera.model.principal_point();
    let skew = match camera.model {
        CameraModel::Fisheye(lens) => lens.skew_px,
        CameraModel::Pinhole(_) => 0.0,
    };
    Matrix3::new(fx, skew, center.u_px, 0.0, fy, center.v_px, 0.0, 0.0, 1.0)
}

/// Distortion coefficients of a lens, in OpenCV's order.
pub fn distortion(camera: &Camera) -> Vec<f64> {
    camera.model.parameters()[4..].to_vec()
}

/// A rotation from its matrix. Rounding is repaired; anything worse is an error.
pub fn rotation(matrix: &Matrix3<f64>, place: &Place) -> Result<UnitQuaternion<f64>, FormatError> {
    let deviation = if matrix.determinant() > 0.0 {
        (matrix.transpose() * matrix - Matrix3::identity()).amax()
    } else {
        2.0
    };
    if deviation.is_nan() || deviation > ROTATION_TOLERANCE {
        return Err(FormatError::NotARotation { place: place.clone(), deviation });
    }
    let nearest = if deviation > 1e-14 { nearest_rotation(matrix) } else { *matrix };
    let quaternion = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(nearest));
    Ok(UnitQuaternion::new_normalize(quaternion.into_inner()))
}

fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    // Newton's iteration to the orthogonal polar factor; so close to it, a few steps do.
    let mut nearest = *matrix;
    for _ in 0..6 {
        if let Some(inverse) = nearest.try_inverse() {
            nearest = 0.5 * (nearest + inverse.transpose());
        }
    }
    nearest
}

/// How the eyes sit to each other, as a file gives it, before the unit of length is applied.
#[derive(Clone, Debug)]
pub struct StereoNumbers {
    /// Rotation of `right_from_left`.
    pub rotation: UnitQuaternion<f64>,
    /// Translation of `right_from_left`, in the file's unit.
    pub translation: Vector3<f64>,
    /// Where the translation stands.
    pub place: Place,
    /// What to do when the eyes are the wrong way round.
    pub swap_advice: &'static str,
}

impl StereoNumbers {
    /// The calibrated pair, if it is one that eyes can form.
    pub fn cameras(
        &self,
        left: Camera,
        right: Camera,
        options: &ReadOptions,
    ) -> Result<StereoCameras, FormatError> {
        let unit_m = options.length_unit.map_or(1.0, |unit| unit.meters());
        let translation_m = self.translation * unit_m;
        let baseline_m = translation_m.norm();
        if baseline_m.is_nan() || baseline_m < SMALLEST_BASELINE_M {
            return Err(FormatError::NoBaseline { place: self.place.clone(), baseline_m });
        }
        if options.length_unit.is_none() && baseline_m > LARGEST_PLAUSIBLE_BASELINE_M {
            return Err(FormatError::ImplausibleBaseline { place: self.place.clone(), baseline_m });
        }
        let right_from_left = Pose::<RightCamera, LeftCamera>::new(Isometry3::from_parts(
            Translation3::from(translation_m),
            self.rotation,
        ));
        let right_eye_in_left = right_from_left.inverse().translation_m();
        if right_eye_in_left.x <= 0.0 {
            return Err(FormatError::EyesSwapped {
                place: self.place.clone(),
                reason: format!(
                    "the right eye would sit {:.4} m to the left of the left eye: {}",
                    -right_eye_in_left.x, self.swap_advice
                ),
            });
        }
        Ok(StereoCameras { left, right, right_from_left })
    }
}

/// Refuses to write numbers that no reader could use.
pub fn check_finite(cameras: &StereoCameras, file: &Path) -> Result<(), FormatError> {
    let pose = &cameras.right_from_left.isometry;
    let mut numbers: Vec<(String, f64)> = Vec::new();
    for eye in Eye::BOTH {
        let camera = cameras.camera(eye);
        let names = camera.model.kind().parameter_names();
        numbers.extend(
            names.iter().zip(camera.model.parameters()).map(|(name, x)| (format!("{eye}.{name}"), x)),
        );
        numbers.push((format!("{eye}.skew"), camera_matrix(camera)[(0, 1)]));
    }
    numbers.extend(pose.rotation.coords.iter().map(|&x| ("right_from_left.rotation".to_owned(), x)));
    numbers.extend(pose.translation.vector.iter().map(|&x| ("right_from_left.translation".to_owned(), x)));
    match numbers.into_iter().find(|(_, x)| !x.is_finite()) {
        Some((key, x)) => Err(FormatError::NotFinite {
            place: Place { file: file.to_path_buf(), line: None, key },
            found: x.to_string(),
        }),
        None => Ok(()),
    }
}
