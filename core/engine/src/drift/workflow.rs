//! Whether it watches, when it looks, and what was seen.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_drift::{Monitor, Sample, Verdict, WatcherSetup, is_too_short, words};
use plumbline_effects::RobotModel;
use plumbline_model::StereoFrame;

use super::DriftAround;
use super::command::DriftCommand;
use super::stage::{DriftInput, DriftOutput};
use super::view::{DriftCourse, DriftPoint, DriftView};
pub use super::work::Context;
use super::work::{DriftResult, DriftWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::stage::Timed;
use crate::ground::step::StepState;
use crate::ground::{Moment, Nothing, Time, Workflow};

/// It looks no more often than this.
const EVERY: Duration = Duration::from_secs(2);
/// It takes no more than this share of the time that passes.
const MOST_SHARE: f64 = 0.03;
/// The clock of the eyes goes back by more than this when they were switched off, s.
const WENT_BACK_S: f64 = 1.0;

/// Watching drift. There is one at a time, of what is shown.
#[derive(Clone, Debug, Default)]
pub struct DriftWorkflow {
    /// Counts watches.
    number: u64,
    watch: Option<Watch>,
    /// What was seen in the watch under way, else in the last one.
    course: Option<Arc<DriftCourse>>,
    failed: Option<String>,
    down: Option<String>,
    data_dir: PathBuf,
    /// A session is being made of what was watched.
    logging: Option<JobId>,
    /// What was watched is being told with another model.
    retelling: Option<JobId>,
    /// The session that was made last, and whether somebody was told of it.
    log: Option<(PathBuf, bool)>,
}

/// A watch under way.
#[derive(Clone, Debug)]
struct Watch {
    began: Instant,
    /// Of which source, counted.
    opened: u64,
    /// Whether the eyes' clock is known.
    from_switching_on: bool,
    monitor: Monitor,
    /// The model that it is told with.
    model: Arc<RobotModel>,
    due: Instant,
    pending: Option<Arc<DriftInput>>,
    told_alarms: usize,
    told_motions: usize,
    epipolar_px: Option<f64>,
}

impl DriftWorkflow {
    /// A pair has come.
    pub fn saw(&mut self, frame: &StereoFrame, around: &DriftAround, context: &mut Context<'_>) {
        let now = context.time;
        let Some(watch) = &self.watch else { return };
        if watch.opened != around.opened || watch.from_switching_on != around.eyes_on_s.is_some() {
            self.begin(around, now);
        } else if self.went_back(around) {
            let text = "The cameras were switched on again: watching drift begins anew.";
            context.notices.add(NoticeLevel::Info, text);
            self.begin(around, now);
        }
        self.use_model(around, context);
        let number = self.number;
        let Some(watch) = self.watch.as_mut().filter(|_| self.retelling.is_none()) else { return };
        if now.instant < watch.due || watch.pending.is_some() || around.waits_because().is_some() {
            return;
        }
        let since = now.instant.saturating_duration_since(watch.began).as_secs_f64();
        let setup = WatcherSetup {
            model: around.model.clone(),
            posture: around.posture(),
            eyes_on_s: around.eyes_on_s,
            references: around.references(frame),
        };
        let at_s = around.eyes_on_s.unwrap_or(since);
        watch.pending = Some(Arc::new(DriftInput { watch: number, frame: frame.clone(), setup, at_s }));
        watch.due = now.instant + EVERY;
    }

    /// What the thread is to look at, if anything.
    pub fn input(&self) -> Option<Arc<DriftInput>> {
        self.watch.as_ref()?.pending.clone()
    }

    /// The thread has looked.
    pub fn looked(&mut self, output: Timed<DriftOutput>, context: &mut Context<'_>) {
        let DriftOutput { watch: number, at_s, look } = output.result;
        let Some(watch) = self.watch.as_mut().filter(|_| number == self.number) else { return };
        watch.pending = None;
        watch.due = watch.due.max(context.time.instant + output.busy.div_f64(MOST_SHARE));
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
            return self.begin(around, context.time);
        };
        watch.told_alarms = monitor.alarms().len();
        watch.told_motions = monitor.own_motions().len();
        watch.monitor = monitor;
        self.course = watch.course().map(Arc::new);
    }

    fn explain(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        if let Some(why) = self.unexplained(around) {
            return context.refuse(format!("What was watched cannot be explained: {why}."));
        }
        let (Some(watch), Some(world)) = (&self.watch, around.world) else { return };
        self.logging = Some(context.start(DriftWork::WriteLog {
            sessions: world.folder(&self.data_dir).join("sessions"),
            samples: watch.monitor.samples().into(),
            model: around.model.clone(),
            posture: around.posture(),
            at: context.time.day,
        }));
    }

    /// Why what was watched cannot be explained now, a part of a sentence; `None`: it can.
    fn unexplained(&self, around: &DriftAround) -> Option<&'static str> {
        let Some(watch) = &self.watch else { return Some("nothing is being watched") };
        if self.logging.is_some() || self.retelling.is_some() {
            return Some("it is being worked at already; wait a moment");
        }
        if !watch.from_switching_on {
            return Some(
                "nobody knows when the cameras were switched on; say it on the screen Eyes, then watch anew",
            );
        }
        if around.world.is_none() {
            return Some("the eyes that are shown are not those of the robot that is connected");
        }
        let samples = watch.monitor.samples();
        let span_s = samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.at_s - first.at_s);
        is_too_short(samples.len(), span_s)
            .then_some("it has to be watched for at least 3 minutes, better 10")
    }

    /// The session that was made of what was watched, once.
    pub fn next_log(&mut self) -> Option<PathBuf> {
        let (log, told) = self.log.as_mut()?;
        (!std::mem::replace(told, true)).then(|| log.clone())
    }

    fn went_back(&self, around: &DriftAround) -> bool {
        let last = self.watch.as_ref().and_then(|watch| watch.monitor.samples().last());
        last.zip(around.eyes_on_s).is_some_and(|(last, on_s)| on_s < last.at_s - WENT_BACK_S)
    }

    fn begin(&mut self, around: &DriftAround, now: Time) {
        self.number += 1;
        self.retelling = None;
        self.failed = None;
        self.course = None;
        self.watch = Some(Watch {
            began: now.instant,
            opened: around.opened,
            from_switching_on: around.eyes_on_s.is_some(),
            monitor: Monitor::default(),
            model: around.model.clone(),
            due: now.instant,
            pending: None,
            told_alarms: 0,
            told_motions: 0,
            epipolar_px: None,
        });
    }
}

