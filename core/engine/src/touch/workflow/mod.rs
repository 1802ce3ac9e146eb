//! What was planned, what is touched, where the screen lies.

mod contacts;
mod placed;
mod planned;
mod room;
mod running;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use plumbline_correction::CorrectionModel;
use plumbline_effects::{RigModel, RobotModel};
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{Finger, PlanOptions, TouchArea};
use plumbline_model::touchscreen::ScreenPlacement;

use super::command::{Correction, ScreenWindow, TouchCommand};
use super::placement::Proposal;
use super::plan::RunPlan;
use super::refusal::{Held, Refusal, Trouble};
use super::run::{Phase, Run};
use super::seen::Seen;
use super::store::Runs;
use super::view::{ContactSource, ContactView, TouchView};
use super::work::{Context, TouchResult, TouchWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::robot::RobotControl;
use crate::robot::view::{Connection, MotionState, RobotView};

/// What the workflow can see of the rest.
pub struct TouchAround {
    /// The robot as its description has it, the screen where it is nominally.
    pub rig: Arc<Rig>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// Models that targets can be corrected with: proposals, then the one in use.
    pub models: Vec<Arc<CorrectionModel>>,
    /// The robot as it is known.
    pub model: Arc<RobotModel>,
    /// What a hand holds.
    pub held: Option<Held>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug, Default)]
pub struct TouchWorkflow {
    folder: PathBuf,
    /// The part of the screen that the finger reaches, once that was looked for.
    pub(super) reach: [Option<TouchArea>; 2],
    pub(super) placement: Option<Arc<ScreenPlacement>>,
    /// Whether what was accepted before has been read.
    pub(super) is_known: bool,
    pub(super) proposal: Option<Proposal>,
    pub(super) correct_with: Option<Correction>,
    /// The effects that targets were corrected by, or not, last.
    follows: Option<Arc<RigModel>>,
    /// What was asked for last, to be planned again when something changes.
    pub(super) options: Option<PlanOptions>,
    pub(super) planning: Option<JobId>,
    /// The plan, and the screen for which it was made.
    pub(super) planned: Option<(Arc<RunPlan>, Touchscreen)>,
    /// A session is being begun or opened.
    pub(super) starting: Option<JobId>,
    /// The place of the screen is being measured.
    pub(super) placing: Option<JobId>,
    pub(super) run: Option<Run>,
    pub(super) runs: Runs,
    last_session: Option<PathBuf>,
    /// What made room on the twin's screen is to come back.
    owes_room: bool,
    /// Since when the arms rest away from the screen.
    free_since: Option<Instant>,
    pub(super) window: Option<ScreenWindow>,
    pub(super) last_contact: Option<ContactView>,
    /// What [`Self::screen`] gives.
    screen: Option<Touchscreen>,
    pub(super) seen: Seen,
}

impl TouchWorkflow {
    /// The session that is written or shown; after it was closed, still the newest one.
    pub fn session(&self) -> Option<&Path> {
        self.run.as_ref().map(|run| run.session.as_path()).or(self.last_session.as_deref())
    }

    /// The session of a run that is finished and on disk, with a number that grows with its changes.
    pub fn finished_session(&self) -> Option<(&Path, u64)> {
        let run = self.run.as_ref().filter(|run| run.phase == Phase::Finished && run.is_on_disk())?;
        Some((run.session.as_path(), run.revision()))
    }

    /// The newest run on disk that was finished and made to learn from, of whatever day.
    pub fn trained_session(&self) -> Option<&Path> {
        self.runs.trained.as_ref().map(|run| run.session.as_path())
    }

    /// Where sessions are kept.
    pub fn sessions(&self) -> PathBuf {
        self.folder.join("sessions")
    }

    /// What touches in the run that is under way or shown.
    pub fn finger(&self) -> Option<Finger> {
        self.run.as_ref().map(|run| run.plan.options.finger)
    }

    /// What the run that is under way or shown was planned from.
    pub fn run_options(&self) -> Option<&PlanOptions> {
        self.run.as_ref().map(|run| &run.plan.options)
    }

    /// The screen where it was measured to lie, on its block while a run has put it on one; `None`:
    /// nominal.
    pub fn screen(&self) -> Option<&Touchscreen> {
        self.screen.as_ref()
    }

    /// What follows from a change: the end of a run, the screen on its block, what is shown.
    pub fn refresh(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        self.follow_model(around, context);
        if self.run.as_mut().is_some_and(Run::take_ended) {
            self.ended(around, context);
        }
        let placed = self.placement.as_ref().map(|placement| &placement.screen);
        let height_m = self.active_run().map_or(0.0, |run| run.progress.prepared[0]);
        self.screen = if height_m > 0.0 {
            Some(placed.unwrap_or(&around.rig.touchscreen).raised(height_m))
        } else {
            placed.cloned()
        };
        self.seen = self.seen_now();
    }

    fn leave_run(&mut self) {
        if let Some(run) = self.run.take() {
            self.last_session = Some(run.session);
        }
    }

    /// The run that is not finished.
    pub(super) fn active_run(&self) -> Option<&Run> {
        self.run.as_ref().filter(|run| run.is_active())
    }

    fn no_run_under_way(&self) -> Result<(), Refusal> {
        if self.starting.is_some() || self.active_run().is_some() {
            return Err(Refusal::RunUnderWay);
        }
        Ok(())
    }

