//! The scene: robot, table, screen, eyes, toys and board as solids and lines.

use egui::Color32;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plumbline_engine::View;
use plumbline_engine::view::{MotionState, RobotView};
use plumbline_model::Chessboard;
use plumbline_model::robot::{self as model, Description, JointIndex, JointKind, LinkIndex, Posture, Rig};
use plumbline_widgets::scene3d::{
    Dot, Grid, Label3d, Line, PickId, Scene, Shape, Solid, Tint, eye_frustum, screen_slab, table_slab, triad,
};
use plumbline_widgets::{class_color, class_words};

use super::state::RobotPanels;

/// Encoders flicker by a tick; a picture drawn anew for that costs time and shows nothing. Rad.
const STILL_RAD: f64 = 0.0015;
/// The same for things that stand on the table, m.
const STILL_M: f64 = 0.0005;
/// A link that the ghost has nearer than this to where it is is not drawn twice, m and rad.
const SAME: (f64, f64) = (0.001, 0.004);
/// The cone drawn for an eye says where it looks, not all that it sees.
const EYE_CONE: (f64, f64) = (0.22, 0.16);
const BOARD_THICKNESS_M: f64 = 0.004;
/// Picks from here on are toys, below are joints.
const TOYS_FROM: u64 = 1000;

/// What a pick stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thing {
    /// The joint that carries the part.
    Joint(JointIndex),
    /// A toy by its place in the list.
    Toy(usize),
}

/// What was picked.
pub fn thing(id: PickId) -> Thing {
    match id.0.checked_sub(TOYS_FROM) {
        Some(toy) => Thing::Toy(toy as usize),
        None => Thing::Joint(JointIndex(id.0 as usize)),
    }
}

/// Whether a part of the robot was picked.
pub fn is_part_of_robot(id: PickId) -> bool {
    matches!(thing(id), Thing::Joint(_))
}

/// Everything there is to see; empty until the joints were read once.
///
/// `names` false leaves the names of the toys out, where there is no room for them.
/// `ghost` is a posture to be shown while no move is.
pub fn scene(view: &View, panels: &RobotPanels, ghost: Option<&Posture>, names: bool) -> Scene {
    let mut scene = Scene::default();
    let robot = &view.robot;
    let (Some(rig), Some(measured)) = (&robot.rig, &robot.measured) else { return scene };
    if measured.len() != rig.description.movable_count() {
        return scene;
    }
    let measured = steadied(measured);
    table(&mut scene, rig);
    body(&mut scene, robot, rig, &measured, panels.chosen_joint);
    if let Some(goal) = ghost_posture(view, ghost, &rig.description) {
        draw_ghost(&mut scene, rig, &measured, goal);
    }
    eyes(&mut scene, rig, &measured);
    if view.twin.running {
        toys(&mut scene, view, names);
        if let Some(pose) = &view.twin.board {
            board(&mut scene, &pose.isometry, &view.eyes.board);
        }
    }
    objects(&mut scene, view, names);
    tip(&mut scene, view);
    if let Some(at_m) = panels.chosen_point_m {
        scene.dots.push(Dot { at_m, radius: 5.0, tint: Tint::Selected });
    }
    scene
}

/// What the detector places: where it can be by two standard deviations and, where there is room, its name. Rings, not a
/// body: it is no thing, and must not hide one.
fn objects(scene: &mut Scene, view: &View, names: bool) {
    if view.detect.stale.is_some() {
        return;
    }
    let objects = view.detect.found.iter().flat_map(|found| &found.objects);
    for object in objects {
        let Ok(place) = object.best_place() else { continue };
        let at_m = steadied_m(&place.point_in_robot.coords);
        let tint = Tint::Object(class_color(&object.name, object.class.0));
        if let Some((radii_m, turn)) = two_sigma(&place.covariance_m2) {
            let pose = Isometry3::from_parts(Translation3::from(at_m.coords), turn);
            scene.lines.extend(rings(radii_m).map(|ring_m| {
                Line::new(ring_m.into_iter().map(|p_m| pose * p_m).collect(), tint).width(1.0)
            }));
        }
        scene.dots.push(Dot { at_m, radius: 3.5, tint });
        if names {
            scene.labels.push(Label3d { at_m, text: class_words(&object.name).to_owned(), tint });
        }
    }
}

