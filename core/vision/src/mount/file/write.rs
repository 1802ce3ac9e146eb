//! From a mount to the keys of its file.

use nalgebra::{Isometry3, Matrix6};
use plumbline_model::{Camera, CameraModel, CornerResidual, Corners};

use super::FORMAT;
use super::parts::{
    CamerasPart, CovariancePart, EndPart, EvidencePart, File, FitPart, LensPart, PixelPart, PosePart,
    TargetPart, ViewPart,
};
use crate::mount::types::{HeadView, MountCalibration, Target, ViewFit};

pub(super) fn parts(mount: &MountCalibration) -> File {
    let evidence = &mount.evidence;
    File {
        format: FORMAT,
        rig: evidence.rig.clone(),
        rms_px: mount.rms_px,
        pixel_sigma_px: mount.pixel_sigma_px,
        angle_sigma_rad: mount.angle_sigma_rad,
        not_seen: mount.not_seen.clone(),
        remarks: mount.remarks.clone(),
        covariance: rows(&mount.covariance),
        head_from_left: pose_part(&mount.head_from_left.isometry),
        head_zeros_rad: mount.head_zeros_rad,
        robot_from_board: mount.robot_from_board.map(|pose| pose_part(&pose.isometry)),
        board_covariance: mount.board_covariance.map(|matrix| CovariancePart { rows: rows(&matrix) }),
        rejected: mount.rejected.clone(),
        fit: mount.per_view.iter().map(fit_part).collect(),
        evidence: EvidencePart {
            created: evidence.created,
            software: evidence.software.clone(),
            minutes_since_on: evidence.minutes_since_on,
            joints: evidence.joints.clone(),
            options: evidence.options.clone(),
            nominal_head_from_left: pose_part(&evidence.nominal.isometry),
            target: target_part(&evidence.target),
            cameras: CamerasPart {
                left: lens_part(&evidence.cameras.left),
                right: lens_part(&evidence.cameras.right),
                right_from_left: pose_part(&evidence.cameras.right_from_left.isometry),
            },
            view: evidence.views.iter().map(view_part).collect(),
        },
        end: EndPart { complete: true },
    }
}

fn rows(matrix: &Matrix6<f64>) -> [[f64; 6]; 6] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

fn pose_part(pose: &Isometry3<f64>) -> PosePart {
    let q = pose.rotation.quaternion();
    PosePart { rotation_wxyz: [q.w, q.i, q.j, q.k], translation_m: pose.translation.vector.into() }
}

fn fit_part(fit: &ViewFit) -> FitPart {
    let residual = |r: &CornerResidual| {
        (r.eye, r.corner, r.measured.u_px, r.measured.v_px, r.error_px[0], r.error_px[1], r.left_out)
    };
    FitPart {
        name: fit.name.clone(),
        left_px: fit.left_px,
        right_px: fit.right_px,
        angle_error_rad: fit.angle_error_rad,
        residuals: fit.residuals.iter().map(residual).collect(),
    }
}

fn target_part(target: &Target) -> TargetPart {
    match target {
        Target::UnknownBoard(board) => TargetPart::UnknownBoard {
            inner_columns: board.inner_columns,
            inner_rows: board.inner_rows,
            square_m: board.square_m,
        },
        Target::KnownPoints(points) => {
            TargetPart::KnownPoints { points_m: points.iter().map(|p| p.coords.coords.into()).collect() }
        }
        Target::Fingertip { tip } => TargetPart::Fingertip { tip: tip.clone() },
    }
}

fn lens_part(camera: &Camera) -> LensPart {
    LensPart {
        model: camera.model.kind(),
        width_px: camera.width_px,
        height_px: camera.height_px,
        parameters: camera.model.parameters(),
        skew_px: match camera.model {
            CameraModel::Fisheye(lens) => lens.skew_px,
            CameraModel::Pinhole(_) => 0.0,
        },
    }
}

fn view_part(view: &HeadView) -> ViewPart {
    let pixels = |corners: &Corners| -> Vec<PixelPart> {
        corners.iter().map(|p| p.map_or_else(Vec::new, |p| vec![p.u_px, p.v_px])).collect()
    };
    ViewPart {
        name: view.name.clone(),
        angles_rad: view.posture.angles_rad().to_vec(),
        left: view.left.as_ref().map(pixels),
        right: view.right.as_ref().map(pixels),
    }
}
