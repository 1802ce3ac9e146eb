//! What goes on by itself: joints are looked at, and what runs is led on.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{Motion, MoveOutcome};
use plumbline_model::frame::Point;
use plumbline_model::robot::Posture;

use super::Worker;
use crate::ground::text::sentence;
use crate::robot::unable::{holds_unheard, is_unheard};
use crate::robot::view::Connection;

/// The trail of the tip goes back this far.
const TRAIL: Duration = Duration::from_secs(30);
/// Places nearer than this to the last one are left out of the trail, m.
const TRAIL_STEP_M: f64 = 0.002;

impl Worker {
    /// Looks at the joints and goes on with what runs.
    pub fn tick(&mut self, now: Instant) {
        self.desk.tick(now, &self.rig);
        self.step_jog(now);
        self.step_touch(now);
        self.step_lead(now);
        let Some(state) = self.arm.as_ref().and_then(|arm| arm.state()) else { return };
        if let Some(reason) = &state.gone {
            let Connection::Connected { to, .. } = self.connection.clone() else { return };
            let reason = sentence(reason);
            self.disconnect();
            self.connection = Connection::Lost { to, reason: reason.clone() };
            return self.refuse(reason);
        }
        if let Some((number, refusal)) = &state.refusal
            && *number > self.seen_refusal
        {
            self.seen_refusal = *number;
            self.refuse_because(sentence(&refusal.to_string()), is_unheard(refusal));
        }
        if let Some(running) = &self.running
            && let Some(outcome) = state.outcome(running.id)
        {
            if let MoveOutcome::Held(reason) = outcome {
                let text = format!("Not finished: {}. {}", running.title, sentence(&reason.to_string()));
                self.refuse_because(text, holds_unheard(reason));
            }
            self.running = None;
        }
        if !matches!(state.motion, Motion::Moving { .. } | Motion::Following) && self.jog.is_none() {
            self.running = self.running.take().filter(|running| state.outcome(running.id).is_none());
        }
        if let Some(since) = self.connected_at {
            self.histories.note(now.saturating_duration_since(since).as_secs_f64(), &state.joints);
        }
        if let Some(posture) = &state.measured
            && self.chain.joints().iter().all(|joint| state.knows(*joint))
        {
            self.follow_tip(posture, now);
        }
    }

    fn follow_tip(&mut self, posture: &Posture, now: Instant) {
        while self.trail.front().is_some_and(|(at, _)| now.saturating_duration_since(*at) > TRAIL) {
            self.trail.pop_front();
        }
        let place = self.tip_by_encoders(posture).translation_m();
        let place = Point::new(place.x, place.y, place.z);
        if self.trail.back().is_none_or(|(_, last)| last.distance_m(&place) > TRAIL_STEP_M) {
            self.trail.push_back((now, place));
        }
    }
}
