//! Shapes as triangles.

use std::f32::consts::{PI, TAU};
use std::sync::OnceLock;

use nalgebra::{Point3, Vector3};

use super::scene::Shape;

/// Corners of one vertex that turn by more than this are edges and stay sharp.
const CREASE_COS: f32 = 0.77;

/// Triangles with a normal at every vertex.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Facets {
    pub(super) positions: Vec<Point3<f32>>,
    pub(super) normals: Vec<Vector3<f32>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Why triangles cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// A corner that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are {count} vertices; check the mesh file")]
    UnknownVertex {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        count: usize,
    },
    /// A coordinate that is no number.
    #[error("vertex {vertex} has a coordinate that is not a number; check the mesh file")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// Nothing to draw.
    #[error("the mesh has no triangle with an area; check the mesh file")]
    Empty,
}

/// Triangles made once and shared by every frame.
#[derive(Debug, PartialEq)]
pub struct TriangleMesh {
    facets: Facets,
    bounding_radius_m: f64,
}

impl TriangleMesh {
    /// From vertices in meters, in the shape's frame, and triangles counterclockwise seen from
    /// outside. Edges sharper than 40° stay sharp; triangles without an area are left out.
    pub fn new(vertices_m: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        if let Some(vertex) = vertices_m.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            return Err(MeshError::NotFinite { vertex });
        }
        let count = vertices_m.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(vertex) = corners.iter().copied().find(|v| *v as usize >= count) {
                return Err(MeshError::UnknownVertex { triangle, vertex, count });
            }
        }
        let facets = creased(vertices_m, triangles);
        if facets.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let radius = facets.positions.iter().map(|p| p.coords.norm()).fold(0.0, f32::max);
        Ok(Self { facets, bounding_radius_m: f64::from(radius) })
    }

    pub(super) fn bounding_radius_m(&self) -> f64 {
        self.bounding_radius_m
    }

    pub(super) fn facets(&self) -> &Facets {
        &self.facets
    }
}

/// Every corner gets the mean normal of those faces around it that do not turn too far.
fn creased(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Facets {
    let at = |index: u32| Point3::from(vertices[index as usize]);
    let mut faces = Vec::with_capacity(triangles.len());
    let mut around: Vec<Vec<Vector3<f32>>> = vec![Vec::new(); vertices.len()];
    for &[a, b, c] in triangles {
        // Twice the area along the normal: larger faces count more.
        let normal = (at(b) - at(a)).cross(&(at(c) - at(a)));
        if normal.norm() > 0.0 {
            faces.push(([a, b, c], normal));
            [a, b, c].into_iter().for_each(|corner| around[corner as usize].push(normal));
        }
    }
    let mut facets = Facets::default();
    for (corners, face) in faces {
        let first = facets.positions.len() as u32;
        for corner in corners {
            let near =
                around[corner as usize].iter().filter(|n| n.dot(&face) > CREASE_COS * n.norm() * face.norm());
            facets.positions.push(at(corner));
            facets.normals.push(near.sum::<Vector3<f32>>().normalize());
        }
        facets.triangles.push([first, first + 1, first + 2]);
    }
    facets
}

/// A shape as unit facets and what to do with them.
pub(super) struct Form<'a> {
    pub(super) facets: &'a Facets,
    /// Multiplies positions; normals are divided by it.
    pub(super) scale: Vector3<f32>,
    /// Moves the upper half up and the lower half down: what makes a capsule of a sphere.
    pub(super) stretch: f32,
}

impl Form<'_> {
    pub(super) fn position(&self, unit: &Point3<f32>) -> Point3<f32> {
        let mut p = Point3::from(unit.coords.component_mul(&self.scale));
        if self.stretch > 0.0 {
            p.z += self.stretch.copysign(unit.z);
        }
        p
    }

    pub(super) fn normal(&self, unit: &Vector3<f32>) -> Vector3<f32> {
        if self.scale.x == self.scale.y && self.scale.y == self.scale.z {
            return *unit;
        }
        let n = unit.component_div(&self.scale);
        n / n.norm().max(f32::MIN_POSITIVE)
    }
}

