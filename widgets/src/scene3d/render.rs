//! The scene as a picture.

use egui::{Color32, Vec2};
use nalgebra::{Point3, Vector3};

use super::camera::{NEAR_M, SceneCamera, View};
use super::facets::{Form, form};
use super::raster::{Layer, Vertex, mode};
use super::scene::{Dot, Grid, Line, LineStyle, Scene, Shape, Solid};
use super::shade::{Light, Linear, linear, on_screen};
use crate::theme::Tokens;

/// How much work a picture may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Quality {
    /// Less than a frame has time for: while something moves.
    Draft,
    /// As good as it gets: once it stands still.
    Fine,
}

/// How many samples a picture of a view is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sampling {
    /// Pixels of the picture; fewer than the view has if there are very many.
    pub(super) size_px: [usize; 2],
    /// Samples per pixel along each side.
    pub(super) factor: usize,
}

impl Sampling {
    /// For a view of so many pixels.
    pub(super) fn of(view_px: [usize; 2], quality: Quality) -> Self {
        let most = match quality {
            Quality::Draft => 3_200_000,
            Quality::Fine => 9_000_000,
        };
        let [width, height] = view_px.map(|n| n.max(1));
        match width.saturating_mul(height) {
            pixels if pixels.saturating_mul(4) <= most => Self { size_px: [width, height], factor: 2 },
            pixels if pixels <= most => Self { size_px: [width, height], factor: 1 },
            _ => Self { size_px: [width.div_ceil(2), height.div_ceil(2)], factor: 1 },
        }
    }
}

/// How much nearer lines are drawn than they are, so that those on a surface are seen.
const LINE_LIFT: f32 = 1.002;
/// A ghost that coincides with a body is not drawn over it.
const GHOST_LIFT: f32 = 0.9985;
/// Shadows fall on what is at most so high above the plane: also on the touchscreen that lies on
/// the table.
const SHADOW_REACH_M: f32 = 0.012;
const SHADOW_ALPHA: f32 = 0.46;
/// Shadows do with fewer triangles.
const SHADOW_FINENESS: f32 = 0.4;
/// Height over which a shadow fades to a third.
const SHADOW_FADE_M: f64 = 0.25;

/// Makes pictures and keeps its memory between them.
#[derive(Default)]
pub(super) struct Renderer {
    solids: Layer,
    over: Layer,
    scratch: Vec<Corner>,
    triangles: usize,
    /// Samples of the last picture.
    size: [f32; 2],
    /// Width of a hairline in samples.
    line_samples: f32,
}

/// A vertex in front of the camera or behind it.
#[derive(Clone, Copy, Default)]
struct Corner {
    /// In samples times meters: right, down; and the distance along the optical axis.
    place: Vector3<f32>,
    color: [f32; 4],
}

/// A picture and what was measured about it.
pub(super) struct Rendered {
    pub(super) size_px: [usize; 2],
    pub(super) pixels: Vec<Color32>,
    pub(super) triangles: usize,
}

/// How a camera maps the robot's frame to samples.
struct Projection {
    view: View,
}

impl Projection {
    fn corner(&self, at_m: &Point3<f64>, color: [f32; 4]) -> Corner {
        let p = at_m - self.view.eye_m;
        let View { right, up, forward, focal, .. } = &self.view;
        let focal = f64::from(*focal);
        let place = Vector3::new(right.dot(&p) * focal, -up.dot(&p) * focal, forward.dot(&p));
        Corner { place: place.cast::<f32>(), color }
    }

    fn vertex(&self, corner: &Corner) -> Vertex {
        let nearness = 1.0 / corner.place.z;
        let center = self.view.center;
        Vertex {
            x: center.x + corner.place.x * nearness,
            y: center.y + corner.place.y * nearness,
            nearness,
            color: corner.color,
        }
    }
}

