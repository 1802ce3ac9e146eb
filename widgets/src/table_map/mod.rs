//! The table from above, as the robot sees it: x forward is up, y left is left. One widget for
//! everything that happens on the table.

mod border;
mod contour;
mod field;
mod paint;
mod points;

pub use border::Border;
pub use field::ScalarField;
pub use points::{PointsResponse, TablePoint};

use egui::{Pos2, Rect, Response, Sense, Ui, Vec2, WidgetInfo, vec2};

use crate::colormap::{ColorScale, Orientation, ScaleBar};
use crate::format::{self, Quantity};
use crate::overlay::Ink;
use crate::theme::{Role, space};

/// Narrower than this, the scale beside the map says its unit alone.
const SHORT_PT: f32 = 300.0;
/// The plot is never narrower.
const LEAST_PT: f32 = 80.0;

/// What an outline on the table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The part of the table that is worked on.
    Patch,
    /// The touchscreen.
    Touchscreen,
    /// Where a model was trained; outside it extrapolates.
    Training,
    /// What the hand reaches.
    Reach,
    /// What both eyes see.
    View,
}

/// A named outline, in the robot's frame, meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// What it is.
    pub place: Place,
    /// Its name on the map; empty for none.
    pub name: String,
    /// Corners (x forward, y left) in order.
    pub corners_m: Vec<[f64; 2]>,
}

impl Outline {
    /// A rectangle from its ranges in x and y.
    pub fn rectangle(place: Place, name: impl Into<String>, x_m: [f64; 2], y_m: [f64; 2]) -> Self {
        let [x0, x1] = x_m;
        let [y0, y1] = y_m;
        Self { place, name: name.into(), corners_m: vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]] }
    }
}

/// A position on the table, with an optional vector.
#[derive(Clone, Debug, PartialEq)]
pub struct TableMark {
    /// Where (x forward, y left), meters.
    pub at_m: [f64; 2],
    /// A vector in meters, drawn magnified: a residual, a shift.
    pub vector_m: Option<[f64; 2]>,
    /// Color.
    pub ink: Ink,
    /// A word beside it; empty for none.
    pub text: String,
}

/// An error at a place of the table in two states: as it was, and as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeforeAfter {
    /// Where (x forward, y left), meters.
    pub at_m: [f64; 2],
    /// As it was, meters; `None` draws none.
    pub before_m: Option<[f64; 2]>,
    /// As it is, meters; `None` draws none.
    pub after_m: Option<[f64; 2]>,
}

impl BeforeAfter {
    /// Color of the arrows as it was.
    pub const BEFORE: Role = Role::Difference;
    /// Color of the arrows as it is, at places that were held out.
    pub const AFTER: Role = Role::HeldOut;
}

/// What lies on the table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableScene {
    /// Range of x (forward) shown, meters.
    pub x_m: [f64; 2],
    /// Range of y (left) shown, meters, smaller first.
    pub y_m: [f64; 2],
    /// Outlines, lowest first.
    pub outlines: Vec<Outline>,
    /// Points and arrows.
    pub marks: Vec<TableMark>,
    /// Errors in two states, drawn with the same magnification.
    pub before_after: Vec<BeforeAfter>,
    /// Magnification of the vectors of `marks` and `before_after`.
    pub vector_scale: f64,
    /// Where the data end; outside of it the map is hatched.
    pub border: Option<Border>,
}

impl TableScene {
    /// The table from the torso to 0.7 m forward and 0.5 m to both sides, with nothing on it.
    pub fn new() -> Self {
        Self {
            x_m: [-0.08, 0.70],
            y_m: [-0.50, 0.50],
            outlines: Vec::new(),
            marks: Vec::new(),
            before_after: Vec::new(),
            vector_scale: 1.0,
            border: None,
        }
    }
}

impl Default for TableScene {
    fn default() -> Self {
        Self::new()
    }
}

