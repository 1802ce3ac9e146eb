//! Does once more what a journal holds.
//!
//! The same commands at the same times, and the ends of the same work in the same order, give the same
//! state. Nothing runs beside it: work is done when its end is due. What a connected robot or a source
//! brought is in no journal, so a journal with either is replayed without it.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use jiff::Timestamp;
use plumbline_model::Unattended;
use plumbline_model::robot::default_rig;

use super::journal::{Entry, Event, Happened, Heading, Line};
use crate::ground::Time;
use crate::ground::jobs::{JobId, Outcome, on_job_workers};
use crate::ground::stage::Skipped;
use crate::robot::{Switches, Worker};
use crate::state::{Action, State};
use crate::twin::{TwinDesk, TwinEyesPlug};
use crate::view::View;
use crate::work::Work;

/// An engine without threads, fed from a journal.
pub struct Replay {
    state: State,
    /// The robot's side, with nothing connected.
    worker: Worker,
    /// Work that was asked for and has not ended.
    work: BTreeMap<JobId, Work>,
    began: Time,
}

impl Replay {
    /// Begins with what is in this folder.
    pub fn new(data_dir: &Path, heading: &Heading) -> Self {
        let eyes = TwinEyesPlug::default();
        let worker = Worker::new(default_rig(), data_dir, Switches::default(), TwinDesk::new(eyes));
        let began = Time { instant: Instant::now(), day: heading.started };
        let mut replay = Self { state: State::new(data_dir), worker, work: BTreeMap::new(), began };
        replay.act();
        replay
    }

    /// Does what a line of the journal says.
    pub fn take(&mut self, line: Line) {
        match line {
            Line::Command(Entry { at_secs, day, command, .. }) => {
                self.state.apply_at(command, self.time(at_secs, day));
            }
            Line::Event(Event { at_secs, day, happened }) => {
                self.state.hold_time(Some(self.time(at_secs, Some(day))));
                self.happen(happened);
                self.state.hold_time(None);
            }
        }
        self.act();
    }

    /// What the window would show.
    pub fn view(&mut self) -> View {
        self.state.view(Skipped::default(), 0, self.began.instant)
    }

    fn time(&self, at_secs: f64, day: Option<Timestamp>) -> Time {
        let time = self.began.after(Duration::try_from_secs_f64(at_secs).unwrap_or_default());
        Time { day: day.unwrap_or(time.day), ..time }
    }

    fn happen(&mut self, happened: Happened) {
        match happened {
            Happened::WorkEnded { job, took_s, cancelled } => {
                let id = JobId(job);
                let Some(work) = self.work.remove(&id) else { return };
                let outcome = match cancelled {
                    true => Outcome::Cancelled,
                    false => on_job_workers(move || work.run(&Unattended)).into(),
                };
                let took = Duration::try_from_secs_f64(took_s).unwrap_or_default();
                self.state.work_ended(id, outcome, took);
            }
            Happened::RobotTold => {
                if let Some(news) = self.worker.take_news() {
                    self.state.robot_changed(news);
                }
            }
            Happened::Noted { level, text } => self.state.source_note((level, text)),
        }
    }

    /// Does what the state asks of the outer world.
    fn act(&mut self) {
        for action in self.state.take_actions() {
            match action {
                Action::Start(id, work) => {
                    self.work.insert(id, work);
                }
                Action::Robot(control) => self.worker.control(control),
                // How a job that was cancelled ended stands in the journal.
                Action::Cancel(_) | Action::Source(_) => {}
            }
        }
    }
}