impl Renderer {
    /// Draws the scene; lines are measured in points, of which the view is `height_points` high.
    pub(super) fn render(
        &mut self,
        scene: &Scene,
        camera: &SceneCamera,
        sampling: Sampling,
        height_points: f32,
        tokens: &Tokens,
    ) -> Rendered {
        let Sampling { size_px: [width, height], factor } = sampling;
        let (columns, rows) = (width * factor, height * factor);
        self.size = [columns as f32, rows as f32];
        self.line_samples = factor as f32;
        let projection = Projection { view: camera.view(Vec2::new(columns as f32, rows as f32)) };
        self.triangles = 0;
        self.solids.reset(columns, rows, tokens.backdrop);
        self.over.fit(columns, rows);

        let drawable = || scene.solids.iter().filter(|solid| solid.is_drawable());
        for solid in drawable().filter(|solid| !solid.tint.is_ghost()) {
            self.solid(solid, &projection, tokens);
        }
        if let Some(grid) = scene.grid.filter(Grid::is_drawable) {
            self.shadows(drawable(), &grid, &projection);
            self.grid(&grid, &projection, tokens);
        }
        let samples_per_point = rows as f32 / height_points.max(1.0);
        for line in scene.drawn_lines(true) {
            self.line(line, &projection, samples_per_point, tokens);
        }
        for dot in &scene.dots {
            self.dot(dot, &projection, samples_per_point, tokens);
        }
        for solid in drawable().filter(|solid| solid.tint.is_ghost()) {
            self.solid(solid, &projection, tokens);
        }
        self.solids.composite(&mut self.over, |_| |ghost, solid| ghost * GHOST_LIFT > solid);
        Rendered { size_px: [width, height], pixels: self.solids.resolve(factor), triangles: self.triangles }
    }

    /// Whether something solid is in front of a point: its place as a fraction of the picture
    /// from the top left, and its distance along the optical axis.
    pub(super) fn is_hidden(&self, at: Vec2, depth_m: f64) -> bool {
        let [columns, rows] = self.size;
        let nearness = self.solids.nearness_at(at.x * columns, at.y * rows);
        nearness.is_some_and(|nearness| nearness > 1.01 / depth_m as f32)
    }

    fn solid(&mut self, solid: &Solid, projection: &Projection, tokens: &Tokens) {
        let Some(form) = placed_form(solid, projection, 1.0) else { return };
        let shape_from_robot = solid.robot_from_shape.inverse();
        let eye = shape_from_robot * projection.view.eye_m;
        let light = Light::new(|direction| shape_from_robot * direction, eye);
        let base: Linear = linear(solid.tint.surface(tokens));
        let ghost = solid.tint.is_ghost();
        let project = Projector::new(solid, projection);
        self.scratch.clear();
        self.scratch.extend(form.facets.positions.iter().zip(&form.facets.normals).map(|(at, normal)| {
            let (at, normal) = (form.position(at), form.normal(normal));
            let (color, alpha) = if ghost {
                light.ghost(&base, &at, &normal)
            } else {
                (light.solid(&base, &at, &normal), 1.0)
            };
            Corner { place: project.place(&at), color: on_screen(&color, alpha) }
        }));
        // Meshes from elsewhere may be open; their back sides are drawn too.
        let cull = !matches!(solid.shape, Shape::Mesh(_));
        for triangle in &form.facets.triangles {
            let corners = triangle.map(|i| self.scratch[i as usize]);
            if cull && !faces_camera(&corners) {
                continue;
            }
            self.triangles += 1;
            let layer = if ghost { &mut self.over } else { &mut self.solids };
            clipped(&corners, projection, |[a, b, c]| layer.triangle::<{ mode::SOLID }>([a, b, c]));
        }
    }

