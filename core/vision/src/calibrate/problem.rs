//! The joint problem of both eyes and all board poses: parameters, residuals, normal equations.
//!
//! Residual = measured − predicted, pixels. Parameters in two parts: *shared* (left intrinsics,
//! right intrinsics, pose of the right eye) and one pose per *view* (`left_from_board`). Rotations
//! are changed by a small rotation vector on the left side. Triggs et al. (2000), "Bundle
//! adjustment — a modern synthesis", section 6: the views are eliminated by the Schur complement.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix6, Vector2, Vector3, Vector6};
use plumbline_model::camera::MAX_PARAMETERS;
use plumbline_model::{CameraModel, Eye, ModelKind, StereoCameras};

/// One measured corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub eye: Eye,
    /// Index on the board.
    pub index: usize,
    pub point_in_board: Vector3<f64>,
    pub measured_px: Vector2<f64>,
    /// Left-out corners keep their residual but pull on nothing.
    pub left_out: bool,
}

/// All corners of one board pose.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub name: String,
    pub corners: Vec<Corner>,
}

/// Everything that is estimated.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub models: [CameraModel; 2],
    pub right_from_left: Isometry3<f64>,
    /// One per view.
    pub left_from_board: Vec<Isometry3<f64>>,
}

/// Which shared parameters may change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Free {
    pub intrinsics: [bool; 2],
    pub right_from_left: bool,
}

/// What to fit.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub kind: ModelKind,
    pub views: Vec<View>,
    pub free: Free,
    /// Scale (px) of a Cauchy loss that weakens corners far from their prediction; `None` is plain
    /// least squares.
    pub robust_px: Option<f64>,
}

/// A view's share of the normal equations.
pub(super) struct ViewBlock {
    pub hessian: Matrix6<f64>,
    pub coupling: DMatrix<f64>,
    pub gradient: Vector6<f64>,
}

/// JᵀWJ and JᵀWr, arranged for elimination of the views.
pub(super) struct NormalEquations {
    pub shared: DMatrix<f64>,
    pub gradient: DVector<f64>,
    pub views: Vec<ViewBlock>,
}

/// Cost of a corner that its model cannot even project; keeps a bad step from looking good.
const UNPROJECTABLE_PX: f64 = 1e3;

impl State {
    pub fn from_cameras(cameras: &StereoCameras, left_from_board: Vec<Isometry3<f64>>) -> Self {
        Self {
            models: [cameras.left.model, cameras.right.model],
            right_from_left: cameras.right_from_left.isometry,
            left_from_board,
        }
    }

    /// Predicted pixel; `None` if the lens cannot see the point.
    pub fn predict(&self, view: usize, corner: &Corner) -> Option<Vector2<f64>> {
        let in_left = self.left_from_board[view] * nalgebra::Point3::from(corner.point_in_board);
        let in_eye = match corner.eye {
            Eye::Left => in_left,
            Eye::Right => self.right_from_left * in_left,
        };
        self.models[corner.eye.index()].project(&in_eye.coords).ok().map(|p| p.vector())
    }

    /// Measured minus predicted, pixels.
    pub fn residual(&self, view: usize, corner: &Corner) -> Option<Vector2<f64>> {
        Some(corner.measured_px - self.predict(view, corner)?)
    }
}

impl Problem {
    pub fn shared_count(&self) -> usize {
        2 * self.kind.parameter_count() + 6
    }

    /// Cost after the robust loss (px², one half left off).
    pub fn cost(&self, state: &State) -> f64 {
        self.active()
            .map(|(view, corner)| {
                let r2 = state.residual(view, corner).map_or(UNPROJECTABLE_PX.powi(2), |r| r.norm_squared());
                match self.robust_px {
                    Some(c) => c * c * (r2 / (c * c)).ln_1p(),
                    None => r2,
                }
            })
            .sum()
    }

    /// Corners that count, with the index of their view.
    pub fn active(&self) -> impl Iterator<Item = (usize, &Corner)> {
        self.views
            .iter()
            .enumerate()
            .flat_map(|(i, view)| view.corners.iter().filter(|c| !c.left_out).map(move |c| (i, c)))
    }

    pub fn normal_equations(&self, state: &State) -> NormalEquations {
        let n = self.shared_count();
        let mut equations = NormalEquations {
            shared: DMatrix::zeros(n, n),
            gradient: DVector::zeros(n),
            views: Vec::with_capacity(self.views.len()),
        };
        for (i, view) in self.views.iter().enumerate() {
            let mut block = ViewBlock {
                hessian: Matrix6::zeros(),
                coupling: DMatrix::zeros(6, n),
                gradient: Vector6::zeros(),
            };
            for corner in view.corners.iter().filter(|c| !c.left_out) {
                self.add_corner(state, i, corner, &mut equations, &mut block);
            }
            equations.views.push(block);
        }
        self.hold_fixed(&mut equations);
        equations
    }