/// Half axes of the ellipsoid of two standard deviations, and how it is turned. Known too well to
/// be seen, it is drawn a little larger.
fn two_sigma(covariance_m2: &Matrix3<f64>) -> Option<([f64; 3], UnitQuaternion<f64>)> {
    const SEEN_FROM_M: f64 = 0.003;
    const SEEN_TO_M: f64 = 0.3;
    if !covariance_m2.iter().all(|c| c.is_finite()) {
        return None;
    }
    let parts = plumbline_model::decompose::symmetric_eigen(*covariance_m2)?;
    let radii_m = [0, 1, 2].map(|i| (2.0 * parts.eigenvalues[i].max(0.0).sqrt()).max(SEEN_FROM_M));
    if radii_m.iter().any(|radius_m| *radius_m > SEEN_TO_M) {
        // An ellipsoid larger than the table hides everything and says no more than the list does.
        return None;
    }
    let mut axes = parts.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Some((radii_m, turn))
}

/// The three outlines of an ellipsoid around its axes, about its middle.
fn rings([a_m, b_m, c_m]: [f64; 3]) -> [Vec<Point3<f64>>; 3] {
    const CORNERS: usize = 48;
    let around = |at: fn(f64, f64) -> [f64; 3]| {
        let corner = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / CORNERS as f64).sin_cos();
            let [x, y, z] = at(cos, sin);
            Point3::new(a_m * x, b_m * y, c_m * z)
        };
        (0..=CORNERS).map(corner).collect()
    };
    [around(|u, v| [u, v, 0.0]), around(|u, v| [u, 0.0, v]), around(|u, v| [0.0, u, v])]
}

fn steadied(posture: &Posture) -> Posture {
    let steps = posture.angles_rad().iter().map(|angle| (angle / STILL_RAD).round() * STILL_RAD);
    Posture::new(steps.collect())
}

fn steadied_m(at_m: &Point3<f64>) -> Point3<f64> {
    at_m.map(|c| (c / STILL_M).round() * STILL_M)
}

/// Where the robot would be: the shown move, else the goal of the one that runs.
fn ghost_posture<'a>(
    view: &'a View,
    otherwise: Option<&'a Posture>,
    description: &Description,
) -> Option<&'a Posture> {
    let robot = &view.robot;
    let moving = matches!(robot.motion, MotionState::Moving { .. });
    let posture = match &robot.preview {
        Some(preview) => Some(&preview.end),
        None if moving => robot.commanded.as_ref(),
        None => otherwise,
    };
    posture.filter(|posture| posture.len() == description.movable_count() && posture.is_finite())
}

fn table(scene: &mut Scene, rig: &Rig) {
    let top = rig.table;
    scene.grid = Some(Grid { z_m: top.height_m, x_m: [0.0, 0.6], y_m: [-0.4, 0.4], step_m: 0.1 });
    scene.solids.push(table_slab(top.x_range_m, top.y_range_m, top.height_m));
    let screen = &rig.touchscreen;
    let (u, v) = (screen.u_axis.vector(), screen.v_axis.vector());
    let middle = screen.origin.coords + u * (screen.width_m / 2.0) + v * (screen.height_m / 2.0);
    // Out of the glass is up where u grows to the robot's right and v toward it.
    let (x, y) = (u, -v);
    let axes = Rotation3::from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let turn = UnitQuaternion::from_rotation_matrix(&axes);
    let pose = Isometry3::from_parts(Translation3::from(middle.coords), turn);
    scene.solids.push(screen_slab(&pose, [screen.width_m, screen.height_m]));
}

/// What hangs on a joint that is not known is drawn where it was last seen, colorless, and says so.
fn body(scene: &mut Scene, robot: &RobotView, rig: &Rig, posture: &Posture, chosen: Option<JointIndex>) {
    let description = &rig.description;
    let poses = description.forward(posture);
    let mut said = false;
    for (i, link) in description.links().iter().enumerate() {
        let joint = carrying_joint(description, LinkIndex(i));
        let is_chosen = chosen.is_some() && joint == chosen;
        let is_unknown = hangs_on(description, LinkIndex(i), &robot.unknown);
        if is_unknown && !std::mem::replace(&mut said, true) {
            let at_m = Point3::from(poses.all()[i].translation.vector);
            scene.labels.push(Label3d { at_m, text: "not known".to_owned(), tint: Tint::Neutral });
        }
        for visual in &link.visuals {
            let at = poses.all()[i] * visual.link_from_shape;
            let tint = match (is_chosen, is_unknown) {
                (true, _) => Tint::Selected,
                (_, true) => Tint::Neutral,
                _ => Tint::Measured,
            };
            let solid = Solid::new(shape(&visual.shape), at, tint);
            scene.solids.push(match joint {
                Some(joint) => solid.pick(PickId(joint.0 as u64)),
                None => solid,
            });
        }
    }
}

