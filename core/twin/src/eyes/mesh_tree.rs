//! Triangle meshes as the shaders walk them: a tree of boxes without a stack (every node knows where
//! to go on when it is missed), all meshes in one buffer of vec4.
//!
//! A node is two vec4: (low corner, next node if missed), (high corner, leaf). `leaf` is 0 for an
//! inner node, else 16 · first triangle + count. A triangle is six vec4: a vertex, two edges, three
//! normals. Numbers are stored as floats, exact up to 2^24.

use nalgebra::{Point3, Vector3};

use crate::scene::Mesh;

/// Triangles of a leaf, at most 15.
const LEAF: usize = 4;

/// Where a mesh lies in the buffer, and its extent.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshPlace {
    /// First node, end of the nodes, first triangle; indices of vec4.
    pub first: usize,
    pub end: usize,
    pub triangles: usize,
    /// Corners of the box around it.
    pub low: Vector3<f64>,
    pub high: Vector3<f64>,
}

struct Corner {
    low: Vector3<f32>,
    high: Vector3<f32>,
    middle: Vector3<f32>,
}

/// What is wrong with a mesh, if anything.
pub(super) fn problem(mesh: &Mesh) -> Option<&'static str> {
    let count = mesh.vertices.len();
    if mesh.triangles.is_empty() {
        return Some("its mesh has no triangles: give at least one");
    }
    if mesh.normals.len() != count {
        return Some("its mesh needs one normal per vertex");
    }
    if mesh.triangles.iter().flatten().any(|&v| v as usize >= count) {
        return Some("a triangle of its mesh names a vertex that does not exist");
    }
    let finite = mesh.vertices.iter().all(|v| v.iter().all(|c| c.is_finite()))
        && mesh.normals.iter().all(|n| n.iter().all(|c| c.is_finite()));
    // Six vec4 per triangle must stay countable in a float.
    let countable = mesh.triangles.len() < 400_000;
    match (finite, countable) {
        (false, _) => Some("its mesh has vertices or normals that are not finite"),
        (_, false) => Some("its mesh has more than 400000 triangles: simplify it"),
        _ => None,
    }
}

/// Appends a mesh to the buffer; it must have no [`problem`].
pub(super) fn append(mesh: &Mesh, buffer: &mut Vec<[f32; 4]>) -> MeshPlace {
    let corners: Vec<Corner> = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.vertices[v as usize].coords);
            Corner { low: a.inf(&b).inf(&c), high: a.sup(&b).sup(&c), middle: (a + b + c) / 3.0 }
        })
        .collect();
    let mut order: Vec<usize> = (0..corners.len()).collect();
    let first = buffer.len();
    let all = order.len();
    let (low, high) = build(&corners, &mut order, 0..all, buffer);
    let end = buffer.len();
    for &t in &order {
        let [a, b, c] = mesh.triangles[t].map(|v| v as usize);
        let vertex = |v: usize| -> Point3<f32> { mesh.vertices[v] };
        let four = |v: Vector3<f32>| [v.x, v.y, v.z, 0.0];
        buffer.push(four(vertex(a).coords));
        buffer.push(four(vertex(b) - vertex(a)));
        buffer.push(four(vertex(c) - vertex(a)));
        for v in [a, b, c] {
            buffer.push(four(mesh.normals[v]));
        }
    }
    MeshPlace { first, end, triangles: end, low: low.cast(), high: high.cast() }
}

/// Builds the tree of a range of `order`, depth first; returns its box.
fn build(
    corners: &[Corner],
    order: &mut [usize],
    range: std::ops::Range<usize>,
    buffer: &mut Vec<[f32; 4]>,
) -> (Vector3<f32>, Vector3<f32>) {
    let own = &mut order[range.clone()];
    let mut low = Vector3::repeat(f32::INFINITY);
    let mut high = Vector3::repeat(f32::NEG_INFINITY);
    for &t in own.iter() {
        low = low.inf(&corners[t].low);
        high = high.sup(&corners[t].high);
    }
    let node = buffer.len();
    buffer.push([0.0; 4]);
    buffer.push([0.0; 4]);
    let mut leaf = 0;
    if own.len() <= LEAF {
        leaf = 16 * range.start + own.len();
    } else {
        let axis = (high - low).imax();
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |&a, &b| {
            corners[a].middle[axis].total_cmp(&corners[b].middle[axis])
        });
        build(corners, order, range.start..range.start + half, buffer);
        build(corners, order, range.start + half..range.end, buffer);
    }
    // A hair larger: a flat box must not be missed by rounding.
    let hair = Vector3::repeat(1e-6);
    buffer[node] = [low.x - hair.x, low.y - hair.y, low.z - hair.z, buffer.len() as f32];
    buffer[node + 1] = [high.x + hair.x, high.y + hair.y, high.z + hair.z, leaf as f32];
    (low, high)
}
