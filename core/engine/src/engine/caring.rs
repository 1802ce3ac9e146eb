//! Looking after the threads: what fails is told with what it means, and started again when the
//! operator says so.

use std::time::Instant;

use super::hub::Hub;
use super::journal::Journal;
use crate::ground::notice::NoticeLevel;
use crate::ground::watched::{Pulse, ThreadFault, Trouble, WatchedThread};
use crate::robot::RobotControl;
use crate::robot::command::RobotCommand;
use crate::source::command::{Control, SourceCommand};
use crate::source::view::SourceView;

impl Hub<'_> {
    /// Tells the state which threads have failed, are silent, or are back.
    pub(super) fn look_after(&mut self) {
        let now = Instant::now();
        let mut seen: Vec<(WatchedThread, Option<ThreadFault>)> = Vec::with_capacity(8);
        let journal = self.journal.as_ref().map(Journal::watched);
        for watched in self.pipeline.watched().into_iter().chain(journal) {
            let (thread, ended) = (watched.pulse().thread(), watched.has_ended());
            // The journal that takes its place is another file, which waits for nobody.
            let free = ended || thread == WatchedThread::Journal;
            let trouble = watched.pulse().trouble(now);
            seen.push((thread, trouble.map(|trouble| ThreadFault::new(thread, trouble, free))));
        }
        if let Some((why, since)) = &self.no_journal {
            let trouble = Trouble::Ended { said: why.clone(), since: *since };
            let fault = ThreadFault::new(WatchedThread::Journal, trouble, true);
            seen.push((WatchedThread::Journal, Some(fault)));
        }
        for (thread, fault) in seen {
            let is_new = fault.is_some() && !self.state.is_down(thread);
            if is_new && thread == WatchedThread::Robot {
                // It may be a finger on its way to the glass, which nobody looks after any more.
                self.shared.switches.stop.press();
            }
            if is_new && thread == WatchedThread::Robot && fault.as_ref().is_some_and(|f| !f.is_silent()) {
                self.pipeline.close_twin_eyes();
            }
            self.changed |= self.state.thread_is(thread, fault);
        }
    }

    /// The robot's thread does not hear it: the operator is told why nothing comes of it.
    pub(super) fn answer_for_the_robot(&mut self, control: &RobotControl) {
        match control {
            // These come by themselves; nobody waits for an answer.
            RobotControl::UseModel(_)
            | RobotControl::BoardLooked(_)
            | RobotControl::AbandonTouch
            | RobotControl::Contact(_)
            | RobotControl::Robot(
                RobotCommand::Jog(_) | RobotCommand::EndJog | RobotCommand::DismissRefusal,
            ) => {}
            RobotControl::Robot(_)
            | RobotControl::Twin(_)
            | RobotControl::Touch(_)
            | RobotControl::Withdraw(_)
            | RobotControl::Lead(_)
            | RobotControl::TurnHead { .. } => {
                let why = self.state.meaning(WatchedThread::Robot);
                self.state.notify(NoticeLevel::Warning, &*why);
            }
        }
    }

    /// Puts another thread in the place of one that has ended. Connects nothing and moves nothing.
    pub(super) fn start_again(&mut self, thread: WatchedThread) {
        let Some(fault) = self.state.fault(thread) else {
            let text = format!("There is nothing to start again: {} runs.", thread.title());
            return self.state.notify(NoticeLevel::Info, text);
        };
        if !fault.can_start_again {
            let text = format!(
                "It cannot be started again yet: {} has not come to its end. Wait; if it stays so, close the program and start it anew.",
                thread.title()
            );
            return self.state.notify(NoticeLevel::Warning, text);
        }
        if thread == WatchedThread::Journal {
            return self.start_journal();
        }
        if let Err(error) = self.pipeline.start_again(thread, &self.state) {
            let text =
                format!("The system gives no thread ({error}): close other programs, then start it again.");
            return self.state.notify(NoticeLevel::Error, text);
        }
        self.state.thread_is(thread, None);
        let after = match thread {
            WatchedThread::Robot => " Nothing is connected, and nothing moves: connect when you are ready.",
            _ => "",
        };
        let text = format!("Started again: {}.{after}", thread.title());
        self.state.notify(NoticeLevel::Success, text);
        if thread == WatchedThread::Source {
            self.open_source_again();
        }
    }

    /// What was open is opened anew.
    fn open_source_again(&mut self) {
        let before = self.state.source_spec();
        let opened = self.state.sources_opened();
        self.state.source_changed(SourceView { opened, ..SourceView::default() });
        if let Some(spec) = before {
            let open = Control::from_command(SourceCommand::Open(spec));
            let _ = open.is_some_and(|open| self.pipeline.control_source(open));
        }
    }

    /// Starts a journal in a new file.
    pub(super) fn start_journal(&mut self) {
        let is_again = self.no_journal.is_some() || self.journal.is_some();
        // What the one before lacks stays known.
        self.lost_before += self.journal.take().map_or(0, |journal| journal.lost());
        let pulse = Pulse::new(WatchedThread::Journal, self.bell.clone(), self.shared.trial.clone());
        match Journal::start_watched(&self.folder.path.join("journal"), pulse) {
            Ok(journal) => {
                (self.journal, self.no_journal) = (Some(journal), None);
                self.state.thread_is(WatchedThread::Journal, None);
                if is_again {
                    let text = "A new journal is written; what was done meanwhile is not in it.";
                    self.state.notify(NoticeLevel::Success, text);
                }
            }
            Err(error) => {
                if is_again {
                    self.state.notify(NoticeLevel::Error, format!("No journal is kept: {error}"));
                }
                self.no_journal = Some((error.to_string(), Instant::now()));
            }
        }
    }
}
