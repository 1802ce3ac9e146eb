//! Short messages that pass by, and the list of those that did.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui::{Align2, Area, Context, Frame, Id, Margin, Order, RichText, ScrollArea, Ui, Vec2, vec2};

use crate::format;
use crate::glyph::{self, Glyph};
use crate::theme::{self, Tokens, space};

const MOST_KEPT: usize = 200;
const MOST_TOASTS: usize = 4;
const WIDTH: f32 = 340.0;
/// Of a message that is no wider than this the buttons stand below it.
const NARROW: f32 = 300.0;
const CLOSE: f32 = 64.0;
const SIDES: f32 = 24.0;
/// Of a message that passes by.
const MOST_LETTERS: usize = 220;

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Good to know.
    Info,
    /// Something was finished.
    Done,
    /// Look at it when you can.
    Warning,
    /// Something did not work.
    Failed,
}

impl Severity {
    /// How long a message stays on screen; after that it is found in the list.
    fn lifetime(self) -> Duration {
        Duration::from_secs(match self {
            Self::Info | Self::Done => 5,
            Self::Warning => 12,
            Self::Failed => 25,
        })
    }

    fn sign(self, tokens: &Tokens) -> (Glyph, egui::Color32) {
        match self {
            Self::Info => (Glyph::Info, tokens.text),
            Self::Done => (Glyph::Check, tokens.accepted),
            Self::Warning => (Glyph::Warning, tokens.warning),
            Self::Failed => (Glyph::Cross, tokens.warning),
        }
    }
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Notification {
    /// Counts up.
    pub number: u64,
    /// How much it matters.
    pub severity: Severity,
    /// What happened and, if something is to be done, what.
    pub text: String,
    /// When, the last time.
    pub at: Instant,
    /// How often it was said while it was on screen, or in a row.
    pub times: u32,
    /// What it tells of, to be opened.
    pub file: Option<PathBuf>,
    dismissed: bool,
}

impl Notification {
    fn is_on_screen(&self, now: Instant) -> bool {
        !self.dismissed && now.saturating_duration_since(self.at) < self.severity.lifetime()
    }

    /// Whether there is nothing to be done or opened.
    fn asks_nothing(&self) -> bool {
        matches!(self.severity, Severity::Info | Severity::Done) && self.file.is_none()
    }

    /// What it says, and how often that was said.
    fn words(&self) -> String {
        match self.times {
            0 | 1 => self.text.clone(),
            times => format!("{} ({times} times)", self.text),
        }
    }
}

/// The messages of a run, newest last, at most 200.
#[derive(Clone, Debug, Default)]
pub struct Notifications {
    kept: VecDeque<Notification>,
    next: u64,
}

impl Notifications {
    /// Adds a message. One that repeats the newest, or one that is still on screen, takes its place and is
    /// counted.
    pub fn push(&mut self, severity: Severity, text: impl Into<String>) {
        self.repeat_at(severity, text, 1, Instant::now());
    }

    /// As [`Self::push`], for one that was said so many times.
    pub fn repeat(&mut self, severity: Severity, text: impl Into<String>, times: u32) {
        self.repeat_at(severity, text, times, Instant::now());
    }

    /// As [`Self::repeat`], at a given time.
    pub fn repeat_at(&mut self, severity: Severity, text: impl Into<String>, times: u32, at: Instant) {
        let text = text.into();
        let newest = self.kept.len().saturating_sub(1);
        let is_same = |(i, known): &(usize, &Notification)| {
            (*i == newest || known.is_on_screen(at)) && known.severity == severity && known.text == text
        };
        let same = self.kept.iter().enumerate().rev().find(is_same).map(|(i, _)| i);
        let said = same.and_then(|i| self.kept.remove(i)).map_or(0, |known| known.times);
        if self.kept.len() == MOST_KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back(Notification {
            number: self.next,
            severity,
            text,
            at,
            times: said.saturating_add(times),
            file: None,
            dismissed: false,
        });
        self.next += 1;
    }

    /// The newest message tells of this file, which can be opened there.
    pub fn tells_of(&mut self, file: PathBuf) {
        if let Some(newest) = self.kept.back_mut() {
            newest.file = Some(file);
        }
    }

    /// All messages, newest first.
    pub fn history(&self) -> impl Iterator<Item = &Notification> {
        self.kept.iter().rev()
    }

    /// Messages on screen at a time, newest last. Of those that ask for nothing only the newest: a stack of them
    /// would cover the work, and older ones do not come back once it left or was dismissed.
    pub fn on_screen(&self, now: Instant) -> impl Iterator<Item = &Notification> {
        let newest = self.kept.iter().rev().find(|n| n.asks_nothing());
        let newest = newest.map(|n| n.number);
        let shown = self.kept.iter().filter(|n| n.is_on_screen(now));
        let shown: Vec<_> = shown.filter(|n| !n.asks_nothing() || Some(n.number) == newest).collect();
        let skip = shown.len().saturating_sub(MOST_TOASTS);
        shown.into_iter().skip(skip)
    }

