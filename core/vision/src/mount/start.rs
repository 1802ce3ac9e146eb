//! Where the solution starts: closed forms that need no guess, and the choice between them and
//! the nominal mount.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Matrix6, Point3, Rotation3, UnitQuaternion, Vector3, Vector6,
};
use plumbline_model::decompose;
use plumbline_model::{Eye, StereoCameras};

use super::problem::Seen;
use super::types::perturbed;
use crate::calibrate::pose_from_rays;

/// Pose of a flat target in the left camera from the pixels of one view, fitted to both eyes;
/// `None` if they do not determine it. The second value is the rms residual per point, px.
pub(super) fn left_from_target(
    cameras: &StereoCameras,
    points: &[Vector3<f64>],
    seen: &[Seen],
) -> Option<(Isometry3<f64>, f64)> {
    let start = Eye::BOTH.iter().find_map(|&eye| {
        let (rays, on_target): (Vec<_>, Vec<_>) = seen
            .iter()
            .filter(|s| s.eye == eye && !s.left_out)
            .filter_map(|s| {
                Some((cameras.camera(eye).unproject(s.measured_px.into()).ok()?, points[s.index]))
            })
            .unzip();
        let eye_from_target = pose_from_rays(&rays, &on_target)?;
        Some(match eye {
            Eye::Left => eye_from_target,
            Eye::Right => cameras.right_from_left.isometry.inverse() * eye_from_target,
        })
    })?;
    Some(refined(cameras, points, seen, start))
}

/// Gauss–Newton on the pose alone, with a robust loss.
fn refined(
    cameras: &StereoCameras,
    points: &[Vector3<f64>],
    seen: &[Seen],
    mut pose: Isometry3<f64>,
) -> (Isometry3<f64>, f64) {
    const ROBUST_PX: f64 = 1.0;
    let mut rms_px = f64::INFINITY;
    for _ in 0..12 {
        let (mut matrix, mut right) = (Matrix6::zeros(), Vector6::zeros());
        let (mut squares, mut count) = (0.0, 0.0);
        for s in seen.iter().filter(|s| !s.left_out) {
            let turned = pose.rotation * points[s.index];
            let in_left = turned + pose.translation.vector;
            let (in_eye, rotation) = match s.eye {
                Eye::Left => (in_left, Matrix3::identity()),
                Eye::Right => {
                    let eye = &cameras.right_from_left.isometry;
                    (
                        eye.rotation * in_left + eye.translation.vector,
                        eye.rotation.to_rotation_matrix().into_inner(),
                    )
                }
            };
            let Ok(lens) = cameras.camera(s.eye).model.project_with_jacobian(&in_eye) else { continue };
            let residual = s.measured_px - lens.pixel_px;
            let by_left = lens.by_point * rotation;
            let mut by_pose = nalgebra::Matrix2x6::zeros();
            by_pose.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_left * -turned.cross_matrix()));
            by_pose.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_left);
            let weight = 1.0 / (1.0 + residual.norm_squared() / (ROBUST_PX * ROBUST_PX));
            matrix += by_pose.transpose() * by_pose * weight;
            right += by_pose.transpose() * residual * weight;
            squares += residual.norm_squared();
            count += 1.0;
        }
        rms_px = (squares / f64::max(count, 1.0)).sqrt();
        let Some(factor) = matrix.cholesky() else { break };
        let step = factor.solve(&right);
        pose = perturbed(&pose, step.as_slice());
        if step.norm() < 1e-10 {
            break;
        }
    }
    (pose, rms_px)
}