/// The map.
pub struct TableMap<'a> {
    label: &'a str,
    scene: &'a TableScene,
    field: Option<(&'a ScalarField, ColorScale)>,
    scale: Option<(&'a str, ColorScale, Quantity)>,
    points: &'a [TablePoint],
    chosen: Option<usize>,
    words: Option<&'a dyn Fn([f64; 2]) -> String>,
    height: Option<f32>,
}

/// What happened to the map.
pub struct TableMapResponse {
    /// The whole map.
    pub response: Response,
    /// Where the pointer is on the table (x forward, y left), meters.
    pub hover_m: Option<[f64; 2]>,
    /// Where it was clicked, beside the points.
    pub clicked_m: Option<[f64; 2]>,
    /// What was done to the points.
    pub points: PointsResponse,
}

/// Maps the table to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TableTransform {
    center: Pos2,
    middle_m: [f64; 2],
    points_per_m: f64,
}

impl TableTransform {
    fn fit(scene: &TableScene, rect: Rect) -> Self {
        let span = |range: [f64; 2]| (range[1] - range[0]).max(1e-6);
        let points_per_m =
            (f64::from(rect.width()) / span(scene.y_m)).min(f64::from(rect.height()) / span(scene.x_m));
        let middle = |range: [f64; 2]| (range[0] + range[1]) / 2.0;
        Self { center: rect.center(), middle_m: [middle(scene.x_m), middle(scene.y_m)], points_per_m }
    }

    /// x forward is up, y left is left.
    pub(crate) fn to_screen(self, at_m: [f64; 2]) -> Pos2 {
        self.center + self.vector([at_m[0] - self.middle_m[0], at_m[1] - self.middle_m[1]])
    }

    pub(crate) fn vector(self, vector_m: [f64; 2]) -> Vec2 {
        vec2((-vector_m[1] * self.points_per_m) as f32, (-vector_m[0] * self.points_per_m) as f32)
    }

    pub(crate) fn to_table(self, at: Pos2) -> [f64; 2] {
        let offset = at - self.center;
        [
            self.middle_m[0] - f64::from(offset.y) / self.points_per_m,
            self.middle_m[1] - f64::from(offset.x) / self.points_per_m,
        ]
    }

    fn rect(self, scene: &TableScene) -> Rect {
        Rect::from_two_pos(
            self.to_screen([scene.x_m[0], scene.y_m[0]]),
            self.to_screen([scene.x_m[1], scene.y_m[1]]),
        )
    }
}

impl<'a> TableMap<'a> {
    /// A map that keeps the proportions of its scene.
    pub fn new(label: &'a str, scene: &'a TableScene) -> Self {
        Self { label, scene, field: None, scale: None, points: &[], chosen: None, words: None, height: None }
    }

    /// Points that can be chosen, dragged, and pushed with the arrow keys; which one is chosen.
    pub fn points(mut self, points: &'a [TablePoint], chosen: Option<usize>) -> Self {
        self.points = points;
        self.chosen = chosen;
        self
    }

    /// What is said about the place under the pointer, after its coordinates; instead of the value
    /// of the field.
    pub fn words(mut self, words: &'a dyn Fn([f64; 2]) -> String) -> Self {
        self.words = Some(words);
        self
    }

    /// A quantity over the table as colors and contour lines, with its scale beside the map.
    pub fn field(mut self, field: &'a ScalarField, scale: ColorScale) -> Self {
        self.field = Some((field, scale));
        self
    }

    /// A scale beside the map although there is no field: points carry its colors.
    pub fn scale(mut self, name: &'a str, scale: ColorScale, quantity: Quantity) -> Self {
        self.scale = Some((name, scale, quantity));
        self
    }

    /// At most this height in points, instead of all that is available.
    pub fn height(mut self, height: f32) -> Self {
        self.height = Some(height);
        self
    }

