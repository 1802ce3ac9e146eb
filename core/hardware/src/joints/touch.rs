//! The touchscreen in front of the robot: where it was touched last.

use std::time::Instant;

/// A contact with the touchscreen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Column, px of the screen, grows to the robot's right.
    pub u_px: f64,
    /// Row, px of the screen, grows toward the robot.
    pub v_px: f64,
    /// When the contact began, host clock.
    pub at: Instant,
    /// Whether it still lasts.
    pub is_down: bool,
}

/// Nothing is felt any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the touchscreen is gone: start the twin again, or plug the screen in")]
pub struct ScreenGone;

/// Something that is touched: the screen, the twin's glass, a recording.
pub trait TouchSource: Send {
    /// The newest contact; `None` before the first.
    ///
    /// # Errors
    /// When the screen is gone.
    fn newest(&mut self) -> Result<Option<Touch>, ScreenGone>;
}
