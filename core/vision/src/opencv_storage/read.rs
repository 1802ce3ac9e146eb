//! OpenCV FileStorage as a calibration.

use std::path::{Path, PathBuf};

use nalgebra::{DMatrix, Matrix3, Vector3};
use opencv::core::{
    CV_64F, FileNode, FileNodeTraitConst, FileStorage, FileStorage_MEMORY, FileStorage_READ,
    FileStorageTraitConst, Mat, MatTraitConst, MatTraitConstManual,
};
use plumbline_model::camera::Camera;
use plumbline_model::files::shortened;
use plumbline_model::formats::lens::{self, LensNumbers, StereoNumbers};
use plumbline_model::formats::{FormatError, Place, ReadOptions, depth, is_opencv_storage, read_text};
use plumbline_model::{Eye, ModelKind, StereoCameras};

/// Names under which scripts store the same thing, for the left and the right eye.
const CAMERA_MATRIX: [&[&str]; 2] = [
    &["M1", "K1", "cameraMatrix1", "camera_matrix_1", "camera_matrix_left", "left_camera_matrix", "K_left"],
    &[
        "M2",
        "K2",
        "cameraMatrix2",
        "camera_matrix_2",
        "camera_matrix_right",
        "right_camera_matrix",
        "K_right",
    ],
];
const DISTORTION: [&[&str]; 2] = [
    &[
        "D1",
        "distCoeffs1",
        "dist_coeffs_1",
        "dist_coeffs_left",
        "left_dist_coeffs",
        "distortion_left",
        "D_left",
    ],
    &[
        "D2",
        "distCoeffs2",
        "dist_coeffs_2",
        "dist_coeffs_right",
        "right_dist_coeffs",
        "distortion_right",
        "D_right",
    ],
];
const MODEL: [&[&str]; 2] = [
    &["distortion_model1", "distortion_model", "camera_model"],
    &["distortion_model2", "distortion_model", "camera_model"],
];
const WIDTH: [&[&str]; 2] = [&["image_width"], &["image_width2", "image_width"]];
const HEIGHT: [&[&str]; 2] = [&["image_height"], &["image_height2", "image_height"]];
const SIZE: &[&str] = &["image_size", "imageSize", "size"];
const ROTATION: &[&str] = &["R", "rotation", "rotation_matrix"];
const TRANSLATION: &[&str] = &["T", "translation", "translation_vector"];

/// Reads a stereo calibration from one file, or from several that hold its parts.
pub fn read(files: &[PathBuf], options: &ReadOptions) -> Result<StereoCameras, FormatError> {
    let storages = Storages { all: files.iter().map(|file| Storage::open(file)).collect::<Result<_, _>>()? };
    let left = storages.camera(Eye::Left, options)?;
    let right = storages.camera(Eye::Right, options)?;
    let rotation = storages.matrix(ROTATION)?.sized(3, 3)?;
    let translation = storages.matrix(TRANSLATION)?.vector(&[3], "3 numbers")?;
    StereoNumbers {
        rotation: lens::rotation(&Matrix3::from_column_slice(rotation.values.as_slice()), &rotation.place)?,
        translation: Vector3::from_column_slice(&translation.values.as_slice()[..3]),
        place: translation.place,
        swap_advice: "M1 and D1 must be the left eye's, M2 and D2 the right eye's, and R, T must take points of the left eye to the right one; calibrate with the images in that order",
    }
    .cameras(left, right, options)
}

struct Storages {
    all: Vec<Storage>,
}

struct Storage {
    file: PathBuf,
    text: String,
    storage: FileStorage,
}

/// A node that was found.
struct Entry {
    place: Place,
    node: FileNode,
}

/// A matrix of finite numbers.
struct Matrix {
    place: Place,
    values: DMatrix<f64>,
}

impl Storage {
    fn open(file: &Path) -> Result<Self, FormatError> {
        let text = read_text(file)?;
        if !is_opencv_storage(&text) {
            return Err(FormatError::Unrecognized {
                file: file.to_path_buf(),
                keys: "it is not marked as OpenCV's".to_owned(),
            });
        }
        let refused = |message: &str| {
            let (line, reason) = parser_message(message);
            let place = Place { file: file.to_path_buf(), line, key: String::new() };
            FormatError::Syntax { place, language: "OpenCV storage", reason }
        };
        // OpenCV works its way down by calling itself.
        let nested =
            if text.trim_start().starts_with('<') { depth::of_xml(&text) } else { depth::of_yaml(&text) };
        depth::check(nested).map_err(|reason| FormatError::Syntax {
            place: Place { file: file.to_path_buf(), line: None, key: String::new() },
            language: "OpenCV storage",
            reason,
        })?;
        if let Some((line, tag)) = strange_tag(&text) {
            let place = Place { file: file.to_path_buf(), line: Some(line), key: String::new() };
            let reason = format!("it has the tag \"{tag}\", which OpenCV does not write");
            return Err(FormatError::Syntax { place, language: "OpenCV storage", reason });
        }
        let storage = FileStorage::new(&text, FileStorage_READ | FileStorage_MEMORY, "")
            .map_err(|error| refused(&error.message))?;
        match storage.is_opened() {
            Ok(true) => Ok(Self { file: file.to_path_buf(), text, storage }),
            _ => Err(refused("OpenCV does not accept it")),
        }
    }