/// The triangles of a shape whose radius covers about so many pixels.
pub(super) fn form(shape: &Shape, radius_px: f32) -> Form<'_> {
    let round = |kind: fn(usize) -> &'static Facets| kind(detail(radius_px));
    match shape {
        Shape::Box { size_m } => Form { facets: cube(), scale: vector(size_m), stretch: 0.0 },
        Shape::Ellipsoid { radii_m } => Form { facets: round(sphere), scale: vector(radii_m), stretch: 0.0 },
        Shape::Capsule { radius_m, length_m } => {
            // How long it is does not matter for how round it has to be.
            let across = radius_px * (*radius_m / (radius_m + length_m / 2.0)) as f32;
            Form {
                facets: sphere(detail(across)),
                scale: vector(&[*radius_m; 3]),
                stretch: (length_m / 2.0) as f32,
            }
        }
        Shape::Cylinder { radius_m, length_m } => {
            Form { facets: round(cylinder), scale: vector(&[*radius_m, *radius_m, *length_m]), stretch: 0.0 }
        }
        Shape::Mesh(mesh) => Form { facets: mesh.facets(), scale: Vector3::repeat(1.0), stretch: 0.0 },
    }
}

fn vector(v: &[f64; 3]) -> Vector3<f32> {
    Vector3::from(v.map(|c| c as f32))
}

/// Coarse, middle or fine, by the radius on screen.
fn detail(radius_px: f32) -> usize {
    match radius_px {
        r if r < 14.0 => 0,
        r if r < 60.0 => 1,
        _ => 2,
    }
}

const SEGMENTS: [usize; 3] = [12, 20, 36];

/// A unit sphere with two rings at the equator, so that it can be pulled apart there.
fn sphere(detail: usize) -> &'static Facets {
    static FACETS: [OnceLock<Facets>; 3] = [const { OnceLock::new() }; 3];
    FACETS[detail].get_or_init(|| {
        let segments = SEGMENTS[detail];
        let bands = segments / 4;
        let mut facets = Facets::default();
        for half in [1.0f32, -1.0] {
            for band in 0..=bands {
                let from_pole = band as f32 / bands as f32 * PI / 2.0;
                // The tiny z tells the two equators apart.
                let (z, r) = (half * from_pole.cos().max(1e-6), from_pole.sin());
                for segment in 0..segments {
                    let turn = segment as f32 / segments as f32 * TAU;
                    facets.positions.push(Point3::new(r * turn.cos(), r * turn.sin(), z));
                }
            }
        }
        facets.normals = facets.positions.iter().map(|p| p.coords.normalize()).collect();
        let ring = |half: usize, band: usize| half * (bands + 1) + band;
        let mut rings: Vec<[usize; 2]> = (0..bands).map(|band| [ring(0, band), ring(0, band + 1)]).collect();
        rings.push([ring(0, bands), ring(1, bands)]);
        rings.extend((0..bands).map(|band| [ring(1, band + 1), ring(1, band)]));
        for [upper, lower] in rings {
            join(&mut facets, upper * segments, lower * segments, segments);
        }
        facets.triangles.retain(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|i| facets.positions[i as usize]);
            // Poles are rings of radius zero. The band between the equators has no area yet.
            let distinct = |p: Point3<f32>, q: Point3<f32>| (p - q).norm() > 1e-7;
            distinct(a, b) && distinct(b, c) && distinct(c, a)
        });
        facets
    })
}

/// Two rings of vertices joined by triangles, counterclockwise from outside.
fn join(facets: &mut Facets, upper: usize, lower: usize, segments: usize) {
    for segment in 0..segments {
        let next = (segment + 1) % segments;
        let [a, b] = [upper + segment, upper + next].map(|i| i as u32);
        let [c, d] = [lower + segment, lower + next].map(|i| i as u32);
        facets.triangles.push([a, c, d]);
        facets.triangles.push([a, d, b]);
    }
}

/// Radius 1, from z −0.5 to 0.5.
fn cylinder(detail: usize) -> &'static Facets {
    static FACETS: [OnceLock<Facets>; 3] = [const { OnceLock::new() }; 3];
    FACETS[detail].get_or_init(|| {
        let segments = SEGMENTS[detail];
        let mut facets = Facets::default();
        let rim = |segment: usize, z: f32| {
            let turn = segment as f32 / segments as f32 * TAU;
            Point3::new(turn.cos(), turn.sin(), z)
        };
        for z in [0.5, -0.5] {
            for segment in 0..segments {
                let p = rim(segment, z);
                facets.positions.push(p);
                facets.normals.push(Vector3::new(p.x, p.y, 0.0));
            }
        }
        join(&mut facets, 0, segments, segments);
        for z in [0.5f32, -0.5] {
            let first = facets.positions.len() as u32;
            facets.positions.extend((0..segments).map(|segment| rim(segment, z)));
            facets.normals.extend((0..segments).map(|_| Vector3::z() * z.signum()));
            for i in 1..segments as u32 - 1 {
                let fan = if z > 0.0 { [0, i, i + 1] } else { [0, i + 1, i] };
                facets.triangles.push(fan.map(|corner| first + corner));
            }
        }
        facets
    })
}

