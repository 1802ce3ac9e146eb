//! What the eyes see, measured: chessboard corners, stereo calibration, rectification,
//! disparity, and where in space a point of the image is.
//!
//! Everything here is a plain function or a plain struct with a `process`-like method: no thread,
//! no window, no device.

pub mod calibrate;
pub mod calibration_file;
pub mod chessboard;
mod cv_words;
pub mod depth;
pub mod detect;
pub mod detect_places;
pub mod detect_score;
pub mod disparity;
pub mod disparity_bench;
pub mod follow;
pub mod health;
pub mod locate;
pub mod mat;
pub mod mount;
pub mod opencv_storage;
mod pyramid;
pub mod rectify;
pub mod synthetic;
pub mod yolo_set;