    /// Everything above the plane, straight down onto it.
    fn shadows<'a>(&mut self, solids: impl Iterator<Item = &'a Solid>, grid: &Grid, projection: &Projection) {
        for solid in solids.filter(|solid| solid.tint.casts_shadow()) {
            let Some(form) = placed_form(solid, projection, SHADOW_FINENESS) else { continue };
            self.scratch.clear();
            let mut above = false;
            let robot_from_shape = solid.robot_from_shape.to_matrix();
            self.scratch.extend(form.facets.positions.iter().map(|at| {
                let at_m = robot_from_shape.transform_point(&form.position(at).cast::<f64>());
                let height_m = at_m.z - grid.z_m;
                above |= height_m > 0.0;
                let alpha = SHADOW_ALPHA * (-height_m.max(0.0) / SHADOW_FADE_M).exp() as f32;
                let below_m = Point3::new(at_m.x, at_m.y, grid.z_m);
                projection.corner(&below_m, [0.0, 0.0, 0.0, 255.0 * alpha])
            }));
            if !above {
                continue;
            }
            for triangle in &form.facets.triangles {
                let corners = triangle.map(|i| self.scratch[i as usize]);
                // Seen from the plane's upper side, only the upper half of a body counts.
                if faces_camera(&corners) {
                    let layer = &mut self.over;
                    clipped(&corners, projection, |[a, b, c]| layer.triangle::<{ mode::SHADOW }>([a, b, c]));
                }
            }
        }
        // Lines of sight of one row fall by the same height per meter of depth.
        let View { forward, up, focal, center, .. } = projection.view;
        self.solids.composite(&mut self.over, |row| {
            let above_middle = (center.y - row as f32 - 0.5) / focal;
            let fall = (forward.z as f32 + up.z as f32 * above_middle).abs();
            move |shadow: f32, ground: f32| fall * (shadow - ground).abs() < SHADOW_REACH_M * shadow * ground
        });
    }

    fn grid(&mut self, grid: &Grid, projection: &Projection, tokens: &Tokens) {
        let color = |alpha: f32| {
            let [r, g, b, _] = tokens.text_weak.to_array().map(f32::from);
            [r, g, b, 255.0 * alpha]
        };
        let [x0, x1] = grid.x_m;
        let [y0, y1] = grid.y_m;
        let at = |x: f64, y: f64| Point3::new(x, y, grid.z_m);
        // Lines stand at whole multiples of the step, so that zero is one of them.
        let multiples = |[low, high]: [f64; 2]| {
            let [first, last] = [(low / grid.step_m - 1e-6).ceil(), (high / grid.step_m + 1e-6).floor()];
            (first as i64..=last as i64).map(|i| (i, i as f64 * grid.step_m))
        };
        let alpha = |i: i64| if i == 0 { 0.62 } else { 0.24 };
        let width = self.line_samples;
        for (i, x) in multiples(grid.x_m) {
            self.segment([at(x, y0), at(x, y1)], [color(alpha(i)); 2], width, projection);
        }
        for (i, y) in multiples(grid.y_m) {
            self.segment([at(x0, y), at(x1, y)], [color(alpha(i)); 2], width, projection);
        }
    }

    fn line(&mut self, line: &Line, projection: &Projection, samples_per_point: f32, tokens: &Tokens) {
        let [r, g, b, _] = line.tint.ink(tokens).to_array().map(f32::from);
        let width = line.width * samples_per_point;
        let last = line.points_m.len() - 1;
        let color = |i: usize| {
            let alpha = match line.style {
                LineStyle::Trail => 0.15 + 0.85 * i as f32 / last as f32,
                LineStyle::Plain | LineStyle::Arrow => 1.0,
            };
            [r, g, b, 255.0 * alpha]
        };
        for (i, ends) in line.points_m.windows(2).enumerate() {
            self.segment([ends[0], ends[1]], [color(i), color(i + 1)], width, projection);
        }
        if line.style == LineStyle::Arrow {
            self.head([line.points_m[last - 1], line.points_m[last]], color(last), width, projection);
        }
    }

    /// A straight line of constant width in samples.
    fn segment(&mut self, ends_m: [Point3<f64>; 2], colors: [[f32; 4]; 2], width: f32, on: &Projection) {
        let [mut a, mut b] = [0, 1].map(|i| on.corner(&ends_m[i], colors[i]));
        let near = NEAR_M as f32;
        if a.place.z < near && b.place.z < near {
            return;
        }
        if a.place.z < near {
            a = cut(&b, &a);
        } else if b.place.z < near {
            b = cut(&a, &b);
        }
        let [a, b] = [&a, &b].map(|corner| lifted(on.vertex(corner)));
        let Some([across_x, across_y]) = across(&a, &b, width / 2.0) else { return };
        let shifted =
            |v: &Vertex, side: f32| Vertex { x: v.x + side * across_x, y: v.y + side * across_y, ..*v };
        let [p, q, r, s] = [shifted(&a, -1.0), shifted(&a, 1.0), shifted(&b, 1.0), shifted(&b, -1.0)];
        self.triangles += 2;
        self.solids.triangle::<{ mode::BLEND }>([&p, &q, &r]);
        self.solids.triangle::<{ mode::BLEND }>([&p, &r, &s]);
    }

    fn head(&mut self, ends_m: [Point3<f64>; 2], color: [f32; 4], width: f32, on: &Projection) {
        let [from, to] = ends_m.map(|end| on.corner(&end, color));
        if from.place.z < NEAR_M as f32 || to.place.z < NEAR_M as f32 {
            return;
        }
        let [from, to] = [&from, &to].map(|corner| lifted(on.vertex(corner)));
        let Some([x, y]) = across(&from, &to, width * 2.2) else { return };
        // The tip stands a little beyond the end, the barbs behind it.
        let tip = Vertex { x: to.x + 0.8 * y, y: to.y - 0.8 * x, ..to };
        let barb = |side: f32| Vertex { x: to.x - 1.4 * y + side * x, y: to.y + 1.4 * x + side * y, ..to };
        self.triangles += 1;
        self.solids.triangle::<{ mode::BLEND }>([&tip, &barb(1.0), &barb(-1.0)]);
    }

    fn dot(&mut self, dot: &Dot, projection: &Projection, samples_per_point: f32, tokens: &Tokens) {
        const CORNERS: usize = 14;
        let [r, g, b, _] = dot.tint.ink(tokens).to_array().map(f32::from);
        let corner = projection.corner(&dot.at_m, [r, g, b, 255.0]);
        if corner.place.z.is_nan() || corner.place.z < NEAR_M as f32 {
            return;
        }
        let middle = lifted(projection.vertex(&corner));
        let radius = dot.radius * samples_per_point;
        let rim = |i: usize| {
            let turn = i as f32 / CORNERS as f32 * std::f32::consts::TAU;
            Vertex { x: middle.x + radius * turn.cos(), y: middle.y + radius * turn.sin(), ..middle }
        };
        self.triangles += CORNERS;
        for i in 0..CORNERS {
            self.solids.triangle::<{ mode::SOLID }>([&middle, &rim(i), &rim((i + 1) % CORNERS)]);
        }
    }
}

