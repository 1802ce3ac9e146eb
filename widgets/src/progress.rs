//! The bottom line: what is happening, how far, how long, and how to halt it.

use std::time::Duration;

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align, Layout, Rect, RichText, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::format;
use crate::theme::{self, Role, space};

const BAR: egui::Vec2 = vec2(180.0, 6.0);

/// A job under way, or the sentence that says what to do next.
#[derive(Clone, Copy, Debug)]
pub struct ProgressLine<'a> {
    sentence: &'a str,
    role: Role,
    job: Option<JobProgress>,
}

#[derive(Clone, Copy, Debug)]
struct JobProgress {
    fraction: f64,
    left: Option<Duration>,
    cancelling: bool,
    resting: bool,
}

/// What the operator asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressAction {
    /// Give up.
    Cancel,
    /// Show the log.
    OpenLog,
}

impl<'a> ProgressLine<'a> {
    /// A sentence without a job: what to do next.
    pub fn idle(sentence: &'a str) -> Self {
        Self { sentence, role: Role::Ink, job: None }
    }

    /// A sentence that something went wrong, and what to do.
    pub fn warning(sentence: &'a str) -> Self {
        Self { sentence, role: Role::Warning, job: None }
    }

    /// A job: what it does, and how far it is, 0..=1.
    pub fn job(sentence: &'a str, fraction: f64) -> Self {
        let job = JobProgress { fraction, left: None, cancelling: false, resting: false };
        Self { sentence, role: Role::Ink, job: Some(job) }
    }

    /// How long it will still take, if that is known.
    pub fn time_left(mut self, left: Option<Duration>) -> Self {
        if let Some(job) = &mut self.job {
            job.left = left;
        }
        self
    }

    /// Cancel was asked for and has not taken effect yet.
    pub fn cancelling(mut self, cancelling: bool) -> Self {
        if let Some(job) = &mut self.job {
            job.cancelling = cancelling;
        }
        self
    }

    /// Where something else could be pressed a moment ago; Cancel is not pressed by the same hand.
    pub fn resting(mut self, resting: bool) -> Self {
        if let Some(job) = &mut self.job {
            job.resting = resting;
        }
        self
    }

    /// Draws the line over the available width.
    pub fn show(self, ui: &mut Ui) -> Option<ProgressAction> {
        let mut action = None;
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.button("Log").clicked() {
                    action = Some(ProgressAction::OpenLog);
                }
                if let Some(job) = self.job {
                    action = self.controls(ui, job).or(action);
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(self.fitted(ui)).wrap());
                });
            });
        });
        action
    }

    /// The sentence on one line; in small on two where it is too long for that, and cut only then.
    fn fitted(&self, ui: &Ui) -> LayoutJob {
        let color = self.role.color(theme::tokens(ui));
        let width = ui.available_width();
        let line = |style: TextStyle| {
            LayoutJob::simple_singleline(self.sentence.to_owned(), style.resolve(ui.style()), color)
        };
        let body = line(TextStyle::Body);
        let needed = ui.painter().layout_job(body.clone()).size().x;
        let (mut job, rows) = if needed <= width { (body, 1) } else { (line(TextStyle::Small), 2) };
        job.wrap = TextWrapping { max_width: width, max_rows: rows, ..TextWrapping::default() };
        job.break_on_newline = true;
        job
    }

    /// From right to left: cancel, time left, bar.
    fn controls(&self, ui: &mut Ui, job: JobProgress) -> Option<ProgressAction> {
        let mut action = None;
        let cancel = if job.cancelling { "Cancelling…" } else { "Cancel" };
        if ui.add_enabled(!job.cancelling && !job.resting, egui::Button::new(cancel)).clicked() {
            action = Some(ProgressAction::Cancel);
        }
        ui.add_space(space::S);
        if let Some(left) = job.left {
            ui.label(RichText::new(format::time_left(left)).color(theme::tokens(ui).text_weak));
        }
        ui.label(format::percent(job.fraction));
        progress_bar(ui, self.sentence, job.fraction, BAR);
        ui.add_space(space::S);
        action
    }
}

/// A bar alone: `fraction` of 0..=1.
pub fn progress_bar(ui: &mut Ui, label: &str, fraction: f64, size: egui::Vec2) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 };
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(egui::Role::ProgressIndicator, true, format!("Progress: {label}"));
        info.value = Some(fraction);
        info
    });
    let tokens = theme::tokens(ui);
    ui.painter().rect_filled(rect, size.y / 2.0, tokens.raised);
    let end = rect.left() + (rect.width() * fraction as f32).max(size.y);
    let filled = Rect::from_min_max(rect.min, pos2(end, rect.bottom()));
    if fraction > 0.0 {
        ui.painter().rect_filled(filled, size.y / 2.0, tokens.text);
    }
    response
}
