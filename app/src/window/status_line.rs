//! The bottom line: what is happening and what to do next, with the one button that does it.

use egui::{Align, Layout, Panel, Ui};
use plumbline_engine::view::{JobState, JobView};
use plumbline_engine::{JobCommand, View};
use plumbline_widgets::buttons::accent_button;
use plumbline_widgets::progress::{ProgressAction, ProgressLine};
use plumbline_widgets::theme::space;

use super::PlumblineWindow;
use crate::operator::guidance::{Guidance, failed_inside, guidance};
use crate::operator::{Action, Course, GraspAction, Outbox, Screen, TouchAction, course, shortcut_text};

const HEIGHT: f32 = 52.0;

pub(super) fn show(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let margin = egui::Margin { left: 16, right: 8, top: 8, bottom: 8 };
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(margin);
    let bottom = Panel::bottom("bottom line").frame(frame).exact_size(HEIGHT).show_separator_line(false);
    bottom.show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| contents(window, ui, outbox));
    });
}

fn contents(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let view = &window.view;
    let screen = window.settings.screen;
    let failed = failed_inside(view, screen);
    // What failed inside is not hidden behind work that goes on.
    if let (Some(job), None) = (view.running_job(), &failed) {
        return running(job, ui, outbox);
    }
    let (guidance, led) = match (failed, course(view)) {
        (Some(failed), _) => (failed, false),
        (None, Some(course)) => (of_course(view, screen, course), true),
        (None, None) => (guidance(view, screen), false),
    };
    next_button(view, &guidance, led, ui, outbox);
    if let Some((job, reason)) = failed_job(view) {
        if ui.button("Dismiss").clicked() {
            outbox.send(JobCommand::Dismiss(job.id));
        }
        line(ProgressLine::warning(&format!("{}: {reason}", job.title)), ui, outbox);
    } else if guidance.warning {
        line(ProgressLine::warning(&guidance.sentence), ui, outbox);
    } else {
        line(ProgressLine::idle(&guidance.sentence), ui, outbox);
    }
}

fn running(job: &JobView, ui: &mut Ui, outbox: &mut Outbox) {
    let JobState::Running { fraction, doing, remaining, cancelling } = &job.state else { return };
    let sentence = format!("{}: {doing}", job.title);
    let progress = ProgressLine::job(&sentence, *fraction).time_left(*remaining).cancelling(*cancelling);
    if line(progress, ui, outbox) == Some(ProgressAction::Cancel) {
        outbox.send(JobCommand::Cancel(job.id));
    }
}

fn line(progress: ProgressLine<'_>, ui: &mut Ui, outbox: &mut Outbox) -> Option<ProgressAction> {
    let action = ui.with_layout(Layout::left_to_right(Align::Center), |ui| progress.show(ui)).inner;
    if action == Some(ProgressAction::OpenLog) {
        outbox.act(Action::ToggleLog);
    }
    action
}

/// While commissioning leads, its button is the primary one: here stands what it says, with nothing but a
/// way to hold what moves. Where the operator looks elsewhere, that screen says its own.
fn of_course(view: &View, screen: Screen, course: Course) -> Guidance {
    let own = guidance(view, screen);
    let of_eyes = course.screen.is_eyes() && screen.is_eyes();
    if !of_eyes && screen != course.screen && screen != Screen::Commission {
        return own;
    }
    let holds = |action: Action| {
        matches!(action, Action::Touch(TouchAction::Pause) | Action::Grasp(GraspAction::Pause))
    };
    Guidance {
        sentence: course.sentence,
        warning: course.warning,
        next: own.next.filter(|next| holds(next.action)),
    }
}

fn next_button(view: &View, guidance: &Guidance, led: bool, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(next) = &guidance.next else { return };
    let refusal = next.action.refusal(view);
    let keys = shortcut_text(ui.ctx(), Action::Next).unwrap_or_default();
    let button = if led { egui::Button::new(&next.label) } else { accent_button(ui, &next.label) };
    let button = button.min_size(egui::vec2(120.0, 36.0));
    ui.spacing_mut().button_padding.x = space::M;
    let button = ui.add_enabled(refusal.is_none(), button);
    let button = button.on_hover_text(format!("{keys} does the same"));
    if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
        outbox.act(next.action);
    }
    ui.reset_style();
    ui.add_space(space::S);
}

fn failed_job(view: &View) -> Option<(&JobView, &str)> {
    view.jobs.iter().rev().find_map(|job| match &job.state {
        JobState::Failed { reason } => Some((job, reason.as_str())),
        JobState::Panicked { message } => Some((job, message.as_str())),
        _ => None,
    })
}