/// Edges of length 1.
fn cube() -> &'static Facets {
    static FACETS: OnceLock<Facets> = OnceLock::new();
    FACETS.get_or_init(|| {
        let mut facets = Facets::default();
        for axis in 0..3 {
            for side in [-1.0f32, 1.0] {
                let mut normal = Vector3::zeros();
                normal[axis] = side;
                let (mut u, mut v) = (Vector3::zeros(), Vector3::zeros());
                u[(axis + 1) % 3] = 1.0;
                v[(axis + 2) % 3] = side;
                let first = facets.positions.len() as u32;
                for (i, j) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
                    facets.positions.push(Point3::from(normal * 0.5 + u * i + v * j));
                    facets.normals.push(normal);
                }
                facets.triangles.push([first, first + 1, first + 2]);
                facets.triangles.push([first, first + 2, first + 3]);
            }
        }
        facets
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(form: &Form<'_>) -> f32 {
        let at = |i: u32| form.position(&form.facets.positions[i as usize]).coords;
        form.facets.triangles.iter().map(|&[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0).sum()
    }

    /// Signed volumes are right only if every triangle is there and faces outward.
    #[test]
    fn closed_shapes_have_their_volume() {
        let shapes = [
            (Shape::Box { size_m: [0.2, 0.3, 0.4] }, 0.024),
            (Shape::Ellipsoid { radii_m: [0.1, 0.2, 0.3] }, 4.0 / 3.0 * std::f64::consts::PI * 0.006),
            (
                Shape::Capsule { radius_m: 0.1, length_m: 0.4 },
                std::f64::consts::PI * (0.004 + 4.0 / 3.0 * 0.001),
            ),
            (Shape::Cylinder { radius_m: 0.1, length_m: 0.4 }, std::f64::consts::PI * 0.004),
        ];
        for (shape, expected) in shapes {
            let found = f64::from(volume(&form(&shape, 1000.0)));
            assert!((found / expected - 1.0).abs() < 0.02, "{shape:?}: {found} for {expected}");
            let coarse = f64::from(volume(&form(&shape, 1.0)));
            assert!((coarse / expected - 1.0).abs() < 0.12, "{shape:?}: {coarse} for {expected}");
        }
    }

    #[test]
    fn normals_are_unit_and_point_away() {
        for shape in [
            Shape::Ellipsoid { radii_m: [0.1, 0.2, 0.3] },
            Shape::Capsule { radius_m: 0.1, length_m: 0.4 },
            Shape::Cylinder { radius_m: 0.1, length_m: 0.4 },
            Shape::Box { size_m: [0.2, 0.3, 0.4] },
        ] {
            let form = form(&shape, 30.0);
            for (p, n) in form.facets.positions.iter().zip(&form.facets.normals) {
                let (p, n) = (form.position(p), form.normal(n));
                assert!((n.norm() - 1.0).abs() < 1e-4 && n.dot(&p.coords) > 0.0, "{shape:?} at {p}");
            }
        }
    }

    #[test]
    fn a_mesh_keeps_sharp_edges_and_refuses_what_is_wrong() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = TriangleMesh::new(&vertices, &[[0, 2, 1], [0, 1, 3], [0, 0, 1]]).expect("two triangles");
        assert_eq!(mesh.facets().triangles.len(), 2);
        assert_eq!(mesh.facets().normals[0], Vector3::new(0.0, 0.0, -1.0));
        let unknown = TriangleMesh::new(&vertices, &[[0, 1, 9]]).expect_err("vertex 9");
        assert!(unknown.to_string().contains("vertex 9"), "{unknown}");
        let nan = TriangleMesh::new(&[[f32::NAN, 0.0, 0.0]], &[]).expect_err("not a number");
        assert_eq!(nan, MeshError::NotFinite { vertex: 0 });
        assert_eq!(TriangleMesh::new(&vertices, &[[1, 1, 1]]), Err(MeshError::Empty));
    }
}
