//! Points on the table that can be chosen and dragged.

use egui::{Id, Key, Pos2, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

use super::paint::Map;
use super::{TableMap, TableScene, TableTransform};
use crate::overlay::Ink;
use crate::own_part::own_sides;
use crate::theme;

/// Distance that is still a hit, points.
const GRAB: f32 = 11.0;
/// Shorter drags are trembling of the hand, points.
const LEAST_DRAG: f32 = 2.0;
/// A press of an arrow key moves the chosen point by so much, meters.
const NUDGE_M: f64 = 0.001;

/// A point on the table that can be chosen and dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct TablePoint {
    /// Where (x forward, y left), meters.
    pub at_m: [f64; 2],
    /// Radius on screen, points.
    pub radius: f32,
    /// Fill.
    pub ink: Ink,
    /// Its label for screen readers and tests, and its words on hover: "point 3: 41.0 mm".
    pub label: String,
    /// Whether it is shown as one of many in the background and cannot be touched.
    pub faint: bool,
}

/// What was done to the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointsResponse {
    /// The point that was clicked, or that a drag began on.
    pub chosen: Option<usize>,
    /// The point that is being dragged, and where it would come to lie.
    pub dragging: Option<(usize, [f64; 2])>,
    /// The point that was let go or pushed with the arrow keys, and where.
    pub moved: Option<(usize, [f64; 2])>,
}

/// Where the points are, by what was done to them in this frame.
pub(super) fn interact(
    ui: &Ui,
    map_id: Id,
    on_map: Rect,
    transform: TableTransform,
    scene: &TableScene,
    points: &[TablePoint],
) -> PointsResponse {
    let mut done = PointsResponse::default();
    let at_of = |point: &TablePoint| transform.to_screen(point.at_m);
    let is_touchable = |point: &&TablePoint| !point.faint && on_map.contains(at_of(point));
    let touchable: Vec<Pos2> = points.iter().filter(is_touchable).map(at_of).collect();
    let mut sides = own_sides(&touchable, 2.0 * GRAB).into_iter();
    for (i, point) in points.iter().enumerate().filter(|(_, point)| is_touchable(point)) {
        let (at, side) = (at_of(point), sides.next().unwrap_or(2.0 * GRAB));
        let id = map_id.with(("point", i));
        let rect = Rect::from_center_size(at, Vec2::splat(side)).intersect(on_map);
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &point.label));
        if response.clicked() || response.drag_started() {
            done.chosen = Some(i);
        }
        let pulled = pulled(ui, id, on_map, &response, at).map(|at| transform.to_table(at));
        if let Some(at_m) = pulled {
            // A long press that does not move is a click, not a drag.
            let moved = transform.to_screen(at_m).distance(at) >= LEAST_DRAG;
            if response.drag_stopped() {
                done.moved = moved.then_some((i, at_m));
            } else if moved {
                done.dragging = Some((i, at_m));
            }
        }
        if response.has_focus()
            && let Some(step_m) = nudge(ui, id)
        {
            let inside = |value: f64, range: [f64; 2]| value.max(range[0]).min(range[1]);
            let [x, y] = point.at_m;
            done.moved = Some((i, [inside(x + step_m[0], scene.x_m), inside(y + step_m[1], scene.y_m)]));
        }
        if !response.dragged() {
            response.on_hover_text(&point.label);
        }
    }
    done
}

/// Where a dragged point is: as far from where it lies as the pointer is from where it was
/// pressed, so that it does not jump to the pointer; never off the map.
fn pulled(ui: &Ui, id: Id, on_map: Rect, response: &egui::Response, at: Pos2) -> Option<Pos2> {
    if response.drag_started() {
        let pressed = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
        ui.data_mut(|data| data.insert_temp(id, at - pressed));
    }
    if !(response.dragged() || response.drag_stopped()) {
        return None;
    }
    let offset: Vec2 = ui.data(|data| data.get_temp(id))?;
    let pointer = response.interact_pointer_pos().or(ui.input(|input| input.pointer.latest_pos()))?;
    Some(on_map.clamp(pointer + offset))
}

/// Arrow keys push a chosen point, and do not move the focus meanwhile.
fn nudge(ui: &Ui, id: Id) -> Option<[f64; 2]> {
    let filter =
        egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
    let count = |key| ui.input(|input| input.num_presses(key)) as f64;
    let x = count(Key::ArrowUp) - count(Key::ArrowDown);
    let y = count(Key::ArrowLeft) - count(Key::ArrowRight);
    (x != 0.0 || y != 0.0).then_some([x * NUDGE_M, y * NUDGE_M])
}

impl Map {
    pub(super) fn points(&self, points: &[TablePoint], chosen: Option<usize>, done: &PointsResponse) {
        for (i, point) in points.iter().enumerate() {
            let at_m = match done.dragging.or(done.moved) {
                Some((dragged, at_m)) if dragged == i => at_m,
                _ => point.at_m,
            };
            let at = self.transform.to_screen(at_m);
            let color = point.ink.color(&theme::ON_IMAGE);
            if point.faint {
                self.painter.circle_stroke(at, 2.5, Stroke::new(1.0, self.tokens.text_weak));
                continue;
            }
            self.painter.circle(at, point.radius, color, Stroke::new(1.5, theme::RIM));
            if chosen == Some(i) {
                let ring = point.radius + 4.0;
                self.painter.circle_stroke(at, ring, Stroke::new(4.0, theme::RIM));
                self.painter.circle_stroke(at, ring, Stroke::new(2.0, theme::ON_IMAGE.text_strong));
            }
            if done.dragging.is_some_and(|(dragged, _)| dragged == i) {
                let from = self.transform.to_screen(point.at_m);
                self.painter.line_segment([from, at], Stroke::new(1.0, theme::ON_IMAGE.text_strong));
                self.chip(at + vec2(point.radius + 8.0, -18.0), &TableMap::position(at_m));
            }
        }
    }
}
