//! Simple bodies in space and how far apart they are.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::robot::Shape;

/// A convex body: everything within `radius_m` of its core, robot frame, meters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub core: Core,
    pub radius_m: f64,
    /// Center and radius of a ball around all of it.
    pub ball: (Point3<f64>, f64),
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Core {
    /// From end to end; a point when both are the same.
    Segment(Point3<f64>, Point3<f64>),
    /// Columns of `axes` are its edges' directions.
    Box { center: Point3<f64>, axes: Matrix3<f64>, half_m: Vector3<f64> },
    /// Everything below a height.
    Below(f64),
}

impl Solid {
    /// A description's shape at a place. A cylinder gets round ends, so it is never taken for
    /// smaller than it is.
    pub fn new(shape: &Shape, robot_from_shape: &Isometry3<f64>) -> Self {
        let center = Point3::from(robot_from_shape.translation.vector);
        match shape {
            Shape::Box { half_m } => Self {
                core: Core::Box {
                    center,
                    axes: robot_from_shape.rotation.to_rotation_matrix().into_inner(),
                    half_m: *half_m,
                },
                radius_m: 0.0,
                ball: (center, half_m.norm()),
            },
            Shape::Sphere { radius_m } => {
                Self { core: Core::Segment(center, center), radius_m: *radius_m, ball: (center, *radius_m) }
            }
            Shape::Capsule { radius_m, half_length_m } | Shape::Cylinder { radius_m, half_length_m } => {
                let along = robot_from_shape.rotation * Vector3::new(0.0, 0.0, *half_length_m);
                Self {
                    core: Core::Segment(center - along, center + along),
                    radius_m: *radius_m,
                    ball: (center, radius_m + half_length_m),
                }
            }
        }
    }

    /// A point.
    pub fn point(at: Point3<f64>) -> Self {
        Self { core: Core::Segment(at, at), radius_m: 0.0, ball: (at, 0.0) }
    }

    /// Everything below a height (robot frame).
    pub fn below(height_m: f64) -> Self {
        Self { core: Core::Below(height_m), radius_m: 0.0, ball: (Point3::origin(), f64::INFINITY) }
    }

    /// No less than this far apart, m: cheap.
    pub fn least_distance_m(&self, other: &Self) -> f64 {
        (self.ball.0 - other.ball.0).norm() - self.ball.1 - other.ball.1
    }

    /// Distance of the surfaces, m; negative by how far one must be moved to come free of the
    /// other.
    pub fn distance_m(&self, other: &Self) -> f64 {
        let between_cores = match (&self.core, &other.core) {
            (Core::Segment(a, b), Core::Segment(c, d)) => segment_segment_m(a, b, c, d),
            (Core::Segment(a, b), Core::Box { center, axes, half_m })
            | (Core::Box { center, axes, half_m }, Core::Segment(a, b)) => {
                let local = |p: &Point3<f64>| axes.transpose() * (p - center);
                segment_box_m(&local(a), &local(b), half_m)
            }
            (Core::Box { .. }, Core::Box { .. }) => box_box_m(&self.core, &other.core),
            (Core::Below(height_m), core) | (core, Core::Below(height_m)) => lowest_m(core) - height_m,
        };
        between_cores - self.radius_m - other.radius_m
    }
}

fn lowest_m(core: &Core) -> f64 {
    match core {
        Core::Segment(a, b) => a.z.min(b.z),
        Core::Box { center, axes, half_m } => {
            center.z - (0..3).map(|i| axes[(2, i)].abs() * half_m[i]).sum::<f64>()
        }
        Core::Below(height_m) => *height_m,
    }
}

/// Distance of two segments. The squared distance is a convex paraboloid over the unit square:
/// its minimum inside, or else on one of the four sides.
fn segment_segment_m(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, d: &Point3<f64>) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    if determinant > 1e-12 * uu * vv {
        let (s, t) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return (w + u * s - v * t).norm();
        }
    }
    let ends = [
        point_segment_m(a, c, d),
        point_segment_m(b, c, d),
        point_segment_m(c, a, b),
        point_segment_m(d, a, b),
    ];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

