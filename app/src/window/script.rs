//! Doing things in the window without an operator: pictures for the documentation and
//! measurements are made by commands, not by hand.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use plumbline_engine::view::{
    BetweenSteps, Connection, GraspStep, MotionState, SourceStatus, StepState, TouchPhase,
};
use plumbline_engine::{
    BoxEdit, Command, Destination, GraspCommand, HandStep, JobCommand, LabelsCommand, ProbePoint,
    RobotCommand, View,
};
use plumbline_model::Eye;
use plumbline_model::robot::JointIndex;

use super::PlumblineWindow;
use super::frame_time::{FrameTimes, resident_mb};
use super::saving::save_picture;
use super::script_step::ScriptStep;
use crate::operator::{Action, GraspAction, RobotAction};

/// The steps that are left.
#[derive(Debug)]
pub(super) struct Script {
    steps: VecDeque<ScriptStep>,
    not_before: Instant,
    quiet_since: Option<Instant>,
    pub(super) waiting_for_picture: Arc<AtomicBool>,
}

/// A script that waits for what does not go on by itself.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "The script ends: the grasp waits at \"Stop after each step\" after {}, before {}, and no step of the script that is left goes on with it. Turn that switch off, or write grasp:resume where it waits.",
    .done.title().to_lowercase(),
    .next.title().to_lowercase()
)]
pub(super) struct ScriptStuck {
    done: GraspStep,
    next: GraspStep,
    /// Whether nobody is there: the script would have closed the window.
    quits: bool,
}

/// How long nothing may be running before the next step is taken.
const QUIET: Duration = Duration::from_millis(700);

impl Script {
    pub(super) fn new(steps: Vec<ScriptStep>) -> Self {
        let steps = steps.into();
        Self { steps, not_before: Instant::now(), quiet_since: None, waiting_for_picture: Arc::default() }
    }

    /// Whether steps are left: nobody sits before the window.
    pub(super) fn is_set(&self) -> bool {
        !self.steps.is_empty()
    }

    /// The next step, once everything before it has come to rest.
    ///
    /// # Errors
    /// When it never will: why, a sentence.
    pub(super) fn next(
        &mut self,
        view: &View,
        ctx: &egui::Context,
    ) -> Result<Option<ScriptStep>, ScriptStuck> {
        if self.steps.is_empty() {
            return Ok(None);
        }
        ctx.request_repaint_after(Duration::from_millis(100));
        self.due(view, Instant::now())
    }

    fn due(&mut self, view: &View, now: Instant) -> Result<Option<ScriptStep>, ScriptStuck> {
        // Work that waits for an answer is not waited for.
        let between = view.grasp.between();
        let busy = between.is_none() && Self::is_busy(view)
            || self.waiting_for_picture.load(Ordering::Relaxed)
            || now < self.not_before;
        if busy {
            self.quiet_since = None;
            return Ok(None);
        }
        if now.duration_since(*self.quiet_since.get_or_insert(now)) < QUIET {
            return Ok(None);
        }
        self.quiet_since = None;
        if let Some(between) = between.filter(|_| !self.steps.iter().any(answers_a_hold)) {
            return Err(self.stuck(between));
        }
        let step = self.steps.pop_front();
        match step {
            Some(ScriptStep::Wait(time)) => {
                self.not_before = now.checked_add(time).unwrap_or(now);
                Ok(None)
            }
            step => Ok(step),
        }
    }

    /// A script that knows nothing of holds would wait for ever. What is left of it is its end, if it has one.
    fn stuck(&mut self, between: BetweenSteps) -> ScriptStuck {
        self.steps.retain(|step| *step == ScriptStep::Quit);
        self.steps.truncate(1);
        ScriptStuck { done: between.done, next: between.next, quits: !self.steps.is_empty() }
    }

    fn is_busy(view: &View) -> bool {
        view.running_job().is_some()
            || matches!(view.robot.connection, Connection::Connecting { .. })
            || matches!(view.robot.motion, MotionState::Moving { .. })
            || matches!(view.touch.phase, TouchPhase::Running { .. } | TouchPhase::Planning)
            || view.models.training
            || view.gap.searching.is_some()
            || view.labels.working.is_some()
            || view.scores.evaluating.is_some()
            || view.mount.step == StepState::Running
            || view.source.status == SourceStatus::Opening
    }
}

/// Whether a step lets a grasp go on that waits after one of its own, or ends it.
fn answers_a_hold(step: &ScriptStep) -> bool {
    match step {
        ScriptStep::Send(command) => commands_an_answer(command),
        ScriptStep::Act(action) => matches!(
            action,
            Action::Stop
                | Action::CancelJob
                | Action::Grasp(GraspAction::Resume | GraspAction::End | GraspAction::Hand(HandStep::Home))
                | Action::Robot(RobotAction::TorqueOn | RobotAction::Disconnect)
        ),
        _ => false,
    }
}

