//! Words on the scene: its name, what the colors mean, axes, what the pointer is on.

use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, TextStyle, Ui, Vec2, pos2, vec2};
use nalgebra::{Point3, Vector3};

use super::camera::{SceneCamera, View, ViewPreset};
use super::scene::{Grid, Scene, Tint};
use crate::format;
use crate::glyph::{self, Glyph};
use crate::theme::{self, Tokens, space};

const INSET: f32 = 8.0;
/// Below this width the buttons become one menu.
const NARROW: f32 = 460.0;
/// Below this width the menu needs the room of the name.
const NAMED: f32 = 140.0;
/// Least size for the small axes.
const COMPASS_ROOM: Vec2 = vec2(640.0, 320.0);
/// Least distance of two numbers along an axis, in points: beside or below each other.
const TICK_ROOM: Vec2 = vec2(42.0, 18.0);

/// Buttons for the usual places, at the top right.
pub(super) fn presets(ui: &mut Ui, rect: Rect, camera: &mut SceneCamera) {
    let inner = rect.shrink(INSET);
    let layout = egui::Layout::right_to_left(egui::Align::Min);
    let mut ui = ui.new_child(egui::UiBuilder::new().id_salt("places").max_rect(inner).layout(layout));
    ui.spacing_mut().item_spacing.x = space::XS;
    ui.spacing_mut().button_padding = vec2(8.0, 3.0);
    ui.spacing_mut().interact_size.y = 24.0;
    let mut go = |preset| *camera = SceneCamera::preset(preset);
    if rect.width() < NARROW {
        ui.menu_button("View", |ui| {
            for (preset, text) in ViewPreset::BUTTONS {
                if ui.button(text).clicked() {
                    go(preset);
                }
            }
        });
        return;
    }
    for (preset, text) in ViewPreset::BUTTONS.into_iter().rev() {
        if ui.button(egui::RichText::new(text).text_style(TextStyle::Small)).clicked() {
            go(preset);
        }
    }
}

/// Name, legend and warnings at the top left.
pub(super) fn captions(ui: &Ui, rect: Rect, label: &str, stale: Option<&str>, scene: &Scene) {
    let tokens = theme::tokens(ui);
    let mut at = rect.min + Vec2::splat(INSET);
    let mut place = |text: &str, warning: bool| {
        at.y = chip(ui, rect, at, Align2::LEFT_TOP, text, warning).bottom() + space::XS;
    };
    // The tab says it, too.
    if rect.width() > NAMED {
        place(label, false);
    }
    if let Some(sentence) = stale {
        place(sentence, true);
    }
    let left_out = scene.left_out();
    if left_out > 0 {
        let text = format!("{} without a valid place left out", format::count(left_out, "part"));
        place(&text, true);
    }
    legend(ui, at, scene, tokens);
}