    /// Why nothing can be touched now, and what to do.
    pub(super) fn trouble(&self, around: &TouchAround) -> Option<Trouble> {
        let robot = &around.robot;
        if !robot.connection.is_connected() {
            Some(Trouble::NotConnected)
        } else if robot.stopped {
            Some(Trouble::Stopped)
        } else if robot.measured.is_none() {
            Some(Trouble::NotRead)
        } else if robot.motion == MotionState::Limp {
            Some(Trouble::Limp)
        } else if source(robot) == ContactSource::Window && self.window.is_none() {
            Some(Trouble::WindowClosed)
        } else {
            around.held.clone().map(Trouble::FullHand)
        }
    }
}

impl Workflow for TouchWorkflow {
    type Command = TouchCommand;
    type Work = TouchWork;
    type Control = RobotControl;
    type Around = TouchAround;
    type View = TouchView;

    /// Nothing planned. Sessions are kept in `folder/sessions`, the place of the screen in
    /// `folder/screen.toml`.
    fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..Self::default() }
    }

    fn view(&mut self, around: &TouchAround, moment: &Moment) -> Arc<TouchView> {
        Arc::new(self.shown(around, moment.now))
    }

    fn restore(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        context.start(TouchWork::Restore { folder: self.folder.clone(), rig: around.rig.clone() });
    }

    fn apply(&mut self, command: TouchCommand, around: &TouchAround, context: &mut Context<'_>) {
        let result = match command {
            TouchCommand::Plan(options) => self.plan(options, around, context),
            TouchCommand::CorrectWith(correction) => self.correct_with(correction, around, context),
            TouchCommand::Start => self.start(around, context),
            TouchCommand::Open { session } => self.open(session, around, context),
            TouchCommand::Close => self.close(around, context),
            TouchCommand::AcceptPlacement => self.accept_placement(context),
            TouchCommand::DiscardPlacement => {
                self.proposal = None;
                Ok(())
            }
            TouchCommand::UseEarlierPlacement { id } => self.use_earlier(id, around, context),
            TouchCommand::UseNominalPlacement => self.use_nominal(context),
            TouchCommand::Contact(contact) => {
                self.contact(contact, around, context);
                Ok(())
            }
            TouchCommand::Window(window) => {
                self.set_window(window, around, context);
                Ok(())
            }
            of_run => self.apply_to_run(of_run, around, context),
        };
        if let Err(reason) = result {
            context.refuse(reason);
        }
        self.refresh(around, context);
    }

    fn work_done(&mut self, id: JobId, result: TouchResult, around: &TouchAround, context: &mut Context<'_>) {
        match result {
            TouchResult::Restored { placement, runs, reach, choice } => {
                self.reach = reach;
                match choice {
                    Ok(None) => {}
                    Ok(Some(chosen)) => self.correct_with = chosen,
                    Err(reason) => context.notices.add(NoticeLevel::Warning, reason.to_string()),
                }
                self.restored(placement, runs, context);
            }
            TouchResult::Planned(plan, rig) if self.planning == Some(id) => {
                self.planning = None;
                self.leave_run();
                self.planned = Some((plan, rig.touchscreen.clone()));
            }
            TouchResult::NotPlanned => self.planning = self.planning.filter(|known| *known != id),
            TouchResult::Begun { session, stored } if self.starting == Some(id) => {
                self.starting = None;
                self.planned = None;
                self.leave_run();
                let run = self.run.insert(Run::begun(session, *stored));
                run.tell_twin(&around.robot, context);
                self.owes_room |= source(&around.robot) == ContactSource::Twin;
            }
            TouchResult::Opened { session, stored } if self.starting == Some(id) => {
                self.starting = None;
                (self.planned, self.options) = (None, Some(stored.plan.options.clone()));
                self.correct_with = stored.plan.corrected_with;
                self.leave_run();
                self.runs.unfinished.retain(|run| run.session != session);
                self.run = Some(Run::opened(session, *stored));
            }
            TouchResult::Placed(placed) if self.placing == Some(id) => {
                self.placing = None;
                self.placed(placed, context);
            }
            TouchResult::Saved(placement) => {
                self.proposal = self.proposal.take().filter(|p| !Arc::ptr_eq(&p.placement, &placement));
                (self.placement, self.is_known) = (Some(placement), true);
                self.plan_anew(around, context);
            }
            TouchResult::Forgotten => {
                (self.placement, self.is_known) = (None, true);
                self.plan_anew(around, context);
            }
            TouchResult::Written { .. } | TouchResult::Routed { .. } | TouchResult::WayHome(_) => {
                self.run_work_done(id, result, around, context);
            }
            // A plan or a session that nobody waits for any more.
            TouchResult::Planned(..)
            | TouchResult::Begun { .. }
            | TouchResult::Opened { .. }
            | TouchResult::Placed(_)
            | TouchResult::ChoiceKept => {}
        }
        self.go_on(around, context);
        self.refresh(around, context);
    }

    fn work_ended(&mut self, id: JobId, _: Option<&str>, _: &TouchAround, _: &mut Context<'_>) {
        for waiting in [&mut self.planning, &mut self.starting, &mut self.placing] {
            *waiting = waiting.filter(|known| *known != id);
        }
        if let Some(run) = self.run.as_mut().filter(|run| run.waits_for(id)) {
            run.task_ended();
        }
    }
}

/// Where contacts come from.
pub(super) fn source(robot: &RobotView) -> ContactSource {
    match robot.connection {
        Connection::Connected { twin: true, .. } => ContactSource::Twin,
        Connection::Connected { twin: false, .. } => ContactSource::Window,
        _ => ContactSource::None,
    }
}
