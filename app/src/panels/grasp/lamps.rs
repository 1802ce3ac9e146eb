//! The steps of an attempt as a row of lamps.

use egui::{Align2, FontSelection, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_engine::view::{GraspStep, LampState};
use plumbline_widgets::theme::{self, Role};

const HEIGHT: f32 = 42.0;
const RADIUS: f32 = 6.5;
/// The widest title needs so much, and each this height.
const TITLE: f32 = 58.0;
const LINE: f32 = 14.0;
/// Titles at both ends, wider than their share of the row, need so much more.
const ENDS: f32 = 8.0;

/// All steps, those that are done filled, the one under way ringed, the one where it ended crossed.
pub fn show(ui: &mut Ui, lamps: &[(GraspStep, LampState)]) {
    let tokens = theme::tokens(ui);
    let width = ui.available_width();
    let count = lamps.len().max(1) as f32;
    let ends = if width / count < TITLE { ENDS } else { 0.0 };
    let each = (width - 2.0 * ends) / count;
    let height = if each < TITLE { HEIGHT + LINE } else { HEIGHT };
    let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let font = FontSelection::Style(TextStyle::Small).resolve(ui.style());
    let y = rect.top() + 11.0;
    for (i, (step, lamp)) in lamps.iter().enumerate() {
        let x = rect.left() + ends + (i as f32 + 0.5) * each;
        let (at, painter) = (pos2(x, y), ui.painter());
        if i > 0 {
            let line = [pos2(x - each + RADIUS + 3.0, y), pos2(x - RADIUS - 3.0, y)];
            let color = if *lamp == LampState::Dark { tokens.grid } else { Role::Accepted.color(tokens) };
            painter.line_segment(line, Stroke::new(1.5, color));
        }
        let (color, words) = match lamp {
            LampState::Dark => (tokens.text_weak, "to come"),
            LampState::Lit => (tokens.text_strong, "under way"),
            LampState::Done => (Role::Accepted.color(tokens), "done"),
            LampState::Failed => (Role::Warning.color(tokens), "ended here"),
        };
        match lamp {
            LampState::Dark => {
                painter.circle_stroke(at, RADIUS - 1.5, Stroke::new(1.2, color));
            }
            LampState::Lit => {
                painter.circle_stroke(at, RADIUS, Stroke::new(2.0, color));
                painter.circle_filled(at, RADIUS - 3.5, color);
            }
            LampState::Done => {
                painter.circle_filled(at, RADIUS, color);
            }
            LampState::Failed => {
                let (out, stroke) = (RADIUS - 1.0, Stroke::new(2.2, color));
                painter.line_segment([at - vec2(out, out), at + vec2(out, out)], stroke);
                painter.line_segment([at - vec2(out, -out), at + vec2(out, -out)], stroke);
            }
        }
        // Where titles would meet, every other one stands a line lower.
        let lower = if each < TITLE && i % 2 == 1 { LINE } else { 0.0 };
        let below = pos2(x, y + 2.0 * RADIUS + lower);
        painter.text(below, Align2::CENTER_TOP, step.title(), font.clone(), color);
        let area = egui::Rect::from_center_size(at, vec2(each, 2.0 * (RADIUS + 2.0)));
        let response = ui.interact(area, ui.scope_id().with(("step", i)), Sense::hover());
        let label = format!("{} {words}", step.title());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &label));
        response.on_hover_text(label);
    }
}
