//! `log.mcap` of a session: what works live, written as it happens, and read again.
//!
//! The file is MCAP (<https://mcap.dev/spec>) with the protobuf schemas of Foxglove where there is one,
//! so that Foxglove and Rerun open it: images as `foxglove.CompressedImage`, angles of joints, and the angles that they
//! were told, as `foxglove.JointStates`, messages as `foxglove.Log`, calibrations as `foxglove.CameraCalibration`, where the eyes
//! are as `foxglove.FrameTransforms`, boxes of things as `foxglove.ImageAnnotations`. What only this program knows
//! (commands, detections, places, for how long the eyes had been on) is JSON. Calibration files and the description
//! of the robot are attachments, so that a recording is whole by itself.
//!
//! Records are gathered into chunks that are closed once a second. A chunk that was closed is in the file
//! whatever happens to the program; what is read of a file that was cut ends with its last whole chunk.

mod error;
mod frames;
mod index;
mod messages;
mod outlines;
mod parse;
mod reader;
mod records;
mod topic;
mod whose;
mod writer;

pub use error::RecordingError;
pub use frames::EyePlaces;
pub use messages::{JointGoal, JointReading, Level, Note};
pub use outlines::Outline;
pub use reader::{RecordedPair, Recording, Told};
pub use topic::Topic;
pub use whose::Whose;
pub use writer::{About, Attached, Counts, Jpeg, RecordingWriter};

/// The name of the file in a session's folder.
pub const FILE: &str = "log.mcap";
