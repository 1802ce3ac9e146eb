//! What nobody measured of the eyes is off by as much as it usually is on such robots, and places are as
//! uncertain by that.
//!
//! How far that is, the library of effects says: a standard deviation is half of the upper end of what is plausible
//! for a robot that was put together by hand. The eyes sit up to 3° and 40 mm beside their drawing, the zeros of the
//! neck are off by up to 3°: 1.5° and 20 mm about and along each axis, 1.5° a joint. Over the table, 0.5 m away,
//! that is 28 mm in the worst direction and 31 mm on average over the 9×4 grid. The published error of places of a
//! robot whose mount nobody had measured is 36.8 mm on that grid, with that of its stereo. What the twins hide (up to
//! 8 mm and 2.3°, 1.4° a joint of the neck) lies inside. The published eyes are turned sideways against each other by
//! 0.5°, where lenses that nobody calibrated are allowed 0.6°.

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use plumbline_model::StereoCameras;
use plumbline_model::robot::Rig;

use super::mounted::Mounted;
use crate::library::{Kind, Present};
use crate::rig_model::Measured;

/// What of the eyes is taken as described because nobody measured it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unmeasured {
    /// How they sit in the head, and how the head stands on the neck.
    pub mount: bool,
    /// Their lenses, and how they sit to each other.
    pub lenses: bool,
    /// Where the head looks straight ahead: no board tells the zero of the neck's turn, for all that is seen turns with
    /// it. The robot's own body does, and its hands.
    pub neck: bool,
}

impl Unmeasured {
    /// Eyes of which nothing was measured.
    pub const ALL: Self = Self { mount: true, lenses: true, neck: true };
}

/// How far off that is, one standard deviation of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Prior {
    /// What nobody calibrated, whatever effects say of it.
    pub not_calibrated: Unmeasured,
    /// Of mount and neck; `None`: they count as known.
    pub mounted: Option<Mounted>,
    /// Of the lenses; `None`: they count as known.
    pub lenses: Option<Lenses>,
    /// Of the zero of the neck's turn, which counts beside a mount that was measured; `None`: it counts as known.
    pub neck: Option<Mounted>,
}

impl Prior {
    /// Of what nobody calibrated. What an effect in force says of the eyes was measured by it.
    pub fn new(not_calibrated: Unmeasured, rig: &Rig, of_eyes: &Measured) -> Self {
        let Unmeasured { mount, lenses, neck } = not_calibrated;
        let usual = usual_mount(rig, &of_eyes.present);
        Self {
            not_calibrated,
            mounted: usual.filter(|_| mount),
            lenses: lenses.then(|| Lenses::usual(&of_eyes.present)),
            neck: usual.filter(|_| neck).map(|Mounted { rest_sigma_rad: [pan_rad, _], .. }| Mounted {
                covariance: Matrix6::zeros(),
                rest_sigma_rad: [pan_rad, 0.0],
            }),
        }
    }
}

/// Mount and neck as they usually are. `None` where the search for the gap found the mount by looking at things
/// whose place is known: how the head stands is in what it found.
fn usual_mount(rig: &Rig, present: &[Present]) -> Option<Mounted> {
    let is_found = |found: &&Present| found.effect.kind == Kind::CameraMount && found.effect.shape.is_none();
    if present.iter().any(|found| is_found(&found)) {
        return None;
    }
    let of_mount = |name: &str| typical(Kind::CameraMount, name);
    // Those of the library are about the axes of the left camera; the same in all directions they are those of the
    // head, too.
    let [turn_rad, shift_m] = [of_mount("rot_x_rad"), of_mount("x_m")];
    let sigmas = Vector6::new(turn_rad, turn_rad, turn_rad, shift_m, shift_m, shift_m);
    let zero_rad = |joint| {
        let site = &rig.description.joint(joint).name;
        let is_found = |found: &Present| found.effect.kind == Kind::HeadJoint && found.effect.site == *site;
        if present.iter().any(is_found) { 0.0 } else { typical(Kind::HeadJoint, "offset_rad") }
    };
    Some(Mounted {
        covariance: Matrix6::from_diagonal(&sigmas.component_mul(&sigmas)),
        rest_sigma_rad: [rig.eyes.pan, rig.eyes.tilt].map(zero_rad),
    })
}

/// Lenses that nobody calibrated. That both eyes look elsewhere together is a matter of their mount, and that one of
/// them rolls or nods moves no place to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lenses {
    /// The right eye looks to the side, rad.
    yaw_rad: f64,
    /// Its image is shifted along the rows, px.
    shift_px: f64,
    /// Share of the focal length.
    focal: f64,
    /// Share of the distance of the eyes.
    baseline: f64,
}

impl Lenses {
    fn usual(present: &[Present]) -> Self {
        // What grows as the eyes warm up says nothing of how they were when they were switched on.
        let size = |kind: Kind, shape: Option<f64>, name: &str| {
            let is_found = |found: &Present| {
                found.effect.kind == kind && found.effect.shape.is_some() == shape.is_some()
            };
            if present.iter().any(is_found) { 0.0 } else { typical(kind, name) }
        };
        Self {
            yaw_rad: size(Kind::EyeYaw, None, "yaw_rad"),
            shift_px: size(Kind::ImageShift, None, "du_px"),
            focal: size(Kind::FocalOrBaseline, None, "scale"),
            baseline: size(Kind::FocalOrBaseline, Some(1.0), "scale"),
        }
    }

    /// Covariance (m²) that it means at a place of the left camera (m).
    pub fn covariance_m2(&self, cameras: &StereoCameras, in_left_m: &Vector3<f64>) -> Matrix3<f64> {
        let depth_m = in_left_m.z;
        let (focal_px, _) = cameras.right.model.focal_px();
        let by_disparity = turned_sideways(self.yaw_rad.hypot(self.shift_px / focal_px), cameras, in_left_m);
        let by_baseline = in_left_m * self.baseline;
        // Both directions and disparity grow with the focal length: what is beside the axis stays there.
        let by_focal = Vector3::z() * (depth_m * self.focal);
        [by_disparity, by_baseline, by_focal].iter().map(|by| by * by.transpose()).sum()
    }
}

/// How far a place (left camera, m) moves as the right eye turns to the side, m.
pub(super) fn turned_sideways(
    yaw_rad: f64,
    cameras: &StereoCameras,
    in_left_m: &Vector3<f64>,
) -> Vector3<f64> {
    let depth_m = in_left_m.z;
    // A ray's tangent to the side grows faster than its angle, the farther off it is to that side.
    let by_tangent = yaw_rad * (1.0 + (in_left_m.x / depth_m).powi(2));
    in_left_m * (by_tangent * depth_m / cameras.baseline_m())
}

/// Usual size of a parameter.
pub(super) fn typical(kind: Kind, name: &str) -> f64 {
    let mut parameters = kind.parameters().iter();
    parameters.find(|parameter| parameter.name == name).expect("a parameter of the library").typical
}
