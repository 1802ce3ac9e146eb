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
mod withdrawing;

use self::contacts::WindowContacts;
pub(super) use self::hand::Hand;
pub(super) use self::run::{Run, Step};
pub(super) use self::withdrawing::Withdrawing;
use super::command::RobotCommand;
use super::control::RobotControl;
use super::touch_order::{TouchNews, TouchRun};
use super::unable::Unable;

/// What is under way at the screen, and how it did.
#[derive(Default)]
pub struct Touching {
    pub(super) news: Vec<TouchNews>,
    pub(super) run: Option<Run>,
    /// Under way instead of a touch.
    pub(super) withdrawing: Option<Withdrawing>,
    pub(super) window: WindowContacts,
}

impl Touching {
    /// What it does just now, for people; `None` when nothing is under way.
    pub fn title(&self) -> Option<String> {
        self.run.as_ref().map(Run::title).or_else(|| self.withdrawing.as_ref().map(Withdrawing::title))
    }

    /// Whether the arm is on its way to the screen, at it, or away from it.
    pub fn is_busy(&self) -> bool {
        self.run.is_some() || self.withdrawing.is_some()
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
        moves && self.is_busy()
    }

    /// Why it was forbidden.
    pub fn busy(&self) -> Unable {
        Unable::Busy(self.title().unwrap_or_default())
    }

    /// Of an order, by its count and the number of its planned touch.
    pub(super) fn tell(&mut self, (order, number): (u64, Option<usize>), state: TouchRun) {
        self.news.push(TouchNews { order, number, state });
    }
}
