//! Synthetic worlds: perfect corners, seeded noise, solve, compare with the truth.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::{
    CalibrationOptions, Camera, CameraModel, Cancelled, Chessboard, Eye, Fisheye, JobContext, ModelKind,
    PairObservation, Pinhole, Pixel, Pose, StereoCameras, Unattended,
};

use super::{SolveError, check, solve};

const SIZE: (u32, u32) = (640, 480);

fn board() -> Chessboard {
    Chessboard::new(8, 5, 0.03).expect("usable")
}

fn eyes(kind: ModelKind) -> StereoCameras {
    let model = |shift: f64| match kind {
        ModelKind::Fisheye => CameraModel::Fisheye(Fisheye {
            fx_px: 150.7 + shift,
            fy_px: 150.6 + shift,
            cx_px: 321.3 + shift,
            cy_px: 238.1 - shift,
            skew_px: 0.0,
            k: [-0.0084, -0.008, 0.0017, -0.0003],
        }),
        ModelKind::Pinhole => CameraModel::Pinhole(Pinhole {
            fx_px: 524.6 + shift,
            fy_px: 526.9 + shift,
            cx_px: 312.4,
            cy_px: 247.4 - shift,
            k1: -0.36,
            k2: 0.175,
            p1: 0.001,
            p2: -0.0005,
            k3: 0.0,
        }),
    };
    let camera = |shift| Camera { model: model(shift), width_px: SIZE.0, height_px: SIZE.1 };
    StereoCameras {
        left: camera(0.0),
        right: camera(0.8),
        right_from_left: Pose::from_rotation_vector(
            Vector3::new(0.0035, -0.0089, 0.0057),
            Vector3::new(-0.0699, -0.0003, -0.001),
        ),
    }
}

/// Small deterministic generator (SplitMix64), so that every run sees the same noise.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// Board poses over the view, near and far, tilted up to 40°.
fn poses(kind: ModelKind, count: usize, noise: &mut Noise) -> Vec<Isometry3<f64>> {
    let (aside, near, far) = match kind {
        ModelKind::Fisheye => (0.8, 0.15, 0.4),
        ModelKind::Pinhole => (0.2, 0.5, 0.9),
    };
    (0..count)
        .map(|_| {
            let range = noise.between(near, far);
            let place = Vector3::new(
                noise.between(-aside, aside) * range,
                noise.between(-aside, aside) * range,
                range,
            );
            let turn =
                Vector3::new(noise.between(-0.7, 0.7), noise.between(-0.7, 0.7), noise.between(-1.5, 1.5));
            Isometry3::new(place, turn) * Isometry3::translation(-0.105, -0.06, 0.0)
        })
        .collect()
}

fn observe(
    cameras: &StereoCameras,
    poses: &[Isometry3<f64>],
    sigma_px: f64,
    noise: &mut Noise,
) -> Vec<PairObservation> {
    let board = board();
    poses
        .iter()
        .enumerate()
        .map(|(i, left_from_board)| {
            let mut corners = |eye: Eye| {
                board
                    .corners()
                    .iter()
                    .map(|corner| {
                        let in_left = left_from_board * corner.coords;
                        let in_eye = match eye {
                            Eye::Left => in_left,
                            Eye::Right => cameras.right_from_left.isometry * in_left,
                        };
                        let pixel = cameras.camera(eye).project(&in_eye.coords).ok()?;
                        Some(Pixel::new(
                            pixel.u_px + sigma_px * noise.normal(),
                            pixel.v_px + sigma_px * noise.normal(),
                        ))
                    })
                    .collect()
            };
            PairObservation {
                name: format!("pair {i}"),
                left: Some(corners(Eye::Left)),
                right: Some(corners(Eye::Right)),
            }
        })
        .collect()
}

fn world(kind: ModelKind, pairs: usize, sigma_px: f64, seed: u64) -> Vec<PairObservation> {
    let mut noise = Noise(seed);
    let poses = poses(kind, pairs, &mut noise);
    observe(&eyes(kind), &poses, sigma_px, &mut noise)
}

fn options(kind: ModelKind) -> CalibrationOptions {
    CalibrationOptions { model: kind, cross_validation_folds: 0, ..CalibrationOptions::default() }
}

fn solve_plain(
    kind: ModelKind,
    pairs: &[PairObservation],
) -> Result<plumbline_model::StereoCalibration, SolveError> {
    solve(&board(), pairs, [SIZE, SIZE], &options(kind), &[], &Unattended)
}

#[test]
fn perfect_corners_give_the_truth_back() {
    for kind in [ModelKind::Fisheye, ModelKind::Pinhole] {
        let found = solve_plain(kind, &world(kind, 12, 0.0, 1)).expect("solvable");
        let truth = eyes(kind);
        assert!(found.summary.expect("own result").rms_stereo_px < 1e-6);
        for eye in Eye::BOTH {
            let (a, b) = (found.cameras.camera(eye).model.parameters(), truth.camera(eye).model.parameters());
            for (name, (a, b)) in kind.parameter_names().iter().zip(a.iter().zip(&b)) {
                assert!((a - b).abs() < 1e-4 * (1.0 + b.abs()), "{eye} {name}: {a} instead of {b}");
            }
        }
        let apart = found.cameras.right_from_left.translation_m() - truth.right_from_left.translation_m();
        assert!(apart.norm() < 1e-7, "{apart}");
    }
}

