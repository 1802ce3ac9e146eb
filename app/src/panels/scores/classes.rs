//! Each class by itself: a bar with its interval.

use egui::{Rect, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use plumbline_engine::view::{Score, ScoreTable};
use plumbline_widgets::theme::{self, space};
use plumbline_widgets::{class_color, class_swatch, format};

use super::parts::{chosen, figure, judged};
use crate::panels::PanelContext;

const ROW: f32 = 26.0;
const NAME: f32 = 96.0;
const FIGURES: f32 = 118.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(table) = judged(ui, cx, "After evaluating, each class has a bar here.") else { return };
    let Some((model, scores)) = chosen(cx, &table) else {
        ui.label(theme::weak(ui, "This detector could not be judged; choose another row of the table."));
        return;
    };
    ui.label(theme::weak(ui, format!("{model}: mAP50–95, bar; mAP50, tick; line: 95 % interval")));
    ui.add_space(space::XS);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (class, name) in table.names.iter() {
            let score = scores.classes.get(class.0).copied().flatten();
            row(ui, &table, class.0, name, score);
        }
    });
}

fn row(ui: &mut Ui, table: &ScoreTable, class: usize, name: &str, score: Option<Score>) {
    let tokens = theme::tokens(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let boxes = table.instances.get(class).copied().unwrap_or(0);
    let text = format!(
        "{name}: mAP50–95 {}, {}",
        figure(score.map(|score| score.map50_95)),
        format::count(boxes, "box")
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &text));
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    painter.text(rect.left_center(), egui::Align2::LEFT_CENTER, name, body.clone(), tokens.text);
    let bar = Rect::from_min_max(
        pos2(rect.left() + NAME, rect.top() + 7.0),
        pos2((rect.right() - FIGURES).max(rect.left() + NAME + 20.0), rect.bottom() - 7.0),
    );
    painter.rect_filled(bar, 2.0, tokens.raised);
    let x = |value: f64| bar.left() + bar.width() * value.clamp(0.0, 1.0) as f32;
    if let Some(score) = score {
        let filled = Rect::from_min_max(bar.min, pos2(x(score.map50_95), bar.bottom()));
        class_swatch(painter, filled, class_color(name, class), tokens.text_weak);
        if let Some([low, high]) = score.map50_95_interval {
            painter.hline(x(low)..=x(high), bar.center().y, Stroke::new(2.0, tokens.text_strong));
        }
        let tick = Stroke::new(2.0, tokens.text_strong);
        painter.vline(x(score.map50), (bar.top() - 3.0)..=(bar.bottom() + 3.0), tick);
    }
    let figures = format!("{}  {}", figure(score.map(|s| s.map50_95)), figure(score.map(|s| s.map50)));
    painter.text(
        pos2(bar.right() + 8.0, bar.center().y),
        egui::Align2::LEFT_CENTER,
        figures,
        body,
        tokens.text,
    );
    let count = format!("{boxes}");
    painter.text(rect.right_center(), egui::Align2::RIGHT_CENTER, count, small, tokens.text_weak);
    response.on_hover_text(text);
}
