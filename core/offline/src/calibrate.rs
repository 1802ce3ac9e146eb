//! `plumbline calibrate stereo`: chessboard pairs to a stereo calibration.

use std::path::PathBuf;

use plumbline_engine::ground::jobs::Part;
use plumbline_engine::ground::text::sentence;
use plumbline_model::camera::ModelKind;
use plumbline_model::formats::native;
use plumbline_model::{CalibrationOptions, InnerCorners, JobContext, StereoCalibration, files};
use plumbline_vision::calibrate;
use serde::Serialize;

use super::OfflineError;
use super::pairs::find_board;

/// What to calibrate from.
#[derive(Clone, Debug)]
pub struct CalibrateArgs {
    /// Folder of the left eye's images.
    pub left: PathBuf,
    /// Folder of the right eye's images.
    pub right: PathBuf,
    /// Inner corners of the board.
    pub board: InnerCorners,
    /// Side of a square, meters.
    pub square_m: f64,
    /// Lens model of both eyes.
    pub model: ModelKind,
    /// Pairs to leave out, by the file name of either image.
    pub exclude: Vec<PathBuf>,
    /// Where the calibration is written; `None` writes nothing.
    pub out: Option<PathBuf>,
}

/// How it went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibrateReport {
    /// Pairs in which both eyes see the board.
    pub pairs_found: usize,
    /// Pairs that were fitted.
    pub pairs_used: usize,
    /// Pairs that were not, and why: the board was not found, or the pair does not fit.
    pub pairs_rejected: Vec<Rejected>,
    /// Pairs left out as asked.
    pub pairs_excluded: Vec<String>,
    /// Rms residual per corner, left eye.
    pub rms_left_px: f64,
    /// Same, right eye.
    pub rms_right_px: f64,
    /// Same, both eyes.
    pub rms_stereo_px: f64,
    /// Rms over pairs not used for solving; null with too few pairs.
    pub cross_validated_px: Option<f64>,
    /// Rms distance from the partner's epipolar line.
    pub epipolar_px: f64,
    /// Distance between the eyes.
    pub baseline_mm: f64,
    /// The board's square measured back: mean.
    pub square_mm_mean: f64,
    /// Standard deviation.
    pub square_mm_sd: f64,
    /// Each pair.
    pub per_pair: Vec<PairErrors>,
    /// Single corners that were found wrong and left out.
    pub corners_left_out: Vec<LeftOutCorner>,
    /// What was noticed about the files.
    pub notes: Vec<String>,
}

/// A pair that was not used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rejected {
    /// Its file name.
    pub name: String,
    /// Why, in a sentence.
    pub reason: String,
}

/// Residuals of one pair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairErrors {
    /// Its file name.
    pub name: String,
    /// Rms residual per corner, left eye.
    pub left_px: Option<f64>,
    /// Same, right eye.
    pub right_px: Option<f64>,
}

/// A corner that was left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOutCorner {
    /// Its pair.
    pub pair: String,
    /// `left` or `right`.
    pub eye: String,
    /// Its index on the board, row by row.
    pub corner: usize,
    /// How far it is off.
    pub error_px: f64,
}

/// Finds the board, solves, writes.
pub fn calibrate_stereo(
    args: &CalibrateArgs,
    context: &dyn JobContext,
) -> Result<CalibrateReport, OfflineError> {
    if let Some(out) = &args.out {
        files::output(out, &[&args.left, &args.right])?;
    }
    let finding = Part { whole: context, begin: 0.0, end: 0.6 };
    let pairs = find_board([&args.left, &args.right], args.board, args.square_m, &args.exclude, &finding)?;
    let options = CalibrationOptions { model: args.model, ..CalibrationOptions::default() };
    let solving = Part { whole: context, begin: 0.6, end: 1.0 };
    let solved = calibrate::solve(&pairs.board, &pairs.observations, pairs.sizes_px, &options, &[], &solving);
    let mut calibration = solved?;
    if let Some(evidence) = &mut calibration.evidence {
        evidence.source = pairs.title;
    }
    if let Some(out) = &args.out {
        native::write(&calibration, out)?;
    }
    let not_found = pairs.not_found.into_iter().map(|(name, reason)| Rejected { name, reason });
    let not_fitting = calibration
        .rejected
        .iter()
        .map(|rejected| Rejected { name: rejected.name.clone(), reason: sentence(&rejected.reason) });
    let pairs_rejected = not_found.chain(not_fitting).collect();
    Ok(report(&calibration, pairs.observations.len(), pairs_rejected, pairs.excluded, pairs.notes))
}

fn report(
    calibration: &StereoCalibration,
    pairs_found: usize,
    pairs_rejected: Vec<Rejected>,
    pairs_excluded: Vec<String>,
    notes: Vec<String>,
) -> CalibrateReport {
    let summary = calibration.summary.as_ref().expect("the solver always gives its figures");
    let per_pair = calibration.per_pair.iter().map(|pair| PairErrors {
        name: pair.name.clone(),
        left_px: pair.left_px,
        right_px: pair.right_px,
    });
    let left_out = calibration.left_out_corners().map(|(pair, residual)| LeftOutCorner {
        pair: pair.to_owned(),
        eye: residual.eye.to_string(),
        corner: residual.corner,
        error_px: residual.norm_px(),
    });
    CalibrateReport {
        pairs_found,
        pairs_used: calibration.per_pair.len(),
        pairs_rejected,
        pairs_excluded,
        rms_left_px: summary.rms_left_px,
        rms_right_px: summary.rms_right_px,
        rms_stereo_px: summary.rms_stereo_px,
        cross_validated_px: summary.cross_validated_px,
        epipolar_px: summary.epipolar_px,
        baseline_mm: calibration.cameras.baseline_m() * 1000.0,
        square_mm_mean: summary.square_mean_m * 1000.0,
        square_mm_sd: summary.square_sd_m * 1000.0,
        per_pair: per_pair.collect(),
        corners_left_out: left_out.collect(),
        notes,
    }
}
