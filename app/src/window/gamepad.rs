//! A gamepad for jogging. Having none is the usual case.

use egui::Context;
use gilrs::{Axis, Button, Gilrs};

/// A stick nearer to its middle than this is at rest.
const DEAD: f32 = 0.15;

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

/// The gamepads of this machine; looked for when somebody first needs one.
#[derive(Default)]
pub(super) struct Gamepads {
    allowed: bool,
    library: Option<Gilrs>,
    failed: bool,
}

impl Gamepads {
    /// `allowed` false never looks (tests, pictures).
    pub(super) fn new(allowed: bool) -> Self {
        Self { allowed, ..Self::default() }
    }

    /// The first gamepad that is plugged in. Reads what has come and does not wait.
    pub(super) fn poll(&mut self, ctx: &Context) -> Option<GamepadState> {
        if !self.allowed || self.failed {
            return None;
        }
        if self.library.is_none() {
            match Gilrs::new() {
                Ok(library) => self.library = Some(library),
                Err(error) => {
                    log::info!("no gamepads here: {error}");
                    self.failed = true;
                }
            }
        }
        let library = self.library.as_mut()?;
        while library.next_event().is_some() {}
        let (_, pad) = library.gamepads().find(|(_, pad)| pad.is_connected())?;
        let axis = |axis| dead_zone(pad.value(axis));
        // Sticks count up and right as positive; the robot's y points to its left.
        let push = [
            axis(Axis::LeftStickY),
            -axis(Axis::LeftStickX),
            axis(Axis::RightStickY),
            -axis(Axis::RightStickX),
        ];
        // A window behind others must not move the robot.
        let enabled = pad.is_pressed(Button::LeftTrigger) && ctx.input(|input| input.focused);
        Some(GamepadState { name: pad.name().to_owned(), enabled, push })
    }
}

/// Zero near the middle, and from there evenly up to 1.
fn dead_zone(value: f32) -> f64 {
    let beyond = (value.abs() - DEAD) / (1.0 - DEAD);
    if beyond > 0.0 { f64::from(beyond.min(1.0) * value.signum()) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stick_near_its_middle_is_at_rest_and_nothing_exceeds_one() {
        assert_eq!(dead_zone(0.1), 0.0);
        assert_eq!(dead_zone(f32::NAN), 0.0);
        assert_eq!(dead_zone(-1.0), -1.0);
        assert_eq!(dead_zone(1.2), 1.0);
        assert!((dead_zone(0.575) - 0.5).abs() < 1e-6);
    }
}
