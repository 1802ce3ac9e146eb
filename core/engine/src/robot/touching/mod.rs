//! Touching the screen once: above, settle, lower until something is felt, log, up.
//!
//! Whatever moves goes through [`super::arm::Arm`] and with it through all limits. What cannot go
//! on without the operator ends the touch where the arm stands; what is merely no touch (nothing
//! felt, a contact of somebody else, too much load) ends it above the screen.

mod contacts;
mod hand;
mod lowering;
mod run;
#[cfg(test)]
mod tests;

use self::contacts::WindowContacts;
pub(super) use self::hand::Hand;
pub(super) use self::run::{Run, Step};
use super::command::RobotCommand;
use super::control::RobotControl;
use super::touch_order::{TouchNews, TouchOrder, TouchRun};
use super::unable::Unable;

/// The touch that is under way, and how touches did.
#[derive(Default)]
pub struct Touching {
    pub(super) news: Vec<TouchNews>,
    pub(super) run: Option<Run>,
    pub(super) window: WindowContacts,
}

impl Touching {
    /// What it does just now, for people; `None` when no touch is under way.
    pub fn title(&self) -> Option<String> {
        self.run.as_ref().map(Run::title)
    }

    /// Whether a command would get in the way of the touch.
    pub fn forbids(&self, control: &RobotControl) -> bool {
        use RobotCommand::{Jog, Preview, RunPreview, Scan};
        let moves = match control {
            RobotControl::Robot(command) => {
                matches!(command, Preview(_) | RunPreview | Jog(_) | Scan)
            }
            RobotControl::TurnHead { .. } => true,
            _ => false,
        };
        moves && self.run.is_some()
    }

    /// Why it was forbidden.
    pub fn busy(&self) -> Unable {
        Unable::Busy(self.title().unwrap_or_default())
    }

    pub(super) fn tell(&mut self, order: &TouchOrder, state: TouchRun) {
        self.news.push(TouchNews { order: order.order, number: order.number, state });
    }
}