/// Only what would be elsewhere: a ghost inside of the body it belongs to would flicker.
fn draw_ghost(scene: &mut Scene, rig: &Rig, measured: &Posture, goal: &Posture) {
    let description = &rig.description;
    let (now, then) = (description.forward(measured), description.forward(goal));
    for (i, link) in description.links().iter().enumerate() {
        let by = now.all()[i].inverse() * then.all()[i];
        if by.translation.vector.norm() < SAME.0 && by.rotation.angle() < SAME.1 {
            continue;
        }
        for visual in &link.visuals {
            let at = then.all()[i] * visual.link_from_shape;
            scene.solids.push(Solid::new(shape(&visual.shape), at, Tint::Ghost));
        }
    }
}

/// Whether one of some joints is between the base and a link.
fn hangs_on(description: &Description, mut link: LinkIndex, joints: &[JointIndex]) -> bool {
    while let (Some(joint), Some(above)) = (carrying_joint(description, link), description.joint_above(link))
    {
        if joints.contains(&joint) {
            return true;
        }
        link = above.parent;
    }
    false
}

/// The nearest joint above a link that moves by itself.
fn carrying_joint(description: &Description, link: LinkIndex) -> Option<JointIndex> {
    let mut link = link;
    loop {
        let joint = description.joint_above(link)?;
        match &joint.kind {
            JointKind::Revolute { index, .. } => return Some(*index),
            JointKind::Coupled { mimic, .. } => return Some(mimic.source),
            JointKind::Fixed => link = joint.parent,
        }
    }
}

fn shape(shape: &model::Shape) -> Shape {
    match *shape {
        model::Shape::Box { half_m } => {
            Shape::Box { size_m: [half_m.x * 2.0, half_m.y * 2.0, half_m.z * 2.0] }
        }
        model::Shape::Sphere { radius_m } => Shape::Ellipsoid { radii_m: [radius_m; 3] },
        model::Shape::Capsule { radius_m, half_length_m } => {
            Shape::Capsule { radius_m, length_m: 2.0 * half_length_m }
        }
        model::Shape::Cylinder { radius_m, half_length_m } => {
            Shape::Cylinder { radius_m, length_m: 2.0 * half_length_m }
        }
    }
}

fn eyes(scene: &mut Scene, rig: &Rig, posture: &Posture) {
    let robot_from_left = rig.robot_from_left(posture);
    let robot_from_right = robot_from_left * rig.eyes.cameras.right_from_left.inverse();
    let (half_angle_rad, range_m) = EYE_CONE;
    for eye in [robot_from_left.isometry, robot_from_right.isometry] {
        scene.lines.extend(eye_frustum(&eye, half_angle_rad, range_m, Tint::Neutral));
    }
}

fn toys(scene: &mut Scene, view: &View, names: bool) {
    for (i, toy) in view.twin.toys.iter().enumerate() {
        let Some(place) = toy.place else { continue };
        let at = steadied_m(&place.coords);
        let [r, g, b] = toy.rgb;
        let shape = Shape::Ellipsoid { radii_m: [toy.radius_m; 3] };
        let solid =
            Solid::new(shape, Translation3::from(at.coords).into(), Tint::Object(Color32::from_rgb(r, g, b)));
        scene.solids.push(solid.pick(PickId(TOYS_FROM + i as u64)));
        if !names {
            continue;
        }
        let above = at + Vector3::z() * (toy.radius_m + 0.02);
        scene.labels.push(Label3d { at_m: above, text: toy.name.clone(), tint: Tint::Neutral });
    }
}