    /// Takes a message off the screen; it stays in the history.
    pub fn dismiss(&mut self, number: u64) {
        if let Some(found) = self.kept.iter_mut().find(|n| n.number == number) {
            found.dismissed = true;
        }
    }

    /// Takes those off the screen that say this and ask for nothing more.
    pub fn dismiss_those_of(&mut self, text: &str) {
        self.kept.iter_mut().filter(|n| n.text.contains(text)).for_each(|n| n.dismissed = true);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.kept.clear();
    }

    /// Draws the messages on screen, stacked upward from the bottom right; `margin` keeps them
    /// off the window's bottom line; `room`: how wide they may be, pt, where something there spares that much. Returns the
    /// file that is to be opened.
    pub fn show_toasts(&mut self, ctx: &Context, margin: Vec2, room: Option<f32>) -> Option<PathBuf> {
        let width = room.map_or(WIDTH, |room| (room - SIDES).clamp(160.0, WIDTH));
        let now = Instant::now();
        let shown: Vec<Notification> = self.on_screen(now).cloned().collect();
        let (mut dismissed, mut opened) = (Vec::new(), None);
        let area = Area::new(Id::unique("notifications")).order(Order::Foreground);
        area.anchor(Align2::RIGHT_BOTTOM, -margin).interactable(!shown.is_empty()).show(ctx, |ui| {
            for notification in &shown {
                let asked = toast(ui, notification, width);
                if asked.dismissed {
                    dismissed.push(notification.number);
                }
                opened = opened.take().or(notification.file.clone().filter(|_| asked.opened));
            }
        });
        for number in dismissed {
            self.dismiss(number);
        }
        let next_end = shown.iter().map(|n| n.at + n.severity.lifetime()).min();
        if let Some(end) = next_end {
            ctx.request_repaint_after(end.saturating_duration_since(now));
        }
        opened
    }

