//! Places of an evaluation from above: targets, where they come out, arrows between, and heights.

use egui::{Align2, Painter, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2};
use plumbline_engine::view::{GridPlace, Judged};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, Tokens};

/// What is shown of the table, robot frame: x (up) and y (to the left), m.
const SHOWN_M: [[f64; 2]; 2] = [[0.08, 0.66], [-0.52, 0.52]];
const TARGET: f32 = 3.5;
const ESTIMATE: f32 = 2.5;
/// Shorter arrows have no head, points.
const HEAD_FROM: f32 = 7.0;

/// How tall it is at such a width.
pub fn height_of(width: f32) -> f32 {
    let [[near, far], [right, left]] = SHOWN_M;
    width * ((far - near) / (left - right)) as f32
}

/// Draws it as wide as there is room; `times`: how many times as long as the error arrows are.
pub fn show(ui: &mut Ui, label: &str, judged: &Judged, times: f64) {
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(vec2(width, height_of(width)), Sense::hover());
    response.widget_info(|| {
        let said = format!("{label}: {} off on average", format::mm(judged.errors.mean_m));
        WidgetInfo::labeled(egui::Role::Image, true, said)
    });
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 6.0, tokens.background);
    let nearest = response.hover_pos().and_then(|pointer| {
        let away = |place: &&GridPlace| on(rect, flat(&place.target)).distance(pointer);
        judged.places.iter().filter(|place| away(place) < 24.0).min_by(|a, b| away(a).total_cmp(&away(b)))
    });
    for place in &judged.places {
        let is_nearest = nearest.is_some_and(|nearest| std::ptr::eq(nearest, place));
        draw(ui, &painter, tokens, rect, place, times, is_nearest);
    }
    let small = TextStyle::Small.resolve(ui.style());
    let [[near, _], _] = SHOWN_M;
    let robot = pos2(on(rect, [near, 0.0]).x, rect.bottom() - 2.0);
    painter.text(robot, Align2::CENTER_BOTTOM, "robot", small, tokens.text_weak);
    if let Some(place) = nearest {
        response.on_hover_text_at_pointer(words(place));
    }
}

fn flat(at: &plumbline_model::Point<plumbline_model::Robot>) -> [f64; 2] {
    [at.coords.x, at.coords.y]
}

fn on(rect: Rect, [x_m, y_m]: [f64; 2]) -> Pos2 {
    let [[near, far], [right, left]] = SHOWN_M;
    let across = ((left - y_m) / (left - right)) as f32;
    let up = ((far - x_m) / (far - near)) as f32;
    pos2(rect.left() + across * rect.width(), rect.top() + up * rect.height())
}

fn draw(ui: &Ui, painter: &Painter, tokens: &Tokens, rect: Rect, place: &GridPlace, times: f64, near: bool) {
    let target = flat(&place.target);
    let error = place.error_m();
    let (from, to) = (on(rect, target), on(rect, [target[0] + times * error.x, target[1] + times * error.y]));
    let color = Role::Measured.color(tokens);
    let width = if near { 2.5 } else { 1.2 };
    painter.circle_stroke(from, TARGET, Stroke::new(1.2, Role::Predicted.color(tokens)));
    painter.line_segment([from, to], Stroke::new(width, color));
    painter.circle_filled(to, ESTIMATE, color);
    if let Some(along) = direction(to - from) {
        let back = to - along * 6.0;
        let side = vec2(-along.y, along.x) * 3.0;
        painter.add(Shape::convex_polygon(vec![to, back + side, back - side], color, Stroke::NONE));
    }
    let mm = format::fixed(1e3 * up_m(place), 0);
    let mm = if up_m(place) > 0.0005 { format!("+{mm}") } else { mm };
    let small = TextStyle::Small.resolve(ui.style());
    // Beside the target, away from where the arrow goes.
    let (at, anchor) = if to.y > from.y + 1.0 {
        (from - vec2(0.0, TARGET + 1.0), Align2::CENTER_BOTTOM)
    } else {
        (from + vec2(0.0, TARGET + 1.0), Align2::CENTER_TOP)
    };
    painter.text(at, anchor, mm, small, tokens.text_weak);
}

fn direction(by: Vec2) -> Option<Vec2> {
    (by.length() > HEAD_FROM).then(|| by.normalized())
}

/// How much too high it comes out, m.
fn up_m(place: &GridPlace) -> f64 {
    place.estimate.coords.z - place.target.coords.z
}

fn words(place: &GridPlace) -> String {
    let [x_mm, y_mm] = flat(&place.target).map(|m| format::fixed(1e3 * m, 0));
    let error = place.error_m();
    let up = up_m(place);
    let side = if up < 0.0 { "too low" } else { "too high" };
    format!(
        "Target x {x_mm}, y {y_mm} mm\n{} off: {} in x, {} in y; {} {side}",
        format::mm(error.norm()),
        format::mm(error.x),
        format::mm(error.y),
        format::mm(up.abs()),
    )
}
