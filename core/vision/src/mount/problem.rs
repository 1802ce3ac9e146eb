//! The least-squares problem: parameters, residuals and their derivatives, normal equations.
//!
//! Parameters in this order, those that are not asked for left out: mount (rotation, place),
//! zeros of the two head joints, pose of the target in the robot frame, and per view the errors of
//! the two head angles and of the fingertip. What the encoders, the options and the place of known
//! points say about parameters enters as further measurements ("priors") with their own standard
//! deviation.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix2x3, Matrix3, Point3, Vector2, Vector3, Vector6};
use plumbline_model::{Eye, StereoCameras};

pub(super) use super::state::{Layout, Neck, Priors, Seen, State, View};
use super::types::perturbed;

/// Cost of a point that its lens cannot even project; keeps a bad step from looking good.
const UNPROJECTABLE_PX: f64 = 1e3;
/// So weak that it decides only what nothing else does: keeps the normal matrix invertible. SI.
pub(super) const ANYTHING: f64 = 3.0;
/// Parameters of the mount.
pub(super) const MOUNT: usize = 6;

/// What to fit.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub cameras: StereoCameras,
    pub neck: Neck,
    /// Points of the target in its own frame, m.
    pub points: Vec<Vector3<f64>>,
    /// Whether the target's pose is a parameter.
    pub free_target: bool,
    /// Where the mount and the target were expected; the weak priors pull there.
    pub expected: (Isometry3<f64>, Isometry3<f64>),
    pub views: Vec<View>,
    pub priors: Priors,
    /// Scale (px) of a Cauchy loss; `None` is plain least squares.
    pub robust_px: Option<f64>,
    /// A view whose head angles count as unknown: for asking the other views about them.
    pub unknown_angles: Option<usize>,
}

/// A head pose of a view and how it changes with the two angles.
pub(super) struct HeadPose {
    robot_from_head: Isometry3<f64>,
    /// Velocity of the head's origin and angular velocity per pan and tilt, robot frame.
    by_angle: [(Vector3<f64>, Vector3<f64>); 2],
}

/// A parameter's own measurement: its index, by how much it is off, and how far that may be.
pub(super) struct Prior {
    pub index: usize,
    pub off: f64,
    pub sd: f64,
}

/// One point's residual (px) and its derivatives by the parameters that it depends on.
pub(super) struct Row {
    pub residual: Vector2<f64>,
    pub columns: Vec<(usize, Vector2<f64>)>,
}

impl Problem {
    pub fn layout(&self) -> Layout {
        let mut next = MOUNT;
        let mut take = |wanted: bool, count: usize| {
            let at = next;
            next += if wanted { count } else { 0 };
            wanted.then_some(at)
        };
        let zeros = take(self.priors.zero_rad.is_some(), 2);
        let target = take(self.free_target, 6);
        let per_view = if self.priors.tip_m.is_some() { 5 } else { 2 };
        Layout { zeros, target, views: next, per_view, total: next + per_view * self.views.len() }
    }

    fn angles(&self, state: &State, view: usize) -> Vec<f64> {
        let mut angles = self.views[view].encoder_rad.clone();
        for (k, place) in self.neck.pan_tilt.into_iter().enumerate() {
            angles[place] += state.zeros_rad[k] + state.angle_error_rad[view][k];
        }
        angles
    }

    pub fn robot_from_head(&self, state: &State, view: usize) -> Isometry3<f64> {
        self.neck.chain.robot_from_tip(&self.angles(state, view)).isometry
    }

    pub fn head_pose(&self, state: &State, view: usize) -> HeadPose {
        let (place, jacobian) = self.neck.chain.jacobian(&self.angles(state, view));
        let by_angle = self.neck.pan_tilt.map(|joint| {
            let column = jacobian.column(joint);
            (column.fixed_rows::<3>(0).into_owned(), column.fixed_rows::<3>(3).into_owned())
        });
        HeadPose { robot_from_head: place.isometry, by_angle }
    }

    pub fn point_in_robot(&self, state: &State, view: usize, index: usize) -> Point3<f64> {
        if self.priors.tip_m.is_some() {
            Point3::from(self.views[view].tip + state.tip_error_m[view])
        } else {
            state.robot_from_target * Point3::from(self.points[index])
        }
    }

