//! Calibration of real eyes, against what OpenCV reaches on the same images (figures from the
//! data's own notes). Skipped where the measured data are not at hand.

use std::path::{Path, PathBuf};

use image::GrayImage;
use plumbline_model::{
    CalibrationOptions, Chessboard, CornerResidual, ModelKind, PairObservation, Pixel, Raw,
    StereoCalibration, Unattended, measured_data,
};
use plumbline_vision::calibrate::{check, solve};
use plumbline_vision::chessboard;
use rayon::prelude::*;

/// The folder, or `None` after saying why the test is skipped.
fn data(name: &str) -> Option<PathBuf> {
    measured_data::folder(name).map_err(|reason| eprintln!("{reason}")).ok()
}

fn images(folder: &Path, prefix: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("readable")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            name.starts_with(prefix) && (name.ends_with(".png") || name.ends_with(".jpg"))
        })
        .collect();
    files.sort();
    files
}

fn gray(path: &Path) -> GrayImage {
    image::open(path).expect("an image").to_luma8()
}

struct Pairs {
    observations: Vec<PairObservation>,
    sizes_px: [(u32, u32); 2],
}

fn find_all(left: &[PathBuf], right: &[PathBuf], board: &Chessboard) -> Pairs {
    assert_eq!(left.len(), right.len());
    let observations = left
        .par_iter()
        .zip(right)
        .map(|(l, r)| {
            let name = l.file_name().expect("a file").to_string_lossy().into_owned();
            chessboard::find_in_pair(&name, &gray(l), &gray(r), board).observation
        })
        .collect();
    Pairs { observations, sizes_px: [gray(&left[0]).dimensions(), gray(&right[0]).dimensions()] }
}

fn nico(folder: &Path) -> (Chessboard, Pairs) {
    let board = Chessboard::new(8, 5, 0.03).expect("usable");
    let pairs = find_all(&images(&folder.join("left"), ""), &images(&folder.join("right"), ""), &board);
    (board, pairs)
}

fn options(model: ModelKind) -> CalibrationOptions {
    CalibrationOptions { model, cross_validation_folds: 0, ..CalibrationOptions::default() }
}

fn solved(board: &Chessboard, pairs: &Pairs, model: ModelKind) -> StereoCalibration {
    solve(board, &pairs.observations, pairs.sizes_px, &options(model), &[], &Unattended).expect("solvable")
}

fn stereo_rms_px(calibration: &StereoCalibration) -> f64 {
    calibration.summary.as_ref().expect("own result").rms_stereo_px
}

#[test]
fn nicos_eyes_from_all_pairs() {
    let Some(folder) = data("nico-chessboard") else { return };
    let (board, pairs) = nico(&folder);
    let calibration = solved(&board, &pairs, ModelKind::Fisheye);
    assert_eq!(calibration.per_pair.len(), pairs.observations.len(), "rejected: {:?}", calibration.rejected);
    let rms = stereo_rms_px(&calibration);
    assert!(rms <= 0.096, "stereo rms {rms} px");
    assert!((calibration.cameras.baseline_m() - 0.0699).abs() < 3e-4);
}

/// Every third pair kept aside, three times.
#[test]
fn nicos_eyes_on_pairs_kept_aside() {
    let Some(folder) = data("nico-chessboard") else { return };
    let (board, pairs) = nico(&folder);
    let (mut reprojection, mut epipolar) = (0.0, 0.0);
    for part in 0..3 {
        let (held, kept): (Vec<_>, Vec<_>) =
            pairs.observations.iter().cloned().enumerate().partition(|(i, _)| i % 3 == part);
        let [held, kept] =
            [held, kept].map(|part| part.into_iter().map(|(_, pair)| pair).collect::<Vec<_>>());
        let calibration =
            solve(&board, &kept, pairs.sizes_px, &options(ModelKind::Fisheye), &[], &Unattended);
        let report = check(&calibration.expect("solvable").cameras, &board, &held, false).expect("checkable");
        reprojection += report.reprojection_px / 3.0;
        epipolar += report.epipolar_px / 3.0;
    }
    assert!(reprojection <= 0.1, "reprojection {reprojection} px");
    assert!(epipolar <= 0.118, "epipolar {epipolar} px");
}

