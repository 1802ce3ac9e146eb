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

pub mod border;
pub mod data;
pub mod method;
pub mod tables;

pub use data::{DataError, Touch, TouchData};
pub use method::{Correction, Method};
