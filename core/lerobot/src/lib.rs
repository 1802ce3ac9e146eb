//! A recording as a LeRobot data set, version 3 (<https://huggingface.co/docs/lerobot/lerobot-dataset-v3>): one
//! episode, both eyes and the angles of all joints, with intrinsics and extrinsics.
//!
//! ```text
//! meta/info.json                              what there is, how often, and where
//! meta/stats.json                             ranges, means, standard deviations
//! meta/tasks.parquet                          what was being done
//! meta/episodes/chunk-000/file-000.parquet    the one episode
//! meta/cameras.json                           lenses and how the eyes sit to each other (not of the published layout)
//! meta/…                                      calibration files and robot description of the recording, as they were
//! data/chunk-000/file-000.parquet             a row per pair of images
//! ```
//!
//! Images are kept inside the rows as they were recorded (JPEG), so that nothing is encoded twice. As the layout wants
//! it, `timestamp` is the number of the frame over the rate; when a pair truly was captured stands beside it in
//! `observation.captured_s`. Angles are those read last before a pair; pairs before the first reading are left out and
//! counted. Where the recording says how the head stood, `observation.robot_from_left_eye` says for each frame where the
//! left eye was in the robot (a matrix 4 by 4, row by row, m). There is no `action`: a recording holds no goals of joints for each pair.

mod data;
mod error;
mod export;
mod meta;
mod statistics;

pub use error::ExportError;
pub use export::{Exported, Options, export};

/// The version of the layout.
pub const VERSION: &str = "v3.0";
