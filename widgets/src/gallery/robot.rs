//! Pages with the robot: the scene, joints, jogging, poses.

use egui::{Color32, Ui, vec2};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::GalleryState;
use crate::empty::Message;
use crate::scene3d::{
    Dot, Grid, Label3d, Line, PickId, Scene, Scene3d, Shape, Solid, Tint, eye_frustum, limb, screen_slab,
    table_slab,
};
use crate::theme::{self, space};

const TABLE_Z_M: f64 = 0.054;
/// Shoulder, elbow, wrist and palm of the right arm, meters.
type Arm = [[f64; 3]; 4];
const PRESENT: Arm = [[-0.02, -0.14, 0.25], [0.07, -0.24, 0.15], [0.20, -0.20, 0.19], [0.285, -0.165, 0.165]];
const NEXT: Arm = [[-0.02, -0.14, 0.25], [0.10, -0.23, 0.14], [0.26, -0.13, 0.20], [0.345, -0.075, 0.165]];
const LEFT: Arm = [[-0.02, 0.14, 0.25], [0.05, 0.25, 0.14], [0.19, 0.22, 0.13], [0.28, 0.18, 0.11]];

/// A robot at its table, with a preview of a reach or without.
pub(crate) fn robot_scene(preview: bool) -> Scene {
    let mut scene = Scene { grid: Some(Grid::table(TABLE_Z_M)), ..Scene::default() };
    scene.solids.push(table_slab([0.12, 0.72], [-0.55, 0.55], TABLE_Z_M));
    let robot_from_screen = Isometry3::translation(0.405, 0.0, TABLE_Z_M + 0.008);
    scene.solids.push(screen_slab(&robot_from_screen, [0.267, 0.475]));
    body(&mut scene);
    arm(&mut scene, &PRESENT, Tint::Measured, 10);
    arm(&mut scene, &LEFT, Tint::Measured, 20);
    objects(&mut scene);
    if preview {
        arm(&mut scene, &NEXT, Tint::Ghost, 30);
        scene.lines.push(Line::arrow(above_palm(&PRESENT), above_palm(&NEXT), Tint::Predicted));
    }
    let trail = (0..60).map(|i| {
        let t = f64::from(i) / 59.0;
        let [x, y, z] = PRESENT[3];
        Point3::new(x - 0.02 + 0.02 * t, y + 0.20 * (1.0 - t), z + 0.06 * (3.0 * (1.0 - t)).sin())
    });
    scene.lines.push(Line::trail(trail.collect(), Tint::Measured));
    for (i, y) in [-0.12, -0.04, 0.04].into_iter().enumerate() {
        let at_m = Point3::new(0.36 + 0.03 * i as f64, y, TABLE_Z_M + 0.01);
        scene.dots.push(Dot { at_m, radius: 4.0, tint: Tint::Measured });
    }
    scene
}

fn above_palm(arm: &Arm) -> Point3<f64> {
    Point3::from(arm[3]) + Vector3::new(0.0, 0.0, 0.06)
}

fn at(p: [f64; 3]) -> Point3<f64> {
    Point3::from(p)
}

fn body(scene: &mut Scene) {
    let mut part = |shape, place: Isometry3<f64>| {
        scene.solids.push(Solid::new(shape, place, Tint::Neutral).pick(PickId(1)));
    };
    let still = |x, y, z| Translation3::new(x, y, z).into();
    part(Shape::Box { size_m: [0.11, 0.19, 0.26] }, still(-0.03, 0.0, 0.13));
    part(Shape::Cylinder { radius_m: 0.032, length_m: 0.1 }, still(-0.025, 0.0, 0.30));
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.5);
    let head = Isometry3::from_parts(Translation3::new(0.005, 0.0, 0.41), tilt);
    part(Shape::Ellipsoid { radii_m: [0.085, 0.08, 0.09] }, head);
    scene.solids.push(limb(at([-0.02, -0.13, 0.25]), at([-0.02, 0.13, 0.25]), 0.038, Tint::Neutral));
    for y in [-0.035, 0.035] {
        // OpenCV axes: z along the optical axis, 30° down.
        let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_6);
        let axes = UnitQuaternion::from_euler_angles(
            -std::f64::consts::FRAC_PI_2,
            0.0,
            -std::f64::consts::FRAC_PI_2,
        );
        let eye = Isometry3::from_parts(Translation3::new(0.077, y, 0.415), down * axes);
        let ball = Shape::Ellipsoid { radii_m: [0.019; 3] };
        scene.solids.push(Solid::new(ball, eye * Translation3::new(0.0, 0.0, -0.01), Tint::Screen));
        scene.lines.extend(eye_frustum(&eye, 0.55, 0.16, Tint::Measured));
    }
    scene.labels.push(Label3d { at_m: at([0.005, 0.0, 0.53]), text: "eyes".into(), tint: Tint::Neutral });
}