impl Watch {
    /// What the operator is told once.
    fn tell(&mut self, context: &mut Context<'_>) {
        for alarm in &self.monitor.alarms()[self.told_alarms..] {
            context.notices.add(NoticeLevel::Warning, words::alarm(alarm));
        }
        for motion in &self.monitor.own_motions()[self.told_motions..] {
            context.notices.add(NoticeLevel::Info, words::own_motion(motion));
        }
        self.told_alarms = self.monitor.alarms().len();
        self.told_motions = self.monitor.own_motions().len();
    }

    /// `None`: nothing was seen yet.
    fn course(&self) -> Option<DriftCourse> {
        let monitor = &self.monitor;
        let newest = monitor.samples().last()?;
        let point = |sample: &Sample| {
            let table = &sample.look.table;
            DriftPoint {
                at_s: sample.at_s,
                off_m: monitor.off_m(sample),
                along_m: plumbline_drift::Row::ALL.map(|row| table.along_m(row)),
                across_m: plumbline_drift::Row::ALL.map(|row| table.across_m(row)),
            }
        };
        let verdict = monitor.verdict();
        let reference = |seen: &plumbline_drift::ReferenceSeen| {
            (seen.name.clone(), seen.drift_m.filter(|_| !seen.is_lost).map(|drift_m| drift_m.norm()))
        };
        Some(DriftCourse {
            from_switching_on: self.from_switching_on,
            points: monitor.samples().iter().map(point).collect(),
            band_m: monitor.band().map(|band| band.half_m),
            verdict,
            sentence: words::verdict(&verdict),
            table: newest.look.table.rows,
            turns_rad: newest.look.turns_rad.map(Into::into),
            epipolar_px: self.epipolar_px,
            references: newest.look.references.iter().map(reference).collect(),
            alarms: monitor.alarms().iter().map(|alarm| (alarm.since_s, words::alarm(alarm))).collect(),
            own_motions: monitor
                .own_motions()
                .iter()
                .map(|motion| (motion.since_s, words::own_motion(motion)))
                .collect(),
        })
    }
}

impl Workflow for DriftWorkflow {
    type Command = DriftCommand;
    type Work = DriftWork;
    type Control = Nothing;
    type Around = DriftAround;
    type View = DriftView;

    /// Sessions are made in the folder of a world in `data_dir`.
    fn new(data_dir: &Path) -> Self {
        Self { data_dir: data_dir.to_owned(), ..Self::default() }
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
        let waits = self.down.clone().or_else(|| around.waits_because().map(str::to_owned));
        Arc::new(DriftView {
            step,
            is_watching,
            waits_because: waits.filter(|_| is_watching),
            failed: self.failed.clone().filter(|_| is_watching),
            course: self.course.clone(),
            is_busy: self.logging.is_some() || self.retelling.is_some(),
            unexplained: self.unexplained(around),
            log: self.log.as_ref().map(|(log, _)| log.clone()),
        })
    }

    fn apply(&mut self, command: DriftCommand, around: &DriftAround, context: &mut Context<'_>) {
        match command {
            DriftCommand::Start if !around.is_live => {
                context.refuse("Nothing can be watched yet: open the eyes, the twin's, or a recording.");
            }
            DriftCommand::Start => self.begin(around, context.time),
            DriftCommand::Stop if self.watch.is_none() => context.refuse("Nothing is being watched."),
            DriftCommand::Stop => {
                self.watch = None;
                self.retelling = None;
            }
            DriftCommand::Explain => self.explain(around, context),
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
        }
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, around: &DriftAround, context: &mut Context<'_>) {
        self.logging.take_if(|logging| *logging == id);
        if self.retelling.take_if(|retelling| *retelling == id).is_some() && why.is_some() {
            self.begin(around, context.time);
        }
    }
}
