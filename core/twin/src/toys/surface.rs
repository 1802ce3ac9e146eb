//! Triangle meshes of round things: skins over rings of points.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use crate::scene::{Mesh, Shape};

/// A closed skin over rings of equally many points, with a point at both ends; normals are smooth.
///
/// Rings run counter-clockwise seen from the last end, meters.
pub(crate) fn skin(first: Vector3<f64>, rings: &[Vec<Vector3<f64>>], last: Vector3<f64>) -> Shape {
    let sides = rings.first().map_or(0, Vec::len);
    let mut vertices = vec![first];
    vertices.extend(rings.iter().flatten());
    vertices.push(last);
    let end = vertices.len() - 1;
    let at = |ring: usize, side: usize| 1 + ring * sides + side % sides;
    let mut triangles = vec![];
    for side in 0..sides {
        triangles.push([0, at(0, side + 1), at(0, side)]);
        for ring in 1..rings.len() {
            let (a, b) = (at(ring - 1, side), at(ring - 1, side + 1));
            let (c, d) = (at(ring, side + 1), at(ring, side));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([at(rings.len() - 1, side), at(rings.len() - 1, side + 1), end]);
    }
    mesh(&vertices, &triangles)
}

/// A skin around the z axis: radius and height of every ring, and a factor on the radius by angle
/// (rad) and share of the way from the first to the last ring.
pub(crate) fn lathe(
    profile_m: &[(f64, f64)],
    ends_m: [f64; 2],
    sides: usize,
    factor: impl Fn(f64, f64) -> f64,
) -> Shape {
    let steps = profile_m.len().max(2) - 1;
    let rings: Vec<Vec<Vector3<f64>>> = profile_m
        .iter()
        .enumerate()
        .map(|(i, (radius_m, z_m))| {
            (0..sides)
                .map(|side| {
                    let angle = std::f64::consts::TAU * side as f64 / sides as f64;
                    let r = radius_m * factor(angle, i as f64 / steps as f64);
                    Vector3::new(r * angle.cos(), r * angle.sin(), *z_m)
                })
                .collect()
        })
        .collect();
    skin(Vector3::new(0.0, 0.0, ends_m[0]), &rings, Vector3::new(0.0, 0.0, ends_m[1]))
}

/// A mesh with normals averaged over the triangles at every vertex.
pub(crate) fn mesh(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Shape {
    let mut normals = vec![Vector3::zeros(); vertices.len()];
    for [a, b, c] in triangles {
        let normal = (vertices[*b] - vertices[*a]).cross(&(vertices[*c] - vertices[*a]));
        for v in [a, b, c] {
            normals[*v] += normal;
        }
    }
    let unit = |n: &Vector3<f64>| n.try_normalize(1e-15).unwrap_or_else(Vector3::z).cast::<f32>();
    Shape::Mesh {
        mesh: Arc::new(Mesh {
            vertices: vertices.iter().map(|v| Point3::from(v.cast::<f32>())).collect(),
            normals: normals.iter().map(unit).collect(),
            triangles: triangles.iter().map(|t| t.map(|v| v as u32)).collect(),
        }),
    }
}

/// The surface of any shape as triangles in the shape's frame, coarse for round ones: for outlines
/// and for finding the lowest point.
pub(crate) fn triangles(shape: &Shape) -> Vec<[Vector3<f64>; 3]> {
    match shape {
        Shape::Mesh { mesh } => {
            let at = |v: u32| mesh.vertices[v as usize].coords.cast::<f64>();
            mesh.triangles.iter().map(|t| t.map(at)).collect()
        }
        Shape::Ellipsoid { radii_m } => globe(|unit| unit.component_mul(radii_m)),
        Shape::Capsule { radius_m, half_length_m } => {
            globe(|unit| unit * *radius_m + Vector3::z() * unit.z.signum() * *half_length_m)
        }
        Shape::Cylinder { radius_m, half_length_m } => globe(|unit| {
            let flat = unit.xy().try_normalize(1e-9).unwrap_or_default() * *radius_m;
            if unit.z.abs() > 0.98 {
                Vector3::new(0.0, 0.0, half_length_m * unit.z.signum())
            } else {
                Vector3::new(flat.x, flat.y, half_length_m * unit.z.signum())
            }
        }),
        Shape::Box { half_m } => cuboid(half_m),
        Shape::Board { .. } => vec![],
    }
}

/// A unit sphere of rings without one on the equator, its points moved.
fn globe(place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<[Vector3<f64>; 3]> {
    const RINGS: usize = 8;
    const SIDES: usize = 14;
    let at = |ring: usize, side: usize| {
        let polar =
            std::f64::consts::PI * ring as f64 / RINGS as f64 + if ring == RINGS / 2 { 1e-9 } else { 0.0 };
        let angle = std::f64::consts::TAU * (side % SIDES) as f64 / SIDES as f64;
        place(Vector3::new(polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()))
    };
    (0..RINGS)
        .flat_map(|ring| (0..SIDES).map(move |side| (ring, side)))
        .flat_map(|(ring, side)| {
            let (a, b) = (at(ring, side), at(ring, side + 1));
            let (c, d) = (at(ring + 1, side + 1), at(ring + 1, side));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn cuboid(half_m: &Vector3<f64>) -> Vec<[Vector3<f64>; 3]> {
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half_m.component_mul(&Vector3::new(sign(0), sign(1), sign(2)))
    };
    const FACES: [[usize; 4]; 6] =
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    FACES.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).map(|t| t.map(corner)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lathed_ball_is_a_ball_with_normals_outward() {
        let profile: Vec<(f64, f64)> = (1..8)
            .map(|i| std::f64::consts::PI * f64::from(i) / 8.0)
            .map(|polar| (0.02 * polar.sin(), -0.02 * polar.cos()))
            .collect();
        let shape = lathe(&profile, [-0.02, 0.02], 12, |_, _| 1.0);
        let Shape::Mesh { mesh } = &shape else { panic!("a mesh") };
        for (vertex, normal) in mesh.vertices.iter().zip(&mesh.normals) {
            assert!((vertex.coords.norm() - 0.02).abs() < 1e-6);
            assert!(vertex.coords.normalize().dot(normal) > 0.98);
        }
    }

    #[test]
    fn outlines_of_simple_shapes_have_their_extents() {
        let top = |shape: &Shape, axis: usize| {
            triangles(shape).iter().flatten().map(|v| v[axis]).fold(f64::MIN, f64::max)
        };
        let capsule = Shape::Capsule { radius_m: 0.01, half_length_m: 0.03 };
        assert!((top(&capsule, 2) - 0.04).abs() < 1e-9 && (top(&capsule, 0) - 0.01).abs() < 2e-4);
        let cylinder = Shape::Cylinder { radius_m: 0.01, half_length_m: 0.03 };
        assert!((top(&cylinder, 2) - 0.03).abs() < 1e-9 && (top(&cylinder, 0) - 0.01).abs() < 1e-9);
        let cuboid = Shape::Box { half_m: Vector3::new(0.1, 0.2, 0.3) };
        assert_eq!([0, 1, 2].map(|axis| top(&cuboid, axis)), [0.1, 0.2, 0.3]);
    }
}