    /// Adds the two residuals of one corner.
    fn add_corner(
        &self,
        state: &State,
        view: usize,
        corner: &Corner,
        equations: &mut NormalEquations,
        block: &mut ViewBlock,
    ) {
        let count = self.kind.parameter_count();
        let pose = &state.left_from_board[view];
        let turned = pose.rotation * corner.point_in_board;
        let in_left = turned + pose.translation.vector;
        let (in_eye, eye_from_left) = match corner.eye {
            Eye::Left => (in_left, Matrix3::identity()),
            Eye::Right => {
                let rotation = state.right_from_left.rotation.to_rotation_matrix().into_inner();
                (rotation * in_left + state.right_from_left.translation.vector, rotation)
            }
        };
        let Ok(jacobian) = state.models[corner.eye.index()].project_with_jacobian(&in_eye) else { return };
        let residual = corner.measured_px - jacobian.pixel_px;
        let weight = self.robust_px.map_or(1.0, |c| 1.0 / (1.0 + residual.norm_squared() / (c * c)));

        let by_left = jacobian.by_point * eye_from_left;
        let mut by_view = nalgebra::Matrix2x6::<f64>::zeros();
        by_view.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_left * -turned.cross_matrix()));
        by_view.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_left);

        // The shared columns that this corner touches: its own lens and, on the right, the rig.
        let mut columns = [0usize; MAX_PARAMETERS + 6];
        let mut by_shared = [Vector2::<f64>::zeros(); MAX_PARAMETERS + 6];
        let mut used = 0;
        for i in 0..count {
            columns[used] = corner.eye.index() * count + i;
            by_shared[used] = jacobian.by_parameter.column(i).into_owned();
            used += 1;
        }
        if corner.eye == Eye::Right {
            let by_rotation = jacobian.by_point * -(eye_from_left * in_left).cross_matrix();
            for i in 0..3 {
                columns[used] = 2 * count + i;
                by_shared[used] = by_rotation.column(i).into_owned();
                columns[used + 1] = 2 * count + 3 + i;
                by_shared[used + 1] = jacobian.by_point.column(i).into_owned();
                used += 2;
            }
        }
        for a in 0..used {
            let weighted = by_shared[a] * weight;
            equations.gradient[columns[a]] += weighted.dot(&residual);
            for b in 0..used {
                equations.shared[(columns[a], columns[b])] += weighted.dot(&by_shared[b]);
            }
            for row in 0..6 {
                block.coupling[(row, columns[a])] += weighted.dot(&by_view.column(row));
            }
        }
        block.hessian += by_view.transpose() * by_view * weight;
        block.gradient += by_view.transpose() * residual * weight;
    }

    /// Parameters that may not change get an equation that says so.
    fn hold_fixed(&self, equations: &mut NormalEquations) {
        let count = self.kind.parameter_count();
        let is_free = |i: usize| match i / count {
            eye @ (0 | 1) if i < 2 * count => self.free.intrinsics[eye],
            _ => self.free.right_from_left,
        };
        for i in (0..self.shared_count()).filter(|&i| !is_free(i)) {
            equations.shared.row_mut(i).fill(0.0);
            equations.shared.column_mut(i).fill(0.0);
            equations.shared[(i, i)] = 1.0;
            equations.gradient[i] = 0.0;
            for block in &mut equations.views {
                block.coupling.column_mut(i).fill(0.0);
            }
        }
    }

    /// Number of parameters that are estimated.
    pub fn free_count(&self) -> usize {
        let count = self.kind.parameter_count();
        self.free.intrinsics.iter().filter(|&&f| f).count() * count
            + if self.free.right_from_left { 6 } else { 0 }
            + 6 * self.views.len()
    }

    /// The state after a step.
    pub fn moved(&self, state: &State, shared: &DVector<f64>, views: &[Vector6<f64>]) -> State {
        let count = self.kind.parameter_count();
        let lens = |eye: usize| {
            if !self.free.intrinsics[eye] {
                return state.models[eye];
            }
            let mut p = state.models[eye].parameters();
            for (i, value) in p.iter_mut().enumerate() {
                *value += shared[eye * count + i];
            }
            CameraModel::from_parameters(self.kind, &p)
        };
        let rig = Vector6::from_iterator(shared.iter().skip(2 * count).copied());
        State {
            models: [lens(0), lens(1)],
            right_from_left: perturb(&state.right_from_left, &rig),
            left_from_board: state
                .left_from_board
                .iter()
                .zip(views)
                .map(|(pose, d)| perturb(pose, d))
                .collect(),
        }
    }
}

/// Turns by the rotation vector in the first three entries, then moves by the last three.
fn perturb(pose: &Isometry3<f64>, d: &Vector6<f64>) -> Isometry3<f64> {
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(d[0], d[1], d[2]));
    let mut rotation = turn * pose.rotation;
    rotation.renormalize();
    Isometry3::from_parts((pose.translation.vector + Vector3::new(d[3], d[4], d[5])).into(), rotation)
}