/// Mount from head poses and the poses of a still board in the left camera (A X = X B, Park and
/// Martin 1994); `None` if the head's rotations share an axis.
pub(super) fn hand_eye(
    robot_from_head: &[Isometry3<f64>],
    left_from_board: &[Isometry3<f64>],
) -> Option<Isometry3<f64>> {
    let count = robot_from_head.len();
    let mut motions = vec![];
    for i in 0..count {
        for j in 0..i {
            let head = robot_from_head[j].inverse() * robot_from_head[i];
            let eye = left_from_board[j] * left_from_board[i].inverse();
            if head.rotation.angle() > 0.03 {
                motions.push((head, eye));
            }
        }
    }
    let axes = motions.iter().map(|(head, eye)| (eye.rotation.scaled_axis(), head.rotation.scaled_axis()));
    let rotation = aligning_rotation(axes)?;
    let mut system = DMatrix::zeros(3 * motions.len(), 3);
    let mut right = DVector::zeros(3 * motions.len());
    for (i, (head, eye)) in motions.iter().enumerate() {
        let turned = head.rotation.to_rotation_matrix().into_inner() - Matrix3::identity();
        system.fixed_view_mut::<3, 3>(3 * i, 0).copy_from(&turned);
        let difference = rotation * eye.translation.vector - head.translation.vector;
        right.fixed_rows_mut::<3>(3 * i).copy_from(&difference);
    }
    let place = decompose::svd(system, true, true)?.solve(&right, 1e-6).ok()?;
    let place = Vector3::new(place[0], place[1], place[2]);
    place.iter().all(|c| c.is_finite()).then(|| Isometry3::from_parts(place.into(), rotation))
}

/// Mount from points whose places in the left camera and in the head are known (Kabsch 1976).
pub(super) fn absolute(pairs: &[(Point3<f64>, Vector3<f64>)]) -> Option<Isometry3<f64>> {
    let n = pairs.len() as f64;
    if pairs.len() < 3 {
        return None;
    }
    let left = pairs.iter().map(|(p, _)| p.coords).sum::<Vector3<f64>>() / n;
    let head = pairs.iter().map(|(_, p)| *p).sum::<Vector3<f64>>() / n;
    let rotation = aligning_rotation(pairs.iter().map(|(a, b)| (a.coords - left, b - head)))?;
    Some(Isometry3::from_parts((head - rotation * left).into(), rotation))
}

/// The rotation that takes the first vectors nearest to the second ones; `None` if they all lie
/// along one line.
fn aligning_rotation(
    pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>,
) -> Option<UnitQuaternion<f64>> {
    let correlation = pairs.map(|(from, to)| to * from.transpose()).sum::<Matrix3<f64>>();
    let svd = decompose::svd(correlation, true, true)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut strengths: Vec<f64> = svd.singular_values.iter().copied().collect();
    strengths.sort_by(f64::total_cmp);
    let tells = strengths[1] > 1e-4 * strengths[2];
    if !tells {
        return None;
    }
    // The weakest direction takes whatever sign makes a rotation.
    let weakest = svd.singular_values.imin();
    let mut signs = Vector3::repeat(1.0);
    signs[weakest] = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&signs) * v_t;
    Some(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation)))
}

/// A start, and how well views agree with it: the board's place that most of them share, and the
/// sum of bounded disagreements (smaller is better).
pub(super) fn shared_place(
    head_from_left: &Isometry3<f64>,
    robot_from_head: &[Isometry3<f64>],
    left_from_board: &[Isometry3<f64>],
    center: &Point3<f64>,
) -> Option<(Isometry3<f64>, f64)> {
    /// Disagreement (m) beyond which a view counts as not agreeing.
    const AGREE_M: f64 = 0.008;
    let places: Vec<Isometry3<f64>> = robot_from_head
        .iter()
        .zip(left_from_board)
        .map(|(head, board)| head * head_from_left * board)
        .collect();
    places
        .iter()
        .map(|place| {
            let disagreement = places.iter().map(|other| {
                // A tenth of a meter turns angles into lengths.
                let turned = 0.1 * place.rotation.angle_to(&other.rotation);
                let far = (place * center - other * center).norm().hypot(turned) / AGREE_M;
                far * far / (1.0 + far * far)
            });
            (*place, disagreement.sum::<f64>())
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Subsets of views for closed forms that some views may spoil: all, halves in a row, and seeded
/// random fours.
pub(super) fn subsets(count: usize) -> Vec<Vec<usize>> {
    let mut subsets = vec![(0..count).collect::<Vec<_>>()];
    let half = count.div_ceil(2).max(4);
    for start in [0, count / 4, count / 2] {
        subsets.push((start..(start + half).min(count)).collect());
    }
    let mut noise = crate::synthetic::Noise::new(count as u64);
    for _ in 0..40 {
        let mut order: Vec<usize> = (0..count).collect();
        for i in 0..4.min(count) {
            let other = i + (noise.uniform() * (count - i) as f64) as usize;
            order.swap(i, other.min(count - 1));
        }
        order.truncate(4);
        subsets.push(order);
    }
    subsets
}
