//! How far the hand was from where it belongs, look by look.

use egui::{Align2, FontSelection, Rect, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_engine::view::GraspIteration;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role};

const HEIGHT: f32 = 64.0;
const BAR: f32 = 26.0;
const GAP: f32 = 38.0;
/// Bars are drawn on a scale of at least this, m.
const LEAST_SCALE_M: f64 = 0.004;

/// A bar per look, in mm.
pub fn show(ui: &mut Ui, iterations: &[GraspIteration]) {
    let tokens = theme::tokens(ui);
    ui.label(theme::small(ui, "Hand beside the object, look by look"));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let words: Vec<String> =
        iterations.iter().map(|look| look.distance_m.map_or("not found".to_owned(), format::mm)).collect();
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Label, true, format!("Hand beside the object: {}", words.join(", ")))
    });
    let known = iterations.iter().filter_map(|look| look.distance_m);
    let scale_m = known.fold(LEAST_SCALE_M, f64::max);
    let font = FontSelection::Style(TextStyle::Small).resolve(ui.style());
    let (floor, top) = (rect.bottom() - 2.0, rect.top() + 16.0);
    let painter = ui.painter();
    painter.hline(rect.x_range(), floor, egui::Stroke::new(1.0, tokens.grid));
    for (i, (look, text)) in iterations.iter().zip(&words).enumerate() {
        let x = rect.left() + 14.0 + i as f32 * (BAR + GAP);
        let Some(distance_m) = look.distance_m else {
            let at = pos2(x + BAR / 2.0, floor - 4.0);
            painter.text(at, Align2::CENTER_BOTTOM, "–", font.clone(), Role::Warning.color(tokens));
            continue;
        };
        let height = ((distance_m / scale_m) as f32 * (floor - top)).max(1.5);
        let bar = Rect::from_min_max(pos2(x, floor - height), pos2(x + BAR, floor));
        painter.rect_filled(bar, 1.0, Role::Difference.color(tokens));
        painter.text(
            pos2(x + BAR / 2.0, floor - height - 2.0),
            Align2::CENTER_BOTTOM,
            text,
            font.clone(),
            tokens.text,
        );
    }
    if let Some(why) = iterations.last().and_then(|look| look.not_found.as_ref()) {
        ui.label(theme::small(ui, crate::operator::words::grasp::closed(why)));
    }
}
