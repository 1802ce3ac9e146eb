//! Which items each tile of 16×16 pixels can see: a cone around the tile's rays against a ball and a box
//! around each item. An item too many costs time, one too few a hole in the image, so all tests err on
//! the side of seeing.
//!
//! The buffer begins with one header of 16 numbers per tile: its place (x + 1024 y + 2^20 eye); seven
//! places in this buffer, where the items of each kind begin and where the last ends; the same seven
//! for what mirrors may show; one unused. Then the lists.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{Fisheye, Pixel};
use rayon::prelude::*;

use super::pack::{BOARD, BOX, Bound, KINDS, MESH};
use super::sensor::theta_d;

/// Pixels of a tile's side.
pub(super) const TILE: u32 = 16;
/// Numbers of a header.
pub(super) const HEADER: usize = 16;

/// Rays of a tile beyond the image circle by this angle are not needed, rad.
const MARGIN_RAD: f64 = 0.1;
/// Cones are this much wider (pixels), so that they still hold while the lens warms up a little.
const SLACK_PX: f64 = 1.5;

/// What a tile needs of the shader beyond simple shapes.
pub(super) const NEEDS_BOARD: usize = 1;
pub(super) const NEEDS_MIRROR: usize = 2;
pub(super) const NEEDS_MESH: usize = 4;
pub(super) const NEEDS_ROUND: usize = 8;
pub(super) const NEEDS_PATTERN: usize = 16;
/// Number of combinations.
pub(super) const VARIANTS: usize = 32;

/// A cone around all rays of a tile; directions in the eye's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    place: u32,
    axis: Vector3<f64>,
    cos: f64,
    sin: f64,
}

/// The cones of an eye, kept while its lens hardly changes.
#[derive(Default)]
pub(super) struct Cones {
    lens: Option<(Fisheye, (u32, u32), f64)>,
    cones: Vec<Cone>,
}

impl Cones {
    /// The cones of all tiles on the image circle.
    pub fn update(&mut self, lens: &Fisheye, size: (u32, u32), circle_rad: f64) -> &[Cone] {
        let same = self.lens.is_some_and(|(old, old_size, old_circle)| {
            let near = |a: f64, b: f64, tolerance: f64| (a - b).abs() < tolerance;
            old_size == size
                && old_circle == circle_rad
                && near(old.cx_px, lens.cx_px, 0.3)
                && near(old.cy_px, lens.cy_px, 0.3)
                && near(old.fx_px, lens.fx_px, 0.2)
                && near(old.fy_px, lens.fy_px, 0.2)
                && old.skew_px == lens.skew_px
                && old.k == lens.k
        });
        if !same {
            self.cones = cones(lens, size, circle_rad);
            self.lens = Some((*lens, size, circle_rad));
        }
        &self.cones
    }
}