    /// Draws it, as large as the available space allows.
    pub fn show(self, ui: &mut Ui) -> TableMapResponse {
        let of_field = self.field.map(|(field, scale)| (field.name(), scale, field.quantity()));
        let is_short = ui.available_width() < SHORT_PT;
        let bar = of_field.or(self.scale).map(|(name, scale, quantity)| {
            ScaleBar::new(name, scale, quantity, Orientation::Vertical).short(is_short)
        });
        let bar_width = bar.as_ref().map_or(0.0, |bar| bar.width(ui) + space::M);
        let room = vec2(ui.available_width() - bar_width, self.height.unwrap_or(ui.available_height()));
        let size = self.size(room);
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = space::M;
            let (rect, response) = ui.allocate_exact_size(size, Sense::click());
            let shown = self.map(ui, rect, response);
            if let Some(bar) = bar {
                let value = |at_m| self.field.and_then(|(field, _)| field.at(at_m));
                let under_pointer = shown.hover_m.and_then(value).map(|v| v as f32);
                ui.allocate_ui(vec2(bar_width - space::M, size.y), |ui| {
                    ui.set_height(size.y);
                    bar.marker(under_pointer).show(ui)
                });
            }
            shown
        })
        .inner
    }

    /// The largest size with the scene's proportions, axes included, that fits into the room.
    fn size(&self, room: Vec2) -> Vec2 {
        let span = |range: [f64; 2]| (range[1] - range[0]).max(1e-6) as f32;
        let ratio = span(self.scene.x_m) / span(self.scene.y_m);
        let plot = (room - paint::AXES).max(vec2(LEAST_PT, LEAST_PT * ratio));
        paint::AXES + vec2(plot.x.min(plot.y / ratio), plot.y.min(plot.x * ratio))
    }

    fn map(&self, ui: &Ui, rect: Rect, response: Response) -> TableMapResponse {
        let plot = Rect::from_min_max(rect.min + paint::TOP_LEFT, rect.max - (paint::AXES - paint::TOP_LEFT));
        let transform = TableTransform::fit(self.scene, plot);
        let on_map = transform.rect(self.scene).intersect(plot);
        let at =
            |pos: Option<Pos2>| pos.filter(|pos| on_map.contains(*pos)).map(|pos| transform.to_table(pos));
        let hover_m = at(response.hover_pos());
        let clicked_m = at(response.interact_pointer_pos().filter(|_| response.clicked()));
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        let points = points::interact(ui, response.id, on_map, transform, self.scene, self.points);
        if ui.is_rect_visible(rect) {
            let map = paint::map(ui, on_map, transform, self.scene, self.field);
            map.points(self.points, self.chosen, &points);
            let text = hover_m.map(|at_m| self.readout(at_m));
            paint::frame(ui, on_map, &response, text.as_deref());
        }
        TableMapResponse { response, hover_m, clicked_m, points }
    }

    pub(crate) fn position(at_m: [f64; 2]) -> String {
        format!("x {}, y {}", format::mm(at_m[0]), format::mm(at_m[1]))
    }

    /// "x 412 mm, y −35.2 mm: 1.23 mm".
    fn readout(&self, at_m: [f64; 2]) -> String {
        let position = Self::position(at_m);
        if let Some(words) = self.words {
            return format!("{position}: {}", words(at_m));
        }
        match self.field {
            None => position,
            Some((field, _)) => {
                format!("{position}: {}", field.quantity().text_or_none(field.at(at_m)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn forward_is_up_and_left_is_left() {
        let scene = TableScene::new();
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
        let transform = TableTransform::fit(&scene, rect);
        let origin = transform.to_screen([0.3, 0.0]);
        assert!(transform.to_screen([0.4, 0.0]).y < origin.y);
        assert!(transform.to_screen([0.3, 0.1]).x < origin.x);
    }

    #[test]
    fn screen_and_table_are_inverse_and_the_scene_fits() {
        let scene = TableScene::new();
        for rect in [
            Rect::from_min_size(pos2(5.0, 9.0), vec2(800.0, 300.0)),
            Rect::from_min_size(pos2(5.0, 9.0), vec2(200.0, 900.0)),
        ] {
            let transform = TableTransform::fit(&scene, rect);
            let back = transform.to_table(transform.to_screen([0.41, -0.13]));
            assert!((back[0] - 0.41).abs() < 1e-5 && (back[1] + 0.13).abs() < 1e-5, "{back:?}");
            assert!(rect.expand(0.01).contains_rect(transform.rect(&scene)));
        }
    }
}
