//! The robot's workplace in three dimensions: solids, lines and words in the robot's frame, seen
//! by a camera that circles around them.
//!
//! Drawn on the CPU into a texture, and only when scene, camera, size or theme changed, so that
//! it looks the same under wgpu, glow and in tests without a GPU.

mod camera;
mod chrome;
mod facets;
mod input;
mod labels;
mod parts;
mod pick;
mod raster;
mod render;
mod scene;
mod shade;
#[cfg(test)]
mod tests;

pub use camera::{Ray, SceneCamera, View, ViewPreset};
pub use facets::{MeshError, TriangleMesh};
pub use parts::{eye_frustum, limb, screen_slab, table_slab, triad};
pub use pick::Picked;
pub use scene::{Dot, Grid, Label3d, Line, LineStyle, PickId, Scene, Shape, Solid, Tint};

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::emath::GuiRounding;
use egui::mutex::Mutex;
use egui::{
    Color32, ColorImage, Pos2, Rect, Response, Sense, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo,
    pos2,
};

use crate::empty::{EmptyState, Message};
use crate::theme;
use render::{Quality, Renderer, Sampling};

/// Nobody's screen is larger, in pixels.
const LARGEST_PX: f32 = 4096.0;

/// A scene that did not change for so long is drawn again as well as it can be.
const AT_REST: Duration = Duration::from_millis(200);

const NOTHING: Message<'static> = Message {
    title: "Nothing in the scene",
    what_to_do: "Start the twin or connect the robot; the scene follows what they report.",
    button: None,
};

/// A scene that can be looked at from all sides.
///
/// ```no_run
/// # use plumbline_widgets::scene3d::*;
/// # fn draw(ui: &mut egui::Ui, scene: &Scene, camera: &mut SceneCamera) {
/// let shown = Scene3d::new("Robot", scene).show(ui, camera);
/// if let Some(point_m) = shown.clicked.and_then(|picked| picked.point_m) { /* look there */ }
/// # }
/// ```
pub struct Scene3d<'a> {
    label: &'a str,
    scene: &'a Scene,
    size: Option<Vec2>,
    stale: Option<&'a str>,
    empty: Message<'a>,
}

/// What happened to the scene.
pub struct Scene3dResponse {
    /// The whole view.
    pub response: Response,
    /// What was clicked.
    pub clicked: Option<Picked>,
    /// What the pointer is on.
    pub hovered: Option<Picked>,
    /// The button of the empty scene was pressed.
    pub button_clicked: bool,
    /// What the picture cost.
    pub stats: RenderStats,
}

/// What the pictures of a view cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// How often a picture was made: only when something had changed.
    pub renders: u64,
    /// Triangles drawn in the last one.
    pub triangles: usize,
    /// Time that the last one took.
    pub last: Duration,
}

/// What a picture was made of.
#[derive(Clone, PartialEq)]
struct Key {
    scene: Scene,
    camera: SceneCamera,
    view_px: [usize; 2],
    height_points: f32,
    dark: bool,
}

/// The picture of one view, kept by egui between frames.
#[derive(Default)]
struct Cache {
    renderer: Renderer,
    shown: Option<(Key, TextureHandle)>,
    /// Samples of the picture that is shown, and when it was made.
    made: Option<(Sampling, Instant)>,
    stats: RenderStats,
}

impl<'a> Scene3d<'a> {
    /// A scene that fills the available space. The label names it, on screen, for screen readers
    /// and for tests; it must be unique within its panel.
    pub fn new(label: &'a str, scene: &'a Scene) -> Self {
        Self { label, scene, size: None, stale: None, empty: NOTHING }
    }

    /// Takes so much space instead of all that is available.
    pub fn size(mut self, size: Vec2) -> Self {
        self.size = Some(size);
        self
    }

    /// Says that the scene is old, how old, and why. The picture is dimmed.
    pub fn stale(mut self, sentence: Option<&'a str>) -> Self {
        self.stale = sentence;
        self
    }

    /// What stands there while the scene is empty.
    pub fn empty(mut self, message: Message<'a>) -> Self {
        self.empty = message;
        self
    }

