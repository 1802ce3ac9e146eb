//! Slack and lenses that are off are part of the stated uncertainty.

use nalgebra::{DMatrix, DVector};
use plumbline_model::{
    Camera, CameraModel, Fisheye, ModelKind, ParameterCovariance, Pose, StereoCameras, Unattended,
};

use super::honesty::coverage;
use super::world::{World, board};
use crate::mount::types::perturbed;
use crate::mount::{Eyes, MountOptions, Target, calibrate_mount};
use crate::synthetic::Noise;

#[test]
fn slack_that_nobody_stated_is_noticed_and_enters_the_uncertainty() {
    let slack_rad = 0.003;
    let (chi_square, within) = coverage(40, |seed| {
        let mut world = World { slack_rad, ..World::new(300 + seed) };
        let views = world.board_views(16);
        let solved = world.solve(&views);
        if let Ok(solved) = &solved {
            assert!(
                solved.angle_sigma_rad.iter().all(|sd| (0.3..3.0).contains(&(sd / slack_rad))),
                "{:?}",
                solved.angle_sigma_rad
            );
        }
        (world, solved)
    });
    // Its size is estimated from some twenty numbers: tails are heavier.
    assert!((4.5..10.0).contains(&chi_square), "{chi_square}");
    assert!(within >= 0.93, "{within}");
}

#[test]
fn lenses_that_are_a_little_off_are_part_of_the_uncertainty() {
    // How well a good calibration of the eyes knows them: f, c (px), k1 to k4, twice; turn (rad), shift (m).
    let lens = [0.08, 0.08, 0.06, 0.06, 5e-4, 5e-4, 2e-4, 3e-5];
    let sd: Vec<f64> = lens.iter().chain(&lens).copied().chain([2e-4; 3]).chain([5e-5; 3]).collect();
    let matrix = DMatrix::from_diagonal(&DVector::from_iterator(22, sd.iter().map(|s| s * s)));
    let known = ParameterCovariance { matrix };
    let run = |included: bool| {
        coverage(40, |seed| {
            let mut world = World::new(400 + seed);
            let views = world.board_views(12);
            let cameras = off_by(&world.rig.eyes.cameras, &sd, &mut world.noise);
            let eyes = Eyes { cameras: &cameras, covariance: included.then_some(&known) };
            let target = Target::UnknownBoard(board());
            let solved =
                calibrate_mount(&world.rig, eyes, &views, &target, &MountOptions::default(), &Unattended);
            (world, solved)
        })
    };
    let (chi_square, within) = run(true);
    assert!((4.0..8.0).contains(&chi_square), "{chi_square}");
    assert!(within >= 0.95, "{within}");
    // The test would notice if this part were missing.
    assert!(run(false).0 > 10.0);
}

/// Eyes that differ by errors of these standard deviations, in the order of a calibration's
/// covariance.
fn off_by(cameras: &StereoCameras, sd: &[f64], noise: &mut Noise) -> StereoCameras {
    let mut error = sd.iter().map(|sd| sd * noise.normal());
    let mut lens = |camera: &Camera| {
        let CameraModel::Fisheye(old) = camera.model else { panic!("a fisheye") };
        let mut p = camera.model.parameters();
        p.iter_mut().zip(&mut error).for_each(|(p, e)| *p += e);
        let CameraModel::Fisheye(new) = CameraModel::from_parameters(ModelKind::Fisheye, &p) else {
            panic!("a fisheye")
        };
        Camera { model: CameraModel::Fisheye(Fisheye { skew_px: old.skew_px, ..new }), ..*camera }
    };
    let (left, right) = (lens(&cameras.left), lens(&cameras.right));
    let six: Vec<f64> = error.collect();
    StereoCameras {
        left,
        right,
        right_from_left: Pose::new(perturbed(&cameras.right_from_left.isometry, &six)),
    }
}
