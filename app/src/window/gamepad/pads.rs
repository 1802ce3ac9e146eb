//! What is needed of a library of gamepads, so that tests can bring their own.

use std::time::Duration;

use gilrs::{Axis, Button, EventType, Gilrs};

/// What has happened on a gamepad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PadEvent {
    /// A button that stops was pressed.
    Stop,
    /// Anything else.
    Other,
}

/// Where the sticks of a gamepad stand, right and up positive, and whether it is enabled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sticks {
    pub enabled: bool,
    pub left: [f32; 2],
    pub right: [f32; 2],
}

/// The gamepads that are plugged in.
pub(super) trait Pads {
    /// Waits for something to happen, but not longer than this.
    fn next(&mut self, at_most: Duration) -> Option<PadEvent>;

    /// Name and sticks of the first that is plugged in.
    fn first(&self) -> Option<(String, Sticks)>;
}

/// The gamepads of this machine; `None` where there can be none.
pub(super) fn open() -> Option<Gilrs> {
    Gilrs::new().inspect_err(|error| log::info!("no gamepads here: {error}")).ok()
}

/// Whether a button stops.
pub(super) fn stops(button: Button) -> bool {
    matches!(button, Button::East | Button::Start)
}

impl Pads for Gilrs {
    fn next(&mut self, at_most: Duration) -> Option<PadEvent> {
        let event = self.next_event_blocking(Some(at_most))?;
        Some(match event.event {
            EventType::ButtonPressed(button, _) if stops(button) => PadEvent::Stop,
            _ => PadEvent::Other,
        })
    }

    fn first(&self) -> Option<(String, Sticks)> {
        let (_, pad) = self.gamepads().find(|(_, pad)| pad.is_connected())?;
        let sticks = Sticks {
            enabled: pad.is_pressed(Button::LeftTrigger),
            left: [pad.value(Axis::LeftStickX), pad.value(Axis::LeftStickY)],
            right: [pad.value(Axis::RightStickX), pad.value(Axis::RightStickY)],
        };
        Some((pad.name().to_owned(), sticks))
    }
}
