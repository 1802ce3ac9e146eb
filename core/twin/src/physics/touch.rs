//! Fingers meet the glass.

use mujoco_rs::prelude::*;

use super::place::Places;

/// A finger came down on the touchscreen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Simulated time, s.
    pub time_s: f64,
    /// Pixel (u, v); (0, 0) is the top-left one.
    pub pixel: [u32; 2],
    /// Force at that moment, N.
    pub force_n: f64,
}

/// A finger must be off the glass for this long before it can touch anew, s.
const LIFT_S: f64 = 0.03;
/// No more than this many wait to be fetched; the oldest go first.
const WAITING: usize = 256;

/// Watches the fingers.
#[derive(Debug)]
pub(super) struct TouchWatch {
    glass: i32,
    /// Geom and when it was last on the glass.
    fingers: Vec<(i32, Option<f64>)>,
    threshold_n: f64,
    waiting: std::collections::VecDeque<Contact>,
}

impl TouchWatch {
    pub(super) fn new(glass: i32, fingers: Vec<i32>, threshold_n: f64) -> Self {
        let fingers = fingers.into_iter().map(|geom| (geom, None)).collect();
        Self { glass, fingers, threshold_n, waiting: std::collections::VecDeque::new() }
    }

    /// Looks at the contacts of a step.
    pub(super) fn look(&mut self, data: &MjData<Box<MjModel>>, places: &Places) {
        let time_s = data.time();
        for (i, contact) in data.contact().iter().enumerate() {
            let [a, b] = contact.geom;
            let other = if a == self.glass { b } else { a };
            if a != self.glass && b != self.glass {
                continue;
            }
            let Some((_, last)) = self.fingers.iter_mut().find(|(geom, _)| *geom == other) else { continue };
            let Ok(force) = data.try_contact_force(i) else { continue };
            if force[0] < self.threshold_n {
                continue;
            }
            let was_off = last.is_none_or(|last| time_s - last > LIFT_S);
            *last = Some(time_s);
            // Beside the image the glass feels nothing.
            if let Some(pixel) = places.pixel(contact.pos.into()).filter(|_| was_off) {
                if self.waiting.len() == WAITING {
                    self.waiting.pop_front();
                }
                self.waiting.push_back(Contact { time_s, pixel, force_n: force[0] });
            }
        }
    }

    /// Whether a finger is on the glass, or was a moment ago.
    pub(super) fn is_down(&self, time_s: f64) -> bool {
        self.fingers.iter().any(|(_, last)| last.is_some_and(|last| time_s - last <= LIFT_S))
    }

    pub(super) fn take(&mut self) -> Vec<Contact> {
        self.waiting.drain(..).collect()
    }

    pub(super) fn forget(&mut self) {
        self.waiting.clear();
        self.fingers.iter_mut().for_each(|(_, last)| *last = None);
    }
}
