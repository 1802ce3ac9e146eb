//! OpenCV FileStorage, read and written by OpenCV itself: M1 D1 M2 D2 R T, as the stereo samples
//! name them, with R1 R2 P1 P2 Q of a plain rectification beside them.
//!
//! YAML, XML or JSON by the file's extension when writing, by its content when reading. Names of
//! other scripts for the same matrices are understood, and the two files of OpenCV's sample
//! (intrinsics and extrinsics) may be given together.

mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::read;
pub use write::write;
