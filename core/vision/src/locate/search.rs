//! Where along the epipolar curve of the other eye a place might be: normalized cross-correlation
//! of patches of three sizes, so that repeated texture is told apart by what surrounds it.

use plumbline_model::Eye;

use super::NotLocated;
use super::epipolar::{EpipolarGeometry, EpipolarRay};
use super::scene::{LEVELS, Scene};

/// Samples from the center of a patch to its rim, each way.
const HALF: i32 = 5;
const SIDE: usize = (2 * HALF + 1) as usize;
/// Steps of the search per raw pixel.
const STEPS_PER_PX: usize = 2;
/// Nearest place that is looked for, in baselines from the baseline: closer than that the two eyes
/// hardly see the same side of anything.
const NEAREST_BASELINES: f64 = 1.3;
/// The search starts this many pixels beyond infinity, so that a far place is still a peak.
const BEYOND_INFINITY_PX: f64 = 2.0;
/// Weakest correlation that counts as a candidate.
const LEAST_CORRELATION: f32 = 0.5;
/// Most candidates handed on.
const MOST_CANDIDATES: usize = 6;

/// A place along the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Along angle in the left eye minus along angle in the right, rad.
    pub disparity_rad: f64,
    /// Mean correlation over the patch sizes, −1..1.
    pub correlation: f32,
    /// Size of the thing along the curve in this eye, relative to the other: slanted surfaces look
    /// longer to one eye than to the other.
    pub stretch: f64,
    /// Change of disparity across epipolar planes, pixels per pixel: a table seen from above is
    /// nearer in its lower part.
    pub shear: f64,
}

/// Stretches tried. Between them the correlation stays high enough to see the peak.
const STRETCHES: [f64; 3] = [1.0, 0.7, 1.4];
/// Shears tried.
const SHEARS: [f64; 3] = [0.0, 0.4, -0.4];

/// What a slanted surface does to a patch.
#[derive(Clone, Copy, Debug)]
struct Slant {
    stretch: f64,
    shear: f64,
}

/// Size of a step of one raw pixel, as an angle; and across planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub along_rad: f64,
    pub plane_rad: f64,
}

impl Step {
    pub fn at(geometry: &EpipolarGeometry, eye: Eye, ray: &EpipolarRay) -> Self {
        let (fx, fy) = geometry.cameras.camera(eye).model.focal_px();
        let along_rad = 1.0 / (0.5 * (fx + fy));
        Self { along_rad, plane_rad: along_rad / ray.along_rad.cos().max(0.1) }
    }
}

/// Sign of a disparity seen from this eye: the other eye's along angle is `along + sign·disparity`.
pub(crate) fn sign(from: Eye) -> f64 {
    match from {
        Eye::Left => -1.0,
        Eye::Right => 1.0,
    }
}

/// Candidates for `center` (a ray of the eye `from`) in the other eye, best first.
pub(crate) fn candidates(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    from: Eye,
    center: &EpipolarRay,
) -> Result<Vec<Candidate>, NotLocated> {
    let step = Step::at(geometry, from, center);
    let fine_rad = step.along_rad / STEPS_PER_PX as f64;
    let reach_rad = geometry.disparity_rad(center, NEAREST_BASELINES * geometry.baseline_m).abs()
        + BEYOND_INFINITY_PX * step.along_rad;
    let count = (reach_rad / fine_rad).ceil() as usize + 1;
    let first_rad = -BEYOND_INFINITY_PX * step.along_rad;
    let disparity = |k: usize| first_rad + k as f64 * fine_rad;

    let strips: Vec<Strip> = (0..LEVELS)
        .map(|level| Strip::new(geometry, scene, from, level, center, &step, first_rad, count))
        .collect();
    let mut score: Vec<Option<(f32, Slant)>> = vec![None; count];
    for stretch in STRETCHES {
        let patches: [Option<Patch>; LEVELS] =
            std::array::from_fn(|level| Patch::new(geometry, scene, from, level, center, &step, stretch));
        if patches[0].is_none() {
            if stretch == 1.0 {
                return Err(NotLocated::AtTheRim);
            }
            continue;
        }
        for shear in SHEARS {
            for (k, best) in score.iter_mut().enumerate() {
                let correlation = mean_correlation(&patches, &strips, k, shear);
                if let Some(correlation) = correlation.filter(|c| best.is_none_or(|(b, _)| *c > b)) {
                    *best = Some((correlation, Slant { stretch, shear }));
                }
            }
        }
    }
    if score.iter().all(Option::is_none) {
        return Err(NotLocated::OtherEyeCannotSee);
    }
    let mut peaks: Vec<Candidate> = (0..count)
        .filter_map(|k| {
            let (here, Slant { stretch, shear }) = score[k]?;
            let lower = |other: Option<&Option<(f32, Slant)>>| {
                other.copied().flatten().is_none_or(|(o, _)| o <= here)
            };
            let is_peak = lower(k.checked_sub(1).and_then(|i| score.get(i))) && lower(score.get(k + 1));
            (is_peak && here > LEAST_CORRELATION).then(|| Candidate {
                disparity_rad: disparity(k),
                correlation: here,
                stretch,
                shear,
            })
        })
        .collect();
    peaks.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
    peaks.truncate(MOST_CANDIDATES);
    if peaks.is_empty() { Err(NotLocated::NothingAlike) } else { Ok(peaks) }
}