fn point_segment_m(p: &Point3<f64>, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    let (along, to) = (b - a, p - a);
    let squared = along.norm_squared();
    let t = if squared > 0.0 { (to.dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (to - along * t).norm()
}

/// Distance of a segment to a box around the origin; negative inside.
fn segment_box_m(a: &Vector3<f64>, b: &Vector3<f64>, half_m: &Vector3<f64>) -> f64 {
    let along = b - a;
    let outside = |t: f64| {
        let p = a + along * t;
        Vector3::from_fn(|i, _| p[i] - p[i].clamp(-half_m[i], half_m[i]))
    };
    // The slope of the squared distance rises along the segment, linear between the places where
    // the segment crosses a plane of the box's faces.
    let mut breaks = [0.0; 8];
    let mut count = 1;
    for i in 0..3 {
        for face in [-half_m[i], half_m[i]] {
            let t = (face - a[i]) / along[i];
            if t > 0.0 && t < 1.0 {
                breaks[count] = t;
                count += 1;
            }
        }
    }
    breaks[count] = 1.0;
    let breaks = &mut breaks[..=count];
    breaks.sort_unstable_by(f64::total_cmp);
    let slope = |t: f64| outside(t).dot(&along);
    let mut nearest = 1.0;
    let mut before = (0.0, slope(0.0));
    if before.1 >= 0.0 {
        nearest = 0.0;
    } else {
        for t in breaks.iter().skip(1) {
            let here = (*t, slope(*t));
            if here.1 >= 0.0 {
                let rise = here.1 - before.1;
                nearest = if rise > 0.0 { before.0 - before.1 * (here.0 - before.0) / rise } else { here.0 };
                break;
            }
            before = here;
        }
    }
    let distance_m = outside(nearest).norm();
    if distance_m > 0.0 { distance_m } else { -segment_in_box_depth_m(a, b, half_m) }
}

/// How far a segment that meets a box around the origin must move to leave it: the least overlap
/// over the axes that can separate the two.
fn segment_in_box_depth_m(a: &Vector3<f64>, b: &Vector3<f64>, half_m: &Vector3<f64>) -> f64 {
    let (middle, reach) = ((a + b) * 0.5, (b - a) * 0.5);
    let mut depth_m = f64::INFINITY;
    for i in 0..3 {
        depth_m = depth_m.min(half_m[i] + reach[i].abs() - middle[i].abs());
        let mut edge = Vector3::zeros();
        edge[i] = 1.0;
        if let Some(axis) = reach.cross(&edge).try_normalize(1e-9) {
            depth_m = depth_m.min(half_m.dot(&axis.abs()) - middle.dot(&axis).abs());
        }
    }
    depth_m.max(0.0)
}

/// Distance of two boxes; negative by the least overlap when they meet.
fn box_box_m(one: &Core, other: &Core) -> f64 {
    let (Core::Box { center: ca, axes: ra, half_m: ha }, Core::Box { center: cb, axes: rb, half_m: hb }) =
        (one, other)
    else {
        return f64::INFINITY;
    };
    let apart = cb - ca;
    let gap_m = |axis: &Vector3<f64>| {
        let reach_a: f64 = (0..3).map(|i| ha[i] * ra.column(i).dot(axis).abs()).sum();
        let reach_b: f64 = (0..3).map(|i| hb[i] * rb.column(i).dot(axis).abs()).sum();
        apart.dot(axis).abs() - reach_a - reach_b
    };
    let faces = (0..3).flat_map(|i| [ra.column(i).into_owned(), rb.column(i).into_owned()]);
    let edges = (0..9).filter_map(|k| ra.column(k / 3).cross(&rb.column(k % 3)).try_normalize(1e-9));
    let widest_m = faces.chain(edges).map(|axis| gap_m(&axis)).fold(f64::NEG_INFINITY, f64::max);
    if widest_m <= 0.0 {
        return widest_m;
    }
    // Of two separate boxes, an edge of one is always nearest to the other.
    edges_to_box_m(ca, ra, ha, cb, rb, hb).min(edges_to_box_m(cb, rb, hb, ca, ra, ha))
}

/// The least distance of the twelve edges of box a to box b.
fn edges_to_box_m(
    ca: &Point3<f64>,
    ra: &Matrix3<f64>,
    ha: &Vector3<f64>,
    cb: &Point3<f64>,
    rb: &Matrix3<f64>,
    hb: &Vector3<f64>,
) -> f64 {
    let corner = |signs: [f64; 3]| {
        let in_a = Vector3::new(signs[0] * ha.x, signs[1] * ha.y, signs[2] * ha.z);
        rb.transpose() * (ca + ra * in_a - cb)
    };
    let mut least_m = f64::INFINITY;
    for direction in 0..3 {
        for (p, q) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let end = |along: f64| {
                let mut signs = [0.0; 3];
                signs[direction] = along;
                signs[(direction + 1) % 3] = p;
                signs[(direction + 2) % 3] = q;
                corner(signs)
            };
            least_m = least_m.min(segment_box_m(&end(-1.0), &end(1.0), hb));
        }
    }
    least_m
}

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion};

    use super::*;

    fn place(x: f64, y: f64, z: f64, turn: [f64; 3]) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::new(x, y, z),
            UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]),
        )
    }

    fn bar(half_m: [f64; 3]) -> Shape {
        Shape::Box { half_m: Vector3::from(half_m) }
    }

    fn distance(a: (&Shape, Isometry3<f64>), b: (&Shape, Isometry3<f64>)) -> f64 {
        let (a, b) = (Solid::new(a.0, &a.1), Solid::new(b.0, &b.1));
        let (there, back) = (a.distance_m(&b), b.distance_m(&a));
        assert!((there - back).abs() < 1e-9, "{there} {back}");
        assert!(a.least_distance_m(&b) <= there + 1e-12);
        there
    }

    #[test]
    fn distances_by_hand() {
        let ball = Shape::Sphere { radius_m: 0.1 };
        let capsule = Shape::Capsule { radius_m: 0.1, half_length_m: 0.5 };
        let cube = bar([0.2, 0.2, 0.2]);
        let at = |x, y, z| place(x, y, z, [0.0; 3]);
        let cases = [
            (distance((&ball, at(0.0, 0.0, 0.0)), (&ball, at(0.5, 0.0, 0.0))), 0.3),
            (distance((&ball, at(0.0, 0.0, 0.0)), (&ball, at(0.15, 0.0, 0.0))), -0.05),
            (distance((&ball, at(0.3, 0.0, 0.9)), (&capsule, at(0.0, 0.0, 0.0))), 0.3),
            (
                distance((&capsule, at(0.0, 0.0, 0.0)), (&capsule, place(0.4, 0.0, 0.0, [1.57, 0.0, 0.0]))),
                0.2,
            ),
            (distance((&capsule, at(0.0, 0.0, 0.0)), (&capsule, at(0.0, 0.3, 0.7))), 0.1),
            (distance((&ball, at(0.5, 0.6, 0.0)), (&cube, at(0.0, 0.0, 0.0))), 0.4),
            (distance((&capsule, at(0.35, 0.0, 0.0)), (&cube, at(0.0, 0.0, 0.0))), 0.05),
            (distance((&capsule, at(0.15, 0.0, 0.0)), (&cube, at(0.0, 0.0, 0.0))), -0.15),
            (distance((&cube, at(0.5, 0.6, 0.0)), (&cube, at(0.0, 0.0, 0.0))), 0.1f64.hypot(0.2)),
            (distance((&cube, at(0.35, 0.1, 0.0)), (&cube, at(0.0, 0.0, 0.0))), -0.05),
        ];
        for (i, (actual, expected)) in cases.into_iter().enumerate() {
            assert!((actual - expected).abs() < 1e-6, "{i}: {actual} {expected}");
        }
        let floor = Solid::below(0.05);
        let standing = Solid::new(&capsule, &at(0.0, 0.0, 0.62));
        assert!((standing.distance_m(&floor) + 0.03).abs() < 1e-12);
        let leaning = Solid::new(&cube, &place(0.0, 0.0, 0.5, [std::f64::consts::FRAC_PI_4, 0.0, 0.0]));
        assert!((leaning.distance_m(&floor) - (0.45 - 0.2 * 2f64.sqrt())).abs() < 1e-12);
    }

    /// Points all over a body's core.
    fn samples(core: &Core) -> Vec<Point3<f64>> {
        let steps = |n: usize| (0..=n).map(move |k| 2.0 * k as f64 / n as f64 - 1.0);
        match core {
            Core::Segment(a, b) => steps(400).map(|s| nalgebra::center(a, b) + (b - a) * (0.5 * s)).collect(),
            Core::Box { center, axes, half_m } => {
                let grid =
                    steps(24).flat_map(|x| steps(24).flat_map(move |y| steps(24).map(move |z| (x, y, z))));
                grid.map(|(x, y, z)| center + axes * Vector3::new(x * half_m.x, y * half_m.y, z * half_m.z))
                    .collect()
            }
            Core::Below(_) => vec![],
        }
    }

    #[test]
    fn distances_agree_with_a_search_over_points() {
        let shapes = [
            bar([0.1, 0.15, 0.05]),
            bar([0.02, 0.1, 0.08]),
            Shape::Capsule { radius_m: 0.01, half_length_m: 0.2 },
            Shape::Capsule { radius_m: 0.02, half_length_m: 0.1 },
        ];
        let mut apart = 0;
        for k in 0..60 {
            let f = |n: f64| (f64::from(k) * n).sin();
            let (a, b) = (shapes[k as usize % 4], shapes[(k as usize / 4) % 4]);
            let there =
                place(0.25 * f(1.3), 0.3 * f(2.1), 0.3 * f(3.7), [3.0 * f(0.7), 3.0 * f(5.1), 3.0 * f(4.3)]);
            let (a, b) =
                (Solid::new(&a, &place(0.0, 0.0, 0.0, [f(9.0), f(8.0), f(7.0)])), Solid::new(&b, &there));
            let ours = a.distance_m(&b) + a.radius_m + b.radius_m;
            if ours <= 0.0 {
                continue;
            }
            apart += 1;
            // Distance to a convex body is exact for a point, so sampling one of the two is enough.
            let to = |solid: &Solid, p: &Point3<f64>| {
                (Solid::point(*p).distance_m(solid) + solid.radius_m).max(0.0)
            };
            let searched = samples(&a.core).iter().map(|p| to(&b, p)).fold(f64::INFINITY, f64::min);
            assert!(ours <= searched + 1e-9 && searched - ours < 0.012, "{k}: {ours} {searched}");
        }
        assert!(apart > 20, "{apart}");
    }

    #[test]
    fn a_body_moved_by_its_depth_comes_free() {
        let cube = bar([0.1, 0.15, 0.05]);
        for k in 0..40 {
            let f = |n: f64| (f64::from(k) * n).sin();
            let turn = [3.0 * f(0.7), 3.0 * f(5.1), 3.0 * f(4.3)];
            let still = Solid::new(&cube, &place(0.0, 0.0, 0.0, [0.0; 3]));
            for shape in [bar([0.02, 0.1, 0.08]), Shape::Capsule { radius_m: 0.02, half_length_m: 0.1 }] {
                let at = Vector3::new(0.05 * f(1.3), 0.05 * f(2.1), 0.03 * f(3.7));
                let moved = |by: Vector3<f64>| {
                    let p = at + by;
                    Solid::new(&shape, &place(p.x, p.y, p.z, turn)).distance_m(&still)
                };
                let depth_m = -moved(Vector3::zeros());
                assert!(depth_m > 0.0);
                // Some direction frees it after the depth, none does much before.
                let directions = (0..4000).map(|i| {
                    let (h, a) = (2.0 * f64::from(i) / 3999.0 - 1.0, 2.399_963 * f64::from(i));
                    let r = (1.0 - h * h).sqrt();
                    Vector3::new(r * a.cos(), r * a.sin(), h)
                });
                let best =
                    directions.clone().map(|d| moved(d * (depth_m * 1.05 + 1e-3))).fold(f64::MIN, f64::max);
                assert!(best >= 0.0, "{k} {shape:?}: {best}");
                assert!(directions.map(|d| moved(d * depth_m * 0.9)).all(|distance| distance < 0.0));
            }
        }
    }
}
