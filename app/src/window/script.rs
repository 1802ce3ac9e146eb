//! Doing things in the window without an operator: pictures for the documentation and
//! measurements are made by commands, not by hand.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use plumbline_engine::View;
use plumbline_engine::view::{Connection, MotionState, SourceStatus, StepState, TouchPhase};

use super::script_step::ScriptStep;

/// The steps that are left.
#[derive(Debug)]
pub(super) struct Script {
    steps: VecDeque<ScriptStep>,
    not_before: Instant,
    quiet_since: Option<Instant>,
    pub(super) waiting_for_picture: Arc<AtomicBool>,
}

/// How long nothing may be running before the next step is taken.
const QUIET: Duration = Duration::from_millis(700);

impl Script {
    pub(super) fn new(steps: Vec<ScriptStep>) -> Self {
        let steps = steps.into();
        Self { steps, not_before: Instant::now(), quiet_since: None, waiting_for_picture: Arc::default() }
    }

    /// The next step, once everything before it has come to rest.
    pub(super) fn next(&mut self, view: &View, ctx: &egui::Context) -> Option<ScriptStep> {
        self.steps.front()?;
        ctx.request_repaint_after(Duration::from_millis(100));
        let now = Instant::now();
        let busy = view.running_job().is_some()
            || matches!(view.robot.connection, Connection::Connecting { .. })
            || matches!(view.robot.motion, MotionState::Moving { .. })
            || matches!(view.touch.phase, TouchPhase::Running { .. } | TouchPhase::Planning)
            || view.models.training
            || view.gap.searching.is_some()
            || view.labels.working.is_some()
            || view.scores.evaluating.is_some()
            || view.mount.step == StepState::Running
            || view.source.status == SourceStatus::Opening
            || self.waiting_for_picture.load(Ordering::Relaxed)
            || now < self.not_before;
        if busy {
            self.quiet_since = None;
            return None;
        }
        if now.duration_since(*self.quiet_since.get_or_insert(now)) < QUIET {
            return None;
        }
        self.quiet_since = None;
        let step = self.steps.pop_front();
        match step {
            Some(ScriptStep::Wait(time)) => {
                self.not_before = now.checked_add(time).unwrap_or(now);
                None
            }
            step => step,
        }
    }
}
