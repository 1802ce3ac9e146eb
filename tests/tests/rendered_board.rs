//! The twin's eyes are exact enough to calibrate on: a board drawn at known poses calibrates back
//! to the lenses it was drawn through, within the uncertainty that the calibration states.
#![allow(clippy::print_stderr)]

use nalgebra::{Isometry3, Vector3};
use plumbline_model::{CalibrationOptions, Camera, CameraModel, Fisheye, StereoCameras, Unattended};
use plumbline_vision::{calibrate, chessboard};

use plumbline_tests::eye_renderer;
use plumbline_twin::eyes::{Sensor, sample};
use plumbline_twin::scene::{Scenery, Snapshot};

fn empty() -> (Scenery, Snapshot) {
    let snapshot =
        Snapshot { time_s: 0.0, robot_from_body: vec![Isometry3::identity()], eyes: sample::eyes(0.5) };
    (Scenery::default(), snapshot)
}

/// Poses of the board in the left eye: all over the image, near and far, tilted.
fn poses() -> Vec<Isometry3<f64>> {
    let middle = sample::board().corner(39).coords * 0.5;
    let places = [
        (0.0, 0.0, 0.2),
        (0.12, 0.05, 0.2),
        (-0.12, 0.05, 0.2),
        (0.0, 0.12, 0.2),
        (0.0, -0.12, 0.2),
        (0.2, 0.1, 0.18),
        (-0.2, -0.1, 0.18),
        (0.2, -0.12, 0.18),
        (-0.2, 0.12, 0.18),
        (0.05, 0.0, 0.32),
        (0.22, 0.0, 0.13),
        (-0.2, 0.02, 0.13),
        (0.03, 0.2, 0.14),
        (0.03, -0.2, 0.14),
        (-0.1, -0.1, 0.3),
    ];
    places
        .iter()
        .enumerate()
        .map(|(i, &(x, y, z))| {
            let place = Vector3::new(x, y, z);
            let facing = Vector3::new(-y, x, 0.0) / place.norm() * 0.9;
            let wobble = |k: f64| (1.7 * i as f64 + k).sin();
            let tilt = Vector3::new(0.45 * wobble(0.0), 0.45 * wobble(2.0), 0.6 * wobble(4.0));
            Isometry3::translation(x, y, z)
                * Isometry3::rotation(facing)
                * Isometry3::rotation(tilt)
                * Isometry3::translation(-middle.x, -middle.y, 0.0)
        })
        .collect()
}

#[test]
fn a_board_calibrates_back_to_the_true_lenses() {
    let Some(mut renderer) = eye_renderer() else { return };
    let (mut scenery, mut snapshot) = empty();
    snapshot.eyes.left = without_skew(&snapshot.eyes.left);
    snapshot.eyes.right = without_skew(&snapshot.eyes.right);
    let room = sample::lab().0.items;
    let sensor = Sensor::default();
    let board = sample::board();
    let observations: Vec<_> = poses()
        .iter()
        .enumerate()
        .map(|(i, pose)| {
            scenery.items = room.clone();
            scenery.items.push(sample::held_board(&snapshot, pose));
            let pair = renderer.render(&scenery, &snapshot, &sensor, i as u64).expect("an image");
            let gray = |image| image::imageops::grayscale(image);
            chessboard::find_in_pair(&format!("{i}"), &gray(&pair.left), &gray(&pair.right), &board)
                .observation
        })
        .collect();
    let options = CalibrationOptions { cross_validation_folds: 0, ..Default::default() };
    let size = (640, 480);
    let found = calibrate::solve(&board, &observations, [size, size], &options, &[], &Unattended)
        .expect("the boards calibrate");
    let summary = found.summary.as_ref().expect("solved");
    eprintln!(
        "{} pairs, rms left {:.4} right {:.4} stereo {:.4} px, left-out corners {}",
        found.per_pair.len(),
        summary.rms_left_px,
        summary.rms_right_px,
        summary.rms_stereo_px,
        found.left_out_corners().count()
    );
    assert!(found.per_pair.len() >= 10, "only {} pairs were found", found.per_pair.len());
    assert!(summary.rms_stereo_px <= 0.1, "stereo rms is {} px", summary.rms_stereo_px);
    let eyes = &snapshot.eyes;
    let truth = StereoCameras {
        left: eyes.left,
        right: eyes.right,
        right_from_left: plumbline_model::Pose::new(
            eyes.robot_from_right.isometry.inverse() * eyes.robot_from_left.isometry,
        ),
    };
    // Every parameter within a few of its standard deviations, all together as they should be.
    let errors = differences(&found.cameras, &truth);
    let covariance = &found.covariance.as_ref().expect("solved").matrix;
    let mut squares = 0.0;
    for (i, error) in errors.iter().enumerate() {
        let sd = covariance[(i, i)].sqrt();
        eprintln!("{i:2}: error {error:10.3e}, sd {sd:9.2e}, ratio {:6.2}", error / sd);
        assert!(error.abs() < 4.0 * sd, "parameter {i} is off by {error}, its uncertainty is {sd}");
        squares += (error / sd).powi(2);
    }
    assert!(squares / (errors.len() as f64) < 4.0, "the parameters are off by more than they admit");
}

/// A calibration never fits the skew, so the eyes of this test have none.
fn without_skew(camera: &Camera) -> Camera {
    match camera.model {
        CameraModel::Fisheye(lens) => {
            Camera { model: CameraModel::Fisheye(Fisheye { skew_px: 0.0, ..lens }), ..*camera }
        }
        CameraModel::Pinhole(_) => *camera,
    }
}

/// Found minus true, in the order of the covariance.
fn differences(found: &StereoCameras, truth: &StereoCameras) -> Vec<f64> {
    let mut out = Vec::new();
    for (f, t) in [(&found.left, &truth.left), (&found.right, &truth.right)] {
        out.extend(f.model.parameters().iter().zip(t.model.parameters()).map(|(f, t)| f - t));
    }
    let (f, t) = (&found.right_from_left.isometry, &truth.right_from_left.isometry);
    out.extend((f.rotation * t.rotation.inverse()).scaled_axis().iter());
    out.extend((f.translation.vector - t.translation.vector).iter());
    out
}
