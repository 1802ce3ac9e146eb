//! Accuracy and speed on measured data, each figure beside what is wanted and what a peer reaches.
//!
//! Data that are not at hand leave their figures out, with the reason.

mod correction;
mod gap;
mod looking;
mod robot;

use std::path::Path;
use std::time::Instant;

use plumbline_model::aim::AimedPair;
use plumbline_model::camera::ModelKind;
use plumbline_model::workspace::Workspace;
use plumbline_model::{
    CalibrationOptions, Chessboard, JobContext, StereoCalibration, Unattended, measured_data,
};
use plumbline_vision::calibrate;
use plumbline_vision::disparity::{Matcher, Settings};
use plumbline_vision::disparity_bench::{ComparisonReport, NEAREST_M, compare_with_published};
use serde::Serialize;

use super::OfflineError;
use super::pairs::{BoardPairs, find_board};

/// One measured number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What was measured, with the data it was measured on.
    pub what: String,
    /// The number; null if it could not be measured.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
    /// Most that it may be; null where there is no target.
    pub at_most: Option<f64>,
    /// A peer's number on the same data.
    pub peer: Option<Peer>,
    /// Why it could not be measured.
    pub note: Option<String>,
}

/// Somebody else's number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peer {
    /// Who.
    pub name: &'static str,
    /// Their number, in the same unit.
    pub value: f64,
}

impl Figure {
    fn new(what: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { what: what.into(), value: Some(value), unit, at_most: None, peer: None, note: None }
    }

    fn missing(what: impl Into<String>, note: impl ToString) -> Self {
        Self {
            what: what.into(),
            value: None,
            unit: "",
            at_most: None,
            peer: None,
            note: Some(note.to_string()),
        }
    }

    fn at_most(mut self, limit: f64) -> Self {
        self.at_most = Some(limit);
        self
    }

    fn peer(mut self, name: &'static str, value: f64) -> Self {
        self.peer = Some(Peer { name, value });
        self
    }

    /// Whether the target is met; `None` where there is none or nothing was measured.
    pub fn is_met(&self) -> Option<bool> {
        Some(self.value? <= self.at_most?)
    }
}

/// Everything that was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchReport {
    /// In the order of measuring.
    pub figures: Vec<Figure>,
    /// Threads used.
    pub threads: usize,
}

