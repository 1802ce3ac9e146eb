//! One run: which touch is next, what is waited for, what is not on disk yet.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::Pixel;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Screen, Touchscreen};

use super::depth::Depth;
use super::plan::{Aim, RunPlan};
use super::record::{Ended, Fate, Progress, TouchRecord};
use super::refusal::{Refusal, Trouble};
use super::store::Stored;
use super::work::{Context, RouteRequest, TouchWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::motion::{NoWay, Planner, ScreenPlace, TouchPace};
use crate::robot::patience::{Look, Patience};
use crate::robot::view::{Connection, RobotView};
use crate::robot::{RobotControl, TouchNews, TouchOrder, TouchRun, TouchStage};
use crate::twin::command::TwinCommand;

/// After so many touches without a contact, one after the other, something is wrong.
pub const MISSES: usize = 5;
/// What is said of a finger that ended in the air.
const MET_NOTHING: &str = "The lowest place was reached and the screen felt nothing.";
/// The pace is that of so many touches.
const PACE_OF: usize = 15;

/// What a run does.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Goes on by itself.
    Working,
    /// Holds; why, if not because it was asked to.
    Paused(Option<String>),
    /// Cannot write: why. Tries again when told to go on.
    Stuck(String),
    /// The screen has to be put on a block of this height (m), the hand to carry this mass (kg).
    Preparing([f64; 2]),
    /// Nothing is left to be done.
    Finished,
}

/// Work that a run waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// What happened is being written.
    Write,
    /// The way to a target is being looked for.
    Route(usize),
}

/// What is done when the touch under way ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AtEnd {
    /// What was measured is kept.
    Keep,
    /// The operator leaves it out.
    Skip,
    /// It was broken off and is made again.
    Retry,
    /// The run ends with it.
    Finish,
}

/// The touch that is under way.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderWay {
    /// Which order.
    order: u64,
    /// Number of the planned touch.
    pub number: usize,
    /// What the arm does; `None` before it said so.
    pub stage: Option<TouchStage>,
    at_end: AtEnd,
}

/// What a run can see of the rest.
pub struct Now<'a> {
    /// The robot, its screen nominal.
    pub rig: &'a Arc<Rig>,
    /// The screen where it is taken to lie, without a block.
    pub screen: &'a Touchscreen,
    /// Whether that place was measured.
    pub place: ScreenPlace,
    /// The robot now.
    pub robot: &'a RobotView,
    /// Why nothing can be touched, and what to do; a sentence.
    pub trouble: Option<Trouble>,
}

/// A run, under way or shown.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its folder.
    pub session: PathBuf,
    /// The plan.
    pub plan: Arc<RunPlan>,
    /// What happened.
    pub progress: Progress,
    /// Joints of the chain.
    pub joints: Vec<String>,
    /// The screen where it was taken to lie when the run was begun.
    pub screen: Touchscreen,
    /// What it does.
    pub phase: Phase,
    /// The touch that is under way.
    pub touch: Option<UnderWay>,
    /// Whether it holds after the touch that is under way.
    pub pause: bool,
    task: Option<(JobId, Task)>,
    revision: u64,
    written: u64,
    /// Number of the newest touch that is not on disk yet.
    pub unwritten: Option<usize>,
    misses: usize,
    depth: Depth,
    patience: Patience,
    contacts: Vec<Instant>,
    planner: Option<(Touchscreen, Arc<Planner>)>,
    ended: bool,
    /// Whether the disk knows that it is finished.
    end_on_disk: bool,
}

impl Run {
    /// A run that was just begun; goes on by itself.
    pub fn begun(session: PathBuf, stored: Stored) -> Self {
        Self { phase: Phase::Working, written: 1, ..Self::opened(session, stored) }
    }

    /// A run of earlier; holds. Its tables are written anew before it goes on, in case the
    /// program ended between two of its files.
    pub fn opened(session: PathBuf, stored: Stored) -> Self {
        let Stored { plan, progress, screen, joints } = stored;
        Self {
            end_on_disk: progress.finished,
            session,
            plan: Arc::new(plan),
            phase: if progress.finished { Phase::Finished } else { Phase::Paused(None) },
            progress,
            joints,
            screen,
            touch: None,
            pause: false,
            task: None,
            revision: 1,
            written: 0,
            unwritten: None,
            misses: 0,
            depth: Depth::default(),
            patience: Patience::default(),
            contacts: vec![],
            planner: None,
            ended: false,
        }
    }

