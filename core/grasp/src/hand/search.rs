//! Where the hand is to about a pixel: its silhouette, shifted, against the evidence of the pixels.

use nalgebra::{Isometry3, Matrix2x3, Matrix3, Vector2, Vector3};
use plumbline_model::Camera;
use plumbline_model::frame::{Robot, Tip};
use plumbline_model::{Pose, decompose};

use super::evidence::Evidence;
use super::shape::Part;
use super::solve::{SIGMAS, candidates};

/// Pixels of a silhouette are far from independent: their sum counts this much less.
const TEMPER: f64 = 30.0;
/// Only every so manyth pixel of the silhouette is looked at, along both axes: nearby, and where the
/// hand is looked for farther than [`FAR_PX`].
const EVERY: [usize; 2] = [2, 4];
const FAR_PX: i32 = 10;

/// How an eye's image moves with the hand.
pub(super) struct Moves {
    /// Pixels per meter, robot axes, at the tip.
    pub px_per_m: Matrix2x3<f64>,
}

impl Moves {
    pub fn at(
        camera: &Camera,
        camera_from_robot: &Isometry3<f64>,
        robot_from_tip: &Pose<Robot, Tip>,
    ) -> Option<Self> {
        let in_camera = camera_from_robot * nalgebra::Point3::from(robot_from_tip.translation_m());
        let projection = camera.model.project_with_jacobian(&in_camera.coords).ok()?;
        let turn = camera_from_robot.rotation.to_rotation_matrix();
        Some(Self { px_per_m: projection.by_point * turn.matrix() })
    }

    /// How far the image may move under a prior, px.
    pub fn reach_px(&self, covariance_m2: &Matrix3<f64>) -> f64 {
        let spread = self.px_per_m * covariance_m2 * self.px_per_m.transpose();
        let most = decompose::symmetric_eigenvalues(spread).map_or(0.0, |variances| variances.max());
        (SIGMAS * most.max(0.0).sqrt()).min(MOST_PX)
    }
}

/// The image of the hand is not looked for farther than this, px.
const MOST_PX: f64 = 28.0;

/// Sums of evidence under a silhouette, for whole-pixel shifts.
pub(super) struct Scores {
    reach: i32,
    sums: Vec<f32>,
}

impl Scores {
    pub fn new(evidence: &Evidence, ratios: &[f32], labels: &[Option<Part>], reach_px: f64) -> Self {
        let reach = reach_px.ceil() as i32 + 1;
        let every = EVERY[usize::from(reach > FAR_PX)];
        let (width, height) = (evidence.region.width as i32, evidence.region.height as i32);
        let chosen: Vec<(i32, i32)> = (0..labels.len())
            .filter(|i| labels[*i].is_some())
            .map(|i| ((i % evidence.region.width) as i32, (i / evidence.region.width) as i32))
            .filter(|(u, v)| (*u as usize).is_multiple_of(every) && (*v as usize).is_multiple_of(every))
            .collect();
        let mut sums = Vec::with_capacity(((2 * reach + 1) * (2 * reach + 1)) as usize);
        for dv in -reach..=reach {
            for du in -reach..=reach {
                let mut sum = 0.0;
                for (u, v) in &chosen {
                    let (u, v) = (u + du, v + dv);
                    if u >= 0 && v >= 0 && u < width && v < height {
                        sum += ratios[(v * width + u) as usize];
                    }
                }
                sums.push(sum * (every * every) as f32);
            }
        }
        Self { reach, sums }
    }

    /// Between whole pixels; shifts beyond the reach count as at its end.
    fn at(&self, shift_px: &Vector2<f64>) -> f64 {
        let most = f64::from(self.reach) - 1e-6;
        let place = shift_px.map(|value| value.clamp(-most, most) + f64::from(self.reach));
        let (u, v) = (place.x.floor(), place.y.floor());
        let (p, q) = (place.x - u, place.y - v);
        let side = (2 * self.reach + 1) as usize;
        let sum = |du: usize, dv: usize| f64::from(self.sums[(v as usize + dv) * side + u as usize + du]);
        (1.0 - q) * ((1.0 - p) * sum(0, 0) + p * sum(1, 0)) + q * ((1.0 - p) * sum(0, 1) + p * sum(1, 1))
    }
}

/// The shift (robot axes, m) whose silhouettes fit the evidence and the prior best.
pub(super) fn best_shift(
    eyes: &[(&Moves, Scores)],
    covariance_m2: &Matrix3<f64>,
    step_m: f64,
) -> Option<Vector3<f64>> {
    let information = covariance_m2.try_inverse()?;
    let score = |shift: &Vector3<f64>| {
        let seen: f64 = eyes.iter().map(|(moves, scores)| scores.at(&(moves.px_per_m * shift))).sum();
        seen / TEMPER - 0.5 * shift.dot(&(information * shift))
    };
    let shifts = candidates(covariance_m2, step_m)?;
    let columns = shifts.column_iter().map(nalgebra::Matrix::into_owned);
    columns.map(|shift| (score(&shift), shift)).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, shift)| shift)
}
