//! Parts that scenes are made of: frames, eyes, table and touchscreen.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::scene::{Label3d, Line, Shape, Solid, Tint};

/// Thickness of slabs, in meters. Only for the eye.
const TABLE_THICKNESS_M: f64 = 0.03;
const SCREEN_THICKNESS_M: f64 = 0.008;

/// The axes of a frame as arrows, with their names: `x`, `y`, `z`, or what `names` says.
pub fn triad(
    robot_from_frame: &Isometry3<f64>,
    length_m: f64,
    names: [&str; 3],
) -> (Vec<Line>, Vec<Label3d>) {
    let origin = robot_from_frame * Point3::origin();
    let tip = |axis: Vector3<f64>, by: f64| robot_from_frame * Point3::from(axis * length_m * by);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let lines = axes.map(|axis| Line::arrow(origin, tip(axis, 1.0), Tint::Neutral)).to_vec();
    let labels = axes.into_iter().zip(names).map(|(axis, name)| Label3d {
        at_m: tip(axis, 1.25),
        text: name.to_owned(),
        tint: Tint::Neutral,
    });
    (lines, labels.collect())
}

/// The cone that an eye sees, as lines from its optical center. The camera's frame has OpenCV
/// axes: z along the optical axis. `half_angle_rad` is from the axis to the rim, less than π.
pub fn eye_frustum(
    robot_from_camera: &Isometry3<f64>,
    half_angle_rad: f64,
    range_m: f64,
    tint: Tint,
) -> Vec<Line> {
    const RIM: usize = 48;
    const SPOKES: usize = 4;
    let center = robot_from_camera * Point3::origin();
    let (sin, cos) = half_angle_rad.sin_cos();
    let rim = |i: usize, of: usize| {
        let (v, u) = ((i as f64 + 0.5) / of as f64 * std::f64::consts::TAU).sin_cos();
        robot_from_camera * Point3::new(range_m * sin * u, range_m * sin * v, range_m * cos)
    };
    let axis_end = robot_from_camera * Point3::new(0.0, 0.0, range_m);
    let circle = Line::new((0..=RIM).map(|i| rim(i, RIM)).collect(), tint).width(1.25);
    let spokes = (0..SPOKES).map(|i| Line::new(vec![center, rim(i, SPOKES)], tint).width(1.25));
    let axis = Line::arrow(center, axis_end, tint).width(1.0);
    std::iter::once(circle).chain(spokes).chain(std::iter::once(axis)).collect()
}

/// The table: a slab whose top is at `top_z_m`.
pub fn table_slab(x_m: [f64; 2], y_m: [f64; 2], top_z_m: f64) -> Solid {
    let middle = |[low, high]: [f64; 2]| (low + high) / 2.0;
    let size_m = [x_m[1] - x_m[0], y_m[1] - y_m[0], TABLE_THICKNESS_M];
    let at = Translation3::new(middle(x_m), middle(y_m), top_z_m - TABLE_THICKNESS_M / 2.0);
    Solid::new(Shape::Box { size_m }, at.into(), Tint::Table)
}

/// The touchscreen. Its frame has the origin in the middle of the glass, z out of it, x and y
/// along its edges; `size_m` is along x and y.
pub fn screen_slab(robot_from_screen: &Isometry3<f64>, size_m: [f64; 2]) -> Solid {
    let below = Translation3::new(0.0, 0.0, -SCREEN_THICKNESS_M / 2.0);
    let shape = Shape::Box { size_m: [size_m[0], size_m[1], SCREEN_THICKNESS_M] };
    Solid::new(shape, robot_from_screen * below, Tint::Screen)
}

/// A capsule from one point to another: how a limb is drawn when there is no mesh of it.
pub fn limb(from_m: Point3<f64>, to_m: Point3<f64>, radius_m: f64, tint: Tint) -> Solid {
    let along = to_m - from_m;
    // Points that coincide have no direction; any will do for a sphere.
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    let middle = Translation3::from(nalgebra::center(&from_m, &to_m));
    let shape = Shape::Capsule { radius_m, length_m: along.norm() };
    Solid::new(shape, Isometry3::from_parts(middle, turn), tint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limb_ends_where_it_should() {
        for to in [[0.3, -0.2, 0.5], [0.1, 0.2, -0.7], [0.1, 0.2, 0.3]] {
            let (from, to) = (Point3::new(0.1, 0.2, 0.3), Point3::from(to));
            let solid = limb(from, to, 0.02, Tint::Measured);
            let Shape::Capsule { length_m, .. } = solid.shape else { panic!("a capsule") };
            let end = |side: f64| solid.robot_from_shape * Point3::new(0.0, 0.0, side * length_m / 2.0);
            assert!((end(-1.0) - from).norm() < 1e-12 && (end(1.0) - to).norm() < 1e-12);
        }
    }

    #[test]
    fn a_frustum_opens_along_the_optical_axis() {
        let robot_from_camera = Isometry3::translation(0.1, 0.0, 0.4);
        let lines = eye_frustum(&robot_from_camera, 0.5, 0.2, Tint::Measured);
        let axis = Vector3::z();
        for point in &lines[0].points_m {
            let ray = point - Point3::new(0.1, 0.0, 0.4);
            assert!((ray.norm() - 0.2).abs() < 1e-12 && (ray.angle(&axis) - 0.5).abs() < 1e-9);
        }
    }

    #[test]
    fn slabs_have_their_upper_side_where_it_is_given() {
        let table = table_slab([0.0, 0.8], [-0.6, 0.6], 0.054);
        assert!((table.robot_from_shape.translation.z + TABLE_THICKNESS_M / 2.0 - 0.054).abs() < 1e-12);
        let screen = screen_slab(&Isometry3::translation(0.4, 0.0, 0.062), [0.475, 0.267]);
        assert!((screen.robot_from_shape.translation.z + SCREEN_THICKNESS_M / 2.0 - 0.062).abs() < 1e-12);
    }
}