    /// Whether it is neither finished nor waits for the disk to say so.
    pub fn is_active(&self) -> bool {
        self.phase != Phase::Finished
    }

    /// The work that is waited for.
    pub fn task(&self) -> Option<Task> {
        self.task.map(|(_, task)| task)
    }

    /// Whether this work is the run's.
    pub fn waits_for(&self, id: JobId) -> bool {
        self.task.is_some_and(|(waiting, _)| waiting == id)
    }

    /// Whether it has come to its end since the last call.
    pub fn take_ended(&mut self) -> bool {
        std::mem::take(&mut self.ended)
    }

    /// Something has to be written.
    pub fn changed(&mut self) {
        self.revision += 1;
        if let Phase::Stuck(_) = self.phase {
            self.phase = if self.progress.finished { Phase::Finished } else { Phase::Paused(None) };
        }
    }

    /// Whether it is finished and the disk knows it.
    pub fn is_over(&self) -> bool {
        self.phase == Phase::Finished && self.end_on_disk
    }

    /// Whether everything that happened is on disk.
    pub fn is_on_disk(&self) -> bool {
        self.revision == self.written
    }

    /// What becomes of a planned touch, as it stands now.
    pub fn fate(&self, aim: &Aim) -> Fate {
        self.progress.fate(aim.touch.number)
    }

    /// The touch that is done next: in the order of the plan; then those that are made once more,
    /// first those that need no other block or weight.
    pub fn next(&self) -> Option<&Aim> {
        let waits = |aim: &&Aim| {
            aim.refusal.is_none()
                && !self.progress.again.contains(&aim.touch.number)
                && self.fate(aim) == Fate::Waiting
        };
        if let Some(aim) = self.plan.touches.iter().find(waits) {
            return Some(aim);
        }
        let again = || self.progress.again.iter().filter_map(|number| self.plan.aim(*number));
        again().find(|aim| aim.preparation() == self.progress.prepared).or_else(|| again().next())
    }

    /// Touches that are left.
    pub fn left(&self) -> usize {
        let waits = |aim: &&Aim| aim.refusal.is_none() && self.fate(aim) == Fate::Waiting;
        self.plan.touches.iter().filter(waits).count()
    }

    /// Time that the rest takes at the pace so far; before there is one, as estimated.
    pub fn remaining(&self) -> Option<Duration> {
        let newest = &self.contacts[self.contacts.len().saturating_sub(PACE_OF)..];
        let mut gaps: Vec<Duration> =
            newest.windows(2).map(|pair| pair[1].saturating_duration_since(pair[0])).collect();
        gaps.sort();
        let planned = self.plan.duration_s / self.plan.reachable().max(1) as f64;
        // The median: a pause in between says nothing about the pace.
        let each_s = gaps.get(gaps.len() / 2).map_or(planned, Duration::as_secs_f64);
        Duration::try_from_secs_f64(each_s * self.left() as f64).ok()
    }

    /// Does what can be done now: writes, looks for the way to the next target, or ends.
    pub fn go_on(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        if self.task.is_some() || self.touch.is_some() {
            return;
        }
        if !self.is_on_disk() {
            if !matches!(self.phase, Phase::Stuck(_)) {
                self.write(context);
            }
            return;
        }
        if self.phase != Phase::Working {
            return;
        }
        if std::mem::take(&mut self.pause) {
            self.phase = Phase::Paused(None);
            return;
        }
        let Some(aim) = self.next().cloned() else { return self.finish(now, context) };
        if let Some(trouble) = now.trouble {
            self.phase = Phase::Paused(Some(trouble.to_string()));
            return;
        }
        if aim.preparation() != self.progress.prepared {
            self.phase = Phase::Preparing(aim.preparation());
            return;
        }
        self.route(aim, now, context);
    }

