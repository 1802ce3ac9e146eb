//! The strip of commissioning under the top line: where it is, what it took, and the one button that
//! leads on.

use std::time::{Duration, Instant};

use egui::{Align, Layout, Panel, ProgressBar, Ui};
use plumbline_widgets::buttons::accent_button;
use plumbline_widgets::theme::{self, space};

use super::PlumblineWindow;
use crate::operator::guidance::spent;
use crate::operator::{
    Action, CommissionAction, Course, GraspAction, Outbox, Press, Screen, course, shortcut_text,
};

const HEIGHT: f32 = 46.0;
/// Before what was asked for shows, the same button would ask for it twice.
const ONCE: Duration = Duration::from_millis(900);

pub(super) fn show(window: &mut PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let course = course(&window.view);
    let meaning = course.as_ref().and_then(|course| match &course.press {
        Press::Do { actions, .. } => Some(actions.clone()),
        Press::Wait { .. } => None,
    });
    window.commission_rest.see(ui.ctx(), meaning);
    let (Some(course), window) = (course, &*window) else { return };
    let margin = egui::Margin { left: 16, right: 8, top: 5, bottom: 5 };
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(margin);
    let frame = frame.fill(theme::tokens(ui).raised);
    let strip = Panel::top("commission").frame(frame).exact_size(HEIGHT).show_separator_line(false);
    strip.show(ui, |ui| {
        // Accepting is never where collecting was.
        let layout = match accepts(&course) {
            true => Layout::left_to_right(Align::Center),
            false => Layout::right_to_left(Align::Center),
        };
        ui.with_layout(layout, |ui| {
            next(window, &course, ui, outbox);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| words(window, &course, ui, outbox));
        });
    });
}

/// Whether its button puts something in use.
fn accepts(course: &Course) -> bool {
    matches!(&course.press, Press::Do { actions, .. } if actions.iter().any(|action| action.puts_in_use()))
}

/// Where it is, and what it took.
fn words(window: &PlumblineWindow, course: &Course, ui: &mut Ui, outbox: &mut Outbox) {
    let title = egui::Label::new(theme::strong(ui, &course.title)).truncate().sense(egui::Sense::click());
    // What it took stands whole where there is room for both.
    let spent = spent(&window.view.commission.spent);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let color = theme::tokens(ui).text_weak;
    let width = ui.painter().layout_no_wrap(spent.clone(), font, color).size().x + space::M;
    let room = (ui.available_width() - width).max(120.0);
    let asked = ui
        .scope(|ui| {
            ui.set_max_width(room);
            ui.add(title).on_hover_text("All steps")
        })
        .inner;
    if asked.clicked() {
        outbox.act(Action::Go(Screen::Commission));
    }
    ui.add(egui::Label::new(theme::weak(ui, spent)).truncate());
}

/// The one button, or what is waited for.
fn next(window: &PlumblineWindow, course: &Course, ui: &mut Ui, outbox: &mut Outbox) {
    let just_pressed =
        window.commission_pressed.map(|pressed| pressed.elapsed()).filter(|since| *since < ONCE);
    if let Some(since) = just_pressed {
        ui.ctx().request_repaint_after(ONCE - since);
    }
    ui.spacing_mut().button_padding.x = space::M;
    match &course.press {
        Press::Do { label, actions } => {
            let label = if leads_only(window.settings.screen, course.screen, actions) {
                Action::Go(course.screen).label()
            } else {
                label.clone()
            };
            let button = accent_button(ui, next_label(&label)).min_size(egui::vec2(120.0, 34.0));
            let keys = shortcut_text(ui.ctx(), Action::Next).unwrap_or_default();
            let hover = format!("{}\n{keys} does the same", course.sentence);
            let resting = just_pressed.is_some() || window.commission_rest.is_on(ui.ctx());
            let button = ui.add_enabled(!resting, button).on_hover_text(hover);
            let button = button.on_disabled_hover_text(crate::panels::rest::WHY);
            if button.clicked() {
                outbox.act(Action::Commission(CommissionAction::Next));
            }
            if let Some(no) = otherwise(actions) {
                ui.reset_style();
                let button = ui.add_enabled(!resting, egui::Button::new(no.label()));
                if button.on_disabled_hover_text(crate::panels::rest::WHY).clicked() {
                    outbox.act(no);
                }
            }
        }
        Press::Wait { why, fraction } => {
            // While STOP is latched nothing goes on by waiting.
            let label = if window.view.robot.stopped { "Stopped" } else { "Wait" };
            let button = egui::Button::new(label).min_size(egui::vec2(120.0, 34.0));
            ui.add_enabled(false, button).on_disabled_hover_text(why);
            if let Some(fraction) = fraction {
                ui.add(ProgressBar::new(*fraction as f32).desired_width(140.0).desired_height(6.0));
            } else if !window.view.robot.stopped {
                // While STOP is latched nothing goes on.
                ui.spinner();
            }
        }
    }
    ui.reset_style();
    ui.add_space(space::S);
}

/// Whether the next press only leads to where it is said what will move: from elsewhere nothing begins to move.
fn leads_only(from: Screen, to: Screen, actions: &[Action]) -> bool {
    let is_said = from == Screen::Commission || from == to;
    !is_said && actions.iter().any(|action| action.moves_the_robot())
}

/// The other answer, where the button gives one: what is pressed to go on must not be what makes it good.
fn otherwise(actions: &[Action]) -> Option<Action> {
    let answers_yes = actions == [Action::Grasp(GraspAction::Held)];
    answers_yes.then_some(Action::Grasp(GraspAction::NotHeld))
}

/// "Next: show the board at all places".
fn next_label(label: &str) -> String {
    let mut letters = label.chars();
    let first = letters.next().map(|first| first.to_lowercase().to_string()).unwrap_or_default();
    format!("Next: {first}{}", letters.as_str())
}

impl PlumblineWindow {
    pub(super) fn act_on_commission(&mut self, ctx: &egui::Context, action: CommissionAction) {
        let view = self.view.clone();
        if action == CommissionAction::Next {
            let Some(Course { screen, press: Press::Do { actions, .. }, .. }) = course(&view) else { return };
            self.commission_pressed = Some(Instant::now());
            let leads_only = leads_only(self.settings.screen, screen, &actions);
            self.settings.screen = screen;
            if leads_only {
                return;
            }
            actions.into_iter().for_each(|action| self.act(ctx, action));
            return;
        }
        for command in action.commands(&view) {
            self.send(command);
        }
        if matches!(action, CommissionAction::Start | CommissionAction::StartAnew) {
            self.settings.screen = Screen::Commission;
        }
    }

    /// Where nothing was ever commissioned, that is what is opened.
    pub(super) fn open_commissioning(&mut self) {
        let commission = &self.view.commission;
        if !self.may_open_commissioning || !commission.is_known {
            return;
        }
        // The twin is reached a moment after the window has opened.
        if self.view.robot.connection.is_connected() {
            self.may_open_commissioning = false;
            if commission.is_untouched() {
                self.settings.screen = Screen::Commission;
            }
        }
    }
}
