//! The touch window: a second window, full screen on the touch monitor. It shows the target,
//! and feels where the glass is touched.

mod contacts;
mod prompt;
mod showing;
mod surface;

pub use surface::{TouchSurface, touch_surface};

use plumbline_engine::ScreenWindow;

/// The touch window as it was left.
#[derive(Default)]
pub struct TouchWindow {
    surface: TouchSurface,
    /// What the engine was told of it.
    told: Option<ScreenWindow>,
}
