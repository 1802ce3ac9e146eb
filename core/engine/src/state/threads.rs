//! What it means for everything else that a thread has failed, and that it is back.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_hardware::SourceSpec;

use super::State;
use crate::ground::data_folder::KeptView;
use crate::ground::notice::NoticeLevel;
use crate::ground::watched::{ThreadFault, WatchedThread};
use crate::robot::News;
use crate::robot::view::robot_without_its_thread;
use crate::source::view::{SourceStatus, SourceView};
use crate::twin::view::twin_without_its_thread;

impl State {
    /// How a thread is: `None` when it does its work. Whether that is new.
    pub fn thread_is(&mut self, thread: WatchedThread, fault: Option<ThreadFault>) -> bool {
        let before = self.faults.get(&thread);
        if before == fault.as_ref() {
            return false;
        }
        let was_silent = before.is_some_and(ThreadFault::is_silent);
        // That it lets go of what it held makes it no other fault.
        let is_told = match (before, &fault) {
            (Some(before), Some(now)) => before.is_silent() == now.is_silent(),
            _ => false,
        };
        match fault {
            Some(fault) => {
                if !is_told {
                    self.has_failed(&fault);
                }
                self.faults.insert(thread, fault);
            }
            None => {
                self.faults.remove(&thread);
                self.is_back(thread, was_silent);
            }
        }
        true
    }

    fn has_failed(&mut self, fault: &ThreadFault) {
        let said = fault.said.as_ref().map_or_else(String::new, |said| format!(" (It said: {said}.)"));
        self.notices.add(NoticeLevel::Error, format!("{}{said}", fault.meaning));
        let reason = fault.meaning.to_string();
        match fault.thread {
            WatchedThread::Robot => {
                self.before_silence = fault.is_silent().then(|| (self.robot.clone(), self.twin.clone()));
                let robot = Arc::new(robot_without_its_thread(&self.robot, &reason));
                let twin = Arc::new(twin_without_its_thread(&self.twin, &reason));
                let before = self.before_silence.take();
                self.robot_changed(News { robot, twin, twins_started: self.twins_started });
                self.before_silence = before;
            }
            WatchedThread::Source => {
                self.source_before_silence = fault.is_silent().then(|| self.rooms.source.view().clone());
                let status = SourceStatus::Lost { reason, since: fault.since, attempts: 0 };
                self.rooms
                    .source
                    .update(SourceView { status, ..SourceView::clone(self.rooms.source.view()) });
            }
            WatchedThread::Rectify | WatchedThread::Corners | WatchedThread::Probe => {
                self.rooms.live.stage_is_down(fault.thread, Some(reason));
            }
            WatchedThread::Detect => self.rooms.detect.stage_is_down(Some(reason)),
            WatchedThread::Drift => self.rooms.drift.stage_is_down(Some(reason)),
            WatchedThread::Engine | WatchedThread::Journal => {}
        }
    }

    /// Started again, or it gave a sign of life after all.
    fn is_back(&mut self, thread: WatchedThread, was_silent: bool) {
        match thread {
            WatchedThread::Rectify | WatchedThread::Corners | WatchedThread::Probe => {
                self.rooms.live.stage_is_down(thread, None);
            }
            WatchedThread::Detect => self.rooms.detect.stage_is_down(None),
            WatchedThread::Drift => self.rooms.drift.stage_is_down(None),
            WatchedThread::Robot => {
                if let Some((robot, twin)) = self.before_silence.take() {
                    self.robot_changed(News { robot, twin, twins_started: self.twins_started });
                }
            }
            WatchedThread::Source => {
                if let Some(view) = self.source_before_silence.take() {
                    self.rooms.source.update(SourceView::clone(&view));
                }
            }
            WatchedThread::Engine | WatchedThread::Journal => {}
        }
        if was_silent {
            let text = format!("There is a sign of life again: {}.", thread.title());
            self.notices.add(NoticeLevel::Info, text);
        }
    }

    /// A stage met a defect on one pair: what it showed before is not true of the next.
    pub(super) fn stage_gave_nothing(&mut self, thread: WatchedThread, why: &str) {
        match thread {
            WatchedThread::Detect => self.rooms.detect.gave_nothing(why),
            WatchedThread::Drift => self.rooms.drift.gave_nothing(why, self.clock.time()),
            _ => self.rooms.live.gave_nothing(thread, why),
        }
    }

    /// Whether a thread has failed or gives no sign of life.
    pub fn is_down(&self, thread: WatchedThread) -> bool {
        self.faults.contains_key(&thread)
    }

    /// What is wrong with a thread.
    pub fn fault(&self, thread: WatchedThread) -> Option<&ThreadFault> {
        self.faults.get(&thread)
    }

    /// What it means that a thread is down, a sentence.
    pub fn meaning(&self, thread: WatchedThread) -> Arc<str> {
        self.fault(thread).map_or_else(|| thread.meaning_of_end().into(), |fault| fault.meaning.clone())
    }

    /// Where data are kept, and how the journal is doing.
    pub fn set_kept(&mut self, kept: KeptView) {
        if *self.kept != kept {
            self.kept = Arc::new(kept);
        }
    }

    /// The connected robot as it is known.
    pub fn model_of_the_arm(&self) -> Arc<RobotModel> {
        self.models.of(self.arm_of).clone()
    }

    /// Counts twins.
    pub fn twins_started(&self) -> u64 {
        self.twins_started
    }

    /// Counts sources.
    pub fn sources_opened(&self) -> u64 {
        self.rooms.source.view().opened
    }

    /// What was opened last.
    pub fn source_spec(&self) -> Option<SourceSpec> {
        self.rooms.source.view().spec.clone()
    }
}
