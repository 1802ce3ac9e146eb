//! Messages: passing by as toasts, and kept as a history.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Align2, Context, vec2};
use plumbline_engine::{Notice, NoticeCommand, NoticeLevel};
use plumbline_widgets::notifications::{Notifications, Severity};
use plumbline_widgets::theme::space;

use super::saving::open_file;
use super::sheet::sheet;
use super::undo;
use crate::operator::{Outbox, words};

/// More new messages than this are not all put on screen.
const MOST_AT_ONCE: usize = 2;
/// Of more files than this that were never told of the oldest is forgotten.
const MOST_AWAITED: usize = 16;

/// The engine's messages and the window's own.
#[derive(Default)]
pub(super) struct NoticeList {
    shown: Notifications,
    newest: u64,
    /// How often the newest one was said.
    times: u32,
    unread: usize,
    /// Whether STOP was latched when it was looked last.
    stopped: bool,
    history_open: bool,
    /// In this pass: a press of the button that opened the list closes it, and does not open it anew.
    closed_in_pass: Option<u64>,
    /// What the operator asked to be written and no message has told of yet.
    awaited: Vec<PathBuf>,
}

impl NoticeList {
    /// Adds the engine's messages that are new, and the newest one known when it was said again, before others came.
    pub(super) fn take(&mut self, notices: &Arc<[Notice]>) {
        let first_new = notices.partition_point(|notice| notice.number <= self.newest);
        let known = notices[..first_new].last().filter(|known| known.number == self.newest);
        if let Some(again) = known.filter(|known| known.times > self.times) {
            let more = again.times - self.times;
            self.times = again.times;
            self.add(again, more);
        }
        let new = &notices[first_new..];
        for notice in new {
            (self.newest, self.times) = (notice.number, notice.times);
            self.add(notice, notice.times);
        }
        if new.len() > MOST_AT_ONCE {
            self.summarize(new.len());
        }
    }

    fn add(&mut self, notice: &Notice, times: u32) {
        let severity = severity(notice.level);
        if matches!(severity, Severity::Warning | Severity::Failed) {
            self.unread += 1;
        }
        self.shown.repeat(severity, notice.text.as_str(), times);
        if severity == Severity::Done {
            self.attach(&notice.text);
        }
    }

    /// A file is going to be written: it can be opened from the message that tells of it.
    pub(super) fn await_file(&mut self, file: PathBuf) {
        self.awaited.push(file);
        if self.awaited.len() > MOST_AWAITED {
            self.awaited.remove(0);
        }
    }

    fn attach(&mut self, text: &str) {
        let told = self.awaited.iter().position(|file| text.contains(&*file.to_string_lossy()));
        if let Some(i) = told {
            self.shown.tells_of(self.awaited.remove(i));
        }
    }

    /// Many messages at once would cover the work: the first stays on screen, and the button of
    /// the top line counts the others.
    fn summarize(&mut self, count: usize) {
        let newest: Vec<u64> = self.shown.history().take(count).map(|message| message.number).collect();
        for number in &newest[..newest.len().saturating_sub(1)] {
            self.shown.dismiss(*number);
        }
    }

    /// What STOP ended is no news any more once it is released.
    pub(super) fn see_stop(&mut self, stopped: bool) {
        if self.stopped && !stopped {
            self.shown.dismiss_those_of(words::robot::BY_STOP);
        }
        self.stopped = stopped;
    }

    /// Adds a passing message of the window.
    pub(super) fn say(&mut self, text: &str) {
        self.shown.push(Severity::Info, text);
    }

    /// The window itself wrote a file: it can be opened from the message.
    pub(super) fn say_written(&mut self, file: PathBuf) {
        self.shown.push(Severity::Done, format!("Saved {}.", file.display()));
        self.shown.tells_of(file);
    }

    /// Something that the window itself did failed.
    pub(super) fn say_failed(&mut self, text: &str) {
        self.shown.push(Severity::Failed, text);
        self.unread += 1;
    }

    /// Warnings and failures since the history was last open.
    pub(super) fn unread(&self) -> usize {
        self.unread
    }

    pub(super) fn is_history_open(&self) -> bool {
        self.history_open
    }

    pub(super) fn toggle_history(&mut self, ctx: &Context) {
        let just_closed = self.closed_in_pass.take() == Some(ctx.cumulative_pass_nr());
        self.history_open = !self.history_open && !just_closed;
        self.unread = 0;
    }

