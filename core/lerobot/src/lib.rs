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
//! counted. `action` is what joints were told last before the next pair (rad), so the answer to what the pair shows; a
//! joint that was told nothing in some pair (it was limp, or nobody had moved it yet) is not in it, and is named. Where the
//! recording says how the head stood, `observation.robot_from_left_eye` says for each frame where the left eye was in the
//! robot (a matrix 4 by 4, row by row, m); a frame of which it does not say so has 16 times NaN there, which is no number
//! and in no statistics.

mod data;
mod error;
mod export;
mod frames;
mod meta;
mod rows;
mod statistics;
mod tables;
mod words;

pub use error::ExportError;
pub use export::{Exported, Options, export};
pub use frames::NotCommanded;

/// The version of the layout.
pub const VERSION: &str = "v3.0";
