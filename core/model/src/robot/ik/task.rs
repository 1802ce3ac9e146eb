//! A target as least squares: residuals and their derivatives.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::kernel::{Angles, MAX_JOINTS, Reading};
use super::target::Target;

/// A radian of orientation counts as much as this many meters: about the length of a hand.
pub(super) const LENGTH_PER_RAD_M: f64 = 0.1;
/// The same for a wish, which must not cost more than a little of what is demanded.
const WISH_LENGTH_PER_RAD_M: f64 = 0.02;
/// Most residuals: three of position, one of heading, three of the tool's axis.
const ROWS: usize = 7;
/// Keeps the heading of a tip that points straight up or down from having infinite slope.
const SMALLEST_HORIZONTAL_SQUARED: f64 = 1e-6;

/// What is demanded, and what is wished for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    position_m: Vector3<f64>,
    orientation: Orientation,
    tool_z: Option<Vector3<f64>>,
    rest: Option<Angles>,
}

#[derive(Clone, Copy, Debug)]
enum Orientation {
    Free,
    Yaw(f64),
    Full(Matrix3<f64>),
}

/// Normal equations of a step: `matrix` · step = `right`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    pub matrix: [[f64; MAX_JOINTS]; MAX_JOINTS],
    pub right: Angles,
}

/// What is left of a demand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remaining {
    pub position_m: f64,
    pub orientation_rad: f64,
}

impl Remaining {
    /// Both as one length, squared.
    pub fn cost(&self) -> f64 {
        self.position_m.powi(2) + (LENGTH_PER_RAD_M * self.orientation_rad).powi(2)
    }

    pub fn within(&self, position_m: f64, orientation_rad: f64) -> bool {
        self.position_m <= position_m && self.orientation_rad <= orientation_rad
    }
}

impl Task {
    /// What the target demands, and as wishes a direction for the tip's z axis and a rest posture.
    pub fn new(target: &Target, tool_z: Option<Vector3<f64>>, rest: Option<Angles>) -> Self {
        let position_m = target.point().coords.coords;
        let (orientation, tool_z) = match target {
            Target::Position(_) => (Orientation::Free, tool_z),
            Target::PositionYaw { yaw_rad, .. } => (Orientation::Yaw(*yaw_rad), tool_z),
            Target::Pose(pose) => (Orientation::Full(pose.rotation()), None),
        };
        Self { position_m, orientation, tool_z, rest }
    }

    /// The same without wishes.
    pub fn demands(&self) -> Self {
        Self { tool_z: None, rest: None, ..*self }
    }

    pub fn has_wishes(&self) -> bool {
        self.tool_z.is_some() || self.rest.is_some()
    }

    /// What is left of the demands.
    pub fn remaining(&self, reading: &Reading) -> Remaining {
        let orientation_rad = match &self.orientation {
            Orientation::Free => 0.0,
            Orientation::Yaw(yaw_rad) => wrapped(yaw_rad - heading_rad(reading)).abs(),
            Orientation::Full(rotation) => rotation_left(rotation, reading).norm(),
        };
        Remaining { position_m: (self.position_m - reading.position_m).norm(), orientation_rad }
    }

    /// Sum of the squared, weighted residuals, m².
    pub fn cost(&self, reading: &Reading, angles_rad: &Angles, count: usize) -> f64 {
        let (residuals, rows) = self.residuals(reading);
        let of_rest = self.rest.map_or(0.0, |rest| {
            (0..count).map(|i| (WISH_LENGTH_PER_RAD_M * (rest[i] - angles_rad[i])).powi(2)).sum()
        });
        residuals[..rows].iter().map(|r| r * r).sum::<f64>() + of_rest
    }

