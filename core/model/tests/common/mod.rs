//! Eyes and calibrations made up for the tests. Every number is invented.
#![allow(dead_code, reason = "each test program uses its own part")]

use nalgebra::{DMatrix, Vector3};
use plumbline_model::camera::{Camera, CameraModel, Fisheye, Pinhole};
use plumbline_model::{
    CalibrationOptions, Chessboard, CornerResidual, Corners, Evidence, Eye, FitSummary, ModelKind, PairFit,
    PairObservation, ParameterCovariance, Pixel, Pose, RejectedPair, StereoCalibration, StereoCameras,
};

/// Fisheye eyes about like NICO's, with digits that rounding would show.
pub fn fisheye_eyes() -> StereoCameras {
    let camera = |cx_px: f64| Camera {
        model: CameraModel::Fisheye(Fisheye {
            fx_px: 150.123_456_789_012_34,
            fy_px: 149.987_654_321_098_76,
            cx_px,
            cy_px: 240.0 - 1.0 / 3.0,
            skew_px: 0.0,
            k: [-0.008_4, -8.0e-3 / 7.0, 1.7e-13, -2.6e-4],
        }),
        width_px: 640,
        height_px: 480,
    };
    StereoCameras {
        left: camera(321.3),
        right: camera(317.7),
        right_from_left: Pose::from_rotation_vector(
            Vector3::new(0.004, -0.021, 0.013),
            Vector3::new(-0.069_93, 0.1 / 300.0, -7e-4),
        ),
    }
}

/// The same eyes with a skewed right sensor, which this program never fits but must keep.
pub fn skewed_eyes() -> StereoCameras {
    let mut eyes = fisheye_eyes();
    if let CameraModel::Fisheye(lens) = &mut eyes.right.model {
        lens.skew_px = -0.1 / 3.0;
    }
    eyes
}

/// Pinhole eyes; `k3` is what Kalibr has no place for.
pub fn pinhole_eyes(k3: f64) -> StereoCameras {
    let mut eyes = fisheye_eyes();
    for camera in [&mut eyes.left, &mut eyes.right] {
        camera.model = CameraModel::Pinhole(Pinhole {
            fx_px: 524.6,
            fy_px: 526.9,
            cx_px: 312.4,
            cy_px: 247.4,
            k1: -0.36,
            k2: 0.175,
            p1: 1.0 / 3000.0,
            p2: -5e-4,
            k3,
        });
    }
    eyes
}

/// The board of [`calibration`].
pub fn board() -> Chessboard {
    Chessboard::new(4, 3, 0.03).expect("usable")
}

fn corners(shift_px: f64) -> Corners {
    (0..board().corner_count())
        .map(|i| {
            let i = i as f64;
            // One corner was not measured.
            (i != 5.0).then(|| Pixel::new(100.0 + i / 3.0 + shift_px, 200.0 + i / 7.0))
        })
        .collect()
}

/// A calibration in which every optional part is present once and absent once.
pub fn calibration() -> StereoCalibration {
    let observation = |name: &str, left, right| PairObservation { name: name.to_owned(), left, right };
    let residual = |eye, corner: usize, left_out| CornerResidual {
        eye,
        corner,
        measured: Pixel::new(101.0 / 3.0, 77.0 / 9.0),
        error_px: [0.1 / 3.0, -1e-7],
        left_out,
    };
    let fit = |name: &str, left_px| PairFit {
        name: name.to_owned(),
        left_px,
        right_px: Some(0.1 / 7.0),
        epipolar_px: left_px.map(|px| px / 3.0),
        left_from_board: Pose::from_rotation_vector(
            Vector3::new(0.1, 0.2, -3.0),
            Vector3::new(0.01, -0.02, 1.0 / 3.0),
        ),
        residuals: vec![
            residual(Eye::Left, 0, false),
            residual(Eye::Right, 11, true),
            residual(Eye::Left, 1, false),
        ],
    };
    let size = 2 * ModelKind::Fisheye.parameter_count() + 6;
    StereoCalibration {
        cameras: skewed_eyes(),
        covariance: Some(ParameterCovariance {
            matrix: DMatrix::from_fn(size, size, |i, j| ((i * j) as f64 - 30.0) * 1e-9 / 7.0),
        }),
        summary: Some(FitSummary {
            rms_left_px: 0.09,
            rms_right_px: 0.1,
            rms_stereo_px: 0.19_f64.sqrt() / 5.0,
            cross_validated_px: None,
            epipolar_px: 0.12,
            square_mean_m: 0.030_08,
            square_sd_m: 4.5e-4,
        }),
        per_pair: vec![fit("01.png", Some(0.08)), fit("02: \"quoted\", 目.png", None)],
        rejected: vec![RejectedPair {
            name: "03.png".to_owned(),
            reason: "no board: show\nthe whole board # really".to_owned(),
        }],
        evidence: Some(Evidence {
            board: board(),
            options: CalibrationOptions { cross_validation_folds: 3, ..CalibrationOptions::default() },
            observations: vec![
                observation("01.png", Some(corners(0.0)), Some(corners(-20.25))),
                observation("02: \"quoted\", 目.png", None, Some(corners(-21.0 / 11.0))),
                observation("03.png", None, None),
            ],
            dropped_pairs: vec!["03.png".to_owned()],
            created: "2026-11-21T10:04:00.123456789Z".parse().expect("a time"),
            software: "Plumbline 0.1.0".to_owned(),
            minutes_since_on: Some(12.5),
            source: "a folder: left/*.png, right/*.png".to_owned(),
        }),
    }
}