/// Errors in units of the stated standard deviation, over many worlds, must look like one.
#[test]
fn noisy_corners_give_the_truth_within_the_stated_uncertainty() {
    for kind in [ModelKind::Fisheye, ModelKind::Pinhole] {
        let truth = eyes(kind);
        let mut squared = Vec::new();
        for seed in 0..8 {
            let found = solve_plain(kind, &world(kind, 15, 0.08, 100 + seed)).expect("solvable");
            let covariance = found.covariance.expect("own result").matrix;
            let mut errors: Vec<f64> = Vec::new();
            for eye in Eye::BOTH {
                let (a, b) =
                    (found.cameras.camera(eye).model.parameters(), truth.camera(eye).model.parameters());
                errors.extend(a.iter().zip(&b).map(|(a, b)| a - b));
            }
            let turn = found.cameras.right_from_left.isometry.rotation
                * truth.right_from_left.isometry.rotation.inverse();
            errors.extend(turn.scaled_axis().iter());
            errors.extend(
                (found.cameras.right_from_left.translation_m() - truth.right_from_left.translation_m())
                    .iter(),
            );
            squared.extend(errors.iter().enumerate().map(|(i, e)| e * e / covariance[(i, i)]));
        }
        let mean = squared.iter().sum::<f64>() / squared.len() as f64;
        // 8 worlds of about 8 independent directions: the mean of χ²₁ scatters by about 0.18.
        assert!(
            (0.5..1.7).contains(&mean),
            "{kind:?}: errors are {:.2} of the stated uncertainty",
            mean.sqrt()
        );
    }
}

#[test]
fn one_bad_corner_is_found_and_its_view_is_kept() {
    let mut pairs = world(ModelKind::Fisheye, 12, 0.08, 3);
    let clean =
        solve_plain(ModelKind::Fisheye, &pairs).expect("solvable").summary.expect("own result").rms_stereo_px;
    let corner = pairs[4].right.as_mut().expect("seen")[17].as_mut().expect("measured");
    corner.u_px += 4.0;
    corner.v_px -= 3.0;
    let found = solve_plain(ModelKind::Fisheye, &pairs).expect("solvable");
    let left_out: Vec<_> =
        found.left_out_corners().map(|(name, r)| (name.to_owned(), r.eye, r.corner)).collect();
    assert_eq!(left_out, [("pair 4".to_owned(), Eye::Right, 17)]);
    assert_eq!(found.per_pair.len(), 12);
    assert!((found.summary.expect("own result").rms_stereo_px - clean).abs() < 0.002);
}

#[test]
fn clean_data_loses_no_corner() {
    for seed in 0..4 {
        let found = solve_plain(ModelKind::Fisheye, &world(ModelKind::Fisheye, 15, 0.1, 40 + seed))
            .expect("solvable");
        assert_eq!(found.left_out_corners().count(), 0);
        assert!(found.rejected.is_empty());
    }
}

#[test]
fn a_pair_of_two_moments_is_rejected_with_a_reason() {
    let mut pairs = world(ModelKind::Fisheye, 12, 0.08, 5);
    pairs[3].right = pairs[8].right.clone();
    let found = solve_plain(ModelKind::Fisheye, &pairs).expect("solvable");
    assert_eq!(found.per_pair.len(), 11);
    assert_eq!(found.rejected.len(), 1);
    assert_eq!(found.rejected[0].name, "pair 3");
    assert!(found.rejected[0].reason.contains("same moment"), "{}", found.rejected[0].reason);
}

#[test]
fn a_board_that_slipped_between_the_images_is_rejected() {
    let (kind, mut noise) = (ModelKind::Fisheye, Noise(6));
    let poses = poses(kind, 12, &mut noise);
    let mut pairs = observe(&eyes(kind), &poses, 0.05, &mut noise);
    let mut moved = poses.clone();
    moved[2].translation.vector += Vector3::new(0.0, 0.004, 0.0);
    pairs[2].right = observe(&eyes(kind), &moved, 0.05, &mut noise)[2].right.clone();
    let found = solve_plain(kind, &pairs).expect("solvable");
    assert_eq!(found.rejected.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["pair 2"]);
}

#[test]
fn corners_counted_from_the_other_end_are_turned() {
    let mut pairs = world(ModelKind::Fisheye, 10, 0.05, 7);
    for i in [1, 6] {
        pairs[i].right.as_mut().expect("seen").reverse();
    }
    let found = solve_plain(ModelKind::Fisheye, &pairs).expect("solvable");
    assert_eq!(found.per_pair.len(), 10);
    assert!(found.summary.expect("own result").rms_stereo_px < 0.09);
}

