//! What goes into a calibration of the eyes' mount, and what comes out.

use nalgebra::{Isometry3, Matrix6, SMatrix, UnitQuaternion, Vector3};
use plumbline_model::decompose;
use plumbline_model::frame::{Board, Head, LeftCamera};
use plumbline_model::robot::{CalibratedAt, EyeMount, Posture, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::{
    Chessboard, Corners, Eye, PairObservation, ParameterCovariance, Point, Pose, RejectedPair, Robot,
    StereoCalibration, StereoCameras,
};
use serde::{Deserialize, Serialize};

/// The calibrated eyes, and how well they are known.
#[derive(Clone, Copy, Debug)]
pub struct Eyes<'a> {
    /// Lenses and how the eyes sit to each other.
    pub cameras: &'a StereoCameras,
    /// How well these are known; `None` leaves this part out of the mount's uncertainty.
    pub covariance: Option<&'a ParameterCovariance>,
}

impl<'a> From<&'a StereoCameras> for Eyes<'a> {
    fn from(cameras: &'a StereoCameras) -> Self {
        Self { cameras, covariance: None }
    }
}

impl<'a> From<&'a StereoCalibration> for Eyes<'a> {
    fn from(calibration: &'a StereoCalibration) -> Self {
        Self { cameras: &calibration.cameras, covariance: calibration.covariance.as_ref() }
    }
}

/// What both eyes saw with the head in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadView {
    /// Unique within a calibration.
    pub name: String,
    /// All joints, by their encoders.
    pub posture: Posture,
    /// Pixels in the left image, one entry per point of the target; `None` if it saw nothing.
    pub left: Option<Corners>,
    /// Same, right image.
    pub right: Option<Corners>,
}

impl HeadView {
    /// A sighting of the board, with the posture in which it was made.
    pub fn new(sighting: PairObservation, posture: Posture) -> Self {
        Self { name: sighting.name, posture, left: sighting.left, right: sighting.right }
    }

    /// The pixels of one eye.
    pub fn pixels(&self, eye: Eye) -> Option<&Corners> {
        match eye {
            Eye::Left => self.left.as_ref(),
            Eye::Right => self.right.as_ref(),
        }
    }
}

/// What the eyes looked at.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A chessboard that lies still, nobody knows where.
    UnknownBoard(Chessboard),
    /// Points whose place is known, such as the corners of the touchscreen; one per entry of a
    /// view's pixels.
    KnownPoints(Vec<Point<Robot>>),
    /// The robot's own fingertip, placed by the arm's encoders; one entry per view.
    Fingertip {
        /// Link of the description.
        tip: String,
    },
}

impl Target {
    /// The four corners of a touchscreen's visible area, in this order: at pixel (0, 0), at the end of
    /// the first row, at the last pixel, at the end of the first column.
    pub fn touchscreen(screen: &Touchscreen) -> Self {
        let corner = |u: f64, v: f64| {
            let along = screen.u_axis.vector() * (u * screen.width_m);
            let down = screen.v_axis.vector() * (v * screen.height_m);
            Point::from(screen.origin.coords + along + down)
        };
        Self::KnownPoints(vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)])
    }
}

/// What the solver assumes. All standard deviations are of one axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MountOptions {
    /// Step of the head's encoders, rad.
    pub encoder_tick_rad: f64,
    /// Further error of a head angle from view to view (slack, bending), standard deviation, rad.
    pub head_angle_sd_rad: f64,
    /// Estimate the zeros of the head's two encoders too, expected to be off by this much
    /// (standard deviation, rad); `None` takes them for right.
    pub head_zero_sd_rad: Option<f64>,
    /// How well the place of known points is known as a whole, m.
    pub known_place_sd_m: f64,
    /// Same for their orientation as a whole, rad.
    pub known_turn_sd_rad: f64,
    /// How well the arm's encoders place the fingertip, from view to view, m.
    pub tip_sd_m: f64,
    /// Scale of the robust loss (Cauchy) while bad corners may be among the good ones, px.
    pub robust_px: f64,
}

