//! `plumbline calibrate check`: judges a calibration on pairs it has not seen.

use std::path::PathBuf;

use plumbline_model::{InnerCorners, JobContext};
use plumbline_vision::{calibrate, calibration_file};
use serde::Serialize;

use super::pairs::{check_sizes, find_board};
use super::{OfflineError, PairErrors, Rejected};

/// What to judge on what.
#[derive(Clone, Debug)]
pub struct CheckArgs {
    /// Calibration file in any known format; two files for ROS, left eye first.
    pub cameras: Vec<PathBuf>,
    /// Folder of the left eye's images.
    pub left: PathBuf,
    /// Folder of the right eye's images.
    pub right: PathBuf,
    /// Inner corners of the board.
    pub board: InnerCorners,
    /// Side of a square, meters.
    pub square_m: f64,
    /// Pairs to leave out, by the file name of either image.
    pub exclude: Vec<PathBuf>,
}

/// How the calibration does. Every corner counts, bad ones too.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// Pairs in which both eyes see the board.
    pub pairs: usize,
    /// Pairs in which they do not, and why.
    pub pairs_rejected: Vec<Rejected>,
    /// Rms residual per corner over both eyes; only board poses are fitted.
    pub reprojection_px: f64,
    /// Rms distance from the partner's epipolar line.
    pub epipolar_px: f64,
    /// The board's square measured back: mean.
    pub square_mm_mean: f64,
    /// Standard deviation.
    pub square_mm_sd: f64,
    /// Each pair.
    pub per_pair: Vec<PairErrors>,
    /// What was noticed about the files.
    pub notes: Vec<String>,
}

/// Finds the board and measures it with the calibration.
pub fn check(args: &CheckArgs, context: &dyn JobContext) -> Result<CheckReport, OfflineError> {
    let calibration = calibration_file::load(&args.cameras)?;
    let pairs = find_board([&args.left, &args.right], args.board, args.square_m, &args.exclude, context)?;
    check_sizes(&calibration.cameras, pairs.sizes_px)?;
    let checked = calibrate::check(&calibration.cameras, &pairs.board, &pairs.observations, false)?;
    let per_pair = checked.per_pair.iter().map(|pair| PairErrors {
        name: pair.name.clone(),
        left_px: pair.left_px,
        right_px: pair.right_px,
    });
    Ok(CheckReport {
        pairs: checked.per_pair.len(),
        pairs_rejected: pairs.not_found.into_iter().map(|(name, reason)| Rejected { name, reason }).collect(),
        reprojection_px: checked.reprojection_px,
        epipolar_px: checked.epipolar_px,
        square_mm_mean: checked.square_mean_m * 1000.0,
        square_mm_sd: checked.square_sd_m * 1000.0,
        per_pair: per_pair.collect(),
        notes: pairs.notes,
    })
}
