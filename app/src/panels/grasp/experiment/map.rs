//! A method over the table: how often the thing was lifted at each place, beside the published count.

use egui::{
    Align2, Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use plumbline_widgets::theme::{self, Role};

use crate::operator::snapshot::trials::{Page, PageMethod, PagePosition};

/// What is shown of the table, robot frame: x (up) and y (to the left), m.
const SHOWN_M: [[f64; 2]; 2] = [[0.12, 0.56], [-0.46, 0.46]];
const DOT: f32 = 11.0;
/// Places that differ by less are the same, m.
const SAME_M: f64 = 1e-6;

pub fn show(ui: &mut Ui, page: &Page, method: &PageMethod) {
    let width = ui.available_width().min(460.0);
    let [[near, far], [right, left]] = SHOWN_M;
    let height = width * ((far - near) / (left - right)) as f32;
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let lifted: usize = method.positions.iter().map(|position| position.successes).sum();
    let made: usize = method.positions.iter().map(|position| position.attempts).sum();
    response.widget_info(|| {
        let said = format!("{}: lifted in {lifted} of {made} attempts", method.name);
        WidgetInfo::labeled(egui::Role::Label, true, said)
    });
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 6.0, tokens.background);
    let screen = page.screen_m.map(|at_m| on(rect, at_m)).to_vec();
    painter.add(Shape::convex_polygon(screen, tokens.raised, Stroke::NONE));
    let [[x0, x1], [y0, y1]] = page.area_m;
    let area = [[x0, y0], [x0, y1], [x1, y1], [x1, y0], [x0, y0]].map(|at_m| on(rect, at_m));
    painter.extend(Shape::dashed_line(&area, Stroke::new(1.0, tokens.text_weak), 4.0, 3.0));
    for at_m in &page.beyond_m {
        if !method.positions.iter().any(|position| is_same(position.at_m, *at_m)) {
            painter.circle_stroke(on(rect, *at_m), 0.35 * DOT, Stroke::new(1.0, tokens.text_weak));
        }
    }
    for position in &method.positions {
        dot(ui, &painter, rect, position);
    }
    let small = TextStyle::Small.resolve(ui.style());
    let robot = pos2(on(rect, [near, 0.0]).x, rect.bottom() - 2.0);
    painter.text(robot, Align2::CENTER_BOTTOM, "robot", small, tokens.text_weak);
}

fn is_same([ax_m, ay_m]: [f64; 2], [bx_m, by_m]: [f64; 2]) -> bool {
    (ax_m - bx_m).hypot(ay_m - by_m) < SAME_M
}

fn on(rect: Rect, [x_m, y_m]: [f64; 2]) -> Pos2 {
    let [[near, far], [right, left]] = SHOWN_M;
    let across = ((left - y_m) / (left - right)) as f32;
    let up = ((far - x_m) / (far - near)) as f32;
    pos2(rect.left() + across * rect.width(), rect.top() + up * rect.height())
}

fn dot(ui: &Ui, painter: &Painter, rect: Rect, position: &PagePosition) {
    let tokens = theme::tokens(ui);
    let at = on(rect, position.at_m);
    let share = position.successes as f32 / position.attempts.max(1) as f32;
    let (never, always) = (Role::Warning.color(tokens), Role::Accepted.color(tokens));
    let fill: Color32 = never.lerp_to_gamma(always, share);
    painter.circle_filled(at, DOT, fill);
    let font = theme::strong_style(ui).resolve(ui.style());
    painter.text(at, Align2::CENTER_CENTER, position.successes.to_string(), font, tokens.background);
    if let Some(published) = position.published {
        let small = TextStyle::Small.resolve(ui.style());
        let beside = at + vec2(DOT + 2.0, DOT - 4.0);
        painter.text(beside, Align2::LEFT_CENTER, published.to_string(), small, tokens.text);
    }
}