/// The same of a command. Of the steps of the hand only the one home is taken while a grasp is under way.
fn commands_an_answer(command: &Command) -> bool {
    use RobotCommand::{ConnectPort, ConnectTwin, Disconnect, Torque};
    match command {
        Command::Grasp(command) => {
            matches!(command, GraspCommand::Resume | GraspCommand::End | GraspCommand::Hand(HandStep::Home))
        }
        Command::Robot(command) => {
            matches!(command, Torque { .. } | Disconnect | ConnectTwin { .. } | ConnectPort { .. })
        }
        Command::Job(command) => matches!(command, JobCommand::Cancel(_)),
        _ => false,
    }
}

impl PlumblineWindow {
    /// A script that waits for ever is told of; where nobody is there the grasp is ended, and the window closes when
    /// that is on disk.
    pub(super) fn script_stuck(&mut self, stuck: &ScriptStuck) {
        let said = stuck.to_string();
        if stuck.quits {
            self.send(GraspCommand::End.into());
        }
        // Told once, however long the end of the grasp takes.
        if self.script_failure.set(said.clone()).is_ok() {
            log::error!("{said}");
            self.notices.say_failed(&said);
        }
    }

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

#[cfg(test)]
mod tests {
    use plumbline_engine::view::{GraspPhase, GraspRun, GraspView, RobotView};

    use super::*;

    /// A grasp that waits after its approach.
    fn waits() -> View {
        let between = Some(BetweenSteps { done: GraspStep::Approach, next: GraspStep::Align });
        let run = Some(Arc::new(GraspRun { between, ..GraspRun::default() }));
        let phase = GraspPhase::Grasping { paused: true, ending: false };
        let motion = MotionState::Moving { what: "grasping".to_owned(), fraction: None, remaining: None };
        let grasp = Arc::new(GraspView { phase, run, ..GraspView::default() });
        let robot = Arc::new(RobotView { motion, ..RobotView::default() });
        View { grasp, robot, ..View::default() }
    }

    fn script(steps: &[&str]) -> Script {
        Script::new(steps.iter().map(|step| step.parse().expect("a step")).collect())
    }

    /// What comes once all has been at rest for long enough.
    fn after_a_while(script: &mut Script, view: &View) -> Result<Option<ScriptStep>, ScriptStuck> {
        let now = Instant::now();
        assert_eq!(script.due(view, now), Ok(None), "a moment says nothing");
        script.due(view, now + QUIET)
    }

    #[test]
    fn a_script_whose_grasp_waits_after_a_step_ends_and_says_which_step_waits() {
        let mut script = script(&["picture:held.png", "robot-move", "quit"]);
        let stuck = after_a_while(&mut script, &waits()).expect_err("it would wait for ever");
        let said = stuck.to_string();
        assert!(said.contains("after approach, before align"), "{said}");
        assert!(said.contains("grasp:resume"), "{said}");
        assert!(stuck.quits);
        assert_eq!(script.steps, [ScriptStep::Quit], "it closes the window when the grasp has ended");
        let mut open = self::script(&["grasp:plan"]);
        assert!(!after_a_while(&mut open, &waits()).expect_err("it ends, too").quits);
        assert!(open.steps.is_empty(), "whoever looks at the window decides");
    }

    #[test]
    fn a_script_that_goes_on_with_it_does_so_step_by_step() {
        let mut script = script(&["picture:held.png", "grasp:resume", "quit"]);
        let picture = ScriptStep::Picture("held.png".into());
        assert_eq!(after_a_while(&mut script, &waits()), Ok(Some(picture)));
        let resume = ScriptStep::Send(GraspCommand::Resume.into());
        assert_eq!(after_a_while(&mut script, &waits()), Ok(Some(resume)));
        let stuck = after_a_while(&mut script, &waits()).expect_err("it waits once more");
        assert!(stuck.to_string().contains("before align"), "{stuck}");
    }

    #[test]
    fn what_ends_a_grasp_that_waits_answers_it_too() {
        for step in [
            "grasp-hand-home",
            r#"grasp:{"hand":"home"}"#,
            "grasp-end",
            "stop",
            "cancel-job",
            "robot-torque-on",
            r#"robot:{"torque":{"joints":[],"on":false}}"#,
            "robot:disconnect",
        ] {
            let mut script = script(&[step, "quit"]);
            assert!(matches!(after_a_while(&mut script, &waits()), Ok(Some(_))), "{step}");
        }
        for step in ["grasp-hand-open", "grasp:grasp", r#"grasp:{"hand":"lift"}"#, "grasp-pause"] {
            assert!(after_a_while(&mut script(&[step]), &waits()).is_err(), "{step} is not taken then");
        }
    }

    #[test]
    fn while_something_is_under_way_it_waits() {
        let mut view = waits();
        Arc::make_mut(&mut view.grasp).run = None;
        let mut script = script(&["quit"]);
        assert_eq!(after_a_while(&mut script, &view), Ok(None), "it moves");
        Arc::make_mut(&mut view.robot).motion = MotionState::Holding { why: None };
        assert_eq!(after_a_while(&mut script, &view), Ok(Some(ScriptStep::Quit)));
    }
}
