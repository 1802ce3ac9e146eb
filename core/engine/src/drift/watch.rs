//! A watch under way: what it is of, when it looks next, what was seen.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_drift::{Monitor, Sample, WatcherSetup, words};
use plumbline_effects::RobotModel;
use plumbline_model::StereoFrame;

use super::DriftAround;
use super::stage::DriftInput;
use super::view::{BeganAnew, DriftCourse, DriftPoint};
use super::work::Context;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Time, World};

/// It looks no more often than this, by the clock of the eyes.
pub(super) const EVERY: Duration = Duration::from_secs(2);
/// Before the first look the board is looked for: where it is seen, it is watched, too.
pub(super) const FIRST: Duration = Duration::from_secs(1);
/// It takes no more than this share of the time that passes …
const MOST_SHARE: f64 = 0.03;
/// … but while it learns what is usual, which shall not take longer than a minute on a slow machine.
const MOST_SHARE_LEARNING: f64 = 0.25;
/// The clock of the eyes goes back by more than this when they were switched off, s.
const WENT_BACK_S: f64 = 1.0;

/// A watch under way.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    pub began: Instant,
    /// Of which source, counted.
    pub opened: u64,
    /// And of which world.
    pub world: Option<World>,
    /// How often the eyes' clock had been set.
    pub clock_settings: u64,
    /// Whether it is known.
    pub from_switching_on: bool,
    pub monitor: Monitor,
    /// The model that it is told with.
    pub model: Arc<RobotModel>,
    /// It looks no sooner than this.
    pub due: Instant,
    /// How many times faster than a clock the eyes' one runs.
    pub pace: f64,
    pub pending: Option<Arc<DriftInput>>,
    /// Whether anything has come of it yet.
    pub has_looked: bool,
    /// When the newest pair was taken up of which something came.
    pub looked: Option<Instant>,
    /// When the pair that is looked at was taken up.
    taken: Instant,
    pub told_alarms: usize,
    pub told_motions: usize,
    pub epipolar_px: Option<f64>,
}

impl Watch {
    /// Nothing was seen yet.
    pub fn new(around: &DriftAround, now: Time) -> Self {
        Self {
            began: now.instant,
            opened: around.opened,
            world: around.world,
            clock_settings: around.clock_settings,
            from_switching_on: around.eyes_on_s.is_some(),
            monitor: Monitor::default(),
            model: around.model.clone(),
            due: now.instant,
            pace: around.clock_pace,
            pending: None,
            has_looked: false,
            looked: None,
            taken: now.instant,
            told_alarms: 0,
            told_motions: 0,
            epipolar_px: None,
        }
    }

    /// Why what comes now cannot be compared with what was seen; `None`: it can.
    pub fn begins_anew(&self, around: &DriftAround) -> Option<BeganAnew> {
        if self.opened != around.opened {
            Some(BeganAnew::Opened)
        } else if self.clock_settings != around.clock_settings {
            Some(BeganAnew::ClockSet)
        } else if self.from_switching_on != around.eyes_on_s.is_some() {
            Some(BeganAnew::ClockKnown)
        } else if self.went_back(around) {
            Some(if around.is_recorded { BeganAnew::WoundBack } else { BeganAnew::SwitchedOn })
        } else {
            None
        }
    }

    /// Whether the eyes were switched off since.
    fn went_back(&self, around: &DriftAround) -> bool {
        let last = self.monitor.samples().last();
        last.zip(around.eyes_on_s).is_some_and(|(last, on_s)| on_s < last.at_s - WENT_BACK_S)
    }

    /// Takes up a pair, if it is time; `number` counts watches.
    pub fn take(&mut self, number: u64, frame: &StereoFrame, around: &DriftAround, now: Instant) {
        if now < self.due || self.pending.is_some() || around.waits_because().is_some() {
            return;
        }
        self.pace = around.clock_pace;
        let age_s = now.saturating_duration_since(frame.stamp.captured_at).as_secs_f64();
        let eyes_on_s = around.eyes_on_s.map(|on_s| (on_s - self.pace * age_s).max(0.0));
        let since_s = now.saturating_duration_since(self.began).as_secs_f64();
        let setup = WatcherSetup {
            model: around.model.clone(),
            posture: around.posture(),
            eyes_on_s,
            references: around.references(frame),
        };
        let at_s = eyes_on_s.unwrap_or(since_s);
        let last_s = self.monitor.samples().last().map_or(at_s, |last| last.at_s);
        let at_s = at_s.max(last_s);
        self.pending = Some(Arc::new(DriftInput { watch: number, frame: frame.clone(), setup, at_s }));
        self.due = now + EVERY.div_f64(self.pace);
        self.taken = now;
    }

    /// Something came of the pair that was taken up last.
    pub fn has_seen(&mut self) {
        self.looked = Some(self.taken);
    }

    /// A look has taken so long: the next one waits until it is a small share of the time, which passes as fast
    /// as the eyes' clock.
    pub fn rest(&mut self, busy: Duration, now: Instant) {
        self.pending = None;
        self.has_looked = true;
        let share = if self.monitor.band().is_some() { MOST_SHARE } else { MOST_SHARE_LEARNING };
        self.due = self.due.max(now + busy.div_f64(share * self.pace));
    }

    /// What the operator is told once.
    pub fn tell(&mut self, context: &mut Context<'_>) {
        for alarm in &self.monitor.alarms()[self.told_alarms..] {
            context.notices.add(NoticeLevel::Warning, words::alarm(alarm));
        }
        // What is only covered, by the robot's own arm most of all, is listed and not called out.
        let own = &self.monitor.own_motions()[self.told_motions..];
        for motion in own.iter().filter(|motion| motion.by_m.is_some()) {
            context.notices.add(NoticeLevel::Info, words::own_motion(motion));
        }
        self.told_alarms = self.monitor.alarms().len();
        self.told_motions = self.monitor.own_motions().len();
    }

    /// `None`: nothing was seen yet.
    pub fn course(&self) -> Option<DriftCourse> {
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
