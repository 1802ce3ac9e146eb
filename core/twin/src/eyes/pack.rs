//! The scenery at one moment as flat numbers for the device, and as bounds for deciding which tile can
//! see what.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};

use super::error::RenderError;
use super::mesh_tree::{self, MeshPlace};
use crate::scene::{Item, Mesh, Pattern, Scenery, Shape, Snapshot};

/// Items that fit into the device's constant memory; the shaders say the same.
pub(super) const MOST_ITEMS: usize = 768;
/// Kinds of shapes, in the order in which lists hold them.
pub(super) const KINDS: usize = 6;
pub(super) const BOX: usize = 0;
pub(super) const BOARD: usize = 4;
pub(super) const MESH: usize = 5;

/// Smallest share of mirrored light that is worth tracing; below, the surroundings are guessed.
const LEAST_GLOSS: f32 = 0.03;
/// Smallest side of a box that mirrors, meters.
const LEAST_MIRROR_M: f64 = 0.1;

/// Where an item is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// Box, ellipsoid, capsule, cylinder, board, mesh.
    pub kind: usize,
    /// Center of a ball around it, robot frame.
    pub center: Point3<f64>,
    /// Radius of that ball, meters.
    pub radius_m: f64,
    /// Place of a box around it.
    pub robot_from_box: Isometry3<f64>,
    /// Half extents of that box.
    pub half_m: Vector3<f64>,
    /// A flat glossy box that shows mirror images.
    pub mirrors: bool,
    /// Has a pattern.
    pub patterned: bool,
}

/// Meshes as last uploaded.
#[derive(Default)]
pub(super) struct MeshStore {
    known: Vec<(Arc<Mesh>, MeshPlace)>,
    /// All trees and triangles.
    pub buffer: Vec<[f32; 4]>,
    /// Whether `buffer` has changed since it was last taken.
    pub changed: bool,
}

impl MeshStore {
    /// Forgets meshes that the scenery no longer has, as soon as there is any.
    pub fn keep_only(&mut self, scenery: &Scenery) {
        let used = |mesh: &Arc<Mesh>| {
            scenery
                .items
                .iter()
                .any(|item| matches!(&item.shape, Shape::Mesh { mesh: m } if Arc::ptr_eq(m, mesh)))
        };
        if self.known.iter().any(|(mesh, _)| !used(mesh)) {
            *self = Self { changed: true, ..Self::default() };
        }
    }

    fn place(&mut self, mesh: &Arc<Mesh>) -> Result<MeshPlace, &'static str> {
        if let Some((_, place)) = self.known.iter().find(|(known, _)| Arc::ptr_eq(known, mesh)) {
            return Ok(*place);
        }
        if let Some(problem) = mesh_tree::problem(mesh) {
            return Err(problem);
        }
        let place = mesh_tree::append(mesh, &mut self.buffer);
        if self.buffer.len() >= 1 << 24 {
            return Err("all meshes together have too many triangles: simplify them");
        }
        self.known.push((mesh.clone(), place));
        self.changed = true;
        Ok(place)
    }
}

/// Everything the device needs to know of the items.
#[derive(Default)]
pub(super) struct Packed {
    /// Four vec4 per item: rows of `shape_from_robot`, sizes.
    pub geometries: Vec<[f32; 4]>,
    /// Three vec4 per item: color and gloss, pattern, kind and object.
    pub materials: Vec<[f32; 4]>,
    /// One per item.
    pub bounds: Vec<Bound>,
}

/// Packs and checks a scenery.
pub(super) fn pack(
    scenery: &Scenery,
    snapshot: &Snapshot,
    meshes: &mut MeshStore,
) -> Result<Packed, RenderError> {
    if scenery.items.len() > MOST_ITEMS {
        return Err(RenderError::TooMany { items: scenery.items.len(), most: MOST_ITEMS });
    }
    for (body, pose) in snapshot.robot_from_body.iter().enumerate() {
        if !is_finite(pose) {
            return Err(RenderError::BadPose(format!("body {body}")));
        }
    }
    let mut packed = Packed::default();
    for (index, item) in scenery.items.iter().enumerate() {
        let bodies = &snapshot.robot_from_body;
        let robot_from_body = bodies.get(item.body.0).ok_or(RenderError::NoBody {
            item: index,
            body: item.body.0,
            bodies: bodies.len(),
        })?;
        let robot_from_shape = robot_from_body * item.body_from_shape;
        if !is_finite(&robot_from_shape) {
            return Err(RenderError::BadPose(format!("item {index}")));
        }
        push(&mut packed, item, &robot_from_shape, meshes)
            .map_err(|problem| RenderError::BadItem { item: index, problem })?;
    }
    Ok(packed)
}

/// Whether every number of a pose is one.
pub(super) fn is_finite(pose: &Isometry3<f64>) -> bool {
    pose.translation.vector.iter().all(|c| c.is_finite())
        && pose.rotation.coords.iter().all(|c| c.is_finite())
}