    /// Measured minus predicted, px; `None` if the lens cannot see the point.
    fn residual_from(
        &self,
        state: &State,
        left_from_robot: &Isometry3<f64>,
        view: usize,
        seen: &Seen,
    ) -> Option<Vector2<f64>> {
        let in_left = left_from_robot * self.point_in_robot(state, view, seen.index);
        let in_eye = match seen.eye {
            Eye::Left => in_left,
            Eye::Right => self.cameras.right_from_left.isometry * in_left,
        };
        let pixel = self.cameras.camera(seen.eye).project(&in_eye.coords).ok()?;
        Some(seen.measured_px - pixel.vector())
    }

    /// Residuals (px) of all points of a view, `None` where the lens cannot see.
    pub fn residuals(&self, state: &State, view: usize) -> Vec<Option<Vector2<f64>>> {
        let left_from_robot = (self.robot_from_head(state, view) * state.head_from_left).inverse();
        let seen = self.views[view].seen.iter();
        seen.map(|seen| self.residual_from(state, &left_from_robot, view, seen)).collect()
    }

    /// Twice the negative log-likelihood, up to a constant.
    pub fn cost(&self, state: &State) -> f64 {
        let mut pixels = 0.0;
        for (v, view) in self.views.iter().enumerate() {
            for (seen, residual) in view.seen.iter().zip(self.residuals(state, v)) {
                if !seen.left_out {
                    let r2 = residual.map_or(UNPROJECTABLE_PX.powi(2), |r| r.norm_squared());
                    pixels += match self.robust_px {
                        Some(c) => c * c * (r2 / (c * c)).ln_1p(),
                        None => r2,
                    };
                }
            }
        }
        let priors: f64 = self.priors(state).iter().map(|p| (p.off / p.sd).powi(2)).sum();
        pixels / self.priors.pixel_px.powi(2) + priors
    }

    /// What is known about parameters beside the pixels.
    pub fn priors(&self, state: &State) -> Vec<Prior> {
        let layout = self.layout();
        let mut priors = Vec::with_capacity(layout.total);
        let mut pose = |at: usize, now: &Isometry3<f64>, expected: &Isometry3<f64>, sd: (f64, f64)| {
            let turned = (now.rotation * expected.rotation.inverse()).scaled_axis();
            let moved = now.translation.vector - expected.translation.vector;
            for k in 0..3 {
                priors.push(Prior { index: at + k, off: turned[k], sd: sd.0 });
                priors.push(Prior { index: at + 3 + k, off: moved[k], sd: sd.1 });
            }
        };
        pose(0, &state.head_from_left, &self.expected.0, (ANYTHING, ANYTHING));
        if let Some(at) = layout.target {
            pose(at, &state.robot_from_target, &self.expected.1, self.priors.target);
        }
        if let (Some(at), Some(sd)) = (layout.zeros, self.priors.zero_rad) {
            for k in 0..2 {
                priors.push(Prior { index: at + k, off: state.zeros_rad[k], sd });
            }
        }
        for v in 0..self.views.len() {
            for k in 0..2 {
                let off = state.angle_error_rad[v][k];
                let sd = if self.unknown_angles == Some(v) { ANYTHING } else { self.priors.angle_rad[k] };
                priors.push(Prior { index: layout.angle(v, k), off, sd });
            }
            if let Some(sd) = self.priors.tip_m {
                for k in 0..3 {
                    priors.push(Prior { index: layout.tip(v) + k, off: state.tip_error_m[v][k], sd });
                }
            }
        }
        priors
    }

    /// Normal matrix and right-hand side of a Gauss–Newton step.
    pub fn normal_equations(&self, state: &State) -> (DMatrix<f64>, DVector<f64>) {
        let layout = self.layout();
        let mut matrix = DMatrix::zeros(layout.total, layout.total);
        let mut right = DVector::zeros(layout.total);
        let per_pixel = 1.0 / self.priors.pixel_px.powi(2);
        for (v, view) in self.views.iter().enumerate() {
            let head = self.head_pose(state, v);
            for seen in view.seen.iter().filter(|seen| !seen.left_out) {
                let Some(row) = self.row(state, &layout, &head, v, seen) else { continue };
                let robust =
                    self.robust_px.map_or(1.0, |c| 1.0 / (1.0 + row.residual.norm_squared() / (c * c)));
                let weight = per_pixel * robust;
                for (a, by_a) in &row.columns {
                    right[*a] += weight * by_a.dot(&row.residual);
                    for (b, by_b) in &row.columns {
                        matrix[(*a, *b)] += weight * by_a.dot(by_b);
                    }
                }
            }
        }
        for prior in self.priors(state) {
            matrix[(prior.index, prior.index)] += prior.sd.powi(-2);
            right[prior.index] -= prior.off * prior.sd.powi(-2);
        }
        (matrix, right)
    }

