//! What is known of a gamepad.

/// Which buttons stop, for people.
pub const STOP_BUTTONS: &str = "the right one of the four round buttons (B, circle), or Start";

/// What a gamepad says right now.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GamepadState {
    /// Its name.
    pub name: String,
    /// Whether the left shoulder button, which enables it, is held.
    pub enabled: bool,
    /// Forward, left, up, turn to the left; each −1 to 1.
    pub push: [f64; 4],
}