    /// Draws it. The camera is moved by what the operator does.
    pub fn show(self, ui: &mut Ui, camera: &mut SceneCamera) -> Scene3dResponse {
        let size = self.size.unwrap_or_else(|| ui.available_size()).max(Vec2::splat(48.0));
        if self.scene.is_empty() {
            return self.show_empty(ui, size);
        }
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, ui.is_enabled(), self.label));
        let cache = ui.data_mut(|data| {
            Arc::clone(data.get_temp_mut_or_default::<Arc<Mutex<Cache>>>(response.id.with("scene3d")))
        });
        let mut cache = cache.lock();
        input::handle(ui, &response, camera);
        let view = camera.view(rect.size());
        let at_pointer =
            |pos: Option<Pos2>| pos.map(|pos| pick::pick(self.scene, view.ray(pos - rect.min.to_vec2())));
        let hovered = at_pointer(response.hover_pos().filter(|_| !response.dragged()));
        let clicked = at_pointer(response.interact_pointer_pos().filter(|_| response.clicked()));
        if ui.is_rect_visible(rect) {
            self.paint(ui, rect, &response, camera, &mut cache);
            self.paint_words(ui, rect, &view, hovered.as_ref(), &cache);
        }
        // Last, so that the buttons are on top; a new place is seen in the next frame.
        chrome::presets(ui, rect, camera);
        Scene3dResponse { response, clicked, hovered, button_clicked: false, stats: cache.stats }
    }

    fn show_empty(&self, ui: &mut Ui, size: Vec2) -> Scene3dResponse {
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        ui.painter().rect_filled(rect, 4.0, theme::tokens(ui).backdrop);
        let mut inner = ui.new_child(egui::UiBuilder::new().id_salt(self.label).max_rect(rect.shrink(4.0)));
        let button_clicked = EmptyState::empty(self.empty).show(&mut inner);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        Scene3dResponse {
            response,
            clicked: None,
            hovered: None,
            button_clicked,
            stats: RenderStats::default(),
        }
    }

    fn paint(&self, ui: &Ui, rect: Rect, response: &Response, camera: &SceneCamera, cache: &mut Cache) {
        let pixels_per_point = ui.pixels_per_point();
        let rect = rect.round_to_pixels(pixels_per_point);
        let pixels = |points: f32| (points * pixels_per_point).round().clamp(1.0, LARGEST_PX) as usize;
        let view_px = [pixels(rect.width()), pixels(rect.height())];
        let (height_points, dark) = (rect.height(), ui.visuals().dark_mode);
        let fresh = cache.shown.as_ref().is_some_and(|(key, _)| {
            key.view_px == view_px
                && key.dark == dark
                && key.height_points == height_points
                && key.camera == *camera
                && key.scene == *self.scene
        });
        if !fresh {
            let key = Key { scene: self.scene.clone(), camera: *camera, view_px, height_points, dark };
            cache.render(ui, self.label, key, Quality::Draft);
        }
        cache.refine(ui, self.label);
        let painter = ui.painter_at(rect);
        if let Some((_, texture)) = &cache.shown {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            // What is old fades into the background of its theme.
            painter.rect_filled(rect, 0.0, theme::tokens(ui).backdrop);
            let tint = if self.stale.is_some() { theme::STALE_FADE } else { Color32::WHITE };
            painter.image(texture.id(), rect, whole, tint);
        }
        if response.has_focus() {
            let ring = egui::Stroke::new(1.5, theme::tokens(ui).accent);
            painter.rect_stroke(rect, 0.0, ring, egui::StrokeKind::Inside);
        }
    }

    fn paint_words(&self, ui: &Ui, rect: Rect, view: &View, hovered: Option<&Picked>, cache: &Cache) {
        if let Some(grid) = self.scene.grid.filter(Grid::is_drawable) {
            chrome::axes(ui, rect, view, &grid);
        }
        let hidden = |at: Pos2, depth_m: f64| cache.renderer.is_hidden(at.to_vec2() / rect.size(), depth_m);
        labels::labels(ui, rect, view, self.scene, hidden);
        chrome::compass(ui, rect, view);
        chrome::captions(ui, rect, self.label, self.stale, self.scene);
        if let Some(point_m) = hovered.and_then(|picked| picked.point_m) {
            chrome::readout(ui, rect, &point_m);
        }
    }
}

impl Cache {
    fn render(&mut self, ui: &Ui, label: &str, key: Key, quality: Quality) {
        let start = Instant::now();
        let sampling = Sampling::of(key.view_px, quality);
        let tokens = theme::tokens(ui);
        let rendered = self.renderer.render(&key.scene, &key.camera, sampling, key.height_points, tokens);
        let triangles = rendered.triangles;
        let image = ColorImage::new(rendered.size_px, rendered.pixels);
        let texture = match self.shown.take() {
            Some((_, mut texture)) => {
                texture.set(image, TextureOptions::LINEAR);
                texture
            }
            None => ui.ctx().load_texture(label, image, TextureOptions::LINEAR),
        };
        self.shown = Some((key, texture));
        self.made = Some((sampling, Instant::now()));
        self.stats = RenderStats { renders: self.stats.renders + 1, triangles, last: start.elapsed() };
    }

    /// Draws a large picture again, finer, once it stands still.
    fn refine(&mut self, ui: &Ui, label: &str) {
        let (Some((key, _)), Some((sampling, made))) = (&self.shown, self.made) else { return };
        if sampling == Sampling::of(key.view_px, Quality::Fine) {
            return;
        }
        let age = made.elapsed();
        if age < AT_REST {
            ui.ctx().request_repaint_after(AT_REST - age);
        } else {
            let key = key.clone();
            self.render(ui, label, key, Quality::Fine);
        }
    }
}