    fn write(&mut self, context: &mut Context<'_>) {
        let work = TouchWork::Write {
            session: self.session.clone(),
            joints: self.joints.clone(),
            progress: Arc::new(self.progress.clone()),
            revision: self.revision,
        };
        self.task = Some((context.start(work), Task::Write));
    }

    fn route(&mut self, aim: Aim, now: &Now<'_>, context: &mut Context<'_>) {
        let Some(from) = now.robot.measured.clone() else {
            let why = "The joints have not been read yet. Wait a moment, then go on.";
            self.phase = Phase::Paused(Some(why.to_owned()));
            return;
        };
        let screen = now.screen.raised(aim.touch.screen_height_m);
        if self.planner.as_ref().is_some_and(|(of, _)| *of != screen) {
            // What was found of how low it lies is of its place before.
            (self.planner, self.depth) = (None, Depth::default());
        }
        let planner = self.planner.as_ref();
        let rig = match planner {
            Some((_, planner)) => planner.rig().clone(),
            None => Arc::new(Rig { touchscreen: screen, ..(**now.rig).clone() }),
        };
        let request = RouteRequest {
            rig,
            place: now.place,
            planner: planner.map(|(_, planner)| planner.clone()),
            order: next_order(),
            pace: TouchPace::default().at(speed(now.robot)),
            finger: self.plan.options.finger,
            deeper_m: self.depth.deeper_m(aim.touch.number),
            from,
            aim: Box::new(aim),
        };
        let number = request.aim.touch.number;
        self.task = Some((context.start(TouchWork::Route(request)), Task::Route(number)));
    }

    /// What happened is on disk, or why it is not.
    pub fn written(
        &mut self,
        revision: u64,
        problem: Option<String>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        self.task = None;
        match problem {
            Some(reason) => {
                let text = format!("{reason} The touches are kept in memory; go on to write them again.");
                self.phase = Phase::Stuck(text);
            }
            None => {
                self.written = revision;
                self.end_on_disk = self.progress.finished && (self.end_on_disk || self.is_on_disk());
                if self.written == self.revision {
                    self.unwritten = None;
                }
            }
        }
        self.go_on(now, context);
    }

    /// The way to a target was found, or why not.
    pub fn routed(
        &mut self,
        number: usize,
        planner: Option<Arc<Planner>>,
        order: Result<Box<TouchOrder>, NoWay>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        self.task = None;
        if let Some(planner) = planner {
            self.planner = Some((planner.rig().touchscreen.clone(), planner));
        }
        // Meanwhile it may have been paused, skipped, or something changed that has to be written.
        let wanted = self.phase == Phase::Working
            && !self.pause
            && now.trouble.is_none()
            && self.is_on_disk()
            && self.next().is_some_and(|aim| aim.touch.number == number);
        match order {
            Ok(order) if wanted => {
                self.touch = Some(UnderWay { order: order.order, number, stage: None, at_end: AtEnd::Keep });
                context.control(RobotControl::Touch(order));
            }
            Err(reason) if wanted => {
                let text = format!("Touch {number} was not begun: {reason} Go on to try again, or skip it.");
                self.phase = Phase::Paused(Some(text));
            }
            Ok(_) | Err(_) => self.go_on(now, context),
        }
    }

    /// Work has ended without a result.
    pub fn task_ended(&mut self) {
        self.phase = match self.task.take() {
            Some((_, Task::Write)) => Phase::Stuck(
                "The touches could not be written. They are kept in memory; go on to write them again."
                    .to_owned(),
            ),
            _ => Phase::Paused(Some("The way to the next target was not looked for to the end.".to_owned())),
        };
    }

