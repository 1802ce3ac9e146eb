//! Where the solution starts, without a guess by anybody: board poses straight from viewing rays,
//! and the focal length as the best of a ladder.

use nalgebra::{Isometry3, Matrix3, SMatrix, Vector3};
use plumbline_model::decompose;
use plumbline_model::{CameraModel, Fisheye, ModelKind, Pinhole};

use super::optimizer::Optimizer;
use super::problem::{Corner, Free, Problem, State, View};

/// Pose of a plane (z = 0) from rays to points on it, by the direct linear transform on rays:
/// ray × (H · (X, Y, 1)) = 0 with H = [r1 r2 t]. Works beyond 90° off the axis, where image
/// coordinates do not exist. Returns camera_from_board; `None` if the rays do not determine it.
pub(crate) fn pose_from_rays(rays: &[Vector3<f64>], points: &[Vector3<f64>]) -> Option<Isometry3<f64>> {
    if rays.len() < 4 {
        return None;
    }
    // Condition the plane's coordinates: centered, of unit size.
    let center = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let size = (points.iter().map(|p| (p - center).norm_squared()).sum::<f64>() / points.len() as f64).sqrt();
    if !(size > 0.0) {
        return None;
    }
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (ray, point) in rays.iter().zip(points) {
        let p = Vector3::new((point.x - center.x) / size, (point.y - center.y) / size, 1.0);
        let cross = ray.cross_matrix();
        // Columns of H stacked: ray × (h1 X + h2 Y + h3).
        let mut row = SMatrix::<f64, 3, 9>::zeros();
        for k in 0..3 {
            row.fixed_view_mut::<3, 3>(0, 3 * k).copy_from(&(cross * p[k]));
        }
        normal += row.transpose() * row;
    }
    let eigen = decompose::symmetric_eigen(normal)?;
    let smallest = eigen.eigenvalues.imin();
    let h = eigen.eigenvectors.column(smallest);
    let column = |k: usize| Vector3::new(h[3 * k], h[3 * k + 1], h[3 * k + 2]);
    let scale = 0.5 * (column(0).norm() + column(1).norm());
    if !(scale > 1e-12) {
        return None;
    }
    let mut h = Matrix3::from_columns(&[column(0) / scale, column(1) / scale, column(2) / scale]);
    // Of the two signs the one that puts the board in front of its rays.
    if rays.iter().zip(points).map(|(ray, p)| ray.dot(&(h * plane(p, center, size)))).sum::<f64>() < 0.0 {
        h = -h;
    }
    let rotation = nearest_rotation(&h.column(0).into_owned(), &h.column(1).into_owned())?;
    let to_center = Isometry3::from_parts((h.column(2) * size).into(), rotation);
    Some(to_center * Isometry3::translation(-center.x, -center.y, -center.z))
}

fn plane(point: &Vector3<f64>, center: Vector3<f64>, size: f64) -> Vector3<f64> {
    Vector3::new((point.x - center.x) / size, (point.y - center.y) / size, 1.0)
}

/// Rotation whose first two columns are nearest to the given ones.
fn nearest_rotation(x: &Vector3<f64>, y: &Vector3<f64>) -> Option<nalgebra::UnitQuaternion<f64>> {
    let svd = decompose::svd(Matrix3::from_columns(&[*x, *y, x.cross(y)]), true, true)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(rotation);
    rotation.matrix().iter().all(|c| c.is_finite()).then(|| rotation.into())
}

/// Pose of one eye's corners with a given lens; `None` if too few corners have a ray.
pub(super) fn pose_of_view(model: &CameraModel, corners: &[Corner]) -> Option<Isometry3<f64>> {
    let (rays, points): (Vec<_>, Vec<_>) = corners
        .iter()
        .filter(|c| !c.left_out)
        .filter_map(|c| Some((model.unproject(c.measured_px.into()).ok()?, c.point_in_board)))
        .unzip();
    pose_from_rays(&rays, &points)
}

