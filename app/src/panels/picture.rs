//! Pictures of live images: their names, and how a new one is told from an old one.

use std::hash::{DefaultHasher, Hash, Hasher};

use plumbline_model::{Eye, Stamp};

use crate::operator::Pane;

/// A number that changes with the image. The number of a pair alone would not do: another
/// source counts from the same start.
pub fn seq(stamp: &Stamp) -> u64 {
    seq_with(stamp, ())
}

/// The same for a picture that depends on something else too, such as a color scale.
pub fn seq_with(stamp: &Stamp, also: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    stamp.seq.hash(&mut hasher);
    stamp.captured_at.hash(&mut hasher);
    also.hash(&mut hasher);
    hasher.finish()
}

/// Name of the picture of a raw eye.
pub fn eye_key(eye: Eye) -> &'static str {
    match eye {
        Eye::Left => "left eye",
        Eye::Right => "right eye",
    }
}

/// Name of the picture that a pane shows, if it shows one that can be saved and copied.
pub fn key(pane: Pane) -> Option<&'static str> {
    Some(match pane {
        Pane::LeftEye => eye_key(Eye::Left),
        Pane::RightEye => eye_key(Eye::Right),
        Pane::Rectified => "rectified left",
        Pane::Anaglyph => "anaglyph",
        Pane::Blink => "blink",
        Pane::Disparity => "disparity",
        Pane::Depth => "depth",
        _ => return None,
    })
}
