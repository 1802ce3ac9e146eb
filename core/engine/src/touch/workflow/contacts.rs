//! Who touches the screen: the robot, or somebody at its window.

use plumbline_hardware::joints::Touch;
use plumbline_model::session::Screen;
use plumbline_model::{Pixel, duration};

use super::super::command::{ContactWith, ScreenContact, ScreenWindow};
use super::super::view::{ContactSource, ContactView};
use super::super::work::Context;
use super::{TouchAround, TouchWorkflow, source};
use crate::robot::RobotControl;

impl TouchWorkflow {
    pub(super) fn contact(
        &mut self,
        contact: ScreenContact,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) {
        let ScreenContact { u_px, v_px, age_s, with, down } = contact;
        let age = duration::seconds(age_s).unwrap_or_default();
        if !(u_px.is_finite() && v_px.is_finite()) {
            return;
        }
        self.show_contact(Pixel::new(u_px, v_px), down);
        // The twin has a glass of its own: a mouse over the window touches nothing of it.
        if with == ContactWith::Mouse && source(&around.robot) == ContactSource::Twin {
            return;
        }
        let now = context.time.instant;
        let touch = Touch { u_px, v_px, at: now.checked_sub(age).unwrap_or(now), is_down: down };
        context.control(RobotControl::Contact(touch));
    }

    pub(super) fn show_contact(&mut self, pixel: Pixel<Screen>, is_down: bool) {
        let number = self.last_contact.map_or(0, |last| last.number);
        let begins = is_down && !self.last_contact.is_some_and(|last| last.is_down);
        self.last_contact = Some(ContactView { pixel, number: number + u64::from(begins), is_down });
    }

    pub(super) fn set_window(
        &mut self,
        window: Option<ScreenWindow>,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) {
        let closed = window.is_none() && self.window.is_some();
        self.window = window;
        if closed
            && source(&around.robot) == ContactSource::Window
            && let Some(run) = &mut self.run
        {
            let why = "The touch window is gone (closed, or its monitor unplugged), so no contact can be felt. Open it full screen on the touch monitor, then go on; the touch that was under way is made again.";
            run.break_off(why.to_owned(), context);
        }
    }
}