    fn find(&self, name: &str) -> Option<Entry> {
        let node = self.storage.get(name).ok()?;
        (!node.empty().ok()?).then(|| Entry {
            place: Place { file: self.file.clone(), line: self.line_of(name), key: name.to_owned() },
            node,
        })
    }

    /// OpenCV does not tell lines; a top-level key stands at the start of one.
    fn line_of(&self, name: &str) -> Option<usize> {
        let starts = [format!("{name}:"), format!("<{name}>"), format!("<{name} "), format!("\"{name}\"")];
        let at = self.text.lines().position(|line| {
            let line = line.trim_start_matches([' ', '\t', '{']);
            starts.iter().any(|start| line.starts_with(start))
        });
        at.map(|index| index + 1)
    }
}

/// The first tag of YAML that is not one of OpenCV behind a key, with its line: OpenCV's parser never
/// comes back from some others.
fn strange_tag(text: &str) -> Option<(usize, String)> {
    if text.trim_start().starts_with('<') {
        return None;
    }
    text.lines().enumerate().find_map(|(index, line)| {
        let at = line.find('!')?;
        let before = line[..at].trim_end();
        let is_text = before.contains(['"', '\'', '#']);
        let is_known = before.ends_with(':') && line[at..].starts_with("!!opencv-");
        (!is_text && !is_known).then(|| (index + 1, shortened(&line[at..])))
    })
}

/// OpenCV hides line and reason in its message: `… in function '(60): Bad format …'`.
fn parser_message(message: &str) -> (Option<usize>, String) {
    let message = message.trim().trim_end_matches('\'');
    let (line, reason) = match message.rsplit_once("): ") {
        Some((head, reason)) => (head.rsplit_once('(').and_then(|(_, line)| line.parse().ok()), reason),
        None => (None, message),
    };
    if crate::cv_words::is_raw(reason) {
        log::warn!("OpenCV: {message}");
        return (line, "OpenCV cannot make sense of it".to_owned());
    }
    (line, reason.to_owned())
}

impl Storages {
    fn find(&self, names: &[&str]) -> Option<Entry> {
        names.iter().find_map(|name| self.all.iter().find_map(|storage| storage.find(name)))
    }

    fn missing(&self, names: &[&str]) -> FormatError {
        let file = self.all.first().map(|storage| storage.file.clone()).unwrap_or_default();
        FormatError::Missing {
            place: Place { file, line: None, key: names[0].to_owned() },
            or: names[1..].iter().map(|&name| name.to_owned()).collect(),
        }
    }

    fn matrix(&self, names: &[&str]) -> Result<Matrix, FormatError> {
        self.find(names).ok_or_else(|| self.missing(names))?.matrix()
    }

    fn camera(&self, eye: Eye, options: &ReadOptions) -> Result<Camera, FormatError> {
        let side = eye.index();
        let matrix = self.matrix(CAMERA_MATRIX[side])?.sized(3, 3)?;
        let distortion = self
            .matrix(DISTORTION[side])?
            .vector(&[4, 5, 8, 12, 14], "4 coefficients (fisheye) or 5 (pinhole)")?;
        let count = distortion.values.len();
        let kind = match (options.model, self.model(MODEL[side])?) {
            (Some(kind), _) | (None, Some(kind)) => kind,
            (None, None) if count == 4 => ModelKind::Fisheye,
            (None, None) => ModelKind::Pinhole,
        };
        let (width_px, height_px) = self.image_size(side, options)?;
        let lens = LensNumbers {
            kind,
            matrix: Matrix3::from_column_slice(matrix.values.as_slice()),
            matrix_place: matrix.place,
            distortion: distortion.values.as_slice().to_vec(),
            distortion_place: distortion.place,
        };
        lens.camera(width_px, height_px)
    }