fn arm(scene: &mut Scene, arm: &Arm, tint: Tint, id: u64) {
    let [shoulder, elbow, wrist, palm] = arm.map(at);
    let joints = [(shoulder, 0.044), (elbow, 0.036), (wrist, 0.030)];
    for (i, (place, radius_m)) in joints.into_iter().enumerate() {
        let ball = Shape::Ellipsoid { radii_m: [radius_m; 3] };
        let place = Translation3::from(place.coords).into();
        scene.solids.push(Solid::new(ball, place, tint).pick(PickId(id + i as u64)));
    }
    for (i, (from, to, radius_m)) in
        [(shoulder, elbow, 0.034), (elbow, wrist, 0.029), (wrist, palm, 0.026)].into_iter().enumerate()
    {
        scene.solids.push(limb(from, to, radius_m, tint).pick(PickId(id + i as u64)));
    }
    let forward = (palm - wrist).normalize();
    let aside = forward.cross(&Vector3::z()).normalize();
    for i in 0..3 {
        let base = palm + aside * (0.018 * f64::from(i - 1)) + forward * 0.018;
        let bend = base + forward * 0.034 - Vector3::z() * 0.008;
        let tip = bend + forward * 0.020 - Vector3::z() * 0.024;
        scene.solids.push(limb(base, bend, 0.0085, tint));
        scene.solids.push(limb(bend, tip, 0.0078, tint));
    }
    let thumb = palm - aside * 0.026;
    scene.solids.push(limb(thumb, thumb + forward * 0.03 - Vector3::z() * 0.022, 0.0085, tint));
}

fn objects(scene: &mut Scene) {
    let mut thing = |radii_m: [f64; 3], place: [f64; 3], color, id| {
        let solid = Solid::new(
            Shape::Ellipsoid { radii_m },
            Translation3::from(Point3::from(place).coords).into(),
            Tint::Object(color),
        );
        scene.solids.push(solid.pick(PickId(id)));
    };
    thing([0.029, 0.029, 0.026], [0.40, -0.05, TABLE_Z_M + 0.034], Color32::from_rgb(206, 58, 44), 100);
    thing([0.034, 0.034, 0.034], [0.33, 0.27, TABLE_Z_M + 0.034], Color32::from_rgb(232, 140, 40), 101);
    thing([0.022, 0.060, 0.020], [0.52, 0.10, TABLE_Z_M + 0.028], Color32::from_rgb(226, 196, 62), 102);
    let label =
        Label3d { at_m: at([0.40, -0.05, TABLE_Z_M + 0.085]), text: "tomato".into(), tint: Tint::Neutral };
    scene.labels.push(label);
}

pub(super) fn scene(ui: &mut Ui, state: &mut GalleryState) {
    let scene = robot_scene(true);
    let size = vec2(ui.available_width(), 560.0);
    let shown = Scene3d::new("Robot scene", &scene).size(size).show(ui, &mut state.camera);
    if let Some(picked) = shown.clicked {
        let name =
            picked.pick.map_or_else(|| "nothing with a name".to_owned(), |id| format!("part {}", id.0));
        state.last =
            format!("clicked {name}, point {}", if picked.point_m.is_some() { "known" } else { "none" });
    }
    state.renders = shown.stats.renders;
    ui.add_space(space::S);
    let ms = crate::format::ms(shown.stats.last.as_secs_f64());
    ui.label(theme::small(ui, format!("last: {}; picture made in {ms}", state.last)));
}

pub(super) fn scene_states(ui: &mut Ui, state: &mut GalleryState) {
    let mut broken = robot_scene(false);
    broken.solids.push(Solid::new(
        Shape::Box { size_m: [0.1; 3] },
        Isometry3::translation(f64::NAN, 0.0, 0.0),
        Tint::Measured,
    ));
    let half = vec2((ui.available_width() - space::S) / 2.0, 350.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        let empty = Scene { grid: Some(Grid::table(TABLE_Z_M)), ..Scene::default() };
        let start = Message::new("No robot yet", "Start the twin, or connect the robot on its desk.");
        let shown = Scene3d::new("Empty scene", &empty).size(half).empty(start.button("Start the twin"));
        if shown.show(ui, &mut state.other_cameras[0]).button_clicked {
            state.last = "start twin".to_owned();
        }
        let old = Scene3d::new("Robot, old", &broken).size(half);
        let old = old.stale(Some("4 s old: servo 31 does not answer; the arm is held"));
        old.show(ui, &mut state.other_cameras[1]);
    });
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        for (i, name, preset) in [
            (2, "From above", crate::scene3d::ViewPreset::Top),
            (3, "What the robot sees", crate::scene3d::ViewPreset::Robot),
        ] {
            if !state.places_chosen[i - 2] {
                state.other_cameras[i] = crate::scene3d::SceneCamera::preset(preset);
                state.places_chosen[i - 2] = true;
            }
            Scene3d::new(name, &robot_scene(true)).size(half).show(ui, &mut state.other_cameras[i]);
        }
    });
}