fn cones(lens: &Fisheye, (width, height): (u32, u32), circle_rad: f64) -> Vec<Cone> {
    let widest = (circle_rad + MARGIN_RAD).min(lens.limit_rad());
    let direction = |u: f64, v: f64| -> Vector3<f64> {
        match lens.unproject(Pixel::new(u, v)) {
            Ok(d) if d.z >= widest.cos() => d,
            // Beyond the lens: as far out as it goes, at the same azimuth.
            _ => {
                let (x, y) = ((u - lens.cx_px) / lens.fx_px, (v - lens.cy_px) / lens.fy_px);
                let r = x.hypot(y).max(1e-12);
                let (sin, cos) = widest.sin_cos();
                Vector3::new(x / r * sin, y / r * sin, cos)
            }
        }
    };
    let edge_px = theta_d(lens, circle_rad) * lens.fx_px.max(lens.fy_px) + 6.0;
    let mut cones = Vec::new();
    for y in 0..height.div_ceil(TILE) {
        for x in 0..width.div_ceil(TILE) {
            let (u0, v0) = (f64::from(x * TILE) - 0.5, f64::from(y * TILE) - 0.5);
            let (u1, v1) = (u0 + f64::from(TILE), v0 + f64::from(TILE));
            let nearest = Vector3::new(
                lens.cx_px.clamp(u0, u1) - lens.cx_px,
                lens.cy_px.clamp(v0, v1) - lens.cy_px,
                0.0,
            );
            if nearest.norm() > edge_px {
                continue;
            }
            let axis = direction(0.5 * (u0 + u1), 0.5 * (v0 + v1));
            // The outline bulges: its middles count as well as its corners.
            let outline = [-SLACK_PX, 0.5, SLACK_PX].map(|s| s);
            let us = [u0 + outline[0], 0.5 * (u0 + u1), u1 + outline[2]];
            let vs = [v0 + outline[0], 0.5 * (v0 + v1), v1 + outline[2]];
            let cos = us
                .iter()
                .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
                .map(|(u, v)| direction(u, v).dot(&axis))
                .fold(1.0, f64::min);
            let half = cos.clamp(-1.0, 1.0).acos() * 1.02 + 1e-3;
            cones.push(Cone { place: x + (y << 10), axis, cos: half.cos(), sin: half.sin() });
        }
    }
    cones
}

/// The lists, ready for the device.
#[derive(Default)]
pub(super) struct TileLists {
    /// Headers and lists.
    pub data: Vec<u32>,
    /// Headers that need each variant of the shader: first header, how many.
    pub runs: [(usize, usize); VARIANTS],
    /// Number of headers.
    pub tiles: usize,
}

/// A cone in the robot frame.
struct View {
    apex: Point3<f64>,
    axis: Vector3<f64>,
    cos: f64,
    sin: f64,
    /// Outward normals of four planes that touch the cone.
    planes: [Vector3<f64>; 4],
}

impl View {
    fn new(apex: Point3<f64>, axis: Vector3<f64>, cos: f64, sin: f64) -> Self {
        let side = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let e1 = axis.cross(&side).normalize();
        let e2 = axis.cross(&e1);
        let planes = [e1, -e1, e2, -e2].map(|e| e * cos - axis * sin);
        Self { apex, axis, cos, sin, planes }
    }

    fn may_see(&self, bound: &Bound, sides: &[Vector3<f64>; 3]) -> bool {
        let to = bound.center - self.apex;
        let along = self.axis.dot(&to);
        let beside = (to.norm_squared() - along * along).max(0.0).sqrt();
        if beside * self.cos - along * self.sin > bound.radius_m {
            return false;
        }
        self.planes
            .iter()
            .all(|n| n.dot(&to) <= sides.iter().map(|side| n.dot(side).abs()).sum::<f64>() + 1e-6)
    }
}

struct Tile {
    place: u32,
    needs: usize,
    seen: Vec<u32>,
    mirrored: Vec<u32>,
}

/// Lists of all tiles of both eyes.
pub(super) fn lists(robot_from_eye: [Isometry3<f64>; 2], cones: [&[Cone]; 2], bounds: &[Bound]) -> TileLists {
    let sides: Vec<[Vector3<f64>; 3]> = bounds.iter().map(half_sides).collect();
    // Items of one kind lie together in every list.
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by_key(|&i| bounds[i].kind);
    let jobs: Vec<(usize, &Cone)> =
        cones.iter().enumerate().flat_map(|(eye, cones)| cones.iter().map(move |c| (eye, c))).collect();
    let mut tiles: Vec<Tile> = jobs
        .par_iter()
        .with_min_len(32)
        .map(|&(eye, cone)| tile(eye, cone, &robot_from_eye[eye], bounds, &sides, &order))
        .collect();
    tiles.sort_by_key(|tile| tile.needs);
    write(&tiles, bounds)
}

/// The three half axes of the box around an item, robot frame.
pub(super) fn half_sides(bound: &Bound) -> [Vector3<f64>; 3] {
    let turn = bound.robot_from_box.rotation;
    [0, 1, 2].map(|i| turn * Vector3::ith_axis(i).into_inner() * bound.half_m[i])
}

