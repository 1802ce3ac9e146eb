//! One run: which touch is next, what is waited for, what is not on disk yet.

mod asked;
mod away;
mod going;
mod news;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use super::depth::Depth;
use super::plan::{Aim, RunPlan};
use super::record::{Fate, Progress};
use super::refusal::Trouble;
use super::store::Stored;
use crate::ground::jobs::JobId;
use crate::motion::{Planner, ScreenPlace};
use crate::robot::TouchStage;
use crate::robot::patience::Patience;
use crate::robot::view::RobotView;

/// After so many touches without a contact, one after the other, something is wrong.
pub const MISSES: usize = 5;
/// The pace is that of so many touches.
const PACE_OF: usize = 15;
/// A touch that took so many times as long as the median was one with a pause before it.
const PAUSE: f64 = 4.0;
/// At most so much of a touch counts as done before it is.
const MOST_TAKEN: f64 = 0.9;

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
    /// The way from the screen is being looked for.
    Away,
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
    /// Number of the planned touch; on its way from the screen the one that waits for it, `None` where all are done.
    pub number: Option<usize>,
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

/// The screen on the table, nothing at the hand.
const AS_IT_LIES: [f64; 2] = [0.0, 0.0];

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
    /// How often it held because joints were not heard, and would go on by itself.
    pub held: usize,
    contacts: Vec<Instant>,
    planner: Option<(Touchscreen, Arc<Planner>)>,
    /// What the newest touch was sent beside its place; robot axes, m.
    beside_m: Vector3<f64>,
    /// The arm went away from the screen, and has not been sent back since.
    is_away: bool,
    /// The arm was sent to the screen since the run was begun or opened.
    was_sent: bool,
    /// The arm could not go home at the end.
    stays: bool,
    /// The screen stands on a block, or the hand carries a weight, by what the disk says: nobody has said so since the run
    /// was opened.
    is_hearsay: bool,
    /// The operator ends it before all is done.
    ends: bool,
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
        // The arm may still hover where the newest touch left it.
        let newest = progress.records.last().and_then(|record| plan.aim(record.number));
        let mut run = Self {
            beside_m: newest.map_or_else(Vector3::zeros, |aim| aim.wanted().beside_m()),
            end_on_disk: progress.finished,
            is_hearsay: progress.prepared != AS_IT_LIES,
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
            held: 0,
            contacts: vec![],
            planner: None,
            is_away: false,
            was_sent: false,
            stays: false,
            ends: false,
            ended: false,
        };
        // Broken off when nothing was left but to say so: it says so now.
        if run.phase != Phase::Finished && run.only_leaves() {
            run.phase = Phase::Working;
        }
        run
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
        if self.ends {
            return None;
        }
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

    /// Time that the rest takes at the pace so far; before there is one, as estimated. `None` where no touch is left.
    /// What the touch under way has taken by now is taken from it, so that it runs while the arm does, and not while the run is paused.
    pub fn remaining(&self, now: Instant) -> Option<Duration> {
        if self.left() == 0 {
            return None;
        }
        let newest = &self.contacts[self.contacts.len().saturating_sub(PACE_OF)..];
        let mut gaps: Vec<Duration> =
            newest.windows(2).map(|pair| pair[1].saturating_duration_since(pair[0])).collect();
        gaps.sort();
        let planned = self.plan.duration_s / self.plan.reachable().max(1) as f64;
        let median_s = gaps.get(gaps.len() / 2).map_or(planned, Duration::as_secs_f64);
        // Short holds belong to the pace, or the time left would grow with each; a pause says nothing about it.
        let of_pace: Vec<f64> =
            gaps.iter().map(Duration::as_secs_f64).filter(|gap_s| *gap_s < PAUSE * median_s).collect();
        let each_s = of_pace.iter().sum::<f64>() / of_pace.len().max(1) as f64;
        let each_s = if of_pace.is_empty() { median_s } else { each_s };
        // Of a touch that takes longer than they do at a time a part is left until it is done.
        let works = matches!(self.phase, Phase::Working);
        let last = newest.last().filter(|_| works);
        let under_way_s = last.map_or(0.0, |last| now.saturating_duration_since(*last).as_secs_f64());
        let taken_s = under_way_s.min(MOST_TAKEN * each_s);
        Duration::try_from_secs_f64(each_s * self.left() as f64 - taken_s).ok()
    }

    /// Grows with every change of what is on disk.
    pub fn revision(&self) -> u64 {
        self.revision
    }
}