    /// `beside`: how wide the inspector is, where it is open.
    pub(super) fn show_new(&mut self, ctx: &Context, beside: Option<f32>) {
        // What was just put in use may be taken back at once: they pass by above Undo, over nothing but what describes.
        let above = vec2(space::S, 68.0 + undo::HEIGHT);
        let room = beside.map(|width| width - 2.0 * space::S);
        if !self.history_open
            && let Some(file) = self.shown.show_toasts(ctx, above, room)
        {
            open_file(file);
        }
    }

    pub(super) fn show_history(&mut self, ctx: &Context, escape_pressed: bool, outbox: &mut Outbox) {
        if !self.history_open {
            return;
        }
        let place = (Align2::RIGHT_TOP, vec2(-space::M, 64.0));
        let shown = sheet(ctx, "messages", place, 460.0, escape_pressed, |ui| {
            ui.set_max_height(420.0);
            ui.horizontal(|ui| {
                ui.heading("Messages");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.button("Clear messages").clicked()
                })
                .inner
            })
            .inner
            .then(|| {
                self.shown.clear();
                outbox.send(NoticeCommand::Clear);
            });
            ui.add_space(space::S);
            if let Some(file) = self.shown.show_history(ui) {
                open_file(file);
            }
        });
        self.unread = 0;
        if shown.close {
            self.history_open = false;
            self.closed_in_pass = Some(ctx.cumulative_pass_nr());
        }
    }
}

fn severity(level: NoticeLevel) -> Severity {
    match level {
        NoticeLevel::Info => Severity::Info,
        NoticeLevel::Success => Severity::Done,
        NoticeLevel::Warning => Severity::Warning,
        NoticeLevel::Error => Severity::Failed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notice(number: u64, level: NoticeLevel) -> Notice {
        Notice { number, level, text: format!("message {number}"), at: jiff::Timestamp::UNIX_EPOCH, times: 1 }
    }

    #[test]
    fn every_message_is_taken_once_and_trouble_is_counted() {
        let mut list = NoticeList::default();
        let first: Arc<[Notice]> = Arc::from([notice(1, NoticeLevel::Info), notice(2, NoticeLevel::Error)]);
        list.take(&first);
        list.take(&first);
        assert_eq!((list.shown.history().count(), list.unread()), (2, 1));
        let later: Arc<[Notice]> =
            Arc::from([notice(2, NoticeLevel::Error), notice(3, NoticeLevel::Warning)]);
        list.take(&later);
        assert_eq!((list.shown.history().count(), list.unread()), (3, 2));
        list.toggle_history(&Context::default());
        assert_eq!(list.unread(), 0);
    }

    #[test]
    fn what_is_said_again_comes_back_with_its_count() {
        let mut list = NoticeList::default();
        let said =
            |times: u32| -> Arc<[Notice]> { Arc::from([Notice { times, ..notice(1, NoticeLevel::Error) }]) };
        list.take(&said(1));
        let first = list.shown.history().next().expect("a message").number;
        list.shown.dismiss(first);
        list.take(&said(1));
        assert_eq!((list.shown.on_screen(std::time::Instant::now()).count(), list.unread()), (0, 1));
        list.take(&said(4));
        let again = list.shown.on_screen(std::time::Instant::now()).next().expect("it is said again");
        assert_eq!((again.times, list.unread()), (4, 2));
        assert_eq!(list.shown.history().count(), 1);
        // And so it does where another one was said after it before the window looked.
        list.take(&Arc::from([said(6)[0].clone(), notice(2, NoticeLevel::Info)]));
        let times: Vec<u32> = list.shown.history().map(|message| message.times).collect();
        assert_eq!((times, list.unread()), (vec![1, 6], 3));
    }

    #[test]
    fn what_was_written_as_asked_can_be_opened_from_its_message() {
        let mut list = NoticeList::default();
        list.await_file("reports/gap.html".into());
        let told = |number: u64, level: NoticeLevel| Notice {
            text: "The report was written to reports/gap.html.".to_owned(),
            ..notice(number, level)
        };
        let file_of = |list: &NoticeList| list.shown.history().next().and_then(|newest| newest.file.clone());
        list.take(&Arc::from([told(1, NoticeLevel::Error)]));
        assert_eq!(file_of(&list), None, "it was not written");
        list.take(&Arc::from([told(2, NoticeLevel::Success)]));
        assert_eq!(file_of(&list), Some("reports/gap.html".into()));
        list.take(&Arc::from([notice(3, NoticeLevel::Success)]));
        assert_eq!(file_of(&list), None);
    }
}
