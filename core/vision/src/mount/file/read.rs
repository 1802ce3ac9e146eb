//! From the keys of the file to a mount, every value checked.

use std::path::Path;

use nalgebra::{Isometry3, Matrix6, Point3, Quaternion, Translation3, UnitQuaternion};
use plumbline_model::decompose;
use plumbline_model::plausible::{self, Quantity};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{
    Camera, CameraModel, Chessboard, CornerResidual, Corners, Pixel, Point, Pose, StereoCameras,
};

use super::MountFileError;
use super::parts::{EvidencePart, File, FitPart, LensPart, PixelPart, PosePart, TargetPart, ViewPart};
use crate::mount::types::{HeadView, MountCalibration, MountChange, MountEvidence, Target, ViewFit};

/// A quaternion's squared length may miss 1 by this.
const QUATERNION_TOLERANCE: f64 = 1e-9;
/// An eye farther from the head's joint than this is no eye, m.
const FARTHEST_EYE_M: f64 = 1.0;

/// Knows where it reads, for its errors.
pub(super) struct Reader<'a> {
    pub file: &'a Path,
}

impl Reader<'_> {
    pub fn mount(&self, parts: File, rig: &Rig) -> Result<MountCalibration, MountFileError> {
        let joints: Vec<String> = rig.description.movable().map(|joint| joint.name.clone()).collect();
        let other = |made_for: String, rig: String| {
            Err(MountFileError::OtherRig { file: self.file.to_path_buf(), made_for, rig })
        };
        if parts.rig != rig.name {
            return other(format!("the rig {}", parts.rig), format!("the rig {}", rig.name));
        }
        if parts.evidence.joints != joints {
            let joints = |names: &[String]| format!("a robot with the joints {}", names.join(", "));
            return other(
                joints(&parts.evidence.joints),
                joints(&rig.description.movable().map(|j| j.name.clone()).collect::<Vec<_>>()),
            );
        }
        if !parts.end.complete {
            return Err(
                self.value("end.complete", "is not true: the file is not whole, calibrate the mount again")
            );
        }
        let head_from_left = Pose::new(self.pose("head_from_left", &parts.head_from_left)?);
        if head_from_left.translation_m().norm() > FARTHEST_EYE_M {
            let what = format!(
                "puts the eye more than {FARTHEST_EYE_M} m away from the head's joint; lengths are in meters"
            );
            return Err(self.value("head_from_left.translation_m", &what));
        }
        self.positive("rms_px", parts.rms_px)?;
        self.positive("pixel_sigma_px", parts.pixel_sigma_px)?;
        self.finite("angle_sigma_rad", &parts.angle_sigma_rad)?;
        for zero in parts.head_zeros_rad.iter().flatten() {
            self.plausible("head_zeros_rad", plausible::ANGLE_RAD, &[zero.value, zero.sigma])?;
        }
        let board = parts.robot_from_board.map(|part| self.pose("robot_from_board", &part)).transpose()?;
        if let Some(board) = &board {
            self.plausible("robot_from_board", plausible::PLACE_M, board.translation.vector.as_slice())?;
        }
        let board_covariance =
            parts.board_covariance.map(|part| self.covariance("board_covariance", &part.rows)).transpose()?;
        let evidence = self.evidence(parts.evidence, parts.rig)?;
        Ok(MountCalibration {
            covariance: self.covariance("covariance", &parts.covariance)?,
            head_zeros_rad: parts.head_zeros_rad,
            robot_from_board: board.map(Pose::new),
            board_covariance,
            rms_px: parts.rms_px,
            pixel_sigma_px: parts.pixel_sigma_px,
            angle_sigma_rad: parts.angle_sigma_rad,
            per_view: parts.fit.into_iter().map(|part| self.fit(part)).collect::<Result<_, _>>()?,
            rejected: parts.rejected,
            not_seen: parts.not_seen,
            remarks: parts.remarks,
            change: MountChange::between(&evidence.nominal, &head_from_left),
            head_from_left,
            evidence,
        })
    }

    fn value(&self, place: &str, what: &str) -> MountFileError {
        MountFileError::Value {
            file: self.file.to_path_buf(),
            place: place.to_owned(),
            what: what.to_owned(),
        }
    }

    fn finite(&self, place: &str, values: &[f64]) -> Result<(), MountFileError> {
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.value(place, &format!("{value} is not a number that can be used"))),
            None => Ok(()),
        }
    }

    fn plausible(&self, place: &str, quantity: Quantity, values: &[f64]) -> Result<(), MountFileError> {
        self.finite(place, values)?;
        quantity.check_all(values).map_err(|what| self.value(place, &what.to_string()))
    }

    fn positive(&self, place: &str, value: f64) -> Result<(), MountFileError> {
        self.finite(place, &[value])?;
        if value < 0.0 {
            return Err(self.value(place, &format!("{value} must not be negative")));
        }
        Ok(())
    }

    fn pose(&self, place: &str, part: &PosePart) -> Result<Isometry3<f64>, MountFileError> {
        self.finite(place, &part.rotation_wxyz)?;
        self.finite(place, &part.translation_m)?;
        let [w, x, y, z] = part.rotation_wxyz;
        let quaternion = Quaternion::new(w, x, y, z);
        if (quaternion.norm_squared() - 1.0).abs() > QUATERNION_TOLERANCE {
            return Err(self.value(place, "rotation_wxyz must be a quaternion (w, x, y, z) of length 1"));
        }
        // Unchecked: normalizing once more would change the last digits.
        let rotation = UnitQuaternion::new_unchecked(quaternion);
        Ok(Isometry3::from_parts(Translation3::from(part.translation_m), rotation))
    }

    fn covariance(&self, place: &str, rows: &[[f64; 6]; 6]) -> Result<Matrix6<f64>, MountFileError> {
        self.finite(place, rows.as_flattened())?;
        let matrix = Matrix6::from_fn(|i, j| rows[i][j]);
        let scale = matrix.amax();
        let symmetric = (matrix - matrix.transpose()).amax() <= 1e-9 * scale;
        let least = decompose::symmetric_eigenvalues(matrix).map(|variances| variances.min());
        if !symmetric || least.is_none_or(|least| least < -1e-9 * scale) {
            return Err(self.value(place, "must be symmetric, with no negative variance along any direction"));
        }
        Ok(matrix)
    }

    fn fit(&self, part: FitPart) -> Result<ViewFit, MountFileError> {
        let place = format!("fit of view \"{}\"", part.name);
        self.finite(&place, &part.angle_error_rad)?;
        for px in [part.left_px, part.right_px].into_iter().flatten() {
            self.positive(&place, px)?;
        }
        let mut residuals = Vec::with_capacity(part.residuals.len());
        for (eye, corner, u, v, du, dv, left_out) in part.residuals {
            self.plausible(&place, plausible::IMAGE_PX, &[u, v])?;
            self.plausible(&place, plausible::ERROR_PX, &[du, dv])?;
            residuals.push(CornerResidual {
                eye,
                corner,
                measured: Pixel::new(u, v),
                error_px: [du, dv],
                left_out,
            });
        }
        Ok(ViewFit {
            name: part.name,
            left_px: part.left_px,
            right_px: part.right_px,
            angle_error_rad: part.angle_error_rad,
            residuals,
        })
    }

    fn evidence(&self, part: EvidencePart, rig: String) -> Result<MountEvidence, MountFileError> {
        let target = self.target(part.target)?;
        let views =
            part.view.into_iter().map(|view| self.view(view, part.joints.len())).collect::<Result<_, _>>()?;
        let apart = self.pose("evidence.cameras.right_from_left", &part.cameras.right_from_left)?;
        if let Some(minutes) = part.minutes_since_on {
            self.positive("evidence.minutes_since_on", minutes)?;
        }
        let place = "evidence.cameras.right_from_left";
        self.plausible(place, plausible::BASELINE_M, &[apart.translation.vector.norm()])?;
        Ok(MountEvidence {
            rig,
            joints: part.joints,
            nominal: Pose::new(self.pose("evidence.nominal_head_from_left", &part.nominal_head_from_left)?),
            cameras: StereoCameras {
                left: self.lens("evidence.cameras.left", &part.cameras.left)?,
                right: self.lens("evidence.cameras.right", &part.cameras.right)?,
                right_from_left: Pose::new(apart),
            },
            target,
            options: part.options,
            views,
            created: part.created,
            software: part.software,
            minutes_since_on: part.minutes_since_on,
        })
    }

    fn target(&self, part: TargetPart) -> Result<Target, MountFileError> {
        Ok(match part {
            TargetPart::UnknownBoard { inner_columns, inner_rows, square_m } => Target::UnknownBoard(
                Chessboard::new(inner_columns, inner_rows, square_m)
                    .map_err(|error| self.value("evidence.target", &error.to_string()))?,
            ),
            TargetPart::KnownPoints { points_m } => {
                self.plausible("evidence.target.points_m", plausible::PLACE_M, points_m.as_flattened())?;
                Target::KnownPoints(points_m.into_iter().map(|p| Point::from(Point3::from(p))).collect())
            }
            TargetPart::Fingertip { tip } => Target::Fingertip { tip },
        })
    }

    fn lens(&self, place: &str, part: &LensPart) -> Result<Camera, MountFileError> {
        self.finite(place, &part.parameters)?;
        self.finite(place, &[part.skew_px])?;
        let count = part.model.parameter_count();
        if part.parameters.len() != count {
            let names = part.model.parameter_names().join(", ");
            return Err(self.value(place, &format!("needs {count} parameters: {names}")));
        }
        let mut model = CameraModel::from_parameters(part.model, &part.parameters);
        if let CameraModel::Fisheye(lens) = &mut model {
            lens.skew_px = part.skew_px;
        }
        let camera = Camera { model, width_px: part.width_px, height_px: part.height_px };
        camera.check_plausible().map_err(|what| self.value(place, &what.to_string()))?;
        Ok(camera)
    }

    fn view(&self, part: ViewPart, joints: usize) -> Result<HeadView, MountFileError> {
        let place = format!("evidence.view \"{}\"", part.name);
        self.plausible(&place, plausible::JOINT_ANGLE_RAD, &part.angles_rad)?;
        if part.angles_rad.len() != joints {
            return Err(self.value(&place, &format!("needs one angle for each of {joints} joints")));
        }
        let pixels = |rows: Vec<PixelPart>| -> Result<Corners, MountFileError> {
            rows.into_iter()
                .map(|row| {
                    self.plausible(&place, plausible::IMAGE_PX, &row)?;
                    match row[..] {
                        [] => Ok(None),
                        [u, v] => Ok(Some(Pixel::new(u, v))),
                        _ => Err(self.value(&place, "a pixel is [u, v], or [] where none was measured")),
                    }
                })
                .collect()
        };
        Ok(HeadView {
            left: part.left.map(pixels).transpose()?,
            right: part.right.map(pixels).transpose()?,
            posture: Posture::new(part.angles_rad),
            name: part.name,
        })
    }
}