/// A corner 5 px off, as OpenCV's detector has one on these images.
#[test]
fn one_corner_moved_on_real_data_is_found() {
    let Some(folder) = data("nico-chessboard") else { return };
    let (board, mut pairs) = nico(&folder);
    let corner = pairs.observations[9].right.as_mut().expect("seen")[20].as_mut().expect("measured");
    corner.u_px += 4.0;
    corner.v_px += 3.0;
    let calibration = solved(&board, &pairs, ModelKind::Fisheye);
    let moved = |r: &CornerResidual| r.corner == 20 && r.norm_px() > 4.0;
    assert!(calibration.left_out_corners().any(|(_, r)| moved(r)));
    assert!(stereo_rms_px(&calibration) <= 0.096);
}

#[test]
fn a_large_fisheye_from_its_images() {
    let Some(folder) = data("opencv-fisheye-jy") else { return };
    let board = Chessboard::new(8, 6, 0.0244).expect("usable");
    let pairs = find_all(&images(&folder.join("left"), ""), &images(&folder.join("right"), ""), &board);
    let calibration = solved(&board, &pairs, ModelKind::Fisheye);
    assert_eq!(calibration.per_pair.len(), 34, "rejected: {:?}", calibration.rejected);
    let rms = stereo_rms_px(&calibration);
    assert!(rms <= 0.51, "stereo rms {rms} px");
}

/// From OpenCV's own corners, all parameters free: the minimum that OpenCV finds, 0.327 136 px.
#[test]
fn a_large_fisheye_from_opencvs_corners() {
    let Some(folder) = data("opencv-fisheye-jy") else { return };
    let board = Chessboard::new(8, 6, 0.024_399_999_5).expect("usable");
    let [left, right] = ["left.xml", "right.xml"].map(|name| opencv_corners(&folder.join(name)));
    let all = |corners: Vec<Pixel<Raw>>| Some(corners.into_iter().map(Some).collect());
    let observations: Vec<PairObservation> = left
        .into_iter()
        .zip(right)
        .enumerate()
        .map(|(i, (l, r))| PairObservation { name: format!("image {i}"), left: all(l), right: all(r) })
        .collect();
    assert_eq!(observations.len(), 34);
    // As OpenCV: no corner is left out.
    let options = CalibrationOptions { leave_out_bad_corners: false, ..options(ModelKind::Fisheye) };
    let size = (1280, 800);
    let calibration =
        solve(&board, &observations, [size, size], &options, &[], &Unattended).expect("solvable");
    assert_eq!(calibration.per_pair.len(), 34, "rejected: {:?}", calibration.rejected);
    let rms = stereo_rms_px(&calibration);
    // OpenCV frees the same parameters, so both stand at the same minimum.
    assert!(rms <= 0.32714, "stereo rms {rms} px");
    assert!((calibration.cameras.baseline_m() - 0.099_448).abs() < 3e-4);
}

/// Corner lists of OpenCV's test data: `<image_i>u v u v …</image_i>`.
fn opencv_corners(path: &Path) -> Vec<Vec<Pixel<Raw>>> {
    let text = std::fs::read_to_string(path).expect("readable");
    (0..)
        .map_while(|i| {
            let (open, close) = (format!("<image_{i}>"), format!("</image_{i}>"));
            let body = text.split(&open).nth(1)?.split(&close).next()?;
            let numbers: Vec<f64> = body.split_whitespace().map(|n| n.parse().expect("a number")).collect();
            Some(numbers.chunks_exact(2).map(|c| Pixel::new(c[0], c[1])).collect())
        })
        .collect()
}

#[test]
fn a_pinhole_pair() {
    let Some(folder) = data("opencv-stereo-13") else { return };
    let board = Chessboard::new(9, 6, 0.025).expect("usable");
    let pairs = find_all(&images(&folder, "left"), &images(&folder, "right"), &board);
    let calibration = solved(&board, &pairs, ModelKind::Pinhole);
    assert_eq!(calibration.per_pair.len(), 13, "rejected: {:?}", calibration.rejected);
    let rms = stereo_rms_px(&calibration);
    assert!(rms <= 0.444, "stereo rms {rms} px");
}

#[test]
fn a_bumblebees_baseline() {
    let Some(folder) = data("bumblebee2") else { return };
    let board = Chessboard::new(4, 6, 0.03).expect("usable");
    let pairs = find_all(&images(&folder, "left"), &images(&folder, "right"), &board);
    let calibration = solved(&board, &pairs, ModelKind::Pinhole);
    assert_eq!(calibration.per_pair.len(), 11);
    let off_m = calibration.cameras.baseline_m() - 0.120_05;
    assert!(off_m.abs() <= 2e-4, "baseline is {} mm off BoofCV's", off_m * 1e3);
}