    /// Normal equations at some angles.
    pub fn normal(&self, reading: &Reading, angles_rad: &Angles, count: usize) -> Normal {
        let (residuals, rows) = self.residuals(reading);
        let mut columns = [[0.0; ROWS]; MAX_JOINTS];
        for (i, column) in columns.iter_mut().enumerate().take(count) {
            self.column(reading, i, column);
        }
        let mut normal = Normal { matrix: [[0.0; MAX_JOINTS]; MAX_JOINTS], right: [0.0; MAX_JOINTS] };
        for i in 0..count {
            for j in 0..=i {
                let product = (0..rows).map(|row| columns[i][row] * columns[j][row]).sum();
                normal.matrix[i][j] = product;
                normal.matrix[j][i] = product;
            }
            normal.right[i] = (0..rows).map(|row| columns[i][row] * residuals[row]).sum();
            if let Some(rest) = &self.rest {
                let weight = WISH_LENGTH_PER_RAD_M.powi(2);
                normal.matrix[i][i] += weight;
                normal.right[i] += weight * (rest[i] - angles_rad[i]);
            }
        }
        normal
    }

    /// Target minus reading, weighted, and how many rows it has.
    fn residuals(&self, reading: &Reading) -> ([f64; ROWS], usize) {
        let mut residuals = [0.0; ROWS];
        residuals[..3].copy_from_slice((self.position_m - reading.position_m).as_slice());
        let mut rows = 3;
        match &self.orientation {
            Orientation::Free => {}
            Orientation::Yaw(yaw_rad) => {
                residuals[3] = LENGTH_PER_RAD_M * wrapped(yaw_rad - heading_rad(reading));
                rows = 4;
            }
            Orientation::Full(rotation) => {
                let left = rotation_left(rotation, reading) * LENGTH_PER_RAD_M;
                residuals[3..6].copy_from_slice(left.as_slice());
                rows = 6;
            }
        }
        if let Some(axis) = &self.tool_z {
            let difference = (axis - reading.rotation.column(2)) * WISH_LENGTH_PER_RAD_M;
            residuals[rows..rows + 3].copy_from_slice(difference.as_slice());
            rows += 3;
        }
        (residuals, rows)
    }

    /// How the reading changes with joint `i`, weighted like the residuals.
    fn column(&self, reading: &Reading, i: usize, column: &mut [f64; ROWS]) {
        let axis = &reading.axes[i];
        column[..3].copy_from_slice(axis.cross(&(reading.position_m - reading.origins_m[i])).as_slice());
        let mut rows = 3;
        match &self.orientation {
            Orientation::Free => {}
            Orientation::Yaw(_) => {
                let (x, y, z) =
                    (reading.rotation[(0, 0)], reading.rotation[(1, 0)], reading.rotation[(2, 0)]);
                let horizontal = (x * x + y * y).max(SMALLEST_HORIZONTAL_SQUARED);
                column[3] = LENGTH_PER_RAD_M * (axis.z - z * (axis.x * x + axis.y * y) / horizontal);
                rows = 4;
            }
            Orientation::Full(_) => {
                column[3..6].copy_from_slice((axis * LENGTH_PER_RAD_M).as_slice());
                rows = 6;
            }
        }
        if self.tool_z.is_some() {
            let z: Vector3<f64> = reading.rotation.column(2).into();
            column[rows..rows + 3].copy_from_slice((axis.cross(&z) * WISH_LENGTH_PER_RAD_M).as_slice());
        }
    }
}

/// Azimuth of the tip's x axis, rad.
pub(super) fn heading_rad(reading: &Reading) -> f64 {
    reading.rotation[(1, 0)].atan2(reading.rotation[(0, 0)])
}

/// The same angle within −π to π.
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - std::f64::consts::TAU * (angle_rad / std::f64::consts::TAU).round()
}

/// Rotation vector (rad, robot frame) that takes the tip to `target`.
fn rotation_left(target: &Matrix3<f64>, reading: &Reading) -> Vector3<f64> {
    let turn = target * reading.rotation.transpose();
    let twice_sine_axis =
        Vector3::new(turn[(2, 1)] - turn[(1, 2)], turn[(0, 2)] - turn[(2, 0)], turn[(1, 0)] - turn[(0, 1)]);
    let (sine, cosine) = (0.5 * twice_sine_axis.norm(), 0.5 * (turn.trace() - 1.0));
    if sine < 1e-4 && cosine < 0.0 {
        // Near half a turn the axis is not in the antisymmetric part.
        return UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn)).scaled_axis();
    }
    let stretch = if sine > 1e-9 { sine.atan2(cosine) / sine } else { 1.0 };
    twice_sine_axis * (0.5 * stretch)
}
