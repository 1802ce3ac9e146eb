//! How each eye has turned since a picture was remembered, and what in the picture moved by itself.
//!
//! Corners of the remembered picture (Shi and Tomasi 1994) are found again by their brightness (Lucas and
//! Kanade 1981). An eye that turns in its place moves all of them by one rotation, however far they are;
//! what does not go with it has moved by itself. Each eye is told apart, which matches between the eyes
//! ([`crate::health`]) cannot do; the head must not have been moved, which they do not mind.
//!
//! Not seen this way: whether both eyes turned together or everything before them did.

mod eye;
mod patch;
mod turn;

#[cfg(test)]
mod tests;

pub use eye::{Followed, LEAST_FOLLOWED, RememberedEye};
pub use turn::{EyeTurn, fit_eye_turn};
