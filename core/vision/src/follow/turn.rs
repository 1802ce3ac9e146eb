//! The rotation with which the places of an eye go.

use nalgebra::{Matrix3, Rotation3, Vector3};
use plumbline_model::Camera;

use super::eye::{Followed, LEAST_FOLLOWED};

/// Places are never known better than this, px.
const LEAST_SIGMA_PX: f64 = 0.05;
/// Residuals beyond this are what moved by itself, in standard deviations (Cauchy; Huber and Ronchetti 2009).
const CAUCHY: f64 = 2.385;
const ROUNDS: usize = 30;
const CONVERGED_RAD: f64 = 1e-8;
/// A place that is farther off than this has not gone with the eye, px at least.
const OWN_MOTION_PX: f64 = 0.5;
/// The same in standard deviations of the places that have.
const OWN_MOTION_SIGMAS: f64 = 5.0;
/// At least this share of the places must go with the eye.
const LEAST_SHARE: f64 = 0.5;

/// How an eye has turned about its own center since its picture was remembered.
#[derive(Clone, Debug, PartialEq)]
pub struct EyeTurn {
    /// Rotation vector that takes directions as they were seen to those as they are seen, axes of the eye,
    /// rad: x nods, y pans, z rolls.
    pub rotation_rad: Vector3<f64>,
    /// Covariance, rad².
    pub covariance_rad2: Matrix3<f64>,
    /// Of each followed place: how far from where the turn takes it, px (u, v).
    pub residuals_px: Vec<[f64; 2]>,
    /// Whether each followed place went with the eye.
    pub went_along: Vec<bool>,
}

/// The rotation with which most places go; `None`: they are too few, or no rotation takes half of them.
pub fn fit_eye_turn(camera: &Camera, followed: &[Followed]) -> Option<EyeTurn> {
    let (fx, fy) = camera.model.focal_px();
    let focal_px = 0.5 * (fx + fy);
    let seen: Vec<(Vector3<f64>, Vector3<f64>, f64)> = followed
        .iter()
        .map(|one| {
            let (before, now) = (camera.unproject(one.before).ok()?, camera.unproject(one.now).ok()?);
            Some((before, now, one.sigma_px.hypot(LEAST_SIGMA_PX)))
        })
        .collect::<Option<_>>()?;
    if seen.len() < LEAST_FOLLOWED {
        return None;
    }
    let mut turn = first(&seen);
    let mut scale = 0.0;
    let mut covariance = Matrix3::zeros();
    for round in 0..ROUNDS {
        let rotation = Rotation3::new(turn);
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let off = |(before, now, _): &(Vector3<f64>, Vector3<f64>, f64)| (now - rotation * before) * focal_px;
        scale = median(seen.iter().map(|one| off(one).norm() / one.2)).max(1.0);
        for one in &seen {
            let there = rotation * one.0;
            let residual = off(one);
            let sigma_px = one.2 * scale;
            let weight = 1.0 / (1.0 + (residual.norm() / (CAUCHY * sigma_px)).powi(2)) / sigma_px.powi(2);
            let jacobian = -there.cross_matrix() * focal_px;
            normal += jacobian.transpose() * jacobian * weight;
            right += jacobian.transpose() * residual * weight;
        }
        let factor = normal.cholesky()?;
        let delta = factor.solve(&right);
        turn = (Rotation3::new(delta) * rotation).scaled_axis();
        covariance = factor.inverse();
        if delta.norm() < CONVERGED_RAD && round > 1 {
            break;
        }
    }
    let rotation = Rotation3::new(turn);
    let residual_px = |one: &Followed, before: &Vector3<f64>| {
        let there = camera.project(&(rotation * before)).ok()?;
        Some([one.now.u_px - there.u_px, one.now.v_px - there.v_px])
    };
    let residuals_px: Vec<[f64; 2]> = followed
        .iter()
        .zip(&seen)
        .map(|(one, (before, ..))| residual_px(one, before))
        .collect::<Option<_>>()?;
    let limit_px = |sigma_px: f64| (OWN_MOTION_SIGMAS * scale.min(4.0) * sigma_px).max(OWN_MOTION_PX);
    let went_along: Vec<bool> =
        residuals_px.iter().zip(&seen).map(|([u, v], one)| u.hypot(*v) < limit_px(one.2)).collect();
    let along = went_along.iter().filter(|along| **along).count();
    let enough = along >= LEAST_FOLLOWED / 2 && along as f64 >= LEAST_SHARE * followed.len() as f64;
    enough.then_some(EyeTurn { rotation_rad: turn, covariance_rad2: covariance, residuals_px, went_along })
}

/// A start that a few wrong places do not spoil: the median of each small rotation's part.
fn first(seen: &[(Vector3<f64>, Vector3<f64>, f64)]) -> Vector3<f64> {
    let part = |of: &dyn Fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
        median(seen.iter().map(|(before, now, _)| of(before, now)))
    };
    // Near the axis a turn (x, y) moves a direction by (y, −x).
    let pan = part(&|before, now| now.x.atan2(now.z) - before.x.atan2(before.z));
    let nod = part(&|before, now| now.y.atan2(now.z) - before.y.atan2(before.z));
    Vector3::new(-nod, pan, 0.0)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
