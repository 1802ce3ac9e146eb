//! ROS `camera_info` in YAML, one file per eye, as `camera_calibration` writes and
//! `camera_info_manager` reads it.
//!
//! The pose of the eyes hides in the rectification: with R_l, R_r the rectification matrices and
//! t = K'⁻¹·P\[3\] of the right file (t = (−baseline, 0, 0)), R = R_rᵀ·R_l and T = R_rᵀ·t.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use super::ReadOptions;
use super::document::Document;
use super::error::FormatError;
use super::lens::{self, LensNumbers, StereoNumbers};
use super::node::Field;
use super::rectification::Rectification;
use super::yaml;
use crate::camera::{Camera, ModelKind};
use crate::files::Replacement;
use crate::pixel::Eye;
use crate::stereo::StereoCameras;

const SUPPORTED: &str = "equidistant (fisheye, 4 coefficients) and plumb_bob (pinhole, up to 5)";

/// Writes one file per eye. The camera names in them are `left` and `right`.
pub fn write(cameras: &StereoCameras, left: &Path, right: &Path) -> Result<(), FormatError> {
    lens::check_finite(cameras, left)?;
    let rectification = Rectification::of(cameras);
    let texts = Eye::BOTH.map(|eye| camera_info(cameras, &rectification, eye));
    // Both are complete before either takes its place.
    let replacements = [Replacement::of(left)?, Replacement::of(right)?];
    for (replacement, text) in replacements.iter().zip(&texts) {
        replacement.fill(text)?;
    }
    Ok(replacements.into_iter().try_for_each(Replacement::commit)?)
}

fn camera_info(cameras: &StereoCameras, rectification: &Rectification, eye: Eye) -> String {
    let camera = cameras.camera(eye);
    let model = match camera.model.kind() {
        ModelKind::Fisheye => "equidistant",
        ModelKind::Pinhole => "plumb_bob",
    };
    let rectified_from_eye = match eye {
        Eye::Left => rectification.rectified_from_left,
        Eye::Right => rectification.rectified_from_right,
    };
    let distortion = lens::distortion(camera);
    let mut out =
        format!("image_width: {}\nimage_height: {}\ncamera_name: {eye}\n", camera.width_px, camera.height_px);
    out += &matrix("camera_matrix", 3, 3, lens::camera_matrix(camera).transpose().as_slice());
    out += &format!("distortion_model: {model}\n");
    out += &matrix("distortion_coefficients", 1, distortion.len(), &distortion);
    out += &matrix("rectification_matrix", 3, 3, rectified_from_eye.transpose().as_slice());
    out += &matrix("projection_matrix", 3, 4, &rectification.projections()[eye.index()]);
    out
}

fn matrix(key: &str, rows: usize, columns: usize, data: &[f64]) -> String {
    format!("{key}:\n  rows: {rows}\n  cols: {columns}\n  data: {}\n", yaml::numbers(data))
}

/// What one of the two files says.
struct EyeInfo {
    camera: Camera,
    name: String,
    rectified_from_eye: Matrix3<f64>,
    /// Translation that the projection matrix adds, in the rectified view.
    translation: Vector3<f64>,
}

/// Whether the keys are those of a camera_info file.
pub(crate) fn recognizes(keys: &[&str]) -> bool {
    keys.contains(&"distortion_model") && keys.contains(&"camera_matrix")
}

/// Reads the pair of files, left first.
pub(crate) fn read(
    left: &Document,
    right: &Document,
    options: &ReadOptions,
) -> Result<StereoCameras, FormatError> {
    let infos = [read_eye(&left.root())?, read_eye(&right.root())?];
    for (document, info, eye) in [(left, &infos[0], Eye::Left), (right, &infos[1], Eye::Right)] {
        check_name(document, info, eye)?;
    }
    let [left_info, right_info] = infos;
    let place = right.root().get("projection_matrix")?.place();
    let rectified = [&left_info, &right_info].map(|info| info.rectified_from_eye);
    let right_from_rectified = rectified[1].transpose();
    StereoNumbers {
        rotation: lens::rotation(&(right_from_rectified * rectified[0]), &place)?,
        translation: right_from_rectified * (right_info.translation - left_info.translation),
        place,
        swap_advice: "give the left eye's file first and the right eye's second",
    }
    .cameras(left_info.camera, right_info.camera, options)
}

