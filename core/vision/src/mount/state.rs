//! What is measured, what is estimated, and its place in the vector of parameters.

use nalgebra::{Isometry3, Vector2, Vector3};
use plumbline_model::Eye;
use plumbline_model::robot::{Chain, Posture};

/// One measured point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub eye: Eye,
    /// Index on the target.
    pub index: usize,
    pub measured_px: Vector2<f64>,
    /// Left-out points keep their residual but pull on nothing.
    pub left_out: bool,
}

/// All points of one head pose.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub name: String,
    /// Angles of the head's chain, by the encoders, rad.
    pub encoder_rad: Vec<f64>,
    pub seen: Vec<Seen>,
    /// Place of the fingertip by the arm's encoders, robot frame, m; zero for other targets.
    pub tip: Vector3<f64>,
}

/// The joints between the base and the eyes.
#[derive(Clone, Debug)]
pub(super) struct Neck {
    pub chain: Chain,
    /// Places of pan and tilt in the chain.
    pub pan_tilt: [usize; 2],
}

impl Neck {
    pub fn encoder_rad(&self, posture: &Posture) -> Vec<f64> {
        posture.of(self.chain.joints())
    }
}

/// Standard deviations of what is known beside the pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Priors {
    /// One coordinate of a pixel, px.
    pub pixel_px: f64,
    /// Pan and tilt from view to view, rad.
    pub angle_rad: [f64; 2],
    /// Zeros of the head joints; `None`: exact and no parameter.
    pub zero_rad: Option<f64>,
    /// Rotation (rad) and place (m) of the target.
    pub target: (f64, f64),
    /// Fingertip from view to view, m; `None`: no parameter.
    pub tip_m: Option<f64>,
}

/// Everything that is estimated.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub head_from_left: Isometry3<f64>,
    pub zeros_rad: [f64; 2],
    pub robot_from_target: Isometry3<f64>,
    /// Per view: errors of pan and tilt, rad.
    pub angle_error_rad: Vec<[f64; 2]>,
    /// Per view: error of the fingertip, robot frame, m.
    pub tip_error_m: Vec<Vector3<f64>>,
}

impl State {
    pub fn new(head_from_left: Isometry3<f64>, robot_from_target: Isometry3<f64>, views: usize) -> Self {
        Self {
            head_from_left,
            zeros_rad: [0.0; 2],
            robot_from_target,
            angle_error_rad: vec![[0.0; 2]; views],
            tip_error_m: vec![Vector3::zeros(); views],
        }
    }

    pub fn without_view(mut self, view: usize) -> Self {
        self.angle_error_rad.remove(view);
        self.tip_error_m.remove(view);
        self
    }
}

/// Where things are in the vector of parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub zeros: Option<usize>,
    pub target: Option<usize>,
    pub(super) views: usize,
    pub(super) per_view: usize,
    pub total: usize,
}

impl Layout {
    pub fn angle(&self, view: usize, joint: usize) -> usize {
        self.views + view * self.per_view + joint
    }
    pub fn tip(&self, view: usize) -> usize {
        self.angle(view, 2)
    }
}
