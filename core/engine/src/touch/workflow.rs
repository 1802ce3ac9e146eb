//! What was planned, what is touched, where the screen lies.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::{CorrectionModel, Method};
use plumbline_effects::{RigModel, RobotModel};
use plumbline_hardware::joints::Touch;
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{PlanOptions, Purpose, TouchArea};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{Pixel, duration};

use super::command::{ContactWith, Correction, ScreenContact, ScreenWindow, TouchCommand};
use super::placement::Proposal;
use super::plan::{Corrector, PlanRequest, RunPlan};
use super::refusal::{Refusal, Trouble, Unplaced};
use super::run::{Now, Phase, Run};
use super::seen::Seen;
use super::store::{self, Runs, TrainedRun};
use super::view::{ContactSource, ContactView};
use super::work::{Context, TouchResult, TouchWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::motion::ScreenPlace;
use crate::rig_models::screen_in;
use crate::robot::view::{Connection, RobotView};
use crate::robot::{RobotControl, TouchNews};
use crate::touch::view::TouchView;

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
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct TouchWorkflow {
    folder: PathBuf,
    /// The part of the screen that the finger reaches, once that was looked for.
    pub(super) reach: Option<TouchArea>,
    pub(super) placement: Option<Arc<ScreenPlacement>>,
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
    pub(super) window: Option<ScreenWindow>,
    pub(super) last_contact: Option<ContactView>,
    /// What [`Self::screen`] gives.
    screen: Option<Touchscreen>,
    pub(super) seen: Seen,
}

impl TouchWorkflow {
    /// Nothing planned. Sessions are kept in `folder/sessions`, the place of the screen in
    /// `folder/screen.toml`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            reach: None,
            placement: None,
            proposal: None,
            correct_with: None,
            follows: None,
            options: None,
            planning: None,
            planned: None,
            starting: None,
            placing: None,
            run: None,
            runs: Runs::default(),
            last_session: None,
            window: None,
            last_contact: None,
            screen: None,
            seen: Seen::default(),
        }
    }

    /// The session that is written or shown; after it was closed, still the newest one.
    pub fn session(&self) -> Option<&Path> {
        self.run.as_ref().map(|run| run.session.as_path()).or(self.last_session.as_deref())
    }

    /// The session of a run that is finished and on disk, with a number that grows with its changes.
    pub fn finished_session(&self) -> Option<(&Path, u64)> {
        let run = self.run.as_ref().filter(|run| run.phase == Phase::Finished && run.is_on_disk())?;
        Some((run.session.as_path(), run.revision()))
    }

    /// The screen where it was measured to lie, on its block while a run has put it on one; `None`:
    /// nominal.
    pub fn screen(&self) -> Option<&Touchscreen> {
        self.screen.as_ref()
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: TouchCommand, around: &TouchAround, context: &mut Context<'_>) {
        let result = match command {
            TouchCommand::Plan(options) => self.plan(options, around, context),
            TouchCommand::CorrectWith(correction) => self.correct_with(correction, around, context),
            TouchCommand::Start => self.start(around, context),
            TouchCommand::Open { session } => self.open(session, around, context),
            TouchCommand::Close => self.close(context),
            TouchCommand::AcceptPlacement => self.accept_placement(context),
            TouchCommand::DiscardPlacement => {
                self.proposal = None;
                Ok(())
            }
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

    fn apply_to_run(
        &mut self,
        command: TouchCommand,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let prepares = matches!(command, TouchCommand::Resume | TouchCommand::Prepared { .. });
        let run = self.run.as_mut().ok_or(Refusal::NoRun)?;
        match command {
            TouchCommand::Pause if run.phase == Phase::Working => run.pause = true,
            TouchCommand::Pause => {}
            TouchCommand::Resume => {
                // Writing to disk needs no arm.
                let needs_arm = !run.progress.finished && !matches!(run.phase, Phase::Stuck(_));
                if let (Some(trouble), true) = (now.trouble, needs_arm) {
                    return Err(trouble.into());
                }
                if run.phase != Phase::Working || run.pause {
                    run.resume();
                }
            }
            TouchCommand::Skip => run.skip(context)?,
            TouchCommand::Finish => run.finish_now(&now, context),
            TouchCommand::Prepared { screen_height_m, payload_kg } => {
                run.prepared([screen_height_m, payload_kg])?;
            }
            TouchCommand::Redo { number } => redo(run, number)?,
            TouchCommand::Reject { number } if run.progress.reject(number) => run.changed(),
            TouchCommand::Reject { number } => {
                return Err(Refusal::NothingToReject(number));
            }
            TouchCommand::Restore { number } if run.progress.restore(number) => run.changed(),
            TouchCommand::Restore { number } => {
                return Err(Refusal::NothingToRestore(number));
            }
            _ => {}
        }
        if prepares {
            run.tell_twin(&around.robot, context);
        }
        run.go_on(&now, context);
        Ok(())
    }

    fn plan(
        &mut self,
        options: PlanOptions,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let corrector = match self.correct_with {
            None => Corrector::None,
            Some(Correction::Model(method)) => Corrector::Model(model_of(around, method)?),
            Some(Correction::Effects) => Corrector::Effects(around.model.clone()),
        };
        if let Some(earlier) = self.planning.take() {
            context.cancel(earlier);
        }
        let screen = self.placed_screen(&around.rig);
        let rig = Arc::new(Rig { touchscreen: screen, ..(*around.rig).clone() });
        self.options = Some(options.clone());
        self.planning = Some(context.start(TouchWork::Plan(PlanRequest {
            rig,
            place: self.screen_place(),
            options,
            corrector,
        })));
        Ok(())
    }

    /// Plans once more what is planned, because what it depends on has changed.
    fn plan_anew(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let wanted = self.planned.is_some() || self.planning.is_some();
        if let (Some(options), true, None) = (self.options.clone(), wanted, self.active_run())
            && let Err(reason) = self.plan(options, around, context)
        {
            context.refuse(reason);
        }
    }

    fn correct_with(
        &mut self,
        correction: Option<Correction>,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        if let Some(Correction::Model(method)) = correction {
            model_of(around, method)?;
        }
        self.correct_with = correction;
        self.plan_anew(around, context);
        Ok(())
    }

    fn start(&mut self, around: &TouchAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        if self.planning.is_some() {
            return Err(Refusal::StillPlanning);
        }
        let (plan, of_screen) = self.planned.clone().ok_or(Refusal::NothingPlanned)?;
        if plan.reachable() == 0 {
            return Err(Refusal::NothingInReach);
        }
        if let Some(trouble) = self.trouble(around) {
            return Err(trouble.into());
        }
        let rig = Arc::new(Rig { touchscreen: of_screen, ..(*around.rig).clone() });
        let sessions = self.folder.join("sessions");
        self.starting =
            Some(context.start(TouchWork::Begin { sessions, rig, plan, started: context.time.day }));
        Ok(())
    }

    fn open(
        &mut self,
        session: PathBuf,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let rig = around.rig.clone();
        self.starting = Some(context.start(TouchWork::Open { session, rig }));
        Ok(())
    }

    fn close(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        if self.run.as_ref().is_some_and(|run| !run.is_on_disk()) {
            return Err(Refusal::NotOnDisk);
        }
        if let Some(id) = self.planning.take() {
            context.cancel(id);
        }
        (self.planned, self.options) = (None, None);
        let Some(run) = self.run.take() else { return Ok(()) };
        if run.touch.is_some() {
            context.control(RobotControl::AbandonTouch);
        }
        if run.is_active() && !run.progress.finished {
            self.runs.unfinished.insert(0, store::unfinished(&run.session, &run.progress));
        }
        self.last_session = Some(run.session);
        Ok(())
    }

    fn accept_placement(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let proposal = self.proposal.as_ref();
        let proposal = proposal.ok_or(Refusal::NoPlacement)?;
        let kept = screen_in(&self.folder);
        context.start(TouchWork::Accept { kept, placement: proposal.placement.clone() });
        Ok(())
    }

    fn use_nominal(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        context.start(TouchWork::Forget { kept: screen_in(&self.folder) });
        Ok(())
    }

    fn contact(&mut self, contact: ScreenContact, around: &TouchAround, context: &mut Context<'_>) {
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

    fn show_contact(&mut self, pixel: Pixel<plumbline_model::session::Screen>, is_down: bool) {
        let number = self.last_contact.map_or(0, |last| last.number);
        let begins = is_down && !self.last_contact.is_some_and(|last| last.is_down);
        self.last_contact = Some(ContactView { pixel, number: number + u64::from(begins), is_down });
    }

    fn set_window(&mut self, window: Option<ScreenWindow>, around: &TouchAround, context: &mut Context<'_>) {
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

    /// The robot's thread tells how a touch is doing.
    pub fn news(&mut self, news: TouchNews, around: &TouchAround, context: &mut Context<'_>) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = &mut self.run else { return };
        if let Some(pixel) = run.news(news, &now, context)
            && source(&around.robot) == ContactSource::Twin
        {
            self.show_contact(pixel, true);
            self.show_contact(pixel, false);
        }
        self.refresh(around, context);
    }

    /// The robot has something new, or time has passed.
    pub fn step(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = &mut self.run else { return };
        if run.touch.is_some() && !around.robot.connection.is_connected() {
            run.lost(
                "The connection to the robot is gone. Connect again, look that the arm is free, then go on.",
            );
        }
        let before = (run.phase.clone(), run.task());
        run.go_on(&now, context);
        if before != (run.phase.clone(), run.task()) {
            self.refresh(around, context);
        }
    }

    /// Work has ended with a result.
    pub fn work_done(
        &mut self,
        id: JobId,
        result: TouchResult,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) {
        match result {
            TouchResult::Restored { placement, runs, reach } => {
                self.reach = reach;
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
                self.placement = Some(placement);
                self.plan_anew(around, context);
            }
            TouchResult::Forgotten => {
                self.placement = None;
                self.plan_anew(around, context);
            }
            TouchResult::Written { .. } | TouchResult::Routed { .. } => {
                self.run_work_done(id, result, around, context);
            }
            // A plan or a session that nobody waits for any more.
            TouchResult::Planned(..)
            | TouchResult::Begun { .. }
            | TouchResult::Opened { .. }
            | TouchResult::Placed(_) => {}
        }
        self.go_on(around, context);
        self.refresh(around, context);
    }

    fn run_work_done(
        &mut self,
        id: JobId,
        result: TouchResult,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = self.run.as_mut().filter(|run| run.waits_for(id)) else { return };
        match result {
            TouchResult::Written { revision, problem } => run.written(revision, problem, &now, context),
            TouchResult::Routed { number, planner, order } => {
                run.routed(number, planner, order, &now, context);
            }
            _ => {}
        }
    }

    fn restored(
        &mut self,
        placement: Option<Result<Arc<ScreenPlacement>, String>>,
        runs: Runs,
        context: &mut Context<'_>,
    ) {
        self.runs = runs;
        match placement {
            None => {}
            Some(Ok(placement)) => self.placement = Some(placement),
            Some(Err(reason)) => context.notices.add(NoticeLevel::Warning, reason),
        }
    }

    fn placed(&mut self, placed: Result<Proposal, Arc<Unplaced>>, context: &mut Context<'_>) {
        let run = self.run.as_mut();
        let wanted = run.as_ref().is_some_and(|run| run.plan.options.purpose == Purpose::PlaceScreen);
        match placed {
            Ok(proposal) => {
                if let Some(run) = run.filter(|run| run.session == proposal.session) {
                    run.progress.gave_placement = Some(proposal.placement.at);
                    run.changed();
                }
                if let Some(trained) = &mut self.runs.trained
                    && trained.session == proposal.session
                {
                    trained.gave_placement = Some(proposal.placement.at);
                }
                self.proposal = Some(proposal);
            }
            Err(reason) if wanted => context.refuse(reason),
            Err(reason) => log::info!("no place of the screen from these touches: {reason}"),
        }
    }

    /// Work has ended without a result.
    pub fn work_ended(&mut self, id: JobId) {
        for waiting in [&mut self.planning, &mut self.starting, &mut self.placing] {
            *waiting = waiting.filter(|known| *known != id);
        }
        if let Some(run) = self.run.as_mut().filter(|run| run.waits_for(id)) {
            run.task_ended();
        }
    }

    fn go_on(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        if let Some(run) = &mut self.run {
            run.go_on(&now, context);
        }
    }

    /// Targets are corrected by the model's effects from the moment that it has some, until the operator
    /// chooses otherwise; a run that is under way ends as it began.
    fn follow_model(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let now = around.model.added();
        let same = self.follows.as_ref().is_some_and(|before| Arc::ptr_eq(before, now));
        if same || self.no_run_under_way().is_err() {
            return;
        }
        let before = self.follows.replace(now.clone());
        let had_effects = before.is_some_and(|before| !before.is_nominal());
        match (had_effects, !now.is_nominal(), self.correct_with) {
            (false, true, None) => self.correct_with = Some(Correction::Effects),
            (true, false, Some(Correction::Effects)) => self.correct_with = None,
            (true, true, Some(Correction::Effects)) => {}
            _ => return,
        }
        self.plan_anew(around, context);
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

    /// A run has come to its end: its touches tell where the screen lies.
    fn ended(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let Some(run) = &self.run else { return };
        let touches: Vec<_> = run.progress.counted().cloned().collect();
        let text =
            format!("The run is finished: {} of {} targets touched.", touches.len(), run.plan.reachable());
        context.notices.add(NoticeLevel::Success, text);
        let purpose = run.plan.options.purpose;
        if purpose == Purpose::Train && !touches.is_empty() {
            self.runs.trained = Some(TrainedRun {
                session: run.session.clone(),
                screen: run.screen.clone(),
                gave_placement: run.progress.gave_placement,
            });
        }
        // A check is made with a model: what it touches was sent elsewhere on purpose, and says
        // nothing new of the screen.
        if purpose != Purpose::Check {
            let work = TouchWork::Place {
                session: run.session.clone(),
                rig: around.rig.clone(),
                joints: run.joints.clone(),
                touches,
            };
            self.placing = Some(context.start(work));
        }
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

    /// The screen where it is taken to lie, without a block.
    pub(super) fn placed_screen(&self, rig: &Rig) -> Touchscreen {
        self.placement.as_ref().map_or(&rig.touchscreen, |placement| &placement.screen).clone()
    }

    /// Whether the place of the screen was measured.
    fn screen_place(&self) -> ScreenPlace {
        if self.placement.is_some() { ScreenPlace::Measured } else { ScreenPlace::Nominal }
    }

    fn now<'a>(&self, around: &'a TouchAround, screen: &'a Touchscreen) -> Now<'a> {
        Now {
            rig: &around.rig,
            screen,
            place: self.screen_place(),
            robot: &around.robot,
            trouble: self.trouble(around),
        }
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
        } else if source(robot) == ContactSource::Window && self.window.is_none() {
            Some(Trouble::WindowClosed)
        } else {
            None
        }
    }
}

impl Workflow for TouchWorkflow {
    type Command = TouchCommand;
    type Work = TouchWork;
    type Control = RobotControl;
    type Around = TouchAround;
    type View = TouchView;

    fn new(folder: &Path) -> Self {
        Self::new(folder)
    }

    fn view(&mut self, around: &TouchAround, _moment: &Moment) -> Arc<TouchView> {
        Arc::new(Self::view(self, around))
    }

    fn restore(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        context.start(TouchWork::Restore { folder: self.folder.clone(), rig: around.rig.clone() });
    }

    fn apply(&mut self, command: TouchCommand, around: &TouchAround, context: &mut Context<'_>) {
        self.apply(command, around, context);
    }

    fn work_done(&mut self, id: JobId, result: TouchResult, around: &TouchAround, context: &mut Context<'_>) {
        self.work_done(id, result, around, context);
    }

    fn work_ended(
        &mut self,
        id: JobId,
        _why: Option<&str>,
        _around: &TouchAround,
        _context: &mut Context<'_>,
    ) {
        self.work_ended(id);
    }
}

fn redo(run: &mut Run, number: usize) -> Result<(), Refusal> {
    let aim = run.plan.aim(number).ok_or(Refusal::NoTarget(number))?;
    if let Some(reason) = &aim.refusal {
        return Err(Refusal::CannotBeTouched { number, reason: reason.clone() });
    }
    if run.touch.as_ref().is_some_and(|touch| touch.number == number) {
        return Err(Refusal::BeingTouched(number));
    }
    run.progress.redo(number);
    run.changed();
    if run.phase == Phase::Finished {
        run.phase = Phase::Paused(Some(format!("Target {number} waits to be touched once more.")));
    }
    Ok(())
}

fn model_of(around: &TouchAround, method: Method) -> Result<Arc<CorrectionModel>, Refusal> {
    let model = around.models.iter().find(|model| model.method() == method).cloned();
    model.ok_or(Refusal::NoModel(method))
}

/// Where contacts come from.
pub(super) fn source(robot: &RobotView) -> ContactSource {
    match robot.connection {
        Connection::Connected { twin: true, .. } => ContactSource::Twin,
        Connection::Connected { twin: false, .. } => ContactSource::Window,
        _ => ContactSource::None,
    }
}
