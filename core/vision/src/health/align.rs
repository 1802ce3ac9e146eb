//! Least-squares matching of a patch (Gruen 1985) that may also leave its epipolar plane: shift along and
//! across, slant, shear, brightness gain and offset.

use nalgebra::{Matrix6, Vector6};
use plumbline_model::Eye;

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};
use crate::locate::refine::{Likeness, SHARED_SAMPLES, Sample, likeness, samples};
use crate::locate::scene::Scene;
use crate::locate::search::{Candidate, Step, sign};

/// Pixels to each side of the middle of a patch.
const HALF_PX: i32 = 7;
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
    let samples = samples(geometry, scene, from, center, &step, HALF_PX)?;
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
            let Likeness { correlation, noise } = likeness(&samples, &others, p[4], p[5]);
            let across_sigma_px = (normal.try_inverse()?[(1, 1)] * noise * SHARED_SAMPLES).sqrt();
            let middle = Sample { ray: *center, along_px: 0.0, plane_px: 0.0, value: 0.0, weight: 0.0 };
            let ray = place(&p, &middle, 0.0, 0.0);
            let is_same = correlation >= LEAST_CORRELATION && across_sigma_px.is_finite();
            return is_same.then_some(Aligned { ray, across_sigma_px });
        }
    }
    None
}
