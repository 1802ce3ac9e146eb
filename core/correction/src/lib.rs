//! Correction models learned from touches of the touchscreen, where they may be trusted, and the
//! tables of grasp height and yaw.
//!
//! A model answers: to which point must the simulated robot be sent so that the real fingertip
//! lands on this pixel of the touchscreen? It is trained on touches: the pixel that was touched
//! and the point that had been sent.
//!
//! - M1: the placement of the screen, and measured heights, interpolated between grid points.
//! - M2: an MLP for x and y; the height of M1.
//! - M3: an MLP for x, y and z.

pub mod bench;
pub mod blocks;
pub mod border;
pub mod data;
pub mod errors;
mod file;
pub mod file_error;
pub mod heights;
pub mod method;
pub mod model;
pub mod network;
mod onnx;
pub mod options;
pub mod placement;
mod published;
pub mod repeats;
mod self_test;
pub mod tables;
pub mod train;

pub use blocks::{BlockBy, Blocks};
pub use data::{DataError, Touch, TouchData};
pub use errors::{Errors, distance_2d_m};
pub use file_error::FileError;
pub use heights::HeightGrid;
pub use method::{Correction, Method};
pub use model::{CorrectionModel, CrossValidation, Provenance, TrainedTouch};
pub use network::Activation;
pub use options::{Recipe, ScreenSize, TrainOptions};
pub use placement::{M1, Placement, PlacementFrom};
pub use repeats::{Repeats, spread_of_repeats};
pub use train::{Compared, Comparison, LossPoint, TrainError, compare, cross_validate, train};
