//! A stereo calibration as a result that carries its evidence: what went in, what was left
//! out and why, how well it fits, and how well it is known.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use crate::camera::ModelKind;
use crate::chessboard::Chessboard;
use crate::frame::{Board, LeftCamera, Pose};
use crate::pixel::{Eye, Pixel, Raw};
use crate::stereo::StereoCameras;

/// The corners that one eye saw, in the board's order (`None` where a corner was not measured).
pub type Corners = Vec<Option<Pixel<Raw>>>;

/// What both eyes saw of the board at one moment. An eye that did not see it has `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct PairObservation {
    /// File name or capture number; unique within a calibration.
    pub name: String,
    /// Corners in the left image.
    pub left: Option<Corners>,
    /// Corners in the right image.
    pub right: Option<Corners>,
}

impl PairObservation {
    /// The corners of one eye.
    pub fn corners(&self, eye: Eye) -> Option<&Corners> {
        match eye {
            Eye::Left => self.left.as_ref(),
            Eye::Right => self.right.as_ref(),
        }
    }
}

/// What the solver was asked to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationOptions {
    /// Lens model of both eyes.
    pub model: ModelKind,
    /// Find single bad corners and leave them out.
    pub leave_out_bad_corners: bool,
    /// Number of folds for the cross-validated error; 0 skips it.
    pub cross_validation_folds: usize,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self { model: ModelKind::Fisheye, leave_out_bad_corners: true, cross_validation_folds: 5 }
    }
}

/// Everything needed to solve again.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// The target.
    pub board: Chessboard,
    /// What the solver was asked to do.
    pub options: CalibrationOptions,
    /// Every observation offered, those left out included.
    pub observations: Vec<PairObservation>,
    /// Names of pairs that the operator dropped.
    pub dropped_pairs: Vec<String>,
    /// When it was solved, UTC.
    pub created: jiff::Timestamp,
    /// Program and version.
    pub software: String,
    /// Minutes since the cameras were switched on, at capture; lenses move as they warm up.
    pub minutes_since_on: Option<f64>,
    /// Where the images came from, for people.
    pub source: String,
}

/// One corner and how far the model misses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerResidual {
    /// Eye that saw it.
    pub eye: Eye,
    /// Index on the board.
    pub corner: usize,
    /// Where it was measured.
    pub measured: Pixel<Raw>,
    /// Measured minus predicted, pixels.
    pub error_px: [f64; 2],
    /// Left out of the fit as an outlier.
    pub left_out: bool,
}

impl CornerResidual {
    /// Length of the residual in pixels.
    pub fn norm_px(&self) -> f64 {
        self.error_px[0].hypot(self.error_px[1])
    }
}

/// How one pair fits.
#[derive(Clone, Debug, PartialEq)]
pub struct PairFit {
    /// Name of the pair.
    pub name: String,
    /// Rms residual per corner in the left eye, pixels; `None` if it did not see the board.
    pub left_px: Option<f64>,
    /// Same, right eye.
    pub right_px: Option<f64>,
    /// Rms distance of matched corners from each other's epipolar line, on rectified rays, pixels.
    pub epipolar_px: Option<f64>,
    /// Where the board was.
    pub left_from_board: Pose<LeftCamera, Board>,
    /// Every measured corner.
    pub residuals: Vec<CornerResidual>,
}

/// A pair that could not be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RejectedPair {
    /// Name of the pair.
    pub name: String,
    /// A sentence that says why.
    pub reason: String,
}

/// Summary figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitSummary {
    /// Rms residual per corner, left eye, pixels (as OpenCV: √(Σ|e|² / corners)).
    pub rms_left_px: f64,
    /// Same, right eye.
    pub rms_right_px: f64,
    /// Same over both eyes.
    pub rms_stereo_px: f64,
    /// Rms over pairs not used for solving; `None` if not asked for or too few pairs.
    pub cross_validated_px: Option<f64>,
    /// Rms epipolar error, pixels.
    pub epipolar_px: f64,
    /// Mean side of the board's squares, triangulated, meters.
    pub square_mean_m: f64,
    /// Their standard deviation, meters.
    pub square_sd_m: f64,
}

/// How well the parameters are known: covariance scaled by the residuals.
///
/// Order: left intrinsics, right intrinsics, rotation vector of `right_from_left` (rad, a
/// perturbation on the left side), its translation (m).
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterCovariance {
    /// Square, symmetric.
    pub matrix: DMatrix<f64>,
}

/// A solved stereo calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct StereoCalibration {
    /// The result.
    pub cameras: StereoCameras,
    /// How well the parameters are known; absent in files of other programs.
    pub covariance: Option<ParameterCovariance>,
    /// Figures; absent in files of other programs.
    pub summary: Option<FitSummary>,
    /// Pairs that were fitted.
    pub per_pair: Vec<PairFit>,
    /// Pairs that were not, and why.
    pub rejected: Vec<RejectedPair>,
    /// What it was made from; absent in files of other programs.
    pub evidence: Option<Evidence>,
}

impl StereoCalibration {
    /// A calibration known only by its numbers, as read from another program's file.
    pub fn bare(cameras: StereoCameras) -> Self {
        Self {
            cameras,
            covariance: None,
            summary: None,
            per_pair: Vec::new(),
            rejected: Vec::new(),
            evidence: None,
        }
    }

    /// Corners left out as outliers.
    pub fn left_out_corners(&self) -> impl Iterator<Item = (&str, &CornerResidual)> {
        self.per_pair.iter().flat_map(|pair| {
            pair.residuals.iter().filter(|r| r.left_out).map(move |r| (pair.name.as_str(), r))
        })
    }
}