/// The triangles of a solid, as fine as its size on screen needs; `None` if it is behind.
fn placed_form<'a>(solid: &'a Solid, projection: &Projection, fineness: f32) -> Option<Form<'a>> {
    let View { eye_m, forward, focal, .. } = projection.view;
    let radius_m = solid.shape.bounding_radius_m();
    let depth_m = forward.dot(&(solid.robot_from_shape.translation.vector - eye_m.coords));
    let in_front = depth_m + radius_m > NEAR_M;
    in_front.then(|| form(&solid.shape, fineness * focal * (radius_m / depth_m.max(radius_m)) as f32))
}

/// Takes points of a shape straight to the raster.
struct Projector {
    turn: nalgebra::Matrix3<f32>,
    shift: Vector3<f32>,
}

impl Projector {
    fn new(solid: &Solid, projection: &Projection) -> Self {
        let View { right, up, forward, focal, eye_m, .. } = projection.view;
        let focal = f64::from(focal);
        let rows = [right * focal, -up * focal, forward].map(|row| row.transpose());
        let raster_from_robot = nalgebra::Matrix3::from_rows(&rows);
        let turn = raster_from_robot * solid.robot_from_shape.rotation.to_rotation_matrix().matrix();
        let shift = raster_from_robot * (solid.robot_from_shape.translation.vector - eye_m.coords);
        Self { turn: turn.cast::<f32>(), shift: shift.cast::<f32>() }
    }

    #[inline]
    fn place(&self, at: &Point3<f32>) -> Vector3<f32> {
        self.turn * at.coords + self.shift
    }
}

/// Whether a triangle, counterclockwise from outside, turns its outside to the camera. With y
/// down, so the sense is reversed. Works for corners behind the camera too.
fn faces_camera(corners: &[Corner; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| corner.place);
    a.dot(&b.cross(&c)) < 0.0
}

fn lifted(vertex: Vertex) -> Vertex {
    Vertex { nearness: vertex.nearness * LINE_LIFT, ..vertex }
}

/// The vector of a length at right angles to a line on the raster.
fn across(a: &Vertex, b: &Vertex, length: f32) -> Option<[f32; 2]> {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let norm = dx.hypot(dy);
    (norm > 1e-3 && norm.is_finite()).then(|| [-dy / norm * length, dx / norm * length])
}

/// The point between one in front of the near plane and one behind it, on the plane.
fn cut(front: &Corner, behind: &Corner) -> Corner {
    let near = NEAR_M as f32;
    let t = (front.place.z - near) / (front.place.z - behind.place.z);
    let mut color = [0.0; 4];
    for (i, c) in color.iter_mut().enumerate() {
        *c = front.color[i] + t * (behind.color[i] - front.color[i]);
    }
    let mut place = front.place + (behind.place - front.place) * t;
    place.z = near;
    Corner { place, color }
}

/// The part of a triangle in front of the camera, as up to two triangles.
fn clipped(corners: &[Corner; 3], projection: &Projection, mut draw: impl FnMut([&Vertex; 3])) {
    let near = NEAR_M as f32;
    let in_front = corners.map(|corner| corner.place.z >= near);
    match in_front.iter().filter(|front| **front).count() {
        3 => {
            let [a, b, c] = corners.each_ref().map(|corner| projection.vertex(corner));
            draw([&a, &b, &c]);
        }
        0 => {}
        count => {
            // Turned so that the one that is alone on its side comes first.
            let alone = in_front.iter().position(|front| *front == (count == 1)).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| &corners[(alone + i) % 3]);
            let quad = match count {
                1 => [*a, cut(a, b), cut(a, c), *a],
                _ => [cut(b, a), *b, *c, cut(c, a)],
            };
            let [p, q, r, s] = quad.each_ref().map(|corner| projection.vertex(corner));
            draw([&p, &q, &r]);
            if count == 2 {
                draw([&p, &r, &s]);
            }
        }
    }
}