/// Measures what needs no window.
pub fn bench(context: &dyn JobContext) -> Result<BenchReport, OfflineError> {
    let mut figures = Vec::new();
    type Part = (&'static str, fn(&Path) -> Result<Vec<Figure>, OfflineError>);
    let parts: [Part; 4] = [
        ("nico-chessboard", nico),
        ("opencv-fisheye-jy", large_fisheye),
        ("opencv-stereo-13", pinhole_pair),
        ("bumblebee2", bumblebee),
    ];
    for (i, (name, measure)) in parts.iter().enumerate() {
        context.checkpoint()?;
        context.report(i as f64 / (parts.len() + 1) as f64, &format!("measuring on {name}"));
        match measured_data::folder(name) {
            Ok(folder) => figures.extend(measure(&folder)?),
            Err(reason) => figures.push(Figure::missing(*name, reason)),
        }
    }
    for (name, opencv) in [("teddy", 0.1865), ("cones", 0.2107)] {
        context.checkpoint()?;
        context.report(0.75, &format!("matching {name}"));
        figures.push(bad_disparities(name, opencv)?);
    }
    context.checkpoint()?;
    context.report(0.8, "timing the live pipeline against the published one");
    figures.extend(pipeline()?);
    context.checkpoint()?;
    context.report(0.85, "correction models");
    figures.extend(correction::figures());
    context.checkpoint()?;
    context.report(0.88, "the search for the gap");
    figures.extend(gap::figures());
    context.checkpoint()?;
    context.report(0.9, "kinematics, servo bus, the twin's eyes and what is seen with them");
    figures.extend(robot::figures());
    Ok(BenchReport { figures, threads: std::thread::available_parallelism().map_or(1, usize::from) })
}

/// Finds the board in all pairs of a folder that holds both eyes.
fn pairs_of(folder: &Path, columns: u32, rows: u32, square_m: f64) -> Result<BoardPairs, OfflineError> {
    let inner = plumbline_model::InnerCorners { columns, rows };
    let (left, right) = (folder.join("left"), folder.join("right"));
    if left.is_dir() {
        find_board([&left, &right], inner, square_m, &[], &Unattended)
    } else {
        find_board([folder, folder], inner, square_m, &[], &Unattended)
    }
}

fn solve(pairs: &BoardPairs, model: ModelKind) -> Result<StereoCalibration, OfflineError> {
    let options = CalibrationOptions { model, ..CalibrationOptions::default() };
    Ok(calibrate::solve(&pairs.board, &pairs.observations, pairs.sizes_px, &options, &[], &Unattended)?)
}

fn stereo_rms_px(calibration: &StereoCalibration) -> f64 {
    calibration.summary.as_ref().map_or(f64::NAN, |summary| summary.rms_stereo_px)
}

fn nico(folder: &Path) -> Result<Vec<Figure>, OfflineError> {
    let start = Instant::now();
    let pairs = pairs_of(folder, 8, 5, 0.03)?;
    let calibration = solve(&pairs, ModelKind::Fisheye)?;
    let seconds = start.elapsed().as_secs_f64();
    let (reprojection_px, epipolar_px) = kept_aside(&pairs.board, &pairs)?;
    let title = |what: &str| format!("NICO's eyes, {} pairs: {what}", pairs.observations.len());
    Ok(vec![
        Figure::new(title("stereo rms"), stereo_rms_px(&calibration), "px")
            .at_most(0.096)
            .peer("OpenCV", 0.1443),
        Figure::new(title("corners left out"), calibration.left_out_corners().count() as f64, "corners"),
        Figure::new(title("reprojection on pairs kept aside"), reprojection_px, "px")
            .at_most(0.1)
            .peer("OpenCV", 0.102),
        Figure::new(title("epipolar error on pairs kept aside"), epipolar_px, "px")
            .at_most(0.118)
            .peer("OpenCV", 0.12),
        Figure::new(title("found, solved and cross-validated in"), seconds, "s").at_most(6.0),
    ])
}

/// Mean (reprojection, epipolar error) over three calibrations, each judged on the third of the
/// pairs that it has not seen.
fn kept_aside(board: &Chessboard, pairs: &BoardPairs) -> Result<(f64, f64), OfflineError> {
    const PARTS: usize = 3;
    let (mut reprojection_px, mut epipolar_px) = (0.0, 0.0);
    for part in 0..PARTS {
        let (mut held, mut kept) = (Vec::new(), Vec::new());
        for (i, pair) in pairs.observations.iter().enumerate() {
            if i % PARTS == part { held.push(pair.clone()) } else { kept.push(pair.clone()) }
        }
        let options = CalibrationOptions { cross_validation_folds: 0, ..CalibrationOptions::default() };
        let calibration = calibrate::solve(board, &kept, pairs.sizes_px, &options, &[], &Unattended)?;
        let report = calibrate::check(&calibration.cameras, board, &held, false)?;
        reprojection_px += report.reprojection_px / PARTS as f64;
        epipolar_px += report.epipolar_px / PARTS as f64;
    }
    Ok((reprojection_px, epipolar_px))
}

fn large_fisheye(folder: &Path) -> Result<Vec<Figure>, OfflineError> {
    let pairs = pairs_of(folder, 8, 6, 0.0244)?;
    let calibration = solve(&pairs, ModelKind::Fisheye)?;
    let title = |what: &str| format!("fisheye 1280×800, 34 pairs: {what}");
    Ok(vec![
        Figure::new(title("pairs not found or not used"), 34.0 - calibration.per_pair.len() as f64, "pairs")
            .at_most(0.0),
        Figure::new(title("stereo rms"), stereo_rms_px(&calibration), "px")
            .at_most(0.51)
            .peer("OpenCV", 0.519),
    ])
}

fn pinhole_pair(folder: &Path) -> Result<Vec<Figure>, OfflineError> {
    let pairs = pairs_of(folder, 9, 6, 0.025)?;
    let rms_px = stereo_rms_px(&solve(&pairs, ModelKind::Pinhole)?);
    Ok(vec![
        Figure::new("pinhole pair, 13 pairs: stereo rms", rms_px, "px").at_most(0.444).peer("OpenCV", 0.4439),
    ])
}

fn bumblebee(folder: &Path) -> Result<Vec<Figure>, OfflineError> {
    /// BoofCV's own calibration of the same images.
    const BOOFCV_BASELINE_MM: f64 = 120.051;
    let pairs = pairs_of(folder, 4, 6, 0.03)?;
    let baseline_mm = solve(&pairs, ModelKind::Pinhole)?.cameras.baseline_m() * 1000.0;
    let off_mm = (baseline_mm - BOOFCV_BASELINE_MM).abs();
    Ok(vec![
        Figure::new("Bumblebee2: baseline", baseline_mm, "mm").peer("BoofCV", BOOFCV_BASELINE_MM),
        Figure::new("Bumblebee2: baseline differs from BoofCV's by", off_mm, "mm")
            .at_most(0.2)
            .peer("OpenCV", 0.067),
    ])
}

/// Part of all pixels with known disparity whose result is missing or more than 2 px off, on a
/// Middlebury pair of 2003 (`disp2.png` holds four times the disparity, 0 where it is unknown).
fn bad_disparities(name: &str, opencv: f64) -> Result<Figure, OfflineError> {
    let what = format!("disparity, {name}: pixels missing or more than 2 px off");
    let folder = match measured_data::folder(&format!("disparity/{name}")) {
        Ok(folder) => folder,
        Err(reason) => return Ok(Figure::missing(what, reason)),
    };
    let gray = |file: &str| image::open(folder.join(file)).map(|image| image.into_luma8());
    let (Ok(left), Ok(right), Ok(truth)) = (gray("im2.png"), gray("im6.png"), gray("disp2.png")) else {
        return Ok(Figure::missing(what, "its images cannot be read"));
    };
    let map = Matcher::new(Settings::full(64))?.compute(&left, &right, None)?;
    let (mut known, mut bad) = (0u32, 0u32);
    for (x, y, pixel) in truth.enumerate_pixels().filter(|(.., pixel)| pixel[0] > 0) {
        let truth_px = f32::from(pixel[0]) / 4.0;
        known += 1;
        bad += u32::from(map.get(x, y).is_none_or(|found| (found - truth_px).abs() > 2.0));
    }
    let fraction = f64::from(bad) / f64::from(known.max(1));
    Ok(Figure::new(what, fraction, "").at_most(opencv).peer("OpenCV SGBM", opencv))
}

/// Rectification, disparity and 3D of one real pair, timed in turns with the published pipeline.
fn pipeline() -> Result<Vec<Figure>, OfflineError> {
    const WHAT: &str = "live pipeline";
    let chessboard = match measured_data::folder("nico-chessboard") {
        Ok(folder) => folder,
        Err(reason) => return Ok(vec![Figure::missing(WHAT, reason)]),
    };
    let scenes = match measured_data::folder("nico-scenes/images") {
        Ok(folder) => folder,
        Err(reason) => return Ok(vec![Figure::missing(WHAT, reason)]),
    };
    let calibration = solve(&pairs_of(&chessboard, 8, 5, 0.03)?, ModelKind::Fisheye)?;
    let folder = plumbline_hardware::PairFolder::open_one(&scenes)?;
    let Some(first) = folder.pairs().first() else {
        return Ok(vec![Figure::missing(WHAT, "there is no pair")]);
    };
    let Ok(pair) = folder.load(first) else {
        return Ok(vec![Figure::missing(WHAT, "its pair cannot be read")]);
    };
    let gray = |image: &image::RgbImage| image::DynamicImage::ImageRgb8(image.clone()).into_luma8();
    let (left, right) = (gray(&pair.left), gray(&pair.right));
    let aimed = AimedPair::suited(&calibration.cameras, &Workspace::default())?;
    let report = compare_with_published(&left, &right, &aimed, NEAREST_M, 15)
        .map_err(|error| OfflineError::Comparison(error.to_string()))?;
    Ok(pipeline_figures(&report))
}

fn pipeline_figures(report: &ComparisonReport) -> Vec<Figure> {
    let title = |what: &str| format!("rectify, match and place a 640×480 pair: {what}");
    let time = Figure::new(title("time"), report.ours_ms, "ms");
    let fraction = title("time as a fraction of the published pipeline's");
    const WITHOUT: &str = "built without the published pipeline: run ./plumbline bench";
    vec![
        match report.published_ms {
            Some(published_ms) => time.peer("published", published_ms),
            None => time,
        },
        match report.ratio() {
            Some(ratio) => Figure::new(fraction, ratio, "").at_most(0.25),
            None => Figure::missing(fraction, WITHOUT),
        },
        Figure::new(title("depth step at 0.6 m"), report.depth_step_ours_m * 1000.0, "mm")
            .at_most(2.2)
            .peer("published", report.depth_step_published_m * 1000.0),
    ]
}
