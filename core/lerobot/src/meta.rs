//! What says what there is: `info.json`, cameras, and what files of the recording belong to it.

use std::path::Path;

use plumbline_model::files::{self, FileError};
use plumbline_model::{Camera, CameraModel, Eye, StereoCameras};
use serde_json::{Map, Value, json};

use crate::VERSION;

/// Where rows are, as the layout writes it.
pub(crate) const DATA: &str = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet";
pub(crate) const FIRST_DATA: &str = "data/chunk-000/file-000.parquet";
pub(crate) const FIRST_EPISODES: &str = "meta/episodes/chunk-000/file-000.parquet";

/// What an eye's images are called.
pub(crate) fn image_key(eye: Eye) -> &'static str {
    match eye {
        Eye::Left => "observation.images.left_eye",
        Eye::Right => "observation.images.right_eye",
    }
}

/// Angles of joints as they were read, rad.
pub(crate) const STATE: &str = "observation.state";
/// Angles that joints were told, rad.
pub(crate) const ACTION: &str = "action";
/// When a pair was captured, s since the first one.
pub(crate) const CAPTURED: &str = "observation.captured_s";
/// Where the left eye was in the robot: 16 numbers, row by row, of the matrix that takes points (m) of that eye there.
pub(crate) const PLACES: &str = "observation.robot_from_left_eye";

/// What the data set is about.
pub(crate) struct About<'a> {
    pub robot: &'a str,
    pub joints: &'a [String],
    /// Those of them that were told something in every frame.
    pub actions: &'a [String],
    /// Height, width.
    pub image: [u32; 2],
    pub frames: usize,
    pub rate_hz: f64,
    /// Whether it says where the left eye was.
    pub has_places: bool,
}

/// Features and their kinds.
pub(crate) fn features(about: &About<'_>) -> Map<String, Value> {
    let [height, width] = about.image;
    let image = json!({
        "dtype": "image", "shape": [height, width, 3], "names": ["height", "width", "channels"],
    });
    let one = |dtype: &str| json!({ "dtype": dtype, "shape": [1], "names": null });
    let mut features = Map::new();
    for eye in [Eye::Left, Eye::Right] {
        features.insert(image_key(eye).to_owned(), image.clone());
    }
    let angles = |joints: &[String]| json!({ "dtype": "float32", "shape": [joints.len()], "names": joints });
    features.insert(STATE.to_owned(), angles(about.joints));
    if !about.actions.is_empty() {
        features.insert(ACTION.to_owned(), angles(about.actions));
    }
    features.insert(CAPTURED.to_owned(), one("float64"));
    features.insert("timestamp".to_owned(), one("float32"));
    for name in ["frame_index", "episode_index", "index", "task_index"] {
        features.insert(name.to_owned(), one("int64"));
    }
    if about.has_places {
        let names: Vec<String> = (0..16).map(|k| format!("row_{}_column_{}", k / 4, k % 4)).collect();
        let places = json!({ "dtype": "float32", "shape": [16], "names": names });
        features.insert(PLACES.to_owned(), places);
    }
    features
}

/// `info.json`. The layout wants whole frames per second.
pub(crate) fn info(about: &About<'_>) -> Value {
    json!({
        "codebase_version": VERSION,
        "robot_type": about.robot,
        "total_episodes": 1,
        "total_frames": about.frames,
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 500,
        "fps": about.rate_hz.round().max(1.0) as u64,
        "splits": { "train": "0:1" },
        "data_path": DATA,
        "video_path": null,
        "features": features(about),
    })
}

/// Lenses and how the right eye sits to the left one.
pub(crate) fn cameras(cameras: &StereoCameras) -> Value {
    let eye = |camera: &Camera| {
        let lens = match &camera.model {
            CameraModel::Fisheye(lens) => json!({
                "model": "fisheye (equidistant, OpenCV fisheye)",
                "matrix_px": [[lens.fx_px, lens.skew_px, lens.cx_px], [0.0, lens.fy_px, lens.cy_px], [0.0, 0.0, 1.0]],
                "distortion": lens.k,
            }),
            CameraModel::Pinhole(lens) => json!({
                "model": "pinhole (OpenCV, k1 k2 p1 p2 k3)",
                "matrix_px": [[lens.fx_px, 0.0, lens.cx_px], [0.0, lens.fy_px, lens.cy_px], [0.0, 0.0, 1.0]],
                "distortion": [lens.k1, lens.k2, lens.p1, lens.p2, lens.k3],
            }),
        };
        json!({ "width_px": camera.width_px, "height_px": camera.height_px, "lens": lens })
    };
    let right_from_left = cameras.right_from_left.isometry.to_homogeneous();
    let rows: Vec<Vec<f64>> = right_from_left.row_iter().map(|row| row.iter().copied().collect()).collect();
    json!({
        "about": "pixel (0, 0) is the middle of the top left one; axes of a camera: x right, y down, z along the line \
            of sight; right_from_left takes points (m) of the left camera to the right one; where the left camera was \
            in the robot (torso: x forward, y left, z up) is observation.robot_from_left_eye of each frame, where the \
            recording says it; 16 times NaN where it does not",
        image_key(Eye::Left): eye(&cameras.left),
        image_key(Eye::Right): eye(&cameras.right),
        "right_from_left": rows,
    })
}

/// Writes JSON to be read by people, too.
pub(crate) fn write_json(file: &Path, value: &Value) -> Result<(), FileError> {
    if let Some(folder) = file.parent() {
        files::make_folder(folder)?;
    }
    files::write(file, format!("{value:#}"))
}