/// Mean over the patch sizes; `None` unless the finest patch and a larger one can be compared.
fn mean_correlation(
    patches: &[Option<Patch>; LEVELS],
    strips: &[Strip],
    k: usize,
    shear: f64,
) -> Option<f32> {
    let finest = strips[0].correlate(patches[0].as_ref()?, k, shear)?;
    let larger = patches.iter().zip(strips).skip(1);
    let larger: Vec<f32> =
        larger.filter_map(|(patch, strip)| strip.correlate(patch.as_ref()?, k, shear)).collect();
    (!larger.is_empty()).then(|| (finest + larger.iter().sum::<f32>()) / (1 + larger.len()) as f32)
}

/// Brightness around the place itself, mean removed, unit length.
struct Patch {
    values: [[f32; SIDE]; SIDE],
}

impl Patch {
    fn new(
        geometry: &EpipolarGeometry,
        scene: &Scene,
        eye: Eye,
        level: usize,
        center: &EpipolarRay,
        step: &Step,
        stretch: f64,
    ) -> Option<Self> {
        let stride = f64::from(1i32 << level);
        let mut values = [[0.0f32; SIDE]; SIDE];
        for (j, row) in values.iter_mut().enumerate() {
            for (i, value) in row.iter_mut().enumerate() {
                let ray = EpipolarRay {
                    plane_rad: center.plane_rad + f64::from(j as i32 - HALF) * stride * step.plane_rad,
                    along_rad: center.along_rad
                        + f64::from(i as i32 - HALF) * stride * stretch * step.along_rad,
                };
                *value = scene.along(geometry, eye, level, &ray)?;
            }
        }
        let mean = values.iter().flatten().sum::<f32>() / (SIDE * SIDE) as f32;
        let norm = values.iter().flatten().map(|v| (v - mean).powi(2)).sum::<f32>().sqrt();
        // Flat at this size: says nothing about where.
        if norm < SIDE as f32 {
            return None;
        }
        for value in values.iter_mut().flatten() {
            *value = (*value - mean) / norm;
        }
        Some(Self { values })
    }
}

/// Brightness of the other eye along the epipolar curve and beside it.
struct Strip {
    /// Rows across planes; columns along, `STEPS_PER_PX` per raw pixel.
    rows: Vec<Vec<Option<f32>>>,
    /// Columns between two samples of a patch.
    stride: usize,
    /// Direction of growing disparity in columns.
    first_column: i64,
    direction: i64,
}

impl Strip {
    #[expect(clippy::too_many_arguments, reason = "one call; a struct would only rename them")]
    fn new(
        geometry: &EpipolarGeometry,
        scene: &Scene,
        from: Eye,
        level: usize,
        center: &EpipolarRay,
        step: &Step,
        first_rad: f64,
        count: usize,
    ) -> Self {
        let other = if from == Eye::Left { Eye::Right } else { Eye::Left };
        let stride = STEPS_PER_PX << level;
        let margin = HALF as usize * stride;
        let fine_rad = step.along_rad / STEPS_PER_PX as f64;
        let direction = sign(from) as i64;
        // Column c is at along = start + c·fine; disparity k sits at column first + direction·k.
        let columns = count + 2 * margin;
        let first_column = if direction > 0 { margin } else { margin + count - 1 } as i64;
        let start_rad = center.along_rad + sign(from) * first_rad - first_column as f64 * fine_rad;
        let rows = (-HALF..=HALF)
            .map(|j| {
                let plane_rad = center.plane_rad + f64::from(j << level) * step.plane_rad;
                (0..columns)
                    .map(|c| {
                        let ray = EpipolarRay { plane_rad, along_rad: start_rad + c as f64 * fine_rad };
                        scene.along(geometry, other, level, &ray)
                    })
                    .collect()
            })
            .collect();
        Self { rows, stride, first_column, direction }
    }

    /// Correlation with the patch at step `k`; `None` where the other eye does not see all of it.
    fn correlate(&self, patch: &Patch, k: usize, shear: f64) -> Option<f32> {
        let middle = self.first_column + self.direction * k as i64;
        let leftmost = middle - i64::from(HALF) * self.stride as i64;
        let (mut sum, mut squares, mut product) = (0.0f32, 0.0f32, 0.0f32);
        for (j, (row, values)) in (-HALF..=HALF).zip(self.rows.iter().zip(&patch.values)) {
            let shift = (f64::from(j) * shear * self.stride as f64).round() as i64 * self.direction;
            let first = usize::try_from(leftmost + shift).ok()?;
            for (i, value) in values.iter().enumerate() {
                let other = (*row.get(first + i * self.stride)?)?;
                sum += other;
                squares += other * other;
                product += other * value;
            }
        }
        let n = (SIDE * SIDE) as f32;
        let variance = squares - sum * sum / n;
        // The patch has zero mean and unit length already.
        (variance > n).then(|| product / variance.sqrt())
    }
}