    fn model(&self, names: &[&str]) -> Result<Option<ModelKind>, FormatError> {
        let Some(entry) = self.find(names) else { return Ok(None) };
        let name = entry.node.string().unwrap_or_default();
        match name.to_lowercase().as_str() {
            "fisheye" | "equidistant" => Ok(Some(ModelKind::Fisheye)),
            "pinhole" | "plumb_bob" | "radtan" => Ok(Some(ModelKind::Pinhole)),
            _ => Err(FormatError::UnsupportedModel {
                place: entry.place,
                found: name,
                supported: "fisheye (or equidistant) and pinhole (or plumb_bob)",
            }),
        }
    }

    fn image_size(&self, side: usize, options: &ReadOptions) -> Result<(u32, u32), FormatError> {
        let in_file = (self.find(WIDTH[side]), self.find(HEIGHT[side]));
        if let (Some(width), Some(height)) = in_file {
            return Ok((width.pixels(&width.node)?, height.pixels(&height.node)?));
        }
        if let Some(entry) = self.find(SIZE) {
            let element =
                |i: i32| entry.node.at(i).map_err(|_| entry.wrong_type("[width, height] in pixels"));
            return Ok((entry.pixels(&element(0)?)?, entry.pixels(&element(1)?)?));
        }
        options.image_size_px.ok_or_else(|| {
            self.missing(&["image_width", "image_height", "image_size", "or the size given when reading"])
        })
    }
}

impl Entry {
    fn wrong_type(&self, expected: &str) -> FormatError {
        FormatError::WrongType {
            place: self.place.clone(),
            expected: expected.to_owned(),
            found: self.describe(),
        }
    }

    fn describe(&self) -> String {
        let node = &self.node;
        let is = |answer: opencv::Result<bool>| answer.unwrap_or(false);
        if is(node.is_string()) {
            format!("the text \"{}\"", node.string().unwrap_or_default())
        } else if is(node.is_int()) || is(node.is_real()) {
            "a single number".to_owned()
        } else if is(node.is_seq()) {
            "a list".to_owned()
        } else {
            "something else".to_owned()
        }
    }

    fn pixels(&self, node: &FileNode) -> Result<u32, FormatError> {
        let number = match (node.is_int(), node.is_real()) {
            (Ok(true), _) | (_, Ok(true)) => node.real().ok(),
            _ => None,
        };
        let number = number.ok_or_else(|| self.wrong_type("a number of pixels"))?;
        if (1.0..=1e6).contains(&number) && number.fract() == 0.0 {
            Ok(number as u32)
        } else {
            Err(FormatError::OutOfRange {
                place: self.place.clone(),
                expected: "a whole number of pixels, at least 1".to_owned(),
                found: number.to_string(),
            })
        }
    }

    fn matrix(self) -> Result<Matrix, FormatError> {
        let doubles = self.doubles().map_err(|_| self.wrong_type("a matrix of numbers (opencv-matrix)"))?;
        let (rows, columns, values) = doubles;
        if values.is_empty() || values.len() != rows * columns {
            return Err(self.wrong_type("a matrix of numbers (opencv-matrix)"));
        }
        if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
            return Err(FormatError::NotFinite { place: self.place, found: bad.to_string() });
        }
        Ok(Matrix { place: self.place, values: DMatrix::from_row_slice(rows, columns, &values) })
    }

    fn doubles(&self) -> opencv::Result<(usize, usize, Vec<f64>)> {
        let mat = self.node.mat()?;
        let mut doubles = Mat::default();
        mat.convert_to_def(&mut doubles, CV_64F)?;
        let (rows, columns) = (doubles.rows().max(0) as usize, doubles.cols().max(0) as usize);
        if doubles.empty() || doubles.channels() != 1 {
            return Ok((rows, columns, Vec::new()));
        }
        Ok((rows, columns, doubles.try_clone()?.data_typed::<f64>()?.to_vec()))
    }
}

impl Matrix {
    fn wrong_size(&self, expected: &str) -> FormatError {
        FormatError::WrongSize {
            place: self.place.clone(),
            expected: expected.to_owned(),
            found: format!("{}×{}", self.values.nrows(), self.values.ncols()),
        }
    }

    fn sized(self, rows: usize, columns: usize) -> Result<Self, FormatError> {
        if self.values.shape() == (rows, columns) {
            Ok(self)
        } else {
            Err(self.wrong_size(&format!("{rows}×{columns} numbers")))
        }
    }

    /// One row or one column of as many elements as one of `counts`.
    fn vector(self, counts: &[usize], expected: &str) -> Result<Self, FormatError> {
        let (rows, columns) = self.values.shape();
        if (rows == 1 || columns == 1) && counts.contains(&self.values.len()) {
            Ok(self)
        } else {
            Err(self.wrong_size(expected))
        }
    }
}