/// Only where both are there: the colors explain each other.
fn legend(ui: &Ui, at: Pos2, scene: &Scene, tokens: &Tokens) {
    let tints = || scene.solids.iter().map(|s| s.tint).chain(scene.lines.iter().map(|l| l.tint));
    let measured = tints().any(|tint| tint == Tint::Measured);
    let ghost = tints().any(|tint| tint == Tint::Ghost);
    let predicted = tints().any(|tint| tint == Tint::Predicted);
    if !(measured && (ghost || predicted)) {
        return;
    }
    let font = theme::font(ui, &TextStyle::Small);
    let ground = Rect::from_min_size(at, vec2(164.0, 20.0));
    ui.painter().rect_filled(ground, 4.0, tokens.panel.gamma_multiply(0.85));
    let mut x = at.x + 6.0;
    let second = if ghost { Tint::Ghost } else { Tint::Predicted };
    for (tint, word) in [(Tint::Measured, "measured"), (second, "predicted")] {
        let mark = Rect::from_min_size(pos2(x, at.y + 5.5), Vec2::splat(9.0));
        let color = tint.ink(tokens);
        if tint == Tint::Ghost {
            ui.painter().rect_filled(mark, 2.0, color.gamma_multiply(0.35));
            ui.painter().rect_stroke(mark, 2.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
        } else {
            ui.painter().rect_filled(mark, 2.0, color);
        }
        let text = pos2(mark.right() + space::XS, mark.center().y);
        let drawn = ui.painter().text(text, Align2::LEFT_CENTER, word, font.clone(), tokens.text_weak);
        x = drawn.right() + space::S + space::XS;
    }
}

/// Where the pointer is, at the bottom right.
pub(super) fn readout(ui: &Ui, rect: Rect, at_m: &Point3<f64>) {
    let text = format::position_mm([at_m.x, at_m.y, at_m.z]);
    chip(ui, rect, rect.max - Vec2::splat(INSET), Align2::RIGHT_BOTTOM, &text, false);
}

/// Small text on a quiet ground.
fn chip(ui: &Ui, clip: Rect, at: Pos2, anchor: Align2, text: &str, warning: bool) -> Rect {
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(clip);
    let font = theme::font(ui, &TextStyle::Small);
    let mark = if warning { 16.0 } else { 0.0 };
    let wrap = (clip.width() * 0.6 - mark).max(60.0);
    let galley = painter.layout(text.to_owned(), font, tokens.text, wrap);
    let rect = anchor.anchor_size(at, galley.size() + vec2(12.0 + mark, 6.0));
    painter.rect_filled(rect, 4.0, tokens.panel.gamma_multiply(0.85));
    if warning {
        let center = pos2(rect.left() + 13.0, rect.center().y);
        glyph::paint(&painter, center, 10.0, Glyph::Warning, tokens.warning);
    }
    painter.galley(rect.min + vec2(6.0 + mark, 3.0), galley, tokens.text);
    rect
}

/// Numbers in mm and names along those edges of the grid that are nearest to the camera.
pub(super) fn axes(ui: &Ui, rect: Rect, view: &View, grid: &Grid) {
    let [[x0, x1], [y0, y1]] = [grid.x_m, grid.y_m];
    // The robot stands at the low end of x: numbers there would be written on it, unless it is
    // looked at from behind.
    let (x_edge, x_inner) = if view.eye_m.x < x0 { (x0, x1) } else { (x1, x0) };
    let (y_edge, y_inner) = if view.eye_m.y < (y0 + y1) / 2.0 { (y0, y1) } else { (y1, y0) };
    let place = |x, y| view.project(&Point3::new(x, y, grid.z_m)).map(|(at, _)| rect.min + at.to_vec2());
    // Buttons, captions and the small axes have their corners.
    let corner = |at: Align2, size: Vec2| at.align_size_within_rect(size, rect);
    let mut taken =
        vec![corner(Align2::LEFT_TOP, vec2(190.0, 56.0)), corner(Align2::RIGHT_TOP, vec2(320.0, 36.0))];
    if has_compass(rect) {
        taken.push(corner(Align2::LEFT_BOTTOM, vec2(150.0, 112.0)));
    }
    let mut ruler = Ruler { ui, rect, taken, step_m: grid.step_m };
    ruler.paint("x forward, mm", grid.x_m, |x| Some([place(x, y_inner)?, place(x, y_edge)?]));
    ruler.paint("y left, mm", grid.y_m, |y| Some([place(x_inner, y)?, place(x_edge, y)?]));
}

struct Ruler<'a> {
    ui: &'a Ui,
    rect: Rect,
    /// Where other words stand.
    taken: Vec<Rect>,
    step_m: f64,
}

