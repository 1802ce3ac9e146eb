//! How the hands look: black, with gray screws and joints on the palm, gray fingertips.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::{LinkIndex, Rig};

use crate::physics::parts::Finger;
use crate::scene::{Material, Pattern, Shape};
use crate::toys::along;

/// A shape on a link with its surface.
pub(crate) type Drawn = (Isometry3<f64>, Shape, Material);

/// How one hand differs from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HandLook {
    /// Black of the palm and fingers, linear reflectance.
    pub black: f32,
    /// Metal of screws and joints.
    pub metal: f32,
    /// Gray of the fingertips.
    pub tip: f32,
    /// Breadth of the palm against that of the part that collides.
    pub breadth: f64,
    /// Where a thin light wire crosses the palm, -1 to 1 of its breadth; `None` without one.
    pub wire: Option<f64>,
}

impl Default for HandLook {
    fn default() -> Self {
        Self { black: 0.012, metal: 0.30, tip: 0.06, breadth: 0.85, wire: None }
    }
}

/// The links of the rig that are palms, by the number of the arm.
pub(crate) fn palms(rig: &Rig) -> Vec<Option<LinkIndex>> {
    let description = &rig.description;
    rig.arms.iter().map(|arm| arm.joints.last().map(|last| description.joint(*last).child)).collect()
}

fn matt(gray: f32, gloss: f32) -> Material {
    Material { albedo: [gray, gray, gray * 1.04], gloss, pattern: Pattern::Plain }
}

/// A palm in place of the box that collides, which goes from the wrist (+z) to the roots of the
/// fingers (-z), is broad along y and thin along x.
pub(crate) fn palm(link_from_box: &Isometry3<f64>, half_m: &Vector3<f64>, look: &HandLook) -> Vec<Drawn> {
    let (x, y, z) = (half_m.x, half_m.y * look.breadth, half_m.z);
    let (black, dark, metal) =
        (matt(look.black, 0.035), matt(look.black * 2.2, 0.05), matt(look.metal, 0.25));
    let across = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let through = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    let mut drawn: Vec<Drawn> = vec![];
    let mut put = |at: Vector3<f64>, turn: UnitQuaternion<f64>, shape: Shape, material: Material| {
        let place = Isometry3::from_parts(Translation3::from(at), turn);
        drawn.push((link_from_box * place, shape, material));
    };
    let none = UnitQuaternion::identity();
    put(Vector3::zeros(), none, Shape::Box { half_m: Vector3::new(0.70 * x, 0.86 * y, 0.92 * z) }, black);
    // Rounded flanks.
    for side in [-1.0, 1.0] {
        let flank = Shape::Capsule { radius_m: 0.72 * x, half_length_m: 0.66 * z };
        put(Vector3::new(0.0, side * 0.78 * y, 0.0), none, flank, black);
    }
    // The roots of fingers and thumb, the wrist's joint.
    let roots = Shape::Cylinder { radius_m: 0.55 * x, half_length_m: 0.80 * y };
    put(Vector3::new(0.0, 0.0, -0.90 * z), across, roots, dark);
    let wrist = Shape::Cylinder { radius_m: 0.62 * x, half_length_m: 0.5 * y };
    put(Vector3::new(0.0, 0.0, 0.86 * z), across, wrist, dark);
    let mound = Shape::Ellipsoid { radii_m: Vector3::new(1.0 * x, 0.40 * y, 0.45 * z) };
    put(Vector3::new(0.15 * x, -0.48 * y, 0.30 * z), none, mound, dark);
    // Screws go through to the other side.
    let screws = [
        (-0.55, 0.55, 0.28),
        (0.52, 0.60, 0.20),
        (0.05, 0.05, 0.22),
        (0.55, -0.50, 0.20),
        (-0.30, -0.55, 0.20),
    ];
    for (at_y, at_z, radius) in screws {
        let screw = Shape::Cylinder { radius_m: radius * x, half_length_m: 0.82 * x };
        put(Vector3::new(0.0, at_y * y, at_z * z), through, screw, metal);
    }
    if let Some(at) = look.wire {
        let (from, to) =
            (Vector3::new(0.95 * x, at * y, 0.8 * z), Vector3::new(0.95 * x, -0.4 * at * y, -0.85 * z));
        for side in [-1.0, 1.0] {
            let flip = |v: Vector3<f64>| Vector3::new(side * v.x, v.y, v.z);
            let (from, to) = (flip(from), flip(to));
            let shape = Shape::Capsule { radius_m: 0.0009, half_length_m: 0.5 * (to - from).norm() };
            let place = along(from, to);
            put(place.translation.vector, place.rotation, shape, matt(0.45, 0.1));
        }
    }
    drawn
}

/// The two pieces of a finger with what is on them, each in its own frame.
pub(crate) fn finger(finger: &Finger, look: &HandLook) -> (Vec<Drawn>, Vec<Drawn>) {
    let (black, metal) = (matt(look.black, 0.035), matt(look.metal * 0.35, 0.2));
    let mut near = vec![(finger.near.0, finger.near.1.clone(), black)];
    let mut far = vec![(finger.far.0, finger.far.1.clone(), black)];
    if let Shape::Capsule { radius_m, half_length_m } = finger.far.1 {
        // A ring at the joint, a cap at the tip.
        let ring = Shape::Cylinder { radius_m: 1.08 * radius_m, half_length_m: 0.18 * radius_m };
        near.push((finger.near.0, ring, metal));
        let ends = [half_length_m, -half_length_m].map(|z| finger.far.0 * Point3::new(0.0, 0.0, z));
        let tip = if ends[0].coords.norm() > ends[1].coords.norm() { ends[0] } else { ends[1] };
        let cap = Shape::Ellipsoid { radii_m: Vector3::repeat(1.06 * radius_m) };
        far.push((Isometry3::translation(tip.x, tip.y, tip.z), cap, matt(look.tip, 0.05)));
    }
    (near, far)
}

/// The thumb's last part, and metal on it.
pub(crate) fn thumb(link_from_shape: &Isometry3<f64>, shape: &Shape, look: &HandLook) -> Vec<Drawn> {
    let mut drawn = vec![(*link_from_shape, shape.clone(), matt(look.black, 0.035))];
    if let Shape::Capsule { radius_m, half_length_m } = *shape {
        for at in [-0.55, 0.25] {
            let ring = Shape::Cylinder { radius_m: 1.12 * radius_m, half_length_m: 0.2 * radius_m };
            let place = link_from_shape * Translation3::new(0.0, 0.0, at * half_length_m);
            drawn.push((place, ring, matt(look.metal, 0.25)));
        }
        // The end farther from the joint.
        let ends = [half_length_m, -half_length_m].map(|z| link_from_shape * Point3::new(0.0, 0.0, z));
        let tip = if ends[0].coords.norm() > ends[1].coords.norm() { ends[0] } else { ends[1] };
        let cap = Shape::Ellipsoid { radii_m: Vector3::repeat(1.06 * radius_m) };
        drawn.push((Isometry3::translation(tip.x, tip.y, tip.z), cap, matt(look.tip, 0.05)));
    }
    drawn
}
