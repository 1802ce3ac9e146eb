//! Hand–eye calibration: how the eyes sit in the head.
//!
//! Needs calibrated eyes and something that the head looks at from several poses: a chessboard
//! that lies still anywhere, points whose place is known (the corners of the touchscreen), or the
//! robot's own fingertip. One least-squares problem over the pixels of both raw images, in which
//! the head's angles are uncertain too, because encoders count in ticks and gears have slack.
//!
//! Assumes a rigid head, and head joints as the description has them. Broken when residuals of a
//! view point the same way (the board or the robot moved) or the head angles scatter much more
//! than their encoders' ticks ([`MountCalibration::angle_sigma_rad`]).

mod error;
mod file;
mod inputs;
mod lens;
mod localization;
mod observability;
mod optimizer;
mod plan;
mod prepare;
mod problem;
mod reject;
mod report;
mod start;
mod state;
#[cfg(test)]
mod tests;
mod types;

use nalgebra::{Isometry3, Point3};
use plumbline_model::frame::Board;
use plumbline_model::robot::Rig;
use plumbline_model::{Chessboard, JobContext, Pose, Robot, StereoCameras};

pub use error::MountError;
pub use file::MountFileError;
pub use localization::{Improvement, LocatedPoint, localization_improvement};
pub use plan::{PlannedTarget, expected_sigma, plan_head_views};
pub use report::is_included;
pub use types::{
    Estimate, Eyes, HeadView, MountCalibration, MountChange, MountEvidence, MountOptions, Target, ViewFit,
    mount_numbers,
};

/// Calibrates how the eyes sit in the head.
///
/// `eyes` are the calibrated eyes (`&StereoCalibration`, or `&StereoCameras` without their
/// uncertainty); `rig` gives the kinematics and the nominal mount, which may be far off.
pub fn calibrate_mount<'a>(
    rig: &Rig,
    eyes: impl Into<Eyes<'a>>,
    views: &[HeadView],
    target: &Target,
    options: &MountOptions,
    context: &dyn JobContext,
) -> Result<MountCalibration, MountError> {
    let eyes: Eyes<'a> = eyes.into();
    context.report(0.0, "finding where the views agree");
    let unknown = matches!(target, Target::UnknownBoard(_));
    let fewest = match target {
        Target::UnknownBoard(_) => prepare::FEWEST_OF_UNKNOWN,
        Target::KnownPoints(_) => 2,
        Target::Fingertip { .. } => 4,
    };
    let prepared = prepare::prepare(rig, eyes.cameras, views, target, options)?;
    if prepared.problem.views.len() < fewest {
        return Err(MountError::TooFewViews {
            found: prepared.problem.views.len(),
            needed: fewest,
            rejected: prepare::sentences(&prepared.rejected),
        });
    }
    let check_poses = |problem: &problem::Problem| {
        let place = |view: &problem::View| problem.neck.chain.robot_from_tip(&view.encoder_rad).isometry;
        let heads: Vec<Isometry3<f64>> = problem.views.iter().map(place).collect();
        observability::check_head_poses(rig, &problem.views, problem.neck.pan_tilt, &heads)
    };
    if unknown {
        check_poses(&prepared.problem)?;
    }

    context.report(0.2, "solving with a robust loss");
    let prepared = reject::reject_views(prepared, fewest, context)?;
    let prepare::Prepared { mut problem, state, rejected, .. } = prepared;
    if unknown {
        check_poses(&problem)?;
    }
    reject::leave_out_bad_points(&mut problem, &state);
    problem.robust_px = None;

    context.report(0.6, "solving, and estimating uncertainty");
    let solved = optimizer::solve_with_noise(problem, state, context)?.ok_or(MountError::Undetermined)?;
    let asked = report::Asked { rig, eyes, views, target, options };
    report::calibration(&asked, solved, rejected).ok_or(MountError::Undetermined)
}

/// Where a board lies according to one view and the rig's mount: good enough to plan views of it.
///
/// # Errors
/// When the view does not show the board, or does not fit the rig.
pub fn place_of_board(
    rig: &Rig,
    cameras: &StereoCameras,
    view: &HeadView,
    board: &Chessboard,
) -> Result<Pose<Robot, Board>, MountError> {
    inputs::check_view(rig, view, board.corner_count())?;
    let points: Vec<_> = board.corners().iter().map(|corner| corner.coords.coords).collect();
    let (left_from_board, _) = start::left_from_target(cameras, &points, &inputs::seen_of(view))
        .filter(|(pose, _)| (pose * Point3::from(points[0])).z > 0.0)
        .ok_or(MountError::NotSeen { views: 1 })?;
    Ok(rig.robot_from_left(&view.posture) * Pose::new(left_from_board))
}
