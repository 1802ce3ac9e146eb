//! A calibration as OpenCV FileStorage.

use std::path::Path;

use nalgebra::{DMatrix, Matrix3};
use opencv::core::{
    FileStorage, FileStorage_FORMAT_JSON, FileStorage_FORMAT_XML, FileStorage_FORMAT_YAML,
    FileStorage_MEMORY, FileStorage_WRITE, FileStorageTrait, Mat, MatTraitConst,
};
use plumbline_model::files;
use plumbline_model::formats::{FormatError, Place, Rectification, lens};
use plumbline_model::{ModelKind, StereoCameras};

/// Writes M1 D1 M2 D2 R T R1 R2 P1 P2 Q, the image size and the lens model, lengths in meters.
/// The extension chooses XML or JSON; anything else is YAML.
pub fn write(cameras: &StereoCameras, file: &Path) -> Result<(), FormatError> {
    lens::check_finite(cameras, file)?;
    let text = render(cameras, file).map_err(|error| FormatError::Syntax {
        place: Place { file: file.to_path_buf(), line: None, key: String::new() },
        language: "OpenCV storage",
        reason: crate::cv_words::words(&error).to_owned(),
    })?;
    Ok(files::write(file, text)?)
}

fn render(cameras: &StereoCameras, file: &Path) -> opencv::Result<String> {
    let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let (format, name) = match extension.as_deref() {
        Some("xml") => (FileStorage_FORMAT_XML, "cameras.xml"),
        Some("json") => (FileStorage_FORMAT_JSON, "cameras.json"),
        _ => (FileStorage_FORMAT_YAML, "cameras.yml"),
    };
    let mut storage = FileStorage::new(name, FileStorage_WRITE | FileStorage_MEMORY | format, "")?;
    write_lenses(&mut storage, cameras)?;
    write_pose(&mut storage, cameras)?;
    storage.release_and_get_string()
}

fn write_lenses(storage: &mut FileStorage, cameras: &StereoCameras) -> opencv::Result<()> {
    let pixels = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
    let (left, right) = (&cameras.left, &cameras.right);
    storage.write_i32("image_width", pixels(left.width_px))?;
    storage.write_i32("image_height", pixels(left.height_px))?;
    if right.size_px() != left.size_px() {
        storage.write_i32("image_width2", pixels(right.width_px))?;
        storage.write_i32("image_height2", pixels(right.height_px))?;
    }
    for (camera, suffix) in [(left, "1"), (right, "2")] {
        let model = match camera.model.kind() {
            ModelKind::Fisheye => "fisheye",
            ModelKind::Pinhole => "plumb_bob",
        };
        let distortion = lens::distortion(camera);
        // OpenCV's own shapes: a column for fisheyes, a row for pinholes.
        let (rows, columns) = match camera.model.kind() {
            ModelKind::Fisheye => (distortion.len(), 1),
            ModelKind::Pinhole => (1, distortion.len()),
        };
        storage.write_str(&format!("distortion_model{suffix}"), model)?;
        write_matrix3(storage, &format!("M{suffix}"), &lens::camera_matrix(camera))?;
        write_matrix(storage, &format!("D{suffix}"), &DMatrix::from_row_slice(rows, columns, &distortion))?;
    }
    Ok(())
}

fn write_pose(storage: &mut FileStorage, cameras: &StereoCameras) -> opencv::Result<()> {
    let translation_m = cameras.right_from_left.translation_m();
    write_matrix3(storage, "R", &cameras.right_from_left.rotation())?;
    write_matrix(storage, "T", &DMatrix::from_column_slice(3, 1, translation_m.as_slice()))?;
    let rectification = Rectification::of(cameras);
    write_matrix3(storage, "R1", &rectification.rectified_from_left)?;
    write_matrix3(storage, "R2", &rectification.rectified_from_right)?;
    for (name, projection) in ["P1", "P2"].iter().zip(rectification.projections()) {
        write_matrix(storage, name, &DMatrix::from_row_slice(3, 4, &projection))?;
    }
    let q = rectification.disparity_to_depth();
    write_matrix(storage, "Q", &DMatrix::from_column_slice(4, 4, q.as_slice()))
}

fn write_matrix3(storage: &mut FileStorage, name: &str, matrix: &Matrix3<f64>) -> opencv::Result<()> {
    write_matrix(storage, name, &DMatrix::from_column_slice(3, 3, matrix.as_slice()))
}

fn write_matrix(storage: &mut FileStorage, name: &str, matrix: &DMatrix<f64>) -> opencv::Result<()> {
    // nalgebra stores columns, OpenCV rows.
    let by_rows = matrix.transpose();
    let mat = Mat::new_rows_cols_with_data(1, by_rows.len() as i32, by_rows.as_slice())?;
    storage.write_mat(name, &mat.reshape(1, matrix.nrows() as i32)?.try_clone()?)
}
