//! The eight steps: what is done with its figure and date, what comes now, what waits.

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, RichText, ScrollArea, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_engine::View;
use plumbline_engine::view::{CommissionState, CommissionStep, CommissionStepView};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::guidance::{commission_name, done_in_words};
use crate::operator::{Course, Press, course};
use crate::panels::{PanelContext, padded};

/// Height of a step; where room is scarce it is less, so that all eight are seen.
const ROW: f32 = 52.0;
const LEAST_ROW: f32 = 42.0;
const CIRCLE: f32 = 11.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        let room = ui.available_height();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.label(theme::strong(ui, "From a robot just switched on to its first good grasp"));
            ui.add_space(space::XS);
            ui.label(theme::weak(ui, about(cx.view)));
            ui.add_space(space::S);
            ui.spacing_mut().item_spacing.y = 0.0;
            let course = course(cx.view);
            let steps = &cx.view.commission.steps;
            let each = (room - ui.min_rect().height()) / steps.len().max(1) as f32;
            for step in steps.iter() {
                row(ui, each.clamp(LEAST_ROW, ROW), step, course.as_ref());
            }
        });
    });
}

/// Who is needed.
fn about(view: &View) -> &'static str {
    if view.twin.running {
        "On the twin nobody is needed but you with the button: an unseen hand shows the board and lays things out."
    } else {
        "You hold the board, lay it down, and lay a tomato on the table; the strip says when. Keep a hand near STOP."
    }
}

fn row(ui: &mut Ui, height: f32, view: &CommissionStepView, course: Option<&Course>) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let (name, below) = (commission_name(view.step), below(view, course));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{name}: {below}")));
    let tokens = theme::tokens(ui);
    let is_now = view.state == CommissionState::Now;
    if is_now && course.is_some() {
        ui.painter().rect_filled(rect, 6.0, tokens.raised);
    }
    let center = pos2(rect.left() + 12.0 + CIRCLE, rect.center().y);
    circle(ui, center, view);
    let left = rect.left() + 12.0 + 2.0 * CIRCLE + space::M;
    let (strong, small) = (theme::strong_style(ui).resolve(ui.style()), TextStyle::Small.resolve(ui.style()));
    let ink = match view.state {
        CommissionState::Waits(_) => tokens.text_weak,
        _ => tokens.text_strong,
    };
    let painter = ui.painter().with_clip_rect(rect);
    painter.text(pos2(left, rect.center().y - 9.0), Align2::LEFT_CENTER, name, strong, ink);
    // One line; the whole of it under the mouse.
    let mut line = LayoutJob::simple_singleline(below, small, tokens.text_weak);
    line.wrap = TextWrapping::truncate_at_width((rect.right() - left - space::S).max(40.0));
    let line = painter.layout_job(line);
    painter.galley(pos2(left, rect.center().y + 2.0), line, tokens.text_weak);
}

fn circle(ui: &Ui, center: egui::Pos2, view: &CommissionStepView) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter();
    let number = view.step.number().to_string();
    let font = TextStyle::Small.resolve(ui.style());
    match view.state {
        CommissionState::Done(_) => {
            let color = Role::Accepted.color(tokens);
            painter.circle_stroke(center, CIRCLE, Stroke::new(1.5, color));
            let tick = [vec2(-4.5, 0.5), vec2(-1.2, 3.8), vec2(4.8, -3.6)].map(|by| center + by);
            painter.line(tick.to_vec(), Stroke::new(2.0, color));
        }
        CommissionState::Now => {
            painter.circle_filled(center, CIRCLE, tokens.accent);
            painter.text(center, Align2::CENTER_CENTER, number, font, tokens.on_accent);
        }
        CommissionState::Waits(_) => {
            painter.circle_stroke(center, CIRCLE, Stroke::new(1.0, tokens.text_weak));
            painter.text(center, Align2::CENTER_CENTER, number, font, tokens.text_weak);
        }
    }
}

/// The line below the name.
fn below(view: &CommissionStepView, course: Option<&Course>) -> String {
    match (&view.state, course.map(|course| &course.press)) {
        (CommissionState::Done(done), _) => done_in_words(&done.figure),
        (CommissionState::Now, Some(Press::Do { label, .. })) => format!("now: {}", small_first(label)),
        (CommissionState::Now, Some(Press::Wait { why, .. })) => format!("now: {}", small_first(why)),
        (CommissionState::Now, None) | (CommissionState::Waits(_), _) => what_for(view.step).to_owned(),
    }
}

fn small_first(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_lowercase().to_string()).unwrap_or_default();
    format!("{first}{}", letters.as_str())
}

fn what_for(step: CommissionStep) -> &'static str {
    match step {
        CommissionStep::Eyes => "so that both eyes measure",
        CommissionStep::Mount => "so that places are in the robot's frame",
        CommissionStep::Screen => "so that touches measure the arm",
        CommissionStep::Touches => "the rest is learned from them",
        CommissionStep::Effects => "so that the model moves as the arm does",
        CommissionStep::Hands => "so that the hand meets what the eyes see",
        CommissionStep::Check => "how far the finger misses then",
        CommissionStep::Grasp => "with all of it",
    }
}

/// What a note of the inspector looks like.
pub(super) fn note(ui: &mut Ui, text: &str) {
    let color = theme::tokens(ui).text_weak;
    ui.label(RichText::new(text).color(color));
}
