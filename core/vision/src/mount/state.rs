//! What is estimated, and its place in the vector of parameters.

use nalgebra::{Isometry3, Vector3};

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
