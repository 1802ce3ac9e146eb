//! Whether it watches, when it looks, and what was seen.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_drift::{Monitor, Sample, Verdict};
use plumbline_effects::RobotModel;
use plumbline_model::StereoFrame;

use super::DriftAround;
use super::command::DriftCommand;
use super::grid_room::{GridRoom, PlacesResult};
use super::stage::{DriftInput, DriftOutput};
use super::stated::Stated;
use super::view::{Anew, BeganAnew, DriftCourse, DriftView};
use super::watch::{EVERY, FIRST, Watch};
pub use super::work::Context;
use super::work::{DriftResult, DriftWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::stage::Timed;
use crate::ground::step::StepState;
use crate::ground::{Moment, Time, Workflow, World};
use crate::robot::RobotControl;

/// Watching drift. There is one at a time, of what is shown.
#[derive(Clone, Debug, Default)]
pub struct DriftWorkflow {
    /// Counts watches.
    pub(super) number: u64,
    pub(super) watch: Option<Watch>,
    /// What was seen in the watch under way, else in the last one.
    pub(super) course: Option<Arc<DriftCourse>>,
    /// The model with which the last watch was told that has ended, and of which source it was.
    pub(super) told_with: Option<(Arc<RobotModel>, u64)>,
    /// The watch under way began by itself, after another.
    anew: Option<Anew>,
    failed: Option<String>,
    down: Option<String>,
    pub(super) data_dir: PathBuf,
    /// A session is being made of what was watched.
    pub(super) logging: Option<JobId>,
    /// What was watched is being told with another model.
    pub(super) retelling: Option<JobId>,
    /// The session that was made last, and whether somebody was told of it.
    pub(super) log: Option<(PathBuf, bool)>,
    grid: GridRoom,
    stated: Stated,
}

impl DriftWorkflow {
    /// What the 9 by 4 evaluation gave that ended in a world; `None`: none did, or it is not judged yet.
    pub fn places_result(&self, world: World) -> Option<PlacesResult> {
        self.grid.result(world)
    }

    /// Whether it watches.
    pub fn is_watching(&self) -> bool {
        self.watch.is_some()
    }

    /// Whether the board is to be looked for: nothing is remembered yet.
    pub fn looks_for_board(&self) -> bool {
        self.watch.as_ref().is_some_and(|watch| !watch.has_looked)
    }

    /// A pair has come.
    pub fn saw(&mut self, frame: &StereoFrame, around: &DriftAround, context: &mut Context<'_>) {
        let now = context.time;
        self.grid.saw(&self.data_dir, around, context);
        let Some(watch) = &self.watch else { return };
        if let Some(why) = watch.begins_anew(around) {
            if let Some(text) = why.notice() {
                context.notices.add(NoticeLevel::Info, text);
            }
            self.begin_anew(why, around, now);
        }
        self.use_model(around, context);
        let number = self.number;
        let Some(watch) = self.watch.as_mut().filter(|_| self.retelling.is_none()) else { return };
        watch.take(number, frame, around, now.instant);
    }

    /// What the thread is to look at, if anything.
    pub fn input(&self) -> Option<Arc<DriftInput>> {
        self.watch.as_ref()?.pending.clone()
    }

    /// The thread has looked.
    pub fn looked(&mut self, output: Timed<DriftOutput>, context: &mut Context<'_>) {
        let DriftOutput { watch: number, at_s, look } = output.result;
        let Some(watch) = self.watch.as_mut().filter(|_| number == self.number) else { return };
        watch.rest(output.busy, context.time.instant);
        // It was told with the model before.
        if self.retelling.is_some() {
            return;
        }
        match look {
            Err(failure) => self.failed = Some(failure.0),
            Ok(look) => {
                self.failed = None;
                watch.epipolar_px = look.epipolar_px.or(watch.epipolar_px);
                watch.monitor.add(Sample { at_s, look });
                watch.has_seen();
                self.course = watch.course().map(Arc::new);
                watch.tell(context);
            }
        }
    }

    /// The thread met a defect on a pair: what it remembered is gone.
    pub fn gave_nothing(&mut self, why: &str, time: Time) {
        self.failed = Some(why.to_owned());
        if let Some(watch) = &mut self.watch {
            watch.pending = None;
            watch.due = time.instant + EVERY;
        }
    }

    /// The thread does its work, or why not.
    pub fn stage_is_down(&mut self, why: Option<String>) {
        if why.is_some()
            && let Some(watch) = &mut self.watch
        {
            watch.pending = None;
        }
        self.down = why;
    }

    /// Something was accepted or taken back: what was seen is told as it is now.
    fn use_model(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        let Some(watch) = &mut self.watch else { return };
        if Arc::ptr_eq(&watch.model, &around.model) {
            return;
        }
        watch.model = around.model.clone();
        if let Some(job) = self.retelling.take() {
            context.cancel(job);
        }
        if watch.monitor.samples().is_empty() {
            return;
        }
        self.retelling = Some(context.start(DriftWork::Retell {
            samples: watch.monitor.samples().into(),
            model: around.model.clone(),
            posture: around.posture(),
            knows_when: watch.from_switching_on,
        }));
    }

    fn retold(&mut self, monitor: Option<Monitor>, around: &DriftAround, context: &mut Context<'_>) {
        let Some(watch) = &mut self.watch else { return };
        let Some(monitor) = monitor else {
            let text = "What was watched cannot be told with the new model as the head stands: watching begins anew.";
            context.notices.add(NoticeLevel::Info, text);
            return self.begin_anew(BeganAnew::OtherModel, around, context.time);
        };
        watch.told_alarms = monitor.alarms().len();
        watch.told_motions = monitor.own_motions().len();
        watch.monitor = monitor;
        self.course = watch.course().map(Arc::new);
    }

    /// Nobody asked for it: that something had moved before, in the same world, stays said.
    fn begin_anew(&mut self, why: BeganAnew, around: &DriftAround, now: Time) {
        let is_same_world = self.watch.as_ref().is_some_and(|watch| watch.world == around.world);
        let seen = self.course.as_ref().filter(|course| matches!(course.verdict, Verdict::Moved(_)));
        let seen = seen.map(|course| course.sentence.clone());
        let earlier = self.anew.take().and_then(|anew| anew.moved_before);
        self.begin(around, now);
        let moved_before = seen.or(earlier).filter(|_| is_same_world);
        self.anew = Some(Anew { why, moved_before });
    }

    fn begin(&mut self, around: &DriftAround, now: Time) {
        self.number += 1;
        self.anew = None;
        self.retelling = None;
        self.failed = None;
        self.course = None;
        self.watch = Some(Watch::new(around, now));
    }
}

impl Workflow for DriftWorkflow {
    type Command = DriftCommand;
    type Work = DriftWork;
    type Control = RobotControl;
    type Around = DriftAround;
    type View = DriftView;

    /// Sessions are made in the folder of a world in `data_dir`.
    fn new(data_dir: &Path) -> Self {
        Self { data_dir: data_dir.to_owned(), ..Self::default() }
    }

    fn restore(&mut self, _: &DriftAround, context: &mut Context<'_>) {
        self.grid.list(&self.data_dir, context);
    }

    fn view(&mut self, around: &DriftAround, _: &Moment) -> Arc<DriftView> {
        let is_watching = self.watch.is_some();
        let moved = self.course.as_ref().is_some_and(|course| matches!(course.verdict, Verdict::Moved(_)));
        let step = match (&self.course, is_watching) {
            (Some(course), true) if moved => StepState::Stale { why: course.sentence.clone() },
            (_, true) => StepState::Running,
            (Some(_), false) => StepState::Done,
            (None, false) => StepState::NotDone,
        };
        let stated_m =
            self.course.as_ref().and_then(|course| self.stated.ninety_five_m(&course.table, around));
        let waits = self.down.clone().or_else(|| around.waits_because().map(str::to_owned));
        Arc::new(DriftView {
            step,
            is_watching,
            waits_because: waits.filter(|_| is_watching),
            looks_at: self.watch.as_ref().and_then(|watch| Some([watch.looked?, watch.due])),
            failed: self.failed.clone().filter(|_| is_watching),
            course: self.course.clone(),
            anew: self.anew.clone(),
            is_busy: self.logging.is_some() || self.retelling.is_some(),
            unexplained: self.unexplained(around),
            stated_m,
            log: self.log.as_ref().map(|(log, _)| log.clone()),
            grid: self.grid.view(around),
        })
    }

    fn apply(&mut self, command: DriftCommand, around: &DriftAround, context: &mut Context<'_>) {
        match command {
            DriftCommand::Start if !around.is_live => {
                context.refuse("Nothing can be watched yet: open the eyes, the twin's, or a recording.");
            }
            DriftCommand::Start => {
                self.begin(around, context.time);
                if let Some(watch) = &mut self.watch {
                    watch.due = context.time.instant + FIRST;
                }
            }
            DriftCommand::Stop if self.watch.is_none() => context.refuse("Nothing is being watched."),
            DriftCommand::Stop => {
                // What is told with another model while it ends is not told any more.
                let told = self.watch.take().filter(|_| self.retelling.is_none());
                self.told_with = told.map(|watch| (watch.model, watch.opened));
                self.retelling = None;
            }
            DriftCommand::Explain => self.explain(around, context),
            DriftCommand::Grid(command) => self.grid.apply(command, &self.data_dir, around, context),
        }
    }

    fn work_done(&mut self, id: JobId, result: DriftResult, around: &DriftAround, context: &mut Context<'_>) {
        match result {
            DriftResult::Logged(folder) => {
                self.logging.take_if(|logging| *logging == id);
                self.log = Some((folder, false));
            }
            // What was cancelled may have been done just then.
            DriftResult::Retold(monitor) => {
                if self.retelling.take_if(|retelling| *retelling == id).is_some() {
                    self.retold(monitor.map(|monitor| *monitor), around, context);
                }
            }
            of_grid => self.grid.work_done(id, of_grid, &self.data_dir, around, context),
        }
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, around: &DriftAround, context: &mut Context<'_>) {
        self.logging.take_if(|logging| *logging == id);
        if self.retelling.take_if(|retelling| *retelling == id).is_some() && why.is_some() {
            self.begin_anew(BeganAnew::OtherModel, around, context.time);
        }
        self.grid.work_ended(id, why, context);
    }
}
