//! Tying the arms to the eyes: what is looked at, and where the hands are seen.

mod inspector;
mod map;
mod parts;

use crate::panels::arrows::Errors;

pub use inspector::show as show_inspector;
pub use map::show as show_map;
pub use parts::show as show_parts;

/// How the hands are looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct HandEyePanels {
    /// Which errors the map shows.
    pub errors: Errors,
}
