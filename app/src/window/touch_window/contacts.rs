//! Which events of the window system are a contact. A finger on the glass comes as a touch, and
//! once more as an emulated press of the mouse: it counts once, and of several fingers the first.

use egui::{Event, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase};
use plumbline_engine::ContactWith;

/// After a touch, presses of the mouse are taken for its echo for so long, s.
const ECHO_S: f64 = 0.7;

/// A contact, in points of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Where.
    pub at: Pos2,
    /// With what.
    pub with: ContactWith,
    /// Whether it begins.
    pub down: bool,
}

/// What holds the glass down.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Touch(TouchDeviceId, TouchId),
    Mouse,
}

/// Tells contacts from their echoes.
#[derive(Clone, Debug, Default)]
pub struct ContactFilter {
    held: Option<Held>,
    touched_s: Option<f64>,
}

impl ContactFilter {
    /// The contact that an event is, if it is one. `now_s` is the time of the frame.
    pub fn contact(&mut self, event: &Event, now_s: f64) -> Option<Contact> {
        match *event {
            Event::Touch { device_id, id, phase, pos, .. } => {
                self.touched_s = Some(now_s);
                self.touch(Held::Touch(device_id, id), phase, pos)
            }
            Event::PointerButton { pos, button: PointerButton::Primary, pressed, .. } => {
                self.press(pos, pressed, now_s)
            }
            Event::PointerGone | Event::WindowFocused(false) => {
                // Nothing tells any more when the button is let go.
                if self.held == Some(Held::Mouse) {
                    self.held = None;
                }
                None
            }
            _ => None,
        }
    }

    /// What holds the glass down does not count, and neither does its end.
    pub fn forget(&mut self) {
        self.held = None;
    }

    fn touch(&mut self, finger: Held, phase: TouchPhase, at: Pos2) -> Option<Contact> {
        let contact = |down| Some(Contact { at, with: ContactWith::Touch, down });
        match phase {
            TouchPhase::Start if self.held.is_none() => {
                self.held = Some(finger);
                contact(true)
            }
            TouchPhase::End | TouchPhase::Cancel if self.held == Some(finger) => {
                self.held = None;
                contact(false)
            }
            _ => None,
        }
    }

    fn press(&mut self, at: Pos2, pressed: bool, now_s: f64) -> Option<Contact> {
        let contact = |down| Some(Contact { at, with: ContactWith::Mouse, down });
        if self.held == Some(Held::Mouse) && !pressed {
            self.held = None;
            return contact(false);
        }
        let echo = self.touched_s.is_some_and(|touched_s| now_s - touched_s < ECHO_S);
        if echo || !pressed || self.held.is_some() {
            return None;
        }
        self.held = Some(Held::Mouse);
        contact(true)
    }
}

#[cfg(test)]
mod tests {
    use egui::{Modifiers, pos2};

    use super::*;

    fn touch(id: u64, phase: TouchPhase) -> Event {
        let pos = pos2(10.0 * id as f32, 5.0);
        Event::Touch { device_id: TouchDeviceId(1), id: TouchId(id), phase, pos, force: None }
    }

    fn press(pressed: bool) -> Event {
        let button = PointerButton::Primary;
        Event::PointerButton { pos: pos2(3.0, 4.0), button, pressed, modifiers: Modifiers::NONE }
    }

    fn all(events: &[(Event, f64)]) -> Vec<(ContactWith, bool)> {
        let mut filter = ContactFilter::default();
        let contacts = events.iter().filter_map(|(event, at_s)| filter.contact(event, *at_s));
        contacts.map(|contact| (contact.with, contact.down)).collect()
    }

    #[test]
    fn a_touch_and_its_emulated_press_are_one_contact() {
        let events = [
            (touch(1, TouchPhase::Start), 1.0),
            (press(true), 1.0),
            (touch(1, TouchPhase::Move), 1.1),
            (touch(1, TouchPhase::End), 1.2),
            (press(false), 1.2),
        ];
        assert_eq!(all(&events), [(ContactWith::Touch, true), (ContactWith::Touch, false)]);
        // Some systems send the echo only when the finger is lifted.
        let late = [
            (touch(1, TouchPhase::Start), 1.0),
            (touch(1, TouchPhase::End), 1.2),
            (press(true), 1.5),
            (press(false), 1.5),
        ];
        assert_eq!(all(&late).len(), 2);
    }

    #[test]
    fn of_several_fingers_the_first_counts() {
        let events = [
            (touch(1, TouchPhase::Start), 1.0),
            (touch(2, TouchPhase::Start), 1.1),
            (touch(2, TouchPhase::End), 1.2),
            (touch(1, TouchPhase::End), 1.3),
        ];
        assert_eq!(all(&events), [(ContactWith::Touch, true), (ContactWith::Touch, false)]);
    }

    #[test]
    fn the_mouse_tries_it_out() {
        let events = [(press(true), 1.0), (press(false), 1.1), (press(true), 1.2), (press(false), 1.3)];
        let wanted = [true, false, true, false].map(|down| (ContactWith::Mouse, down));
        assert_eq!(all(&events), wanted);
        // After a touch the mouse works again.
        let after = [
            (touch(1, TouchPhase::Start), 1.0),
            (touch(1, TouchPhase::End), 1.1),
            (press(true), 3.0),
            (press(false), 3.1),
        ];
        assert_eq!(all(&after).len(), 4);
    }
}
