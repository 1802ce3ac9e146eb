//! A made-up place in the proportions of the robot's lab: table, glass, arms, toys, walls. For tests
//! and for measuring speed; nothing here is measured, and the simulation does not use it.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::{Camera, CameraModel, Chessboard, Fisheye, Pose};

use crate::scene::{BodyIndex, Item, Light, Material, Pattern, Scenery, Shape, Snapshot, TrueEyes};

/// Height of the table's top in the robot frame, meters.
pub const TABLE_M: f64 = 0.05;
/// Object of the right hand and of the left hand.
pub const HANDS: [u16; 2] = [7, 8];

/// Eyes with numbers like the published ones, looking down by an angle.
pub fn eyes(down_rad: f64) -> TrueEyes {
    let lens = |fx_px, fy_px, cx_px, cy_px, skew_px, k| Camera {
        model: CameraModel::Fisheye(Fisheye { fx_px, fy_px, cx_px, cy_px, skew_px, k }),
        width_px: 640,
        height_px: 480,
    };
    // Camera axes right, down, forward in the robot's forward, left, up.
    let level = UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(
        nalgebra::Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0),
    ));
    let pitch = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), down_rad);
    let middle = Vector3::new(-0.025, 0.0, 0.335) + pitch * Vector3::new(0.08, 0.0, 0.095);
    let robot_from_left =
        Isometry3::from_parts(Translation3::from(middle + Vector3::new(0.0, 0.035, 0.0)), pitch * level);
    let right_from_left =
        Isometry3::new(Vector3::new(-0.0699, -0.0003, -0.001), Vector3::new(0.0035, -0.0089, 0.0057));
    TrueEyes {
        robot_from_left: Pose::new(robot_from_left),
        robot_from_right: Pose::new(robot_from_left * right_from_left.inverse()),
        left: lens(150.68, 150.71, 321.3, 238.1, -0.075, [-0.0084, -0.0080, 0.0017, -0.00026]),
        right: lens(150.99, 150.92, 322.6, 235.3, -0.046, [-0.0110, -0.0066, 0.0021, -0.00023]),
    }
}

/// Collects items of one body.
struct Builder {
    items: Vec<Item>,
}

impl Builder {
    fn add(&mut self, object: u16, at: Isometry3<f64>, shape: Shape, material: Material) {
        self.items.push(Item { object, body: BodyIndex(0), body_from_shape: at, shape, material });
    }

    fn cuboid(&mut self, center: [f64; 3], half: [f64; 3], material: Material) {
        let [x, y, z] = center;
        self.add(0, Isometry3::translation(x, y, z), Shape::Box { half_m: half.into() }, material);
    }

    fn ball(&mut self, object: u16, center: [f64; 3], radii: [f64; 3], material: Material) {
        let [x, y, z] = center;
        self.add(
            object,
            Isometry3::translation(x, y, z),
            Shape::Ellipsoid { radii_m: radii.into() },
            material,
        );
    }

    /// A capsule from one place to another.
    fn bone(&mut self, object: u16, from: Vector3<f64>, to: Vector3<f64>, radius_m: f64, material: Material) {
        let along = to - from;
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_default();
        let at = Isometry3::from_parts(Translation3::from(0.5 * (from + to)), turn);
        self.add(object, at, Shape::Capsule { radius_m, half_length_m: 0.5 * along.norm() }, material);
    }
}

fn plain(albedo: [f32; 3], gloss: f32) -> Material {
    Material { albedo, gloss, pattern: Pattern::Plain }
}

/// The lab with both arms and six toys, 120 items or a few more; eyes 30° down.
pub fn lab() -> (Scenery, Snapshot) {
    let mut b = Builder { items: Vec::new() };
    room(&mut b);
    tables(&mut b);
    toys(&mut b);
    for side in [-1.0, 1.0] {
        arm(&mut b, side);
    }
    let scenery = Scenery { revision: 1, items: b.items, light: Light::default() };
    let snapshot = Snapshot {
        time_s: 0.0,
        robot_from_body: vec![Isometry3::identity()],
        eyes: eyes(30_f64.to_radians()),
    };
    (scenery, snapshot)
}