fn check_name(document: &Document, info: &EyeInfo, eye: Eye) -> Result<(), FormatError> {
    let name = info.name.to_lowercase();
    let other = Eye::BOTH[1 - eye.index()];
    if name.contains(&other.to_string()) && !name.contains(&eye.to_string()) {
        return Err(FormatError::EyesSwapped {
            place: document.root().get("camera_name")?.place(),
            reason: format!(
                "the file given for the {eye} eye says that it is of the camera \"{}\": give the left eye's file first and the right eye's second",
                info.name
            ),
        });
    }
    Ok(())
}

fn read_eye(root: &Field<'_>) -> Result<EyeInfo, FormatError> {
    let model = root.get("distortion_model")?;
    let name = model.text()?;
    let kind = match name.as_str() {
        "equidistant" | "fisheye" => ModelKind::Fisheye,
        "plumb_bob" => ModelKind::Pinhole,
        _ => {
            return Err(FormatError::UnsupportedModel {
                place: model.place(),
                found: name,
                supported: SUPPORTED,
            });
        }
    };
    let (k, d) = (root.get("camera_matrix")?, root.get("distortion_coefficients")?);
    let lens = LensNumbers {
        kind,
        matrix: Matrix3::from_row_slice(&read_matrix(&k, 3, 3)?),
        matrix_place: k.place(),
        distortion: d.get("data")?.numbers()?,
        distortion_place: d.place(),
    };
    let (width_px, height_px) = (root.get("image_width")?.pixels()?, root.get("image_height")?.pixels()?);
    let (r, p) = (root.get("rectification_matrix")?, root.get("projection_matrix")?);
    let rotation = lens::rotation(&Matrix3::from_row_slice(&read_matrix(&r, 3, 3)?), &r.place())?;
    Ok(EyeInfo {
        camera: lens.camera(width_px, height_px)?,
        name: root.find("camera_name")?.map(|name| name.text()).transpose()?.unwrap_or_default(),
        rectified_from_eye: rotation.to_rotation_matrix().into_inner(),
        translation: projection_translation(&p)?,
    })
}

/// t of P = K'·\[I | t\].
fn projection_translation(p: &Field<'_>) -> Result<Vector3<f64>, FormatError> {
    let m = nalgebra::Matrix3x4::from_row_slice(&read_matrix(p, 3, 4)?);
    let k = m.fixed_view::<3, 3>(0, 0).into_owned();
    if !(k[(0, 0)] > 0.0 && k[(1, 1)] > 0.0 && k[(2, 2)] == 1.0) {
        return Err(p.out_of_range("a projection matrix (f 0 cx tx; 0 f cy 0; 0 0 1 0) of a stereo pair"));
    }
    let last = m.column(3);
    // Back substitution; for the usual zero ty and tz it is one exact division.
    let tz = last[2];
    let ty = (last[1] - k[(1, 2)] * tz) / k[(1, 1)];
    let tx = (last[0] - k[(0, 1)] * ty - k[(0, 2)] * tz) / k[(0, 0)];
    Ok(Vector3::new(tx, ty, tz))
}

fn read_matrix(field: &Field<'_>, rows: usize, columns: usize) -> Result<Vec<f64>, FormatError> {
    let data = field.get("data")?;
    let numbers = data.numbers()?;
    let stated = [("rows", rows), ("cols", columns)];
    for (key, expected) in stated {
        if let Some(found) = field.find(key)? {
            let found_count = found.count()?;
            if found_count != expected {
                return Err(found.wrong_size(format!("{expected} {key}"), found_count.to_string()));
            }
        }
    }
    if numbers.len() != rows * columns {
        return Err(data.wrong_size(format!("{rows}×{columns} numbers"), numbers.len().to_string()));
    }
    Ok(numbers)
}