    /// The robot's thread tells how a touch is doing; gives the contact, if there was one.
    pub fn news(
        &mut self,
        news: TouchNews,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) -> Option<Pixel<Screen>> {
        let under_way = self.touch.as_mut().filter(|touch| touch.order == news.order)?;
        if let TouchRun::Doing(stage) = news.state {
            under_way.stage = Some(stage);
            return None;
        }
        let UnderWay { number, at_end, .. } = self.touch.take()?;
        let mut contact = None;
        match news.state {
            TouchRun::Touched(measured) => {
                contact = Some(measured.pixel);
                self.contacts.push(measured.at);
                if at_end == AtEnd::Skip {
                    self.end(number, Ended::Skipped);
                } else {
                    self.touched(number, &measured);
                }
            }
            TouchRun::Missed(_) | TouchRun::MetNothing if at_end == AtEnd::Skip => {
                self.end(number, Ended::Skipped);
            }
            TouchRun::MetNothing if at_end == AtEnd::Keep => self.met_nothing(number, context),
            TouchRun::Missed(why) if at_end == AtEnd::Keep => self.missed(number, why),
            TouchRun::Unheard(why) if at_end == AtEnd::Keep && self.waits_to_be_heard(context) => {
                let text = format!(
                    "{why} The run goes on by itself with touch {number} as soon as the joints are heard again."
                );
                self.phase = Phase::Paused(Some(text));
            }
            TouchRun::Interrupted(why) | TouchRun::Unheard(why) => {
                if at_end == AtEnd::Skip {
                    self.end(number, Ended::Skipped);
                }
                if at_end != AtEnd::Finish {
                    self.interrupted(number, &why);
                }
            }
            TouchRun::Missed(_) | TouchRun::MetNothing | TouchRun::Doing(_) => {}
        }
        if at_end == AtEnd::Finish {
            self.finish(now, context);
        }
        self.go_on(now, context);
        contact
    }

    fn touched(&mut self, number: usize, measured: &crate::robot::TouchMeasurement) {
        let record = self.plan.aim(number).and_then(|aim| TouchRecord::new(aim, measured));
        match record {
            Some(record) => {
                self.progress.touched(record);
                self.unwritten = Some(number);
                self.misses = 0;
                self.depth.met(number);
                self.patience.done();
                self.changed();
            }
            None => self.missed(number, "The contact had no place.".to_owned()),
        }
    }

    /// The finger ended above the glass: it is looked for a little lower, or missed.
    fn met_nothing(&mut self, number: usize, context: &mut Context<'_>) {
        match self.depth.met_nothing(number) {
            Some(deeper_m) => {
                let text = format!(
                    "Touch {number} met nothing: the arm may stand higher than its encoders say. The same place is touched again, as much as {:.0} mm deeper; the finger stops at what it meets.",
                    deeper_m * 1e3
                );
                context.notices.add(NoticeLevel::Info, text);
            }
            None => self.missed(
                number,
                format!("{MET_NOTHING} Measure where the screen lies, or look whether it works."),
            ),
        }
    }

    fn missed(&mut self, number: usize, why: String) {
        self.depth.forget();
        self.end(number, Ended::Missed(why));
        self.misses += 1;
        if self.misses >= MISSES && self.phase == Phase::Working {
            self.misses = 0;
            self.phase = Phase::Paused(Some(format!(
                "{MISSES} touches in a row felt nothing. Look whether the finger points down and the touch window answers to a hand; if the finger ends above the glass, measure the place of the screen anew. Then go on, and touch the missed ones again."
            )));
        }
    }

    fn end(&mut self, number: usize, how: Ended) {
        self.progress.end(number, how);
        self.changed();
    }

    /// The touch under way cannot go on without the operator.
    fn interrupted(&mut self, number: usize, why: &str) {
        self.pause = false;
        if self.phase == Phase::Working {
            let again = format!("Touch {number} is made again when you go on.");
            self.phase = Phase::Paused(Some(format!("{why} {again}")));
        }
    }

    fn waits_to_be_heard(&mut self, context: &Context<'_>) -> bool {
        self.phase == Phase::Working && !self.pause && self.patience.begin(context.time.instant)
    }

    /// Looks whether a run that holds because joints were not heard goes on by itself.
    pub fn look_again(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        let Phase::Paused(why) = &mut self.phase else {
            self.patience.end();
            return;
        };
        let trouble = now.trouble.map(|trouble| trouble.to_string());
        match self.patience.look(now.robot, trouble, &self.joints, context.time.instant) {
            Look::Same => {}
            Look::GoesOn => {
                self.phase = Phase::Working;
                let text = "The joints are heard again: the run goes on by itself.";
                context.notices.add(NoticeLevel::Info, text.to_owned());
            }
            Look::GivesUp(reason) => {
                let before = why.take().unwrap_or_default();
                *why = Some(format!("{before} It did not: {reason} Go on when the way is free."));
            }
        }
    }

