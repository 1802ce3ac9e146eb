//! From a solution to a result that carries its evidence.

use nalgebra::Matrix6;
use plumbline_model::robot::Rig;
use plumbline_model::{CornerResidual, Eye, Pose, RejectedPair};

use super::lens;
use super::observability::not_seen;
use super::optimizer::Solved;
use super::problem::{Problem, State};
use super::types::{
    Estimate, Eyes, HeadView, MountCalibration, MountChange, MountEvidence, MountOptions, Target, ViewFit,
};

/// What was asked for.
pub(super) struct Asked<'a> {
    pub rig: &'a Rig,
    pub eyes: Eyes<'a>,
    pub views: &'a [HeadView],
    pub target: &'a Target,
    pub options: &'a MountOptions,
}

/// `None` if a solved point cannot be projected, which a solution does not have.
pub(super) fn calibration(
    asked: &Asked<'_>,
    solved: Solved,
    rejected: Vec<RejectedPair>,
) -> Option<MountCalibration> {
    let Asked { rig, eyes, views, target, options } = *asked;
    let Solved { problem, state, .. } = &solved;
    let of_lenses = eyes.covariance.and_then(|covariance| lens::share(&solved, covariance));
    let covariance = match &of_lenses {
        Some(share) => &solved.covariance + share,
        None => solved.covariance.clone(),
    };
    let covariance = &covariance;
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
        remarks: remarks(asked, problem, state, of_lenses.is_some()),
        change: MountChange::between(&rig.eyes.head_from_left, &head_from_left),
        evidence: MountEvidence {
            rig: rig.name.clone(),
            joints: rig.description.movable().map(|joint| joint.name.clone()).collect(),
            nominal: rig.eyes.head_from_left,
            cameras: *eyes.cameras,
            target: target.clone(),
            options: options.clone(),
            views: views.to_vec(),
            created: jiff::Timestamp::now(),
            software: concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned(),
            minutes_since_on: None,
        },
    })
}

/// How a remark ends on what is in the stated uncertainty already.
const INCLUDED: &str = "the stated uncertainty includes it";

/// Whether a remark is of what the stated uncertainty holds already, so that it is no doubt of that.
pub fn is_included(remark: &str) -> bool {
    remark.ends_with(INCLUDED)
}

/// What else the operator should know.
fn remarks(asked: &Asked<'_>, problem: &Problem, state: &State, lenses_included: bool) -> Vec<String> {
    let Asked { rig, target, options, .. } = asked;
    let mut remarks = vec![];
    let stated_rad = options.angle_sd_rad();
    for (joint, sd_rad) in [rig.eyes.pan, rig.eyes.tilt].into_iter().zip(problem.priors.angle_rad) {
        if sd_rad > 1.2 * stated_rad {
            remarks.push(format!(
                "the joint \"{}\" stands ±{:.2}° from where its encoder says, more than the ±{:.2}° expected: its gears have slack, or the head had not come to rest; {INCLUDED}",
                rig.joint_title(joint),
                sd_rad.to_degrees(),
                stated_rad.to_degrees()
            ));
        }
    }
    if matches!(target, Target::KnownPoints(_)) && problem.free_target {
        let moved_m =
            (state.robot_from_target.translation.vector - problem.expected.1.translation.vector).norm();
        let turned_rad = state.robot_from_target.rotation.angle_to(&problem.expected.1.rotation);
        let (turn_sd, place_sd) = problem.priors.target;
        // Three axes together stay below four times the deviation of one in 999 of 1000 cases.
        if moved_m > 4.0 * place_sd || turned_rad > 4.0 * turn_sd {
            remarks.push(format!(
                "the known points lie {:.1} mm and {:.2}° away from where they were said to be, more than the ±{:.1} mm and ±{:.2}° expected: measure their place again",
                moved_m * 1e3,
                turned_rad.to_degrees(),
                place_sd * 1e3,
                turn_sd.to_degrees()
            ));
        }
    }
    if matches!(target, Target::Fingertip { .. }) {
        remarks.push(
            "errors of the arm that are the same in all views, such as zeros of its encoders, are now part of the mount: check it with a board or with the touchscreen".to_owned(),
        );
    }
    if !lenses_included {
        remarks.push(
            "the uncertainty of the eyes' own calibration is not known and not included: calibrate the eyes from board pairs to have it".to_owned(),
        );
    }
    remarks
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
