//! Least-squares matching of a patch (Gruen 1985) that may also leave its epipolar plane: shift along and
//! across, slant, shear, brightness gain and offset.

use nalgebra::{Matrix6, Vector6};
use plumbline_model::Eye;

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};
use crate::locate::scene::Scene;
use crate::locate::search::{Candidate, Step, sign};

/// Pixels to each side of the middle of a patch.
const HALF_PX: i32 = 7;
/// Least noise of one pixel's brightness, gray levels.
const LEAST_NOISE: f64 = 1.5;
/// Neighboring samples share pixels: the covariance of independent ones is too small by this.
const SHARED_SAMPLES: f64 = 2.0;
const MOST_ITERATIONS: usize = 15;
const CONVERGED_PX: f64 = 1e-3;
/// What moves farther than this has found something else, px.
const MOST_MOVE_PX: f64 = 3.0;
/// Patches less alike than this are not the same place.
const LEAST_CORRELATION: f64 = 0.9;

/// The same place in the other eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned {
    pub ray: EpipolarRay,
    /// Standard deviation across the plane, px.
    pub across_sigma_px: f64,
}

struct Sample {
    ray: EpipolarRay,
    along_px: f64,
    plane_px: f64,
    value: f64,
    weight: f64,
}

/// Looks for the place at `center` of one eye near a candidate of the other one; `None`: it does not settle,
/// leaves the image or is not alike.
pub(super) fn align(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    from: Eye,
    center: &EpipolarRay,
    near: &Candidate,
) -> Option<Aligned> {
    let other = if from == Eye::Left { Eye::Right } else { Eye::Left };
    let step = Step::at(geometry, from, center);
    let samples = samples(geometry, scene, from, center, &step)?;
    let slant = sign(from) * (1.0 / near.stretch - 1.0);
    let mut p = Vector6::new(0.0, 0.0, slant, near.shear, 1.0, 0.0);
    let place = |p: &Vector6<f64>, s: &Sample, along_px: f64, plane_px: f64| {
        let shift_px = p[0] + p[2] * s.along_px + p[3] * s.plane_px + along_px;
        let disparity_rad = near.disparity_rad + shift_px * step.along_rad;
        EpipolarRay {
            along_rad: s.ray.along_rad + sign(from) * disparity_rad,
            plane_rad: s.ray.plane_rad + (p[1] + plane_px) * step.plane_rad,
        }
    };
    let look = |p: &Vector6<f64>, s: &Sample, along_px: f64, plane_px: f64| {
        scene.along(geometry, other, 0, &place(p, s, along_px, plane_px)).map(f64::from)
    };
    for _ in 0..MOST_ITERATIONS {
        let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
        for s in &samples {
            let value = look(&p, s, 0.0, 0.0)?;
            let along = p[4] * (look(&p, s, 0.5, 0.0)? - look(&p, s, -0.5, 0.0)?);
            let across = p[4] * (look(&p, s, 0.0, 0.5)? - look(&p, s, 0.0, -0.5)?);
            let jacobian = Vector6::new(along, across, along * s.along_px, along * s.plane_px, value, 1.0);
            let residual = s.value - (p[4] * value + p[5]);
            normal += jacobian * jacobian.transpose() * s.weight;
            right += jacobian * residual * s.weight;
        }
        // Slant and shear are weakly seen on little texture.
        normal[(2, 2)] += 1e2;
        normal[(3, 3)] += 1e2;
        let delta = normal.cholesky()?.solve(&right);
        p += delta;
        if p[0].hypot(p[1]) > MOST_MOVE_PX || p[2].abs() > 0.8 || p[3].abs() > 1.5 {
            return None;
        }
        if delta[0].hypot(delta[1]) < CONVERGED_PX {
            let others: Vec<f64> = samples.iter().map(|s| look(&p, s, 0.0, 0.0)).collect::<Option<_>>()?;
            let noise = noise(&p, &samples, &others)?;
            let across_sigma_px = (normal.try_inverse()?[(1, 1)] * noise * SHARED_SAMPLES).sqrt();
            let middle = Sample { ray: *center, along_px: 0.0, plane_px: 0.0, value: 0.0, weight: 0.0 };
            let ray = place(&p, &middle, 0.0, 0.0);
            return across_sigma_px.is_finite().then_some(Aligned { ray, across_sigma_px });
        }
    }
    None
}

fn samples(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    eye: Eye,
    center: &EpipolarRay,
    step: &Step,
) -> Option<Vec<Sample>> {
    let spread = 0.6 * f64::from(HALF_PX);
    let mut samples = vec![];
    for j in -HALF_PX..=HALF_PX {
        for i in -HALF_PX..=HALF_PX {
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

/// Variance of the brightness that is left, gray levels²; `None`: the patches are not alike.
fn noise(p: &Vector6<f64>, samples: &[Sample], others: &[f64]) -> Option<f64> {
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = |f: &dyn Fn(usize) -> f64| {
        samples.iter().enumerate().map(|(i, s)| s.weight * f(i)).sum::<f64>() / total
    };
    let (mean_a, mean_b) = (mean(&|i| samples[i].value), mean(&|i| others[i]));
    let variance_a = mean(&|i| (samples[i].value - mean_a).powi(2));
    let variance_b = mean(&|i| (others[i] - mean_b).powi(2));
    let together = mean(&|i| (samples[i].value - mean_a) * (others[i] - mean_b));
    let correlation = together / (variance_a * variance_b).sqrt();
    let left = mean(&|i| (samples[i].value - (p[4] * others[i] + p[5])).powi(2));
    (correlation >= LEAST_CORRELATION).then(|| left.max(LEAST_NOISE.powi(2)))
}
