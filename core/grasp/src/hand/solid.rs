//! Where a ray meets the simple shapes of a robot's description.

use nalgebra::Vector3;
use plumbline_model::robot::Shape;

/// Components of a direction that are smaller do not move a ray.
const PARALLEL: f64 = 1e-12;

/// Distance along a ray (unit `direction`, frame of the shape, m) at which it first meets the shape's
/// surface from outside, in front of its origin.
pub(super) fn meet(shape: &Shape, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    match *shape {
        Shape::Box { half_m } => meet_box(&half_m, origin, direction),
        Shape::Sphere { radius_m } => meet_sphere(radius_m, origin, direction),
        Shape::Capsule { radius_m, half_length_m } => {
            meet_capsule(radius_m, half_length_m, origin, direction)
        }
        Shape::Cylinder { radius_m, half_length_m } => {
            meet_cylinder(radius_m, half_length_m, origin, direction)
        }
    }
}

/// Radius (m) of the ball about the shape's origin that encloses it.
pub(super) fn enclosing_radius_m(shape: &Shape) -> f64 {
    match *shape {
        Shape::Box { half_m } => half_m.norm(),
        Shape::Sphere { radius_m } => radius_m,
        Shape::Capsule { radius_m, half_length_m } => radius_m + half_length_m,
        Shape::Cylinder { radius_m, half_length_m } => radius_m.hypot(half_length_m),
    }
}

fn meet_box(half: &Vector3<f64>, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        if direction[k].abs() < PARALLEL {
            if origin[k].abs() > half[k] {
                return None;
            }
            continue;
        }
        let (one, other) = ((-half[k] - origin[k]) / direction[k], (half[k] - origin[k]) / direction[k]);
        near = near.max(one.min(other));
        far = far.min(one.max(other));
    }
    (near <= far && near > 0.0).then_some(near)
}

fn meet_sphere(radius: f64, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let b = origin.dot(direction);
    let inside = b * b - origin.norm_squared() + radius * radius;
    let t = -b - inside.max(0.0).sqrt();
    (inside >= 0.0 && t > 0.0).then_some(t)
}

/// The side of an endless cylinder along z; `None` also for rays along it.
fn meet_side(radius: f64, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let a = direction.xy().norm_squared();
    if a < PARALLEL {
        return None;
    }
    let b = origin.xy().dot(&direction.xy());
    let inside = b * b - a * (origin.xy().norm_squared() - radius * radius);
    let t = (-b - inside.max(0.0).sqrt()) / a;
    (inside >= 0.0 && t > 0.0).then_some(t)
}

fn meet_capsule(radius: f64, half: f64, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let on_side = meet_side(radius, origin, direction);
    if let Some(t) = on_side.filter(|t| (origin.z + t * direction.z).abs() <= half) {
        return Some(t);
    }
    let end = |z: f64| meet_sphere(radius, &(origin - Vector3::z() * z), direction);
    nearer(end(half), end(-half))
}

fn meet_cylinder(radius: f64, half: f64, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let on_side = meet_side(radius, origin, direction);
    let on_side = on_side.filter(|t| (origin.z + t * direction.z).abs() <= half);
    let cap = |z: f64| {
        let t = (z - origin.z) / direction.z;
        let hits = t.is_finite() && t > 0.0 && (origin + direction * t).xy().norm() <= radius;
        hits.then_some(t)
    };
    nearer(on_side, nearer(cap(half), cap(-half)))
}

fn nearer(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (found, None) | (None, found) => found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_along_the_axes_meet_surfaces_where_they_are() {
        let shapes = [
            (Shape::Box { half_m: Vector3::new(0.01, 0.02, 0.03) }, [0.01, 0.02, 0.03]),
            (Shape::Sphere { radius_m: 0.02 }, [0.02; 3]),
            (Shape::Capsule { radius_m: 0.01, half_length_m: 0.03 }, [0.01, 0.01, 0.04]),
            (Shape::Cylinder { radius_m: 0.01, half_length_m: 0.03 }, [0.01, 0.01, 0.03]),
        ];
        for (shape, reach) in shapes {
            for k in 0..3 {
                for sign in [-1.0, 1.0] {
                    let mut origin = Vector3::zeros();
                    origin[k] = sign;
                    let t = meet(&shape, &origin, &-origin).expect("straight on it");
                    assert!((t - (1.0 - reach[k])).abs() < 1e-12, "{shape:?} {k}: {t}");
                    assert_eq!(meet(&shape, &origin, &origin), None, "it lies behind");
                    let mut beside = origin;
                    beside[(k + 1) % 3] += 0.05;
                    assert_eq!(meet(&shape, &beside, &-origin), None, "{shape:?} {k}");
                }
                assert!(enclosing_radius_m(&shape) >= reach[k]);
            }
        }
    }

    /// Rays at points of the surface end there or before, never behind; slanting ones too.
    #[test]
    fn what_is_met_lies_on_the_surface() {
        let shape = Shape::Capsule { radius_m: 0.01, half_length_m: 0.03 };
        let mut met = 0;
        for i in 0..200 {
            let a = f64::from(i) * 0.7;
            let origin = Vector3::new(a.cos(), a.sin(), 0.8 * (1.7 * a).sin());
            let aim = Vector3::new(0.02 * (3.1 * a).sin(), 0.02 * (2.3 * a).cos(), 0.05 * (5.0 * a).sin());
            let direction = (aim - origin).normalize();
            let Some(t) = meet(&shape, &origin, &direction) else { continue };
            let at = origin + direction * t;
            let axis = Vector3::new(0.0, 0.0, at.z.clamp(-0.03, 0.03));
            assert!(((at - axis).norm() - 0.01).abs() < 1e-9, "{at}");
            met += 1;
        }
        assert!(met > 30, "{met}");
    }
}
