//! What the uncertainty of the eyes' own calibration adds to that of the mount.

use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};
use plumbline_model::{Eye, ParameterCovariance};

use super::optimizer::Solved;
use super::problem::{Problem, Seen, State};

/// Covariance of all parameters from that of the eyes' calibration, to first order: a lens that is
/// off moves the solution by −N⁻¹ Jᵀ W L times its error, with L how pixels depend on the lens.
/// `None` if the covariance is not that of these lenses.
pub(super) fn share(solved: &Solved, lenses: &ParameterCovariance) -> Option<DMatrix<f64>> {
    let Solved { problem, state, covariance } = solved;
    let counts = Eye::BOTH.map(|eye| problem.cameras.camera(eye).model.kind().parameter_count());
    let total = counts[0] + counts[1] + 6;
    if lenses.matrix.nrows() != total || lenses.matrix.ncols() != total {
        return None;
    }
    let layout = problem.layout();
    let mut coupling = DMatrix::zeros(layout.total, total);
    let weight = problem.priors.pixel_px.powi(-2);
    for (v, view) in problem.views.iter().enumerate() {
        let head = problem.head_pose(state, v);
        for seen in view.seen.iter().filter(|seen| !seen.left_out) {
            let row = problem.row(state, &layout, &head, v, seen)?;
            for (column, by_lens) in by_lens(problem, state, v, seen, counts)? {
                for (parameter, by_parameter) in &row.columns {
                    coupling[(*parameter, column)] += weight * by_parameter.dot(&by_lens);
                }
            }
        }
    }
    let carried = covariance * coupling;
    Some(&carried * &lenses.matrix * carried.transpose())
}

/// How a predicted pixel depends on the parameters of the eyes' calibration, in their order.
fn by_lens(
    problem: &Problem,
    state: &State,
    view: usize,
    seen: &Seen,
    counts: [usize; 2],
) -> Option<Vec<(usize, Vector2<f64>)>> {
    let left_from_robot = (problem.robot_from_head(state, view) * state.head_from_left).inverse();
    let in_left = left_from_robot * problem.point_in_robot(state, view, seen.index);
    let right_from_left = &problem.cameras.right_from_left.isometry;
    let (in_eye, first) = match seen.eye {
        Eye::Left => (in_left, 0),
        Eye::Right => (right_from_left * in_left, counts[0]),
    };
    let lens = problem.cameras.camera(seen.eye).model.project_with_jacobian(&in_eye.coords).ok()?;
    let own = 0..counts[seen.eye.index()];
    let mut columns: Vec<_> = own.map(|i| (first + i, lens.by_parameter.column(i).into_owned())).collect();
    if seen.eye == Eye::Right {
        let turned: Vector3<f64> = right_from_left.rotation * in_left.coords;
        let by_turn = lens.by_point * -turned.cross_matrix();
        let by_shift = lens.by_point * Matrix3::identity();
        let rig = counts[0] + counts[1];
        for k in 0..3 {
            columns.push((rig + k, by_turn.column(k).into_owned()));
            columns.push((rig + 3 + k, by_shift.column(k).into_owned()));
        }
    }
    Some(columns)
}
