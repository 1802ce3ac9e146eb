//! From a solution to a result that carries its evidence.

use nalgebra::Matrix6;
use plumbline_model::robot::Rig;
use plumbline_model::{CornerResidual, Eye, Pose, RejectedPair, StereoCameras};

use super::observability::not_seen;
use super::optimizer::Solved;
use super::types::{
    Estimate, HeadView, MountCalibration, MountChange, MountEvidence, MountOptions, Target, ViewFit,
};

/// `None` if a solved point cannot be projected, which a solution does not have.
pub(super) fn calibration(
    rig: &Rig,
    cameras: &StereoCameras,
    views: &[HeadView],
    target: &Target,
    options: &MountOptions,
    solved: Solved,
    rejected: Vec<RejectedPair>,
) -> Option<MountCalibration> {
    let Solved { problem, state, covariance } = &solved;
    let layout = problem.layout();
    let six = |at: usize| -> Matrix6<f64> { covariance.fixed_view::<6, 6>(at, at).into_owned() };
    let unknown = matches!(target, Target::UnknownBoard(_));
    let head_from_left = Pose::new(state.head_from_left);
    let per_view: Vec<ViewFit> =
        (0..problem.views.len()).map(|v| view_fit(&solved, v)).collect::<Option<_>>()?;
    let counted = per_view.iter().flat_map(|view| &view.residuals).filter(|r| !r.left_out);
    let squares: Vec<f64> = counted.map(|r| r.norm_px().powi(2)).collect();
    Some(MountCalibration {
        head_from_left,
        covariance: six(0),
        head_zeros_rad: layout.zeros.map(|at| {
            [0, 1].map(|k| Estimate { value: state.zeros_rad[k], sigma: covariance[(at + k, at + k)].sqrt() })
        }),
        robot_from_board: unknown.then(|| Pose::new(state.robot_from_target)),
        board_covariance: layout.target.filter(|_| unknown).map(six),
        rms_px: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
        pixel_sigma_px: problem.priors.pixel_px,
        angle_sigma_rad: problem.priors.angle_rad,
        per_view,
        rejected,
        not_seen: not_seen(rig, target, &layout, &problem.priors, covariance),
        change: MountChange::between(&rig.eyes.head_from_left, &head_from_left),
        evidence: MountEvidence {
            rig: rig.name.clone(),
            joints: rig.description.movable().map(|joint| joint.name.clone()).collect(),
            nominal: rig.eyes.head_from_left,
            cameras: *cameras,
            target: target.clone(),
            options: options.clone(),
            views: views.to_vec(),
            created: jiff::Timestamp::now(),
            software: concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned(),
        },
    })
}

fn view_fit(solved: &Solved, view: usize) -> Option<ViewFit> {
    let Solved { problem, state, .. } = solved;
    let mut residuals = vec![];
    for (seen, error) in problem.views[view].seen.iter().zip(problem.residuals(state, view)) {
        // A bad point may lie beyond the lens; it was left out and has no residual.
        let Some(error) = error else {
            if seen.left_out {
                continue;
            }
            return None;
        };
        residuals.push(CornerResidual {
            eye: seen.eye,
            corner: seen.index,
            measured: seen.measured_px.into(),
            error_px: [error.x, error.y],
            left_out: seen.left_out,
        });
    }
    let rms_px = |eye: Eye| {
        let squares: Vec<f64> =
            residuals.iter().filter(|r| r.eye == eye && !r.left_out).map(|r| r.norm_px().powi(2)).collect();
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    };
    Some(ViewFit {
        name: problem.views[view].name.clone(),
        left_px: rms_px(Eye::Left),
        right_px: rms_px(Eye::Right),
        angle_error_rad: state.angle_error_rad[view],
        residuals,
    })
}