impl Default for MountOptions {
    fn default() -> Self {
        Self {
            encoder_tick_rad: std::f64::consts::TAU / 4096.0,
            head_angle_sd_rad: 0.0,
            head_zero_sd_rad: None,
            known_place_sd_m: 0.001,
            known_turn_sd_rad: 0.002,
            tip_sd_m: 0.004,
            robust_px: 0.5,
        }
    }
}

impl MountOptions {
    /// What a head angle may be off by in one view, standard deviation, rad: rounding to a tick
    /// is spread evenly over it.
    pub fn angle_sd_rad(&self) -> f64 {
        (self.encoder_tick_rad / 12f64.sqrt()).hypot(self.head_angle_sd_rad)
    }
}

/// A number and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
}

/// How one view fits.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewFit {
    /// Name of the view.
    pub name: String,
    /// Rms residual per point in the left eye, px; `None` if it saw nothing.
    pub left_px: Option<f64>,
    /// Same, right eye.
    pub right_px: Option<f64>,
    /// What the head angles (pan, tilt) are off by in this view: true minus encoder, without the
    /// common zero, rad.
    pub angle_error_rad: [f64; 2],
    /// Every measured point.
    pub residuals: Vec<plumbline_model::CornerResidual>,
}

/// Difference of the calibrated mount to the nominal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountChange {
    /// Nominal to calibrated place of the left eye, axes of the head, m.
    pub moved_m: Vector3<f64>,
    /// Nominal to calibrated orientation, rotation vector, axes of the head, rad.
    pub turned_rad: Vector3<f64>,
}

impl MountChange {
    /// From one mount to another.
    pub fn between(from: &Pose<Head, LeftCamera>, to: &Pose<Head, LeftCamera>) -> Self {
        Self {
            moved_m: to.translation_m() - from.translation_m(),
            turned_rad: (to.isometry.rotation * from.isometry.rotation.inverse()).scaled_axis(),
        }
    }
}

/// Everything needed to solve again.
#[derive(Clone, Debug, PartialEq)]
pub struct MountEvidence {
    /// Short name of the rig.
    pub rig: String,
    /// Names of the joints of every posture, in order.
    pub joints: Vec<String>,
    /// The mount it was compared with and started from.
    pub nominal: Pose<Head, LeftCamera>,
    /// The eyes' calibration; the mount is right with this one only.
    pub cameras: StereoCameras,
    /// What was looked at.
    pub target: Target,
    /// What the solver assumed.
    pub options: MountOptions,
    /// Every view offered, those left out included.
    pub views: Vec<HeadView>,
    /// When it was solved, UTC.
    pub created: jiff::Timestamp,
    /// Program and version.
    pub software: String,
    /// Minutes since the cameras were switched on when the views were taken, in the mean; `None`: nobody knows. Eyes
    /// turn as they warm up.
    pub minutes_since_on: Option<f64>,
}

/// A solved mount.
#[derive(Clone, Debug, PartialEq)]
pub struct MountCalibration {
    /// Place of the left eye in the head.
    pub head_from_left: Pose<Head, LeftCamera>,
    /// How well it is known, scaled by the residuals, with the uncertainty of the eyes' own
    /// calibration where that is known. Order: rotation vector (rad), translation
    /// (m), both in the axes of the head, a perturbation on the left side.
    pub covariance: Matrix6<f64>,
    /// Zeros of the head's encoders (pan, tilt), if they were estimated: true angle = encoder +
    /// value, rad.
    pub head_zeros_rad: Option<[Estimate; 2]>,
    /// Where the board lies, if that was not known.
    pub robot_from_board: Option<Pose<Robot, Board>>,
    /// Its covariance: rotation vector (rad), translation (m), axes of the robot.
    pub board_covariance: Option<Matrix6<f64>>,
    /// Rms residual per point over both eyes, px.
    pub rms_px: f64,
    /// Standard deviation of one coordinate of a pixel, from the residuals, px.
    pub pixel_sigma_px: f64,
    /// Standard deviation of the head angles (pan, tilt) from view to view, rad: what the options
    /// say, or more if the residuals ask for it.
    pub angle_sigma_rad: [f64; 2],
    /// Views that were fitted.
    pub per_view: Vec<ViewFit>,
    /// Views that were not, and why.
    pub rejected: Vec<RejectedPair>,
    /// What these views cannot tell, a sentence each, with what would show it; empty when all
    /// was seen.
    pub not_seen: Vec<String>,
    /// What else the operator should know, a sentence each: slack in the neck, known points that
    /// are not where they were said to be, uncertainty that is not included.
    pub remarks: Vec<String>,
    /// Difference to the nominal mount.
    pub change: MountChange,
    /// What it was made from.
    pub evidence: MountEvidence,
}