impl Ruler<'_> {
    /// `ends` gives, for a value, the ends of its grid line, the one at the edge last.
    fn paint(&mut self, name: &str, range: [f64; 2], ends: impl Fn(f64) -> Option<[Pos2; 2]>) {
        let tokens = theme::tokens(self.ui);
        let Some(stride) = self.stride(range, &ends) else { return };
        let [first, last] = [(range[0] / stride - 1e-6).ceil(), (range[1] / stride + 1e-6).floor()];
        for i in first as i64..=last as i64 {
            let value = i as f64 * stride;
            if let Some(line) = ends(value) {
                self.text(line, 0.0, &format::fixed(value * 1e3, 0), tokens.text_weak);
            }
        }
        // In the middle, or where else there is room for it.
        for along in [0.5, 0.7, 0.3, 0.85, 0.15] {
            let Some(line) = ends(range[0] + along * (range[1] - range[0])) else { continue };
            // Past the widest number.
            let beyond = self.reach(line, vec2(32.0, 20.0));
            if self.text(line, beyond, name, tokens.text) {
                break;
            }
        }
    }

    /// Writes beyond the end of a grid line, `beyond` points farther out than a number; `false`
    /// if there is no room.
    fn text(&mut self, line: [Pos2; 2], beyond: f32, text: &str, color: Color32) -> bool {
        let font = theme::font(self.ui, &TextStyle::Small);
        let painter = self.ui.painter_at(self.rect);
        let galley = painter.layout_no_wrap(text.to_owned(), font, color);
        let out = space::XS + beyond + self.reach(line, galley.size()) / 2.0;
        let center = line[1] + (line[1] - line[0]).normalized() * out;
        let place = Rect::from_center_size(center, galley.size()).expand(2.0);
        let free = self.rect.contains_rect(place) && !self.taken.iter().any(|t| t.intersects(place));
        if free {
            painter.galley(center - galley.size() / 2.0, galley, color);
            self.taken.push(place);
        }
        free
    }

    /// How far a box of a size reaches along a line.
    fn reach(&self, line: [Pos2; 2], size: Vec2) -> f32 {
        let along = (line[1] - line[0]).normalized().abs();
        size.x * along.x + size.y * along.y
    }

    /// Meters between two numbers, so that they do not touch; `None` where none have room.
    fn stride(&self, range: [f64; 2], ends: &impl Fn(f64) -> Option<[Pos2; 2]>) -> Option<f64> {
        let [low, high] = [ends(range[0])?[1], ends(range[1])?[1]];
        let steps = (range[1] - range[0]) / self.step_m;
        let along = (high - low).abs() / steps as f32;
        let fits = |factor: &f64| {
            let room = along * *factor as f32;
            room.x >= TICK_ROOM.x || room.y >= TICK_ROOM.y
        };
        [1.0, 2.0, 5.0].into_iter().find(fits).map(|factor| factor * self.step_m)
    }
}

fn has_compass(rect: Rect) -> bool {
    rect.width() >= COMPASS_ROOM.x && rect.height() >= COMPASS_ROOM.y
}

/// Which way the robot's axes point, at the bottom left.
pub(super) fn compass(ui: &Ui, rect: Rect, view: &View) {
    if !has_compass(rect) {
        return;
    }
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    let font = theme::font(ui, &TextStyle::Small);
    let center = rect.left_bottom() + vec2(76.0, -60.0);
    let axes = [(Vector3::x(), "x forward"), (Vector3::y(), "y left"), (Vector3::z(), "z up")];
    let mut axes = axes.map(|(axis, name)| {
        let on_screen = vec2(view.right.dot(&axis) as f32, -view.up.dot(&axis) as f32);
        (on_screen, view.forward.dot(&axis), name)
    });
    // The longest on screen first: its name takes the place that another one might want too.
    axes.sort_by(|a, b| b.0.length().total_cmp(&a.0.length()));
    let mut taken: Vec<Rect> = Vec::new();
    for (on_screen, away, name) in axes {
        let color = if away > 0.3 { tokens.text_weak } else { tokens.text };
        axis(&painter, center, on_screen, name, &font, color, &mut taken);
    }
}

fn axis(
    painter: &Painter,
    center: Pos2,
    on_screen: Vec2,
    name: &str,
    font: &egui::FontId,
    color: Color32,
    taken: &mut Vec<Rect>,
) {
    const LENGTH: f32 = 30.0;
    let tip = center + on_screen * LENGTH;
    painter.line_segment([center, tip], Stroke::new(1.5, color));
    // An axis along the line of sight is a dot.
    painter.circle_filled(tip, 2.0, color);
    let direction = if on_screen.length() > 0.2 { on_screen.normalized() } else { vec2(0.0, 1.0) };
    let galley = painter.layout_no_wrap(name.to_owned(), font.clone(), color);
    let half = galley.size() / 2.0;
    // The box of the text touches a circle around the tip.
    let out = 6.0 + half.x * direction.x.abs() + half.y * direction.y.abs();
    let place = Rect::from_center_size(tip + direction * out, galley.size());
    if !taken.iter().any(|other| other.intersects(place)) {
        painter.galley(place.min, galley, color);
        taken.push(place);
    }
}