#[test]
fn swapped_eyes_are_told() {
    let mut pairs = world(ModelKind::Fisheye, 10, 0.05, 8);
    for pair in &mut pairs {
        std::mem::swap(&mut pair.left, &mut pair.right);
    }
    assert_eq!(solve_plain(ModelKind::Fisheye, &pairs), Err(SolveError::EyesSwapped));
}

#[test]
fn a_mirrored_eye_is_told() {
    let columns = board().inner_columns as usize;
    for eye in Eye::BOTH {
        let mut pairs = world(ModelKind::Fisheye, 10, 0.05, 9);
        for pair in &mut pairs {
            let corners = match eye {
                Eye::Left => pair.left.as_mut(),
                Eye::Right => pair.right.as_mut(),
            };
            let corners = corners.expect("seen");
            // What a detector returns on a mirrored image: it always reads a board from its front.
            for row in corners.chunks_mut(columns) {
                row.reverse();
            }
            for corner in corners.iter_mut().flatten() {
                corner.u_px = f64::from(SIZE.0) - 1.0 - corner.u_px;
            }
        }
        assert_eq!(solve_plain(ModelKind::Fisheye, &pairs), Err(SolveError::Mirrored(eye)));
    }
}

#[test]
fn too_little_is_refused_with_what_is_missing() {
    let pairs = world(ModelKind::Fisheye, 3, 0.05, 10);
    assert_eq!(solve_plain(ModelKind::Fisheye, &pairs), Err(SolveError::TooFewPairs { found: 3 }));
    let one = world(ModelKind::Fisheye, 1, 0.0, 11).remove(0);
    let alike: Vec<_> =
        (0..10).map(|i| PairObservation { name: format!("pair {i}"), ..one.clone() }).collect();
    assert_eq!(solve_plain(ModelKind::Fisheye, &alike), Err(SolveError::AllViewsAlike { distinct: 1 }));
}

#[test]
fn corners_of_another_board_are_refused() {
    let mut pairs = world(ModelKind::Fisheye, 6, 0.05, 12);
    pairs[2].left.as_mut().expect("seen").pop();
    let error = solve_plain(ModelKind::Fisheye, &pairs).expect_err("one corner short");
    assert!(matches!(error, SolveError::WrongCornerCount { found: 39, expected: 40, eye: Eye::Left, .. }));
}

#[test]
fn dropped_pairs_are_kept_as_evidence_and_not_used() {
    let pairs = world(ModelKind::Fisheye, 10, 0.05, 13);
    let dropped = ["pair 2".to_owned()];
    let found = solve(&board(), &pairs, [SIZE, SIZE], &options(ModelKind::Fisheye), &dropped, &Unattended)
        .expect("solvable");
    assert_eq!(found.per_pair.len(), 9);
    let evidence = found.evidence.expect("own result");
    assert_eq!((evidence.observations.len(), evidence.dropped_pairs.as_slice()), (10, dropped.as_slice()));
}

#[test]
fn the_cross_validated_error_is_above_the_fit_and_near_the_noise() {
    let pairs = world(ModelKind::Fisheye, 15, 0.1, 14);
    let options = CalibrationOptions { cross_validation_folds: 5, ..options(ModelKind::Fisheye) };
    let summary = solve(&board(), &pairs, [SIZE, SIZE], &options, &[], &Unattended)
        .expect("solvable")
        .summary
        .expect("own result");
    let crossed = summary.cross_validated_px.expect("asked for");
    // Two axes of 0.1 px each.
    assert!(crossed > summary.rms_stereo_px && crossed < 0.15, "{crossed} against {}", summary.rms_stereo_px);
}

#[test]
fn a_wrong_calibration_fails_the_check() {
    let pairs = world(ModelKind::Fisheye, 8, 0.05, 15);
    let truth = eyes(ModelKind::Fisheye);
    let good = check(&truth, &board(), &pairs, false).expect("checkable");
    assert!(good.reprojection_px < 0.08 && good.epipolar_px < 0.08, "{good:?}");
    assert!((good.square_mean_m - 0.03).abs() < 1e-4);
    let mut bent = truth;
    bent.right_from_left =
        Pose::new(Isometry3::rotation(Vector3::new(0.01, 0.0, 0.0)) * truth.right_from_left.isometry);
    let bad = check(&bent, &board(), &pairs, false).expect("checkable");
    assert!(bad.epipolar_px > 1.0, "an eye pitched by 0.01 rad is 1.5 px off: {}", bad.epipolar_px);
}

#[test]
fn cancelling_stops_without_a_result() {
    struct CancelAtOnce;
    impl JobContext for CancelAtOnce {
        fn checkpoint(&self) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
        fn report(&self, _: f64, _: &str) {}
    }
    let pairs = world(ModelKind::Fisheye, 8, 0.05, 16);
    let result = solve(&board(), &pairs, [SIZE, SIZE], &options(ModelKind::Fisheye), &[], &CancelAtOnce);
    assert_eq!(result, Err(SolveError::Cancelled(Cancelled)));
}