fn tile(
    eye: usize,
    cone: &Cone,
    robot_from_eye: &Isometry3<f64>,
    bounds: &[Bound],
    sides: &[[Vector3<f64>; 3]],
    order: &[usize],
) -> Tile {
    let apex = Point3::from(robot_from_eye.translation.vector);
    let view = View::new(apex, robot_from_eye.rotation * cone.axis, cone.cos, cone.sin);
    let see = |view: &View, item: usize| view.may_see(&bounds[item], &sides[item]);
    let seen: Vec<u32> = order.iter().filter(|&&i| see(&view, i)).map(|&i| i as u32).collect();
    let mut tile = Tile { place: cone.place | (eye as u32) << 20, needs: 0, seen, mirrored: Vec::new() };
    // The nearest mirror of the tile; a second one would show the first one's images.
    let near = |i: u32| (bounds[i as usize].center - apex).norm();
    let mirror = tile
        .seen
        .iter()
        .copied()
        .filter(|&i| bounds[i as usize].mirrors)
        .min_by(|&a, &b| near(a).total_cmp(&near(b)));
    if let Some(mirror) = mirror {
        tile.needs |= NEEDS_MIRROR;
        let (normal, place) = face(&bounds[mirror as usize], &apex);
        let flip = |v: Vector3<f64>| v - normal * (2.0 * normal.dot(&v));
        let image = View::new(place + flip(apex - place), flip(view.axis), cone.cos, cone.sin);
        let before = |i: usize| normal.dot(&(bounds[i].center - place)) > -bounds[i].radius_m;
        tile.mirrored = order
            .iter()
            .filter(|&&i| i != mirror as usize && before(i) && see(&image, i))
            .map(|&i| i as u32)
            .collect();
    }
    if tile.seen.iter().any(|&i| bounds[i as usize].patterned) {
        tile.needs |= NEEDS_PATTERN;
    }
    for &item in tile.seen.iter().chain(&tile.mirrored) {
        tile.needs |= match bounds[item as usize].kind {
            BOX => 0,
            BOARD => NEEDS_BOARD,
            MESH => NEEDS_MESH,
            _ => NEEDS_ROUND,
        };
    }
    tile
}

/// Normal and a point of the face of a box that looks most at a place.
fn face(bound: &Bound, eye: &Point3<f64>) -> (Vector3<f64>, Point3<f64>) {
    debug_assert_eq!(bound.kind, BOX);
    let e = bound.robot_from_box.inverse() * eye;
    let beyond = Vector3::from_fn(|i, _| e[i].abs() - bound.half_m[i]);
    let axis = beyond.imax();
    let sign = e[axis].signum();
    let normal = Vector3::ith(axis, sign);
    let place = Point3::from(normal * bound.half_m[axis]);
    (bound.robot_from_box.rotation * normal, bound.robot_from_box * place)
}

fn write(tiles: &[Tile], bounds: &[Bound]) -> TileLists {
    let mut out = TileLists { tiles: tiles.len(), ..TileLists::default() };
    out.data.resize(tiles.len() * HEADER, 0);
    for (index, tile) in tiles.iter().enumerate() {
        let header = index * HEADER;
        out.data[header] = tile.place;
        append_list(&mut out.data, header + 1, &tile.seen, bounds);
        append_list(&mut out.data, header + 8, &tile.mirrored, bounds);
        let (first, count) = &mut out.runs[tile.needs];
        if *count == 0 {
            *first = index;
        }
        *count += 1;
    }
    out
}

/// Appends a list sorted by kind and writes its seven places at `header`.
pub(super) fn append_list(data: &mut Vec<u32>, header: usize, list: &[u32], bounds: &[Bound]) {
    let start = data.len();
    for kind in 0..=KINDS {
        data[header + kind] = (start + list.partition_point(|&i| bounds[i as usize].kind < kind)) as u32;
    }
    data.extend(list);
}
