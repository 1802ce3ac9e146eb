//! How long frames take, over the window: for whoever looks after its speed.

use egui::{Align2, Area, Context, Id, Order, Sense, Stroke, vec2};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::frame_time::FrameTimes;

/// A frame that takes longer does not fit a display of 60 Hz.
const BUDGET_MS: f32 = 16.0;

pub(super) fn show(ctx: &Context, times: &FrameTimes, renderer: &str) {
    let anchor = Area::new(Id::unique("frame times")).order(Order::Tooltip).interactable(false);
    anchor.anchor(Align2::RIGHT_BOTTOM, vec2(-space::M, -96.0)).show(ctx, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_width(250.0);
            ui.label(theme::strong(ui, "Frame times (own processor time)"));
            if let Some(summary) = times.summary() {
                ui.label(format!(
                    "half {}, 95 of 100 {}, {} frames",
                    format::ms(summary.median.as_secs_f64()),
                    format::ms(summary.percentile_95.as_secs_f64()),
                    summary.count
                ));
            }
            ui.label(theme::small(
                ui,
                format!("{} frames in the last second; {renderer}", times.per_second()),
            ));
            bars(ui, times);
        });
    });
}

fn bars(ui: &mut egui::Ui, times: &FrameTimes) {
    let tokens = theme::tokens(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(240.0, 48.0), Sense::hover());
    let painter = ui.painter_at(rect);
    for (i, time) in times.recent().enumerate() {
        let ms = time.as_secs_f32() * 1e3;
        let x = rect.left() + i as f32;
        let height = (ms / (2.0 * BUDGET_MS) * rect.height()).min(rect.height());
        let role = if ms > BUDGET_MS { Role::Warning } else { Role::Accepted };
        painter.vline(x, rect.bottom() - height..=rect.bottom(), Stroke::new(1.0, role.color(tokens)));
    }
    painter.hline(rect.x_range(), rect.center().y, Stroke::new(1.0, tokens.text_weak));
}