fn room(b: &mut Builder) {
    let wall = plain([0.72, 0.73, 0.72], 0.0);
    let curtain = Material {
        albedo: [0.012, 0.014, 0.02],
        gloss: 0.0,
        pattern: Pattern::Folds { period_m: 0.09, contrast: 0.5 },
    };
    b.cuboid([2.45, 0.0, 0.6], [0.02, 2.2, 1.4], wall);
    b.cuboid([0.5, 2.0, 0.6], [2.5, 0.02, 1.4], wall);
    b.cuboid([0.5, -1.5, 0.6], [2.5, 0.02, 1.4], wall);
    b.cuboid([0.5, 0.0, 1.9], [2.5, 2.5, 0.02], plain([0.5, 0.5, 0.48], 0.0));
    b.cuboid([0.5, 0.0, -0.72], [2.5, 2.5, 0.02], plain([0.42, 0.38, 0.31], 0.0));
    b.cuboid([2.38, 0.55, 0.8], [0.03, 0.52, 0.75], curtain);
    b.cuboid([2.38, -0.6, 0.8], [0.03, 0.6, 0.75], curtain);
    b.cuboid([1.2, 1.96, 0.1], [0.4, 0.03, 0.85], plain([0.09, 0.035, 0.015], 0.02));
    b.cuboid([1.9, 1.5, -0.2], [0.2, 0.2, 0.3], plain([0.03, 0.03, 0.03], 0.0));
    for i in 0..4 {
        let lamp = plain([0.95, 0.95, 0.95], 0.0);
        b.cuboid([0.5 + 0.5 * f64::from(i), 0.4 - 0.8 * f64::from(i % 2), 1.87], [0.12, 0.3, 0.01], lamp);
    }
}

fn tables(b: &mut Builder) {
    let granite = Material {
        albedo: [0.62, 0.61, 0.59],
        gloss: 0.0,
        pattern: Pattern::Speckle { size_m: 0.005, contrast: 0.9 },
    };
    let wood = Material {
        albedo: [0.62, 0.25, 0.07],
        gloss: 0.0,
        pattern: Pattern::Speckle { size_m: 0.02, contrast: 0.06 },
    };
    b.cuboid([0.36, 0.0, TABLE_M - 0.012], [0.28, 0.62, 0.012], granite);
    b.cuboid([0.36, 0.0, TABLE_M - 0.04], [0.30, 0.68, 0.015], wood);
    b.cuboid([1.3, 0.0, TABLE_M - 0.025], [0.63, 0.68, 0.015], wood);
    // The touchscreen: a frame, and the glass in it.
    b.cuboid([0.41, 0.0, TABLE_M + 0.006], [0.165, 0.275, 0.006], plain([0.006, 0.006, 0.007], 0.015));
    b.cuboid([0.41, 0.0, TABLE_M + 0.0065], [0.135, 0.2375, 0.0065], plain([0.004, 0.005, 0.007], 0.12));
    // The robot's own chest and what lies about.
    b.cuboid([0.03, 0.0, 0.06], [0.03, 0.11, 0.04], plain([0.45, 0.45, 0.45], 0.03));
    b.cuboid([1.0, 0.32, TABLE_M + 0.01], [0.1, 0.13, 0.01], plain([0.8, 0.8, 0.8], 0.0));
    b.cuboid([1.15, 0.05, TABLE_M], [0.06, 0.1, 0.01], plain([0.02, 0.02, 0.02], 0.0));
    b.cuboid([0.66, -0.42, TABLE_M], [0.025, 0.12, 0.02], plain([0.8, 0.8, 0.78], 0.0));
    for i in 0..10 {
        let at = |i: i32| {
            let t = f64::from(i) * 0.35;
            Vector3::new(0.68 + 0.05 * t.sin(), -0.3 - 0.04 * f64::from(i), TABLE_M + 0.01)
        };
        b.bone(0, at(i), at(i + 1), 0.004, plain([0.015, 0.015, 0.015], 0.02));
    }
}