    /// Draws the list of all messages, newest first. Returns the file that is to be opened.
    pub fn show_history(&mut self, ui: &mut Ui) -> Option<PathBuf> {
        if self.kept.is_empty() {
            crate::empty::empty_state(ui, "No messages yet", "What the program reports is kept here.", None);
            return None;
        }
        let mut opened = None;
        let now = Instant::now();
        ScrollArea::vertical().id_salt("notification history").auto_shrink([false, true]).show(ui, |ui| {
            for notification in self.history() {
                ui.horizontal_top(|ui| {
                    severity_sign(ui, notification.severity);
                    let age = format::age(now.saturating_duration_since(notification.at));
                    ui.add_sized(
                        vec2(72.0, 18.0),
                        egui::Label::new(theme::small(ui, age)).halign(egui::Align::LEFT),
                    );
                    ui.vertical(|ui| {
                        ui.add(egui::Label::new(notification.words()).wrap());
                        if notification.file.is_some() && ui.button("Open").clicked() {
                            opened.clone_from(&notification.file);
                        }
                    });
                });
            }
        });
        opened
    }
}

fn severity_sign(ui: &mut Ui, severity: Severity) {
    let (rect, _) = ui.allocate_exact_size(vec2(14.0, 18.0), egui::Sense::hover());
    let (sign, color) = severity.sign(theme::tokens(ui));
    glyph::paint(ui.painter(), rect.center(), 12.0, sign, color);
}

/// What was asked for at a message on screen.
struct ToastAsked {
    dismissed: bool,
    opened: bool,
}

fn toast(ui: &mut Ui, notification: &Notification, width: f32) -> ToastAsked {
    let tokens = theme::tokens(ui);
    let frame = Frame::new()
        .fill(tokens.raised)
        .corner_radius(6)
        .inner_margin(Margin::symmetric(12, 10))
        .shadow(ui.visuals().popup_shadow);
    let inner = frame.show(ui, |ui| {
        ui.set_width(width);
        let is_narrow = width < NARROW;
        let asked = |ui: &mut Ui, pressed: bool| {
            let dismissed = ui.add(egui::Button::new(theme::small(ui, "Dismiss")).frame(false)).clicked();
            let opened = notification.file.is_some() && ui.button("Open").clicked();
            ToastAsked { dismissed: dismissed || pressed, opened }
        };
        let said = ui.horizontal_top(|ui| {
            severity_sign(ui, notification.severity);
            let words = RichText::new(shortened(notification.words())).color(tokens.text_strong);
            let words = egui::Label::new(words).wrap().selectable(false).sense(egui::Sense::click());
            // What it covers is one press away, wherever that goes.
            let beside = if is_narrow { 0.0 } else { CLOSE };
            let size = vec2(width - 30.0 - beside - space::S, 0.0);
            let pressed = ui.allocate_ui(size, |ui| ui.add(words).clicked()).inner;
            match is_narrow {
                true => (pressed, None),
                false => {
                    let layout = egui::Layout::top_down(egui::Align::Max);
                    (pressed, Some(ui.with_layout(layout, |ui| asked(ui, pressed)).inner))
                }
            }
        });
        let (pressed, beside) = said.inner;
        beside.unwrap_or_else(|| {
            ui.with_layout(egui::Layout::top_down(egui::Align::Max), |ui| asked(ui, pressed)).inner
        })
    });
    ui.add_space(space::S);
    inner.inner
}

/// What passes by covers little; all of a message stands in the list.
fn shortened(words: String) -> String {
    let Some((most, _)) = words.char_indices().nth(MOST_LETTERS) else { return words };
    let end = words[..most].rfind(' ').unwrap_or(most);
    format!("{}… All of it stands in Messages.", &words[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_message_passes_by_shortened() {
        assert_eq!(shortened("The run is finished.".to_owned()), "The run is finished.");
        let long = "Größe des Fehlers ".repeat(40);
        let said = shortened(long);
        assert!(
            said.chars().count() < MOST_LETTERS + 40 && said.ends_with("… All of it stands in Messages."),
            "{said}"
        );
        assert!(shortened("x".repeat(500)).starts_with(&"x".repeat(MOST_LETTERS)));
    }

    #[test]
    fn messages_leave_the_screen_but_not_the_history() {
        let start = Instant::now();
        let mut notifications = Notifications::default();
        notifications.repeat_at(Severity::Info, "saved", 1, start);
        notifications.repeat_at(Severity::Failed, "camera lost", 1, start);
        let texts = |n: &Notifications, s: u64| {
            n.on_screen(start + Duration::from_secs(s)).map(|n| n.text.clone()).collect::<Vec<_>>()
        };
        assert_eq!(texts(&notifications, 1), ["saved", "camera lost"]);
        assert_eq!(texts(&notifications, 20), ["camera lost"], "what failed stays longer");
        assert!(texts(&notifications, 26).is_empty(), "and leaves, too");
        let failed = notifications.history().next().expect("newest").number;
        notifications.dismiss(failed);
        assert_eq!(texts(&notifications, 1), ["saved"]);
        assert_eq!(notifications.history().count(), 2);
    }

    #[test]
    fn equal_messages_are_one_with_a_count_as_long_as_it_is_on_screen() {
        let start = Instant::now();
        let mut notifications = Notifications::default();
        let mut say = |severity, text: &str, after_s: u64| {
            notifications.repeat_at(severity, text, 1, start + Duration::from_secs(after_s));
        };
        say(Severity::Failed, "camera lost", 0);
        say(Severity::Info, "saved", 1);
        say(Severity::Failed, "camera lost", 20);
        say(Severity::Warning, "camera lost", 21);
        let at_s = |n: &Notifications, s: u64| {
            n.on_screen(start + Duration::from_secs(s)).map(Notification::words).collect::<Vec<_>>()
        };
        assert_eq!(at_s(&notifications, 22), ["camera lost (2 times)", "camera lost"]);
        assert_eq!(at_s(&notifications, 40), ["camera lost (2 times)"], "it counts from the last time");
        notifications.repeat_at(Severity::Failed, "camera lost", 1, start + Duration::from_secs(300));
        assert_eq!(at_s(&notifications, 301), ["camera lost"], "long after it is news again");
        assert_eq!(notifications.history().count(), 4);
    }

    #[test]
    fn repeated_messages_are_kept_once_and_old_ones_go() {
        let mut notifications = Notifications::default();
        for _ in 0..5 {
            notifications.push(Severity::Warning, "frame dropped");
        }
        assert_eq!(notifications.history().count(), 1);
        for i in 0..500 {
            notifications.push(Severity::Info, format!("pair {i}"));
        }
        assert_eq!(notifications.history().count(), MOST_KEPT);
        assert_eq!(notifications.history().next().map(|n| n.text.as_str()), Some("pair 499"));
        let on_screen =
            |of: &Notifications| of.on_screen(Instant::now()).map(|n| n.text.clone()).collect::<Vec<_>>();
        // The warning has scrolled out of what is kept.
        assert_eq!(on_screen(&notifications), ["pair 499"], "of those that ask for nothing only the newest");
        let newest = notifications.history().next().expect("newest").number;
        notifications.dismiss(newest);
        assert!(on_screen(&notifications).is_empty(), "what was put away does not bring back older ones");
        (0..9).for_each(|i| notifications.push(Severity::Warning, format!("servo {i} is hot")));
        assert_eq!(on_screen(&notifications).len(), MOST_TOASTS);
    }
}
