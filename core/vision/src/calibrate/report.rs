//! Figures of a solution: residuals, epipolar error, the board's squares measured back.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::{
    Chessboard, CornerResidual, Eye, FitSummary, LeftCamera, PairFit, Point, Pose, StereoCameras,
};

use super::problem::{Corner, Problem, State};

/// Sum of squares and count, for rms values that combine.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SquareSum {
    sum: f64,
    count: usize,
}

impl SquareSum {
    pub fn add(&mut self, squared: f64) {
        self.sum += squared;
        self.count += 1;
    }
    pub fn merge(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }
    /// `None` of nothing.
    pub fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// Squared residuals per eye over the corners that count.
pub(super) fn square_sums(problem: &Problem, state: &State) -> [SquareSum; 2] {
    let mut sums = [SquareSum::default(); 2];
    for (view, corner) in problem.active() {
        if let Some(r) = state.residual(view, corner) {
            sums[corner.eye.index()].add(r.norm_squared());
        }
    }
    sums
}

/// How each view fits.
pub(super) fn per_pair(problem: &Problem, state: &State, cameras: &StereoCameras) -> Vec<PairFit> {
    problem
        .views
        .iter()
        .enumerate()
        .map(|(v, view)| {
            let mut sums = [SquareSum::default(); 2];
            let mut residuals = Vec::with_capacity(view.corners.len());
            for corner in &view.corners {
                let Some(error) = state.residual(v, corner) else { continue };
                if !corner.left_out {
                    sums[corner.eye.index()].add(error.norm_squared());
                }
                residuals.push(CornerResidual {
                    eye: corner.eye,
                    corner: corner.index,
                    measured: corner.measured_px.into(),
                    error_px: [error.x, error.y],
                    left_out: corner.left_out,
                });
            }
            PairFit {
                name: view.name.clone(),
                left_px: sums[0].rms(),
                right_px: sums[1].rms(),
                epipolar_px: epipolar(cameras, &view.corners).rms(),
                left_from_board: Pose::new(state.left_from_board[v]),
                residuals,
            }
        })
        .collect()
}

/// The corners seen by both eyes and left out in neither, as (left, right).
pub(super) fn matched(corners: &[Corner]) -> impl Iterator<Item = (&Corner, &Corner)> {
    let right =
        |index: usize| corners.iter().find(move |c| c.eye == Eye::Right && c.index == index && !c.left_out);
    corners
        .iter()
        .filter(|c| c.eye == Eye::Left && !c.left_out)
        .filter_map(move |left| Some((left, right(left.index)?)))
}

/// Squared distances (raw pixels) of matched corners from each other's epipolar curve, both eyes.
///
/// The angle between a ray and the plane through the baseline and the partner's ray, times the
/// eye's resolution there (pixels per radian across that plane).
pub(super) fn epipolar(cameras: &StereoCameras, corners: &[Corner]) -> SquareSum {
    let mut sum = SquareSum::default();
    let right_from_left = cameras.right_from_left.isometry;
    let baseline_in_right = right_from_left.translation.vector;
    let baseline_in_left = right_from_left.inverse().translation.vector;
    for (left, right) in matched(corners) {
        let rays = (
            cameras.left.unproject(left.measured_px.into()),
            cameras.right.unproject(right.measured_px.into()),
        );
        let (Ok(ray_left), Ok(ray_right)) = rays else { continue };
        let partner_in_right = right_from_left.rotation * ray_left;
        let partner_in_left = right_from_left.rotation.inverse() * ray_right;
        let distances = [
            distance_from_plane_px(cameras, Eye::Left, &ray_left, &baseline_in_left.cross(&partner_in_left)),
            distance_from_plane_px(
                cameras,
                Eye::Right,
                &ray_right,
                &baseline_in_right.cross(&partner_in_right),
            ),
        ];
        for distance in distances.into_iter().flatten() {
            sum.add(distance * distance);
        }
    }
    sum
}

/// Distance, in raw pixels, of a ray from a plane through the eye with this normal.
fn distance_from_plane_px(
    cameras: &StereoCameras,
    eye: Eye,
    ray: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Option<f64> {
    let normal = normal.try_normalize(1e-12)?;
    let jacobian = cameras.camera(eye).model.project_with_jacobian(ray).ok()?;
    // First order: the curve's gradient in the image is the normal carried by the inverse map.
    let on_plane = ray - normal * ray.dot(&normal);
    let along = normal.cross(&on_plane).try_normalize(1e-12)?;
    let tangent_px = jacobian.by_point * along;
    let offset_px = jacobian.by_point * (ray - on_plane);
    let tangent = tangent_px.try_normalize(1e-12)?;
    Some((offset_px - tangent * tangent.dot(&offset_px)).norm())
}

/// Mean and standard deviation of the board's squares, triangulated corner by corner, meters.
pub(super) fn squares_m(
    cameras: &StereoCameras,
    board: &Chessboard,
    views: &[Vec<Corner>],
) -> Option<(f64, f64)> {
    let columns = board.inner_columns as usize;
    let mut sides = Vec::new();
    for corners in views {
        let mut points: Vec<Option<Point<LeftCamera>>> = vec![None; board.corner_count()];
        for (left, right) in matched(corners) {
            points[left.index] = cameras.triangulate(left.measured_px.into(), right.measured_px.into());
        }
        for (k, point) in points.iter().enumerate() {
            let Some(point) = point else { continue };
            let mut side_to = |other: usize| {
                if let Some(Some(other)) = points.get(other) {
                    sides.push(point.distance_m(other));
                }
            };
            if (k + 1) % columns != 0 {
                side_to(k + 1);
            }
            side_to(k + columns);
        }
    }
    let n = sides.len() as f64;
    (sides.len() > 1).then(|| {
        let mean = sides.iter().sum::<f64>() / n;
        let variance = sides.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, variance.sqrt())
    })
}

/// Summary of a solved problem; `None` if an eye has no corner.
pub(super) fn summary(
    problem: &Problem,
    state: &State,
    cameras: &StereoCameras,
    board: &Chessboard,
    cross_validated_px: Option<f64>,
) -> Option<FitSummary> {
    let [left, right] = square_sums(problem, state);
    let mut both = left;
    both.merge(right);
    let mut epipolar_sum = SquareSum::default();
    for view in &problem.views {
        epipolar_sum.merge(epipolar(cameras, &view.corners));
    }
    let views: Vec<Vec<Corner>> = problem.views.iter().map(|v| v.corners.clone()).collect();
    let (square_mean_m, square_sd_m) = squares_m(cameras, board, &views)?;
    Some(FitSummary {
        rms_left_px: left.rms()?,
        rms_right_px: right.rms()?,
        rms_stereo_px: both.rms()?,
        cross_validated_px,
        epipolar_px: epipolar_sum.rms()?,
        square_mean_m,
        square_sd_m,
    })
}

/// Whether board poses differ enough to tell the lens's parameters apart: how many are more than
/// 3° or a tenth of their distance away from all before them.
pub(super) fn distinct_poses(poses: &[Isometry3<f64>]) -> usize {
    let mut kept: Vec<&Isometry3<f64>> = Vec::new();
    for pose in poses {
        let differs = |other: &&Isometry3<f64>| {
            pose.rotation.angle_to(&other.rotation) > 3f64.to_radians()
                || (pose.translation.vector - other.translation.vector).norm()
                    > 0.1 * pose.translation.vector.norm()
        };
        if kept.iter().all(differs) {
            kept.push(pose);
        }
    }
    kept.len()
}
