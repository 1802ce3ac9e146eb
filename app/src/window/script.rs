//! Doing things in the window without an operator: pictures for the documentation and
//! measurements are made by commands, not by hand.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use plumbline_engine::view::{Connection, MotionState, SourceStatus, StepState, TouchPhase};
use plumbline_engine::{BoxEdit, Destination, LabelsCommand, ProbePoint, RobotCommand, View};
use plumbline_model::Eye;
use plumbline_model::robot::JointIndex;

use super::PlumblineWindow;
use super::frame_time::{FrameTimes, resident_mb};
use super::saving::save_picture;
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

impl PlumblineWindow {
    /// Does one step.
    pub(super) fn do_script_step(&mut self, ctx: &egui::Context, step: ScriptStep) {
        match step {
            ScriptStep::Act(action) => self.act(ctx, action),
            ScriptStep::Pair(index) => {
                self.panels.chosen_pair = self.view.eyes.collected.get(index).map(|pair| pair.name.clone());
            }
            ScriptStep::Probe([u_px, v_px]) => {
                self.panels.probe.pinned = Some(ProbePoint::Raw { eye: Eye::Left, u_px, v_px });
            }
            ScriptStep::Object(name) => self.panels.objects.choose_class(&self.view, &name),
            ScriptStep::DrawBox(class, area) => {
                if let Some(shown) = &self.view.labels.shown {
                    let (image, edit) = (shown.name.clone(), BoxEdit::Add { class, area });
                    self.send(LabelsCommand::Edit { image, edit }.into());
                }
            }
            ScriptStep::ChooseBox(index) => self.panels.labels.canvas.chosen = Some(index),
            ScriptStep::Show(pane) => self.show_pane(self.settings.screen, pane),
            ScriptStep::Errors(errors) => {
                (self.panels.models.errors, self.panels.gap.errors) = (errors, errors)
            }
            ScriptStep::Measure => {
                self.frame_times = FrameTimes::default();
                self.resident_before_mb = resident_mb();
            }
            ScriptStep::Send(command) => self.send(command),
            ScriptStep::PreviewJoint(name, degrees) => {
                if let Some(joint) = self.joint_called(&name) {
                    let to = Destination::Joint { joint, angle_rad: degrees.to_radians() };
                    self.send(RobotCommand::Preview(to).into());
                }
            }
            ScriptStep::Joint(name) => self.panels.robot.chosen_joint = self.joint_called(&name),
            ScriptStep::Wait(_) => {}
            ScriptStep::Picture(file) => {
                self.script.waiting_for_picture.store(true, Ordering::Relaxed);
                let waiting = Arc::clone(&self.script.waiting_for_picture);
                let again = ctx.clone();
                ctx.request_screenshot(move |picture| {
                    save_picture(&again, &picture, file, move |_| waiting.store(false, Ordering::Relaxed));
                });
            }
            ScriptStep::Quit => {
                self.closes = true;
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
    }

    fn joint_called(&self, name: &str) -> Option<JointIndex> {
        let found = self.view.robot.rig.as_ref()?.description.find_joint(name);
        found.inspect_err(|error| log::warn!("{error}")).ok()
    }
}
