//! Touching the screen once: above, settle, lower, log, up.

use std::time::Instant;

use plumbline_hardware::joints::Touch;

use super::touch_order::{TouchNews, TouchOrder, TouchRun};
use super::worker::Worker;

/// The touch that is under way.
#[derive(Debug, Default)]
pub struct Touching {
    news: Vec<TouchNews>,
}

impl Worker {
    /// How touches are doing, since the last call.
    pub fn take_touch_news(&mut self) -> Vec<TouchNews> {
        std::mem::take(&mut self.touching.news)
    }

    pub(super) fn begin_touch(&mut self, order: TouchOrder, _now: Instant) {
        let state = TouchRun::Interrupted("Touching is not there yet.".to_owned());
        self.touching.news.push(TouchNews { order: order.order, number: order.number, state });
    }

    pub(super) fn abandon_touch(&mut self) {}

    pub(super) fn felt_by_window(&mut self, _contact: Touch) {}

    pub(super) fn step_touch(&mut self, _now: Instant) {}
}