fn toys(b: &mut Builder) {
    let top = TABLE_M + 0.013;
    let red = plain([0.5, 0.02, 0.015], 0.03);
    let green = plain([0.05, 0.12, 0.02], 0.0);
    let yellow = plain([0.78, 0.52, 0.02], 0.02);
    let white = plain([0.75, 0.72, 0.7], 0.01);
    // Tomato.
    b.ball(1, [0.36, -0.03, top + 0.03], [0.034, 0.034, 0.03], red);
    for i in 0..5 {
        let a = f64::from(i) * 1.2566;
        let tip = Vector3::new(0.36 + 0.02 * a.cos(), -0.03 + 0.02 * a.sin(), top + 0.055);
        b.bone(1, Vector3::new(0.36, -0.03, top + 0.06), tip, 0.003, green);
    }
    // Banana.
    for i in 0..7 {
        let at = |i: i32| {
            let a = 0.3 + 0.22 * f64::from(i);
            Vector3::new(0.47 + 0.1 * a.cos() - 0.1, 0.12 + 0.1 * a.sin() - 0.05, top + 0.016)
        };
        b.bone(2, at(i), at(i + 1), 0.016 - 0.001 * f64::from((i - 3).abs()), yellow);
    }
    // Duck.
    b.ball(3, [0.49, -0.12, top + 0.02], [0.028, 0.022, 0.02], yellow);
    b.ball(3, [0.475, -0.12, top + 0.045], [0.015, 0.015, 0.015], yellow);
    b.ball(3, [0.46, -0.12, top + 0.043], [0.008, 0.007, 0.003], plain([0.7, 0.2, 0.02], 0.0));
    // Mushroom.
    b.ball(4, [0.33, -0.2, top + 0.035], [0.028, 0.028, 0.018], plain([0.45, 0.2, 0.1], 0.0));
    let stem = Shape::Cylinder { radius_m: 0.011, half_length_m: 0.016 };
    b.add(4, Isometry3::translation(0.33, -0.2, top + 0.016), stem, white);
    // Onion.
    b.ball(5, [0.3, 0.06, top + 0.02], [0.021, 0.021, 0.02], white);
    b.bone(5, Vector3::new(0.3, 0.06, top + 0.035), Vector3::new(0.305, 0.06, top + 0.05), 0.004, white);
    // Orange.
    b.ball(6, [0.28, -0.28, TABLE_M + 0.022], [0.022; 3], plain([0.75, 0.22, 0.02], 0.01));
}

/// An arm lying on the table; `side` -1 is the right one.
fn arm(b: &mut Builder, side: f64) {
    let black = plain([0.012, 0.012, 0.013], 0.03);
    let gray = plain([0.05, 0.05, 0.055], 0.04);
    let object = HANDS[usize::from(side > 0.0)];
    let place = |x: f64, y: f64, z: f64| Vector3::new(x, side * y, z);
    let shoulder = place(0.0, 0.14, 0.2);
    let elbow = place(0.06, 0.26, 0.1);
    let wrist = place(0.24, 0.25, 0.11);
    let palm = place(0.33, 0.22, 0.1);
    b.bone(0, shoulder, elbow, 0.032, black);
    b.bone(0, elbow, wrist, 0.028, black);
    b.bone(object, wrist, palm, 0.02, gray);
    for (i, joint) in [shoulder, elbow, wrist].into_iter().enumerate() {
        let turned = Isometry3::from_parts(
            Translation3::from(joint),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2),
        );
        let radius_m = 0.04 - 0.006 * i as f64;
        b.add(0, turned, Shape::Cylinder { radius_m, half_length_m: 0.03 - 0.005 * i as f64 }, gray);
        b.cuboid([joint.x - 0.02, joint.y, joint.z + 0.02], [0.02, 0.018, 0.014], black);
    }
    let palm_box = Shape::Box { half_m: Vector3::new(0.035, 0.03, 0.012) };
    b.add(
        object,
        Isometry3::from_parts(Translation3::from(palm), UnitQuaternion::identity()),
        palm_box,
        black,
    );
    for finger in 0..4 {
        let y = -0.024 + 0.016 * f64::from(finger);
        let joint = |k: i32| palm + Vector3::new(0.035 + 0.022 * f64::from(k), y, -0.004 * f64::from(k * k));
        for k in 0..3 {
            b.bone(object, joint(k), joint(k + 1), 0.0075 - 0.0005 * f64::from(k), black);
            b.ball(object, joint(k).into(), [0.009; 3], gray);
        }
    }
    for k in 0..4 {
        let s = f64::from(k) * 0.25;
        let along = elbow + (wrist - elbow) * s;
        b.cuboid([along.x, along.y, along.z + 0.02], [0.018, 0.02, 0.015], black);
        let cable = along + Vector3::new(0.0, -side * 0.03, 0.012 * (3.0 * s).sin());
        b.bone(0, cable, cable + (wrist - elbow) * 0.25, 0.004, black);
    }
}

/// A chessboard of 9×6 squares of 30 mm held in front of the left eye, as an item of body 0.
pub fn held_board(snapshot: &Snapshot, left_from_board: &Isometry3<f64>) -> Item {
    Item {
        object: 20,
        body: BodyIndex(0),
        body_from_shape: snapshot.eyes.robot_from_left.isometry * left_from_board,
        shape: Shape::Board { board: board() },
        material: plain([0.7, 0.7, 0.69], 0.0),
    }
}

/// The board of [`held_board`].
pub fn board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}
