//! Least-squares matching of a patch (Gruen 1985): shift along the epipolar curve, its change
//! across the patch (a slanted surface), brightness gain and offset. The shift comes out to a few
//! hundredths of a pixel, with its standard deviation.

use nalgebra::{Matrix5, Vector5};
use plumbline_model::Eye;

use super::epipolar::{EpipolarGeometry, EpipolarRay};
use super::scene::Scene;
use super::search::{Step, sign};

/// A refined place along the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refined {
    pub disparity_rad: f64,
    /// Standard deviation from the residual brightness.
    pub sigma_rad: f64,
    /// Correlation of the two patches after refinement, −1..1.
    pub correlation: f64,
    /// Size along the curve in this eye relative to the other.
    pub stretch: f64,
    /// Change of disparity across epipolar planes, pixels per pixel.
    pub shear: f64,
}

/// Least noise of one pixel's brightness, gray levels: quantization and compression.
const LEAST_NOISE: f64 = 1.5;
/// Neighboring samples share pixels through interpolation in both images; the covariance of
/// independent samples is too small by about the number of samples that share one.
pub(crate) const SHARED_SAMPLES: f64 = 2.0;
const MOST_ITERATIONS: usize = 15;
const CONVERGED_PX: f64 = 1e-3;
/// Refinement that moves further than this has found something else.
const MOST_MOVE_PX: f64 = 2.5;

/// Where refinement starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub disparity_rad: f64,
    /// See [`super::search::Candidate::stretch`].
    pub stretch: f64,
    /// See [`super::search::Candidate::shear`].
    pub shear: f64,
}

/// Refines a candidate with patches of `half_px` to each side; `None` if it does not settle or the
/// patch leaves the image.
pub(super) fn refine(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    from: Eye,
    center: &EpipolarRay,
    start: Start,
    half_px: i32,
) -> Option<Refined> {
    let other = if from == Eye::Left { Eye::Right } else { Eye::Left };
    let step = Step::at(geometry, from, center);
    let samples = samples(geometry, scene, from, center, &step, half_px)?;
    // Shift in pixels, its change per pixel along and across, gain, offset.
    let Start { disparity_rad: start_rad, stretch, shear } = start;
    let slant = sign(from) * (1.0 / stretch - 1.0);
    let mut p = Vector5::new(0.0, slant, shear, 1.0, 0.0);
    let shift = |p: &Vector5<f64>, s: &Sample| p[0] + p[1] * s.along_px + p[2] * s.plane_px;
    let look = |p: &Vector5<f64>, s: &Sample, extra_px: f64| {
        let disparity = start_rad + (shift(p, s) + extra_px) * step.along_rad;
        let ray = EpipolarRay { along_rad: s.ray.along_rad + sign(from) * disparity, ..s.ray };
        scene.along(geometry, other, 0, &ray).map(f64::from)
    };
    for _ in 0..MOST_ITERATIONS {
        let (mut normal, mut right) = (Matrix5::zeros(), Vector5::zeros());
        for s in &samples {
            let (value, before, after) = (look(&p, s, 0.0)?, look(&p, s, -0.5)?, look(&p, s, 0.5)?);
            let slope = p[3] * (after - before);
            let jacobian = Vector5::new(slope, slope * s.along_px, slope * s.plane_px, value, 1.0);
            let residual = s.value - (p[3] * value + p[4]);
            normal += jacobian * jacobian.transpose() * s.weight;
            right += jacobian * residual * s.weight;
        }
        // Slant and gain are weakly seen on little texture; a hint of regularity keeps them sane.
        normal[(1, 1)] += 1e2;
        normal[(2, 2)] += 1e2;
        let delta = normal.cholesky()?.solve(&right);
        p += delta;
        if p[0].abs() > MOST_MOVE_PX || p[1].abs() > 0.8 || p[2].abs() > 1.5 {
            return None;
        }
        if delta[0].abs() < CONVERGED_PX {
            return judge(&p, &samples, &normal, look).map(|(sigma_px, correlation)| Refined {
                disparity_rad: start_rad + p[0] * step.along_rad,
                sigma_rad: sigma_px * step.along_rad,
                correlation,
                stretch: 1.0 / (1.0 + sign(from) * p[1]),
                shear: p[2],
            });
        }
    }
    None
}

/// One place of the patch.
pub(crate) struct Sample {
    pub ray: EpipolarRay,
    /// From the middle of the patch along the curve, px.
    pub along_px: f64,
    /// Across it.
    pub plane_px: f64,
    /// Brightness, gray levels.
    pub value: f64,
    pub weight: f64,
}

/// The patch about a ray; `None` where it leaves the image.
pub(crate) fn samples(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    eye: Eye,
    center: &EpipolarRay,
    step: &Step,
    half_px: i32,
) -> Option<Vec<Sample>> {
    let mut samples = Vec::new();
    let spread = 0.6 * f64::from(half_px);
    for j in -half_px..=half_px {
        for i in -half_px..=half_px {
            let (along_px, plane_px) = (f64::from(i), f64::from(j));
            let ray = EpipolarRay {
                plane_rad: center.plane_rad + plane_px * step.plane_rad,
                along_rad: center.along_rad + along_px * step.along_rad,
            };
            let value = f64::from(scene.along(geometry, eye, 0, &ray)?);
            let weight = (-0.5 * (along_px.powi(2) + plane_px.powi(2)) / spread.powi(2)).exp();
            samples.push(Sample { ray, along_px, plane_px, value, weight });
        }
    }
    Some(samples)
}

/// How alike two patches are after they were laid onto each other.
pub(crate) struct Likeness {
    /// −1..1; not finite for patches without texture.
    pub correlation: f64,
    /// Variance of the brightness that is left, gray levels²; never less than what an image has.
    pub noise: f64,
}

/// Compares samples with the brightness of the other patch, by its gain and offset.
pub(crate) fn likeness(samples: &[Sample], others: &[f64], gain: f64, offset: f64) -> Likeness {
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = |f: &dyn Fn(usize) -> f64| {
        samples.iter().enumerate().map(|(i, s)| s.weight * f(i)).sum::<f64>() / total
    };
    let (mean_a, mean_b) = (mean(&|i| samples[i].value), mean(&|i| others[i]));
    let variance_a = mean(&|i| (samples[i].value - mean_a).powi(2));
    let variance_b = mean(&|i| (others[i] - mean_b).powi(2));
    let covariance = mean(&|i| (samples[i].value - mean_a) * (others[i] - mean_b));
    let residual = mean(&|i| (samples[i].value - (gain * others[i] + offset)).powi(2));
    let correlation = covariance / (variance_a * variance_b).sqrt();
    Likeness { correlation, noise: residual.max(LEAST_NOISE.powi(2)) }
}

/// Standard deviation of the shift (px) and the correlation of the aligned patches.
fn judge(
    p: &Vector5<f64>,
    samples: &[Sample],
    normal: &Matrix5<f64>,
    look: impl Fn(&Vector5<f64>, &Sample, f64) -> Option<f64>,
) -> Option<(f64, f64)> {
    let others: Vec<f64> = samples.iter().map(|s| look(p, s, 0.0)).collect::<Option<_>>()?;
    let Likeness { correlation, noise } = likeness(samples, &others, p[3], p[4]);
    // Weighted least squares: cov = N⁻¹ (Σ w² J Jᵀ σ²) N⁻¹ ≤ N⁻¹ σ² for weights up to 1.
    let variance_px = normal.try_inverse()?[(0, 0)] * noise * SHARED_SAMPLES;
    (variance_px > 0.0 && correlation.is_finite()).then(|| (variance_px.sqrt(), correlation))
}