/// A white slab with its dark squares, so that its sides can be told apart.
fn board(scene: &mut Scene, robot_from_board: &Isometry3<f64>, board: &Chessboard) {
    let side = board.square_m;
    let (columns, rows) = board.squares();
    let middle = |count: u32| (f64::from(count) / 2.0 - 1.0) * side;
    // The origin is the first inner corner; the board lies behind its face, along z.
    let slab = Translation3::new(middle(columns), middle(rows), BOARD_THICKNESS_M / 2.0);
    let size_m = [f64::from(columns) * side, f64::from(rows) * side, BOARD_THICKNESS_M];
    let white = Tint::Object(Color32::from_gray(235));
    scene.solids.push(Solid::new(Shape::Box { size_m }, robot_from_board * slab, white));
    let dark = Tint::Object(Color32::from_gray(28));
    for column in 0..columns {
        for row in (0..rows).filter(|row| (row + column) % 2 == 0) {
            let at = |i: u32| (f64::from(i) - 0.5) * side;
            let place = robot_from_board * Translation3::new(at(column), at(row), -0.0006);
            let size_m = [side, side, 0.0008];
            scene.solids.push(Solid::new(Shape::Box { size_m }, place, dark));
        }
    }
}

fn tip(scene: &mut Scene, view: &View) {
    let robot = &view.robot;
    let trail: Vec<Point3<f64>> = robot.trail.iter().map(|point| steadied_m(&point.coords)).collect();
    if trail.len() >= 2 {
        scene.lines.push(Line::trail(trail, Tint::Measured));
    }
    let Some(place) = &robot.tip_place else { return };
    let at = steadied_m(&place.point.coords);
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), (place.yaw_rad / 0.02).round() * 0.02);
    let (lines, _) = triad(&Isometry3::from_parts(Translation3::from(at.coords), yaw), 0.05, ["x", "y", "z"]);
    scene.lines.extend(lines);
    scene.dots.push(Dot { at_m: at, radius: 3.5, tint: Tint::Measured });
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{PathCheck, Preview, RobotView};

    use super::*;

    fn nico() -> (Arc<Rig>, View) {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let robot = RobotView {
            measured: Some(rig.description.rest()),
            rig: Some(rig.clone()),
            ..RobotView::default()
        };
        (rig, View { robot: Arc::new(robot), ..View::default() })
    }

    #[test]
    fn nothing_is_drawn_before_the_joints_were_read() {
        let (_, mut view) = nico();
        let robot = RobotView { measured: None, ..(*view.robot).clone() };
        view.robot = Arc::new(robot);
        assert!(scene(&view, &RobotPanels::default(), None, true).is_empty());
    }

    #[test]
    fn the_ghost_has_only_what_would_move() {
        let (rig, mut view) = nico();
        let elbow = rig.description.find_joint("r_elbow_y").expect("of this robot");
        let end = rig.description.rest().with(&[elbow], &[1.5]);
        let preview = Preview {
            title: "right elbow to 86°".to_owned(),
            end,
            path: Ok(PathCheck { smallest_m: 0.1, between: String::new() }),
            duration: std::time::Duration::from_secs(1),
            largest_turn: None,
            model: "as described".into(),
            tip_sigma_m: None,
        };
        view.robot = Arc::new(RobotView { preview: Some(preview), ..(*view.robot).clone() });
        let scene = scene(&view, &RobotPanels::default(), None, true);
        let ghosts = scene.solids.iter().filter(|solid| solid.tint == Tint::Ghost).count();
        let all: usize = rig.description.links().iter().map(|link| link.visuals.len()).sum();
        assert!(ghosts > 0 && ghosts < all / 2, "{ghosts} of {all}");
        assert_eq!(scene.left_out(), 0);
    }

    #[test]
    fn parts_are_picked_as_the_joint_that_moves_them() {
        let (rig, view) = nico();
        let picks: Vec<Thing> = scene(&view, &RobotPanels::default(), None, true)
            .solids
            .iter()
            .filter_map(|s| Some(thing(s.pick?)))
            .collect();
        let elbow = rig.description.find_joint("r_elbow_y").expect("of this robot");
        assert!(picks.contains(&Thing::Joint(elbow)));
        assert_eq!(thing(PickId(TOYS_FROM + 2)), Thing::Toy(2));
    }

    #[test]
    fn a_flicker_of_one_tick_is_the_same_picture() {
        let posture = Posture::new(vec![0.3, -0.2]);
        let flicker = Posture::new(vec![0.3 + 0.0003, -0.2]);
        assert_eq!(steadied(&posture), steadied(&flicker));
    }
}
