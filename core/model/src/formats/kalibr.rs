//! Kalibr's camchain: `cam0` is the left eye, `cam1` the right one, `T_cn_cnm1` of `cam1` takes
//! points of `cam0` to `cam1`. `pinhole` + `equidistant` is the fisheye of OpenCV and ROS,
//! `pinhole` + `radtan` the pinhole with k1 k2 p1 p2.

use std::path::Path;

use nalgebra::{Matrix3, Matrix4, Vector3};

use super::document::Document;
use super::error::FormatError;
use super::lens::{self, LensNumbers, StereoNumbers};
use super::node::Field;
use super::{ReadOptions, text_file, yaml};
use crate::camera::{Camera, CameraModel, ModelKind};
use crate::pixel::Eye;
use crate::stereo::StereoCameras;

const NAME: &str = "Kalibr camchain";

/// Writes a camchain. Fails where the format cannot hold the lens: it has no skew, and no third
/// radial coefficient for pinholes.
pub fn write(cameras: &StereoCameras, file: &Path) -> Result<(), FormatError> {
    lens::check_finite(cameras, file)?;
    let mut out = String::new();
    for eye in Eye::BOTH {
        out += &camera(cameras, eye)?;
    }
    text_file::write(file, &out)
}

fn camera(cameras: &StereoCameras, eye: Eye) -> Result<String, FormatError> {
    let camera = cameras.camera(eye);
    let cannot = |what: String, instead| Err(FormatError::CannotCarry { format: NAME, what, instead });
    let (model, coefficients) = match camera.model {
        CameraModel::Fisheye(lens) if lens.skew_px != 0.0 => {
            return cannot(
                format!("the skew of the {eye} camera ({} px)", lens.skew_px),
                "write ROS camera_info or OpenCV FileStorage instead",
            );
        }
        CameraModel::Fisheye(lens) => ("equidistant", lens.k),
        CameraModel::Pinhole(lens) if lens.k3 != 0.0 => {
            return cannot(
                format!("k3 of the {eye} camera ({})", lens.k3),
                "write ROS camera_info or OpenCV FileStorage instead, or calibrate with the fisheye model",
            );
        }
        CameraModel::Pinhole(lens) => ("radtan", [lens.k1, lens.k2, lens.p1, lens.p2]),
    };
    let index = eye.index();
    let mut out = format!("cam{index}:\n");
    if eye == Eye::Right {
        out += "  T_cn_cnm1:\n";
        let matrix = cameras.right_from_left.isometry.to_homogeneous();
        for row in matrix.row_iter() {
            out += &format!("    - {}\n", yaml::numbers(row.iter()));
        }
    }
    let parameters = camera.model.parameters();
    out += &format!(
        "  cam_overlaps: [{}]\n  camera_model: pinhole\n  distortion_coeffs: {}\n  distortion_model: {model}\n",
        1 - index,
        yaml::numbers(&coefficients),
    );
    out += &format!(
        "  intrinsics: {}\n  resolution: [{}, {}]\n  rostopic: /{eye}/image_raw\n",
        yaml::numbers(&parameters[..4]),
        camera.width_px,
        camera.height_px,
    );
    Ok(out)
}

/// Whether the keys are those of a camchain.
pub(crate) fn recognizes(keys: &[&str]) -> bool {
    keys.contains(&"cam0")
}

/// Reads a camchain of two cameras.
pub(crate) fn read(document: &Document, options: &ReadOptions) -> Result<StereoCameras, FormatError> {
    let root = document.root();
    if let Some(third) = root.find("cam2")? {
        return Err(third.out_of_range("absent: a stereo pair has only cam0 (left) and cam1 (right)"));
    }
    let (left, right) = (root.get("cam0")?, root.get("cam1")?);
    let pose = right.get("T_cn_cnm1")?;
    let matrix = read_transform(&pose)?;
    StereoNumbers {
        rotation: lens::rotation(&matrix.fixed_view::<3, 3>(0, 0).into_owned(), &pose.place())?,
        translation: Vector3::new(matrix[(0, 3)], matrix[(1, 3)], matrix[(2, 3)]),
        place: pose.place(),
        swap_advice: "cam0 must be the left eye and cam1 the right one; calibrate with the topics in that order",
    }
    .cameras(read_camera(&left)?, read_camera(&right)?, options)
}

fn read_transform(field: &Field<'_>) -> Result<Matrix4<f64>, FormatError> {
    let rows = field.items()?;
    if rows.len() != 4 {
        return Err(field.wrong_size("4 rows", rows.len().to_string()));
    }
    let mut matrix = Matrix4::zeros();
    for (i, row) in rows.enumerate() {
        let numbers: [f64; 4] = row.exactly()?;
        matrix.set_row(i, &nalgebra::RowVector4::from(numbers));
    }
    if matrix.row(3) != nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0) {
        return Err(field.out_of_range("a rigid transform whose last row is 0 0 0 1"));
    }
    Ok(matrix)
}

fn read_camera(camera: &Field<'_>) -> Result<Camera, FormatError> {
    let model = camera.get("camera_model")?;
    let distortion_model = camera.get("distortion_model")?;
    let (name, distortion_name) = (model.text()?, distortion_model.text()?);
    let unsupported = |field: &Field<'_>, found: String| FormatError::UnsupportedModel {
        place: field.place(),
        found,
        supported: "pinhole with equidistant, radtan or none",
    };
    if name != "pinhole" {
        return Err(unsupported(&model, name));
    }
    let kind = match distortion_name.as_str() {
        "equidistant" | "equi" => ModelKind::Fisheye,
        "radtan" | "none" => ModelKind::Pinhole,
        _ => return Err(unsupported(&distortion_model, distortion_name)),
    };
    let (intrinsics, coefficients) = (camera.get("intrinsics")?, camera.get("distortion_coeffs")?);
    let distortion: Vec<f64> =
        if distortion_name == "none" { Vec::new() } else { coefficients.exactly::<4>()?.to_vec() };
    let [fx, fy, cx, cy] = intrinsics.exactly()?;
    let lens = LensNumbers {
        kind,
        matrix: Matrix3::new(fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0),
        matrix_place: intrinsics.place(),
        distortion,
        distortion_place: coefficients.place(),
    };
    let resolution = camera.get("resolution")?;
    let sizes: Vec<u32> = resolution.items()?.map(|item| item.pixels()).collect::<Result<_, _>>()?;
    let [width_px, height_px] = sizes[..] else {
        return Err(resolution.wrong_size("2 numbers (width, height)", sizes.len().to_string()));
    };
    lens.camera(width_px, height_px)
}