fn push(
    packed: &mut Packed,
    item: &Item,
    robot_from_shape: &Isometry3<f64>,
    meshes: &mut MeshStore,
) -> Result<(), &'static str> {
    let (kind, dims, middle, half_m) = form(&item.shape, meshes)?;
    let usable = |value: f32| value.is_finite() && value >= 0.0;
    let m = &item.material;
    if !(m.albedo.iter().all(|&c| usable(c)) && usable(m.gloss)) {
        return Err("its color and gloss must be numbers from 0 to 1");
    }
    let pattern = match m.pattern {
        Pattern::Plain => [0.0, 1.0, 0.0, 0.0],
        Pattern::Speckle { size_m, contrast } => [1.0, size_m, contrast, 0.0],
        Pattern::Folds { period_m, contrast } => [2.0, period_m, contrast, 0.0],
    };
    if !(pattern[1].is_finite() && pattern[1] > 1e-5 && pattern[2].is_finite()) {
        return Err("its pattern must have a size above 0.01 mm and a finite contrast");
    }
    let shape_from_robot = robot_from_shape.inverse();
    packed.geometries.extend(rows(&shape_from_robot));
    packed.geometries.push(dims);
    packed.materials.push([m.albedo[0], m.albedo[1], m.albedo[2], m.gloss]);
    packed.materials.push(pattern);
    packed.materials.push([kind as f32, f32::from(item.object), 0.0, 0.0]);
    let robot_from_box = robot_from_shape * nalgebra::Translation3::from(middle);
    let mut sides = [half_m.x, half_m.y, half_m.z];
    sides.sort_by(f64::total_cmp);
    packed.bounds.push(Bound {
        kind,
        center: robot_from_box * Point3::origin(),
        radius_m: half_m.norm(),
        robot_from_box,
        half_m,
        patterned: m.pattern != Pattern::Plain,
        mirrors: kind == BOX && m.gloss >= LEAST_GLOSS && sides[1] >= 0.5 * LEAST_MIRROR_M,
    });
    Ok(())
}

/// Kind, sizes for the device, middle and half extents of the box around a shape.
type Form = (usize, [f32; 4], Vector3<f64>, Vector3<f64>);

fn form(shape: &Shape, meshes: &mut MeshStore) -> Result<Form, &'static str> {
    const SIZE: &str = "its sizes must be finite numbers above 0";
    let checked = |sizes: &[f64]| {
        if sizes.iter().all(|&s| s.is_finite() && s > 0.0) { Ok(()) } else { Err(SIZE) }
    };
    let zero = Vector3::zeros();
    let three = |v: &Vector3<f64>| [v.x as f32, v.y as f32, v.z as f32, 0.0];
    Ok(match shape {
        Shape::Box { half_m } => {
            checked(half_m.as_slice())?;
            (BOX, three(half_m), zero, *half_m)
        }
        Shape::Ellipsoid { radii_m } => {
            checked(radii_m.as_slice())?;
            (1, three(radii_m), zero, *radii_m)
        }
        Shape::Capsule { radius_m, half_length_m } => {
            checked(&[*radius_m])?;
            if !(half_length_m.is_finite() && *half_length_m >= 0.0) {
                return Err(SIZE);
            }
            let half = Vector3::new(*radius_m, *radius_m, half_length_m + radius_m);
            (2, [*radius_m as f32, *half_length_m as f32, 0.0, 0.0], zero, half)
        }
        Shape::Cylinder { radius_m, half_length_m } => {
            checked(&[*radius_m, *half_length_m])?;
            let half = Vector3::new(*radius_m, *radius_m, *half_length_m);
            (3, [*radius_m as f32, *half_length_m as f32, 0.0, 0.0], zero, half)
        }
        Shape::Board { board } => {
            let s = board.square_m;
            checked(&[s])?;
            let (columns, rows) = board.squares();
            let (columns, rows) = (f64::from(columns), f64::from(rows));
            // From two squares before the first inner corner to two beyond the last.
            let half = Vector3::new(0.5 * (columns + 2.0) * s, 0.5 * (rows + 2.0) * s, 1e-6);
            let middle = Vector3::new(half.x - 2.0 * s, half.y - 2.0 * s, 0.0);
            (BOARD, [s as f32, columns as f32, rows as f32, 0.0], middle, half)
        }
        Shape::Mesh { mesh } => {
            let place = meshes.place(mesh)?;
            let dims = [place.first as f32, place.end as f32, place.triangles as f32, 0.0];
            let half = (0.5 * (place.high - place.low)).sup(&Vector3::repeat(1e-6));
            (MESH, dims, 0.5 * (place.low + place.high), half)
        }
    })
}

/// The three rows of a pose, the translation last.
pub(super) fn rows(pose: &Isometry3<f64>) -> [[f32; 4]; 3] {
    let m = pose.to_homogeneous();
    std::array::from_fn(|r| std::array::from_fn(|c| m[(r, c)] as f32))
}