/// A lens with this focal length and nothing else.
fn plain_lens(kind: ModelKind, f_px: f64, size_px: (u32, u32)) -> CameraModel {
    let (cx_px, cy_px) = (0.5 * (f64::from(size_px.0) - 1.0), 0.5 * (f64::from(size_px.1) - 1.0));
    match kind {
        ModelKind::Fisheye => CameraModel::Fisheye(Fisheye {
            fx_px: f_px,
            fy_px: f_px,
            cx_px,
            cy_px,
            skew_px: 0.0,
            k: [0.0; 4],
        }),
        ModelKind::Pinhole => CameraModel::Pinhole(Pinhole::ideal(f_px, cx_px, cy_px)),
    }
}

/// One eye alone: lens, and per view the pose (`None` where it could not be had).
pub(super) struct MonoStart {
    pub model: CameraModel,
    pub poses: Vec<Option<Isometry3<f64>>>,
}

/// Focal lengths tried, as fractions of the image width: from 250° across to 28° across.
const FOCAL_LADDER: [f64; 10] = [0.18, 0.23, 0.28, 0.35, 0.45, 0.6, 0.8, 1.1, 1.5, 2.0];
/// Views used to choose among them; more would only cost time.
const LADDER_VIEWS: usize = 12;

/// Calibrates one eye by itself. `views` hold corners of one eye only.
pub(super) fn calibrate_one_eye(
    kind: ModelKind,
    size_px: (u32, u32),
    views: &[Vec<Corner>],
) -> Option<MonoStart> {
    let stride = views.len().div_ceil(LADDER_VIEWS).max(1);
    let sample: Vec<&Vec<Corner>> = views.iter().step_by(stride).collect();
    let mut best: Option<(f64, CameraModel)> = None;
    for fraction in FOCAL_LADDER {
        let start = plain_lens(kind, fraction * f64::from(size_px.0), size_px);
        // A few steps of the full problem: distortion and focal length trade against each other,
        // so poses alone would favor the wrong rung.
        if let Some((cost, model)) = fit_alone(kind, start, &sample, 8)
            && best.as_ref().is_none_or(|(least, _)| cost < *least)
        {
            best = Some((cost, model));
        }
    }
    let all: Vec<&Vec<Corner>> = views.iter().collect();
    let (_, model) = fit_alone(kind, best?.1, &all, 50)?;
    Some(MonoStart { model, poses: views.iter().map(|v| pose_of_view(&model, v)).collect() })
}

/// Robust fit of one lens to the views whose pose can be had: mean cost per corner and lens.
fn fit_alone(
    kind: ModelKind,
    start: CameraModel,
    views: &[&Vec<Corner>],
    steps: usize,
) -> Option<(f64, CameraModel)> {
    let mut usable = Vec::new();
    let mut poses = Vec::new();
    let mut lost = 0.0;
    for corners in views {
        match pose_of_view(&start, corners) {
            Some(pose) => {
                poses.push(pose);
                // The problem knows a left and a right eye; a single eye plays the left one.
                let corners =
                    corners.iter().map(|c| Corner { eye: plumbline_model::Eye::Left, ..*c }).collect();
                usable.push(View { name: String::new(), corners });
            }
            None => lost += 1.0,
        }
    }
    if usable.is_empty() {
        return None;
    }
    let problem = Problem {
        kind,
        views: usable,
        free: Free { intrinsics: [true, false], right_from_left: false },
        robust_px: Some(2.0),
    };
    let state =
        State { models: [start, start], right_from_left: Isometry3::identity(), left_from_board: poses };
    let mut optimizer = Optimizer::new(&problem, state);
    optimizer.run(steps);
    let model = optimizer.state.models[0];
    let sane = model.parameters().iter().all(|p| p.is_finite())
        && model.focal_px().0 > 0.0
        && model.focal_px().1 > 0.0;
    let corners = problem.active().count() as f64;
    // A rung that loses views must not win by having fewer corners to explain.
    sane.then(|| (optimizer.cost / corners * (1.0 + lost), model))
}
