//! `plumbline disparity`: the disparity map of a pair.

use std::path::{Path, PathBuf};
use std::time::Instant;

use plumbline_engine::live::aimed;
use plumbline_engine::live::command::AimChoice;
use plumbline_model::{JobContext, Workspace, files};
use plumbline_vision::calibration_file;
use plumbline_vision::disparity::{Matcher, Settings, write_pfm};
use plumbline_vision::rectify::Rectifier;
use serde::Serialize;

use super::OfflineError;
use super::error::size_text;
use super::locate::read_image;
use super::pairs::check_sizes;

/// What to match.
#[derive(Clone, Debug)]
pub struct DisparityArgs {
    /// Left image.
    pub left: PathBuf,
    /// Right image.
    pub right: PathBuf,
    /// Calibration of the raw images (two files for ROS, left eye first); empty if the images
    /// are rectified already.
    pub cameras: Vec<PathBuf>,
    /// Largest disparity that is searched, pixels.
    pub max_disparity_px: u32,
    /// Where the map is written (PFM, +infinity where there is none); `None` writes nothing.
    pub out: Option<PathBuf>,
}

/// How it went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisparityReport {
    /// Part of the pixels that have a disparity, measured or filled in.
    pub valid_fraction: f64,
    /// Part of the pixels on whose disparity both views agree.
    pub measured_fraction: f64,
    /// Time for rectification (if asked for) and matching, without reading and writing.
    pub milliseconds: f64,
    /// Width of the map.
    pub width_px: u32,
    /// Height of the map.
    pub height_px: u32,
    /// The rectified views, if this program made them.
    pub geometry: Option<Geometry>,
    /// What was noticed about the images.
    pub notes: Vec<String>,
}

/// Depth along the views' axis is `f_px * baseline_m / disparity`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Geometry {
    /// Focal length of the views.
    pub f_px: f64,
    /// Column of their axis.
    pub cx_px: f64,
    /// Row of their axis.
    pub cy_px: f64,
    /// Distance between the eyes.
    pub baseline_m: f64,
    /// How far they are turned down about the baseline.
    pub down_rad: f64,
}

/// Rectifies if a calibration is given, matches, writes.
pub fn disparity(args: &DisparityArgs, context: &dyn JobContext) -> Result<DisparityReport, OfflineError> {
    if let Some(out) = &args.out {
        let images = [args.left.as_path(), &args.right];
        let inputs: Vec<&Path> =
            images.into_iter().chain(args.cameras.iter().map(PathBuf::as_path)).collect();
        files::output(out, &inputs)?;
    }
    let mut notes = Vec::new();
    let left = image::imageops::grayscale(&read_image(&args.left, &mut notes)?);
    let right = image::imageops::grayscale(&read_image(&args.right, &mut notes)?);
    if left.dimensions() != right.dimensions() {
        return Err(OfflineError::EyesDiffer {
            left: size_text(left.dimensions()),
            right: size_text(right.dimensions()),
        });
    }
    let rectifier = if args.cameras.is_empty() {
        None
    } else {
        let cameras = calibration_file::load(&args.cameras)?.cameras;
        check_sizes(&cameras, [left.dimensions(), right.dimensions()])?;
        Some(Rectifier::new(&aimed(AimChoice::Table, &cameras, &Workspace::default())?)?)
    };
    context.checkpoint()?;
    context.report(0.2, "matching");
    let mut matcher = Matcher::new(Settings::full(args.max_disparity_px))?;
    let begun = Instant::now();
    let map = match &rectifier {
        Some(rectifier) => {
            let views = rectifier.rectify_gray(&left, &right)?;
            matcher.compute(&views.left, &views.right, Some(rectifier.masks()))?
        }
        None => matcher.compute(&left, &right, None)?,
    };
    let milliseconds = begun.elapsed().as_secs_f64() * 1000.0;
    context.report(0.9, "writing");
    if let Some(out) = &args.out {
        files::write_with(out, |file| write_pfm(&map, file))?;
    }
    let geometry = rectifier.as_ref().map(|rectifier| {
        let pair = rectifier.aimed();
        Geometry {
            f_px: pair.f_px,
            cx_px: pair.cx_px,
            cy_px: pair.cy_px,
            baseline_m: pair.baseline_m,
            down_rad: pair.down_rad(),
        }
    });
    Ok(DisparityReport {
        valid_fraction: map.valid_fraction(),
        measured_fraction: map.measured_fraction(),
        milliseconds,
        width_px: map.width_px(),
        height_px: map.height_px(),
        geometry,
        notes,
    })
}
