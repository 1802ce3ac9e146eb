//! Messages: passing by as toasts, and kept as a history.

use std::sync::Arc;

use egui::{Align2, Context, vec2};
use plumbline_engine::{Notice, NoticeCommand, NoticeLevel};
use plumbline_widgets::notifications::{Notifications, Severity};
use plumbline_widgets::theme::space;

use super::sheet::sheet;
use crate::operator::Outbox;

/// More new messages than this are not all put on screen.
const MOST_AT_ONCE: usize = 2;

/// The engine's messages and the window's own.
#[derive(Default)]
pub(super) struct NoticeList {
    shown: Notifications,
    newest: u64,
    unread: usize,
    history_open: bool,
}

impl NoticeList {
    /// Adds the engine's messages that are new.
    pub(super) fn take(&mut self, notices: &Arc<[Notice]>) {
        let first_new = notices.partition_point(|notice| notice.number <= self.newest);
        let new = &notices[first_new..];
        for notice in new {
            self.newest = notice.number;
            let severity = severity(notice.level);
            if matches!(severity, Severity::Warning | Severity::Failed) {
                self.unread += 1;
            }
            self.shown.push(severity, notice.text.as_str());
        }
        if new.len() > MOST_AT_ONCE {
            self.summarize(new.len());
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

    /// Adds a passing message of the window.
    pub(super) fn say(&mut self, text: &str) {
        self.shown.push(Severity::Info, text);
    }

    /// Warnings and failures since the history was last open.
    pub(super) fn unread(&self) -> usize {
        self.unread
    }

    pub(super) fn is_history_open(&self) -> bool {
        self.history_open
    }

    pub(super) fn toggle_history(&mut self) {
        self.history_open = !self.history_open;
        self.unread = 0;
    }

    pub(super) fn show_new(&mut self, ctx: &Context) {
        if !self.history_open {
            self.shown.show_toasts(ctx, vec2(space::M, 68.0));
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
            self.shown.show_history(ui);
        });
        self.unread = 0;
        if shown.close {
            self.history_open = false;
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
        list.toggle_history();
        assert_eq!(list.unread(), 0);
    }
}