    /// One point: how its predicted pixel depends on the parameters.
    pub fn row(
        &self,
        state: &State,
        layout: &Layout,
        head: &HeadPose,
        view: usize,
        seen: &Seen,
    ) -> Option<Row> {
        let in_robot = self.point_in_robot(state, view, seen.index);
        let in_head = head.robot_from_head.inverse_transform_point(&in_robot);
        let in_left = state.head_from_left.inverse_transform_point(&in_head);
        let (in_eye, eye_from_left) = match seen.eye {
            Eye::Left => (in_left, Matrix3::identity()),
            Eye::Right => {
                let pose = &self.cameras.right_from_left.isometry;
                (pose * in_left, pose.rotation.to_rotation_matrix().into_inner())
            }
        };
        let lens = self.cameras.camera(seen.eye).model.project_with_jacobian(&in_eye.coords).ok()?;
        let left_from_head = state.head_from_left.rotation.inverse().to_rotation_matrix().into_inner();
        let head_from_robot = head.robot_from_head.rotation.inverse().to_rotation_matrix().into_inner();
        let by_head: Matrix2x3<f64> = lens.by_point * eye_from_left * left_from_head;
        let by_robot: Matrix2x3<f64> = by_head * head_from_robot;

        let mut columns = Vec::with_capacity(layout.total.min(24));
        let mut three = |at: usize, by: Matrix2x3<f64>| {
            columns.extend((0..3).map(|k| (at + k, by.column(k).into_owned())));
        };
        let arm = in_head.coords - state.head_from_left.translation.vector;
        three(0, by_head * arm.cross_matrix());
        three(3, -by_head);
        if self.priors.tip_m.is_some() {
            three(layout.tip(view), by_robot);
        } else if let Some(at) = layout.target {
            let turned = state.robot_from_target.rotation * self.points[seen.index];
            three(at, by_robot * -turned.cross_matrix());
            three(at + 3, by_robot);
        }
        for (k, (velocity, turning)) in head.by_angle.iter().enumerate() {
            let from_head = in_robot.coords - head.robot_from_head.translation.vector;
            let by_angle = -by_robot * (velocity + turning.cross(&from_head));
            columns.push((layout.angle(view, k), by_angle));
            if let Some(at) = layout.zeros {
                columns.push((at + k, by_angle));
            }
        }
        Some(Row { residual: seen.measured_px - lens.pixel_px, columns })
    }

    /// The state after a step.
    pub fn moved(&self, state: &State, step: &DVector<f64>) -> State {
        let layout = self.layout();
        let six = |at: usize| -> Vector6<f64> { step.fixed_rows::<6>(at).into_owned() };
        let mut moved = state.clone();
        moved.head_from_left = perturbed(&state.head_from_left, six(0).as_slice());
        if let Some(at) = layout.target {
            moved.robot_from_target = perturbed(&state.robot_from_target, six(at).as_slice());
        }
        if let Some(at) = layout.zeros {
            moved.zeros_rad = [state.zeros_rad[0] + step[at], state.zeros_rad[1] + step[at + 1]];
        }
        for v in 0..self.views.len() {
            for k in 0..2 {
                moved.angle_error_rad[v][k] += step[layout.angle(v, k)];
            }
            if self.priors.tip_m.is_some() {
                moved.tip_error_m[v] += step.fixed_rows::<3>(layout.tip(v));
            }
        }
        moved
    }

    /// Number of pixel coordinates that count.
    pub fn measurement_count(&self) -> usize {
        2 * self.views.iter().flat_map(|view| &view.seen).filter(|seen| !seen.left_out).count()
    }
}
