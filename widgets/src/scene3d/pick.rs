//! What is under the pointer.

use nalgebra::{Point3, Vector3};

use super::camera::{NEAR_M, Ray};
use super::facets::form;
use super::scene::{Grid, PickId, Scene, Solid};

/// Fine enough to click on, in pixels of radius.
const FINENESS_PX: f32 = 30.0;

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// The thing, if it has an id.
    pub pick: Option<PickId>,
    /// From the camera through the pointer, in the robot's frame.
    pub ray: Ray,
    /// Where it meets a surface or the plane of the grid, in the robot's frame; `None` in the void.
    pub point_m: Option<Point3<f64>>,
}

/// The nearest thing along a ray. Ghosts without an id let it through.
pub(super) fn pick(scene: &Scene, ray: Ray) -> Picked {
    let solids = scene.solids.iter().filter(|solid| !solid.tint.is_ghost() || solid.pick.is_some());
    let hits = solids.filter_map(|solid| Some((range_m(solid, &ray)?, solid.pick)));
    let ground = scene.grid.filter(Grid::is_drawable).and_then(|grid| plane_range_m(&grid, &ray));
    let nearest = hits.chain(ground.map(|range_m| (range_m, None))).min_by(|a, b| a.0.total_cmp(&b.0));
    Picked {
        pick: nearest.and_then(|(_, pick)| pick),
        ray,
        point_m: nearest.map(|(range_m, _)| ray.origin_m + ray.direction * range_m),
    }
}

fn range_m(solid: &Solid, ray: &Ray) -> Option<f64> {
    if !solid.is_drawable() || !meets_sphere(solid, ray) {
        return None;
    }
    let shape_from_robot = solid.robot_from_shape.inverse();
    let origin = (shape_from_robot * ray.origin_m).cast::<f32>();
    let direction = (shape_from_robot * ray.direction).cast::<f32>();
    let form = form(&solid.shape, FINENESS_PX);
    let at = |i: u32| form.position(&form.facets.positions[i as usize]);
    let hits = form
        .facets
        .triangles
        .iter()
        .filter_map(|&[a, b, c]| triangle_range(&origin, &direction, [at(a), at(b), at(c)]));
    hits.map(f64::from).filter(|range| *range > NEAR_M).min_by(f64::total_cmp)
}

fn meets_sphere(solid: &Solid, ray: &Ray) -> bool {
    let to_center = solid.robot_from_shape.translation.vector - ray.origin_m.coords;
    let along = to_center.dot(&ray.direction);
    let radius_m = solid.shape.bounding_radius_m();
    (to_center - ray.direction * along).norm() <= radius_m && along + radius_m > 0.0
}

/// Where a ray meets a triangle (Möller and Trumbore, 1997), from either side.
fn triangle_range(
    origin: &Point3<f32>,
    direction: &Vector3<f32>,
    [a, b, c]: [Point3<f32>; 3],
) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(&ac);
    let determinant = ab.dot(&p);
    if determinant.abs() < 1e-14 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(&p) / determinant;
    let q = from_a.cross(&ab);
    let v = direction.dot(&q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ac.dot(&q) / determinant)
}

fn plane_range_m(grid: &Grid, ray: &Ray) -> Option<f64> {
    let range_m = (grid.z_m - ray.origin_m.z) / ray.direction.z;
    if !(range_m.is_finite() && range_m > NEAR_M) {
        return None;
    }
    let at = ray.origin_m + ray.direction * range_m;
    let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    (within(grid.x_m, at.x) && within(grid.y_m, at.y)).then_some(range_m)
}