impl MountCalibration {
    /// Standard deviations of the rotation about the head's x, y, z (rad).
    pub fn turned_sigma_rad(&self) -> Vector3<f64> {
        self.covariance.diagonal().fixed_rows::<3>(0).map(|v| v.max(0.0).sqrt())
    }

    /// Standard deviations of the place along the head's x, y, z (m).
    pub fn moved_sigma_m(&self) -> Vector3<f64> {
        self.covariance.diagonal().fixed_rows::<3>(3).map(|v| v.max(0.0).sqrt())
    }

    /// The rig with its eyes at the calibrated place and with the eyes' calibration they were
    /// placed with. Encoder zeros are not part of a rig's mount and stay with the caller.
    pub fn applied_to(&self, rig: &Rig) -> Rig {
        let eyes = EyeMount {
            head_from_left: self.head_from_left,
            cameras: self.evidence.cameras,
            calibrated_at: CalibratedAt {
                mount_s: self.evidence.minutes_since_on.map(|minutes| 60.0 * minutes),
                ..rig.eyes.calibrated_at
            },
            ..rig.eyes.clone()
        };
        Rig { eyes, ..rig.clone() }
    }

    /// Whether the mount was solved with this calibration of the eyes. With another one it has to
    /// be solved again.
    pub fn made_with(&self, cameras: &StereoCameras) -> bool {
        self.evidence.cameras == *cameras
    }

    /// Standard deviation (m, along its worst direction) that the mount gives to a point which is
    /// known in the left camera's frame.
    pub fn point_sigma_m(&self, point: Point<LeftCamera>) -> f64 {
        let arm = self.head_from_left.isometry.rotation * point.coords.coords;
        let mut by_mount = SMatrix::<f64, 3, 6>::zeros();
        by_mount.fixed_view_mut::<3, 3>(0, 0).copy_from(&-arm.cross_matrix());
        by_mount.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        let covariance = by_mount * self.covariance * by_mount.transpose();
        decompose::symmetric_eigenvalues(covariance)
            .map_or(f64::INFINITY, |variances| variances.max().max(0.0).sqrt())
    }
}

/// Position and rotation vector of a mount as a rig file has them, see [`EyeMount::pose`].
pub fn mount_numbers(head_from_left: &Pose<Head, LeftCamera>) -> (Vector3<f64>, Vector3<f64>) {
    let straight = EyeMount::pose(Vector3::zeros(), Vector3::zeros());
    let turn = head_from_left.isometry.rotation * straight.isometry.rotation.inverse();
    (head_from_left.translation_m(), turn.scaled_axis())
}

/// Turns by the rotation vector in the first three entries, then moves by the last three.
pub(super) fn perturbed(pose: &Isometry3<f64>, change: &[f64]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(change[0], change[1], change[2]));
    let mut rotation = turn * pose.rotation;
    rotation.renormalize();
    let place = pose.translation.vector + Vector3::new(change[3], change[4], change[5]);
    Isometry3::from_parts(place.into(), rotation)
}