    /// A run that would go on by itself waits for the operator.
    pub fn hold_on(&mut self) {
        if self.patience.end() {
            self.phase = Phase::Paused(None);
        }
    }

    /// The operator decides what becomes of a run that waits for its joints.
    pub fn waits_no_more(&mut self) {
        self.patience.end();
    }

    /// The robot is gone: no more is heard of the touch under way.
    pub fn lost(&mut self, why: &str) {
        let Some(touch) = self.touch.take() else { return };
        match touch.at_end {
            AtEnd::Skip => self.end(touch.number, Ended::Skipped),
            AtEnd::Keep | AtEnd::Retry | AtEnd::Finish => {}
        }
        self.interrupted(touch.number, why);
    }

    /// Breaks the touch under way off, which is made again later.
    pub fn break_off(&mut self, why: String, context: &mut Context<'_>) {
        if let Some(touch) = &mut self.touch {
            touch.at_end = AtEnd::Retry;
            context.control(RobotControl::AbandonTouch);
        }
        if self.phase == Phase::Working {
            self.phase = Phase::Paused(Some(why));
        }
    }

    /// Leaves the touch out that is under way or next.
    ///
    /// # Errors
    /// A sentence, when there is none.
    pub fn skip(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        if let Some(touch) = &mut self.touch {
            touch.at_end = AtEnd::Skip;
            context.control(RobotControl::AbandonTouch);
            return Ok(());
        }
        let next = self.next().filter(|_| self.phase != Phase::Finished);
        let number = next.map(|aim| aim.touch.number).ok_or(Refusal::NothingToSkip)?;
        self.end(number, Ended::Skipped);
        if let Phase::Preparing(_) = self.phase {
            self.phase = Phase::Working;
        }
        Ok(())
    }

    /// Goes on by itself from now on.
    pub fn resume(&mut self) {
        (self.misses, self.pause) = (0, false);
        self.phase = if self.progress.finished { Phase::Finished } else { Phase::Working };
    }

    /// Ends the run with what there is.
    pub fn finish_now(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        match &mut self.touch {
            _ if self.progress.finished => {}
            Some(touch) => {
                touch.at_end = AtEnd::Finish;
                context.control(RobotControl::AbandonTouch);
            }
            None => self.finish(now, context),
        }
    }

    fn finish(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        self.phase = Phase::Finished;
        self.progress.finished = true;
        self.ended = true;
        self.changed();
        self.go_on(now, context);
    }

    /// Grows with every change of what is on disk.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The twin has no operator who puts a block under its screen: it does so by itself.
    pub fn tell_twin(&self, robot: &RobotView, context: &mut Context<'_>) {
        if matches!(robot.connection, Connection::Connected { twin: true, .. }) {
            let [screen_height_m, payload_kg] = self.progress.prepared;
            let command = TwinCommand::PrepareTouch { screen_height_m, payload_kg };
            context.control(RobotControl::Twin(command));
        }
    }

    /// The screen stands on a block, the hand carries a weight, as they should or not.
    ///
    /// # Errors
    /// A sentence, when these are no numbers.
    pub fn prepared(&mut self, preparation: [f64; 2]) -> Result<(), Refusal> {
        if preparation.iter().any(|value| !(value.is_finite() && *value >= 0.0)) {
            return Err(Refusal::NotNumbers);
        }
        self.progress.prepared = preparation;
        self.changed();
        if let Phase::Preparing(_) = self.phase {
            self.phase = Phase::Working;
        }
        Ok(())
    }
}

/// Orders count through the program, so that what is said of one is never taken for another's, be it
/// of the robot or of the twin.
fn next_order() -> u64 {
    use std::sync::atomic::{AtomicU64, Ordering};
    static ORDERS: AtomicU64 = AtomicU64::new(1);
    ORDERS.fetch_add(1, Ordering::Relaxed)
}

/// Share of the usual speed; a view that says nothing says the usual one.
fn speed(robot: &RobotView) -> f64 {
    if robot.speed > 0.0 { robot.speed } else { 1.0 }
}
