//! Which directions of the mount the views can tell, in words.

use nalgebra::{DMatrix, Isometry3, Matrix3, Vector3};
use plumbline_model::decompose;
use plumbline_model::robot::Rig;

use super::error::MountError;
use super::problem::{Layout, Priors, View};
use super::types::Target;

/// Head poses nearer than this count as one, rad.
const SAME_POSE_RAD: f64 = 0.026;
/// Head poses needed with a board at an unknown place.
const FEWEST_POSES: usize = 3;
/// Rotations about the second axis smaller than this (rms) do not count, rad.
const LEAST_SECOND_AXIS_RAD: f64 = 0.02;
/// A direction known worse than this is not seen: m, rad.
const WORST: (f64, f64) = (0.010, 0.0175);
/// A parameter whose standard deviation stays above this share of what was known before is not seen.
const NOTHING_LEARNED: f64 = 0.8;

/// Refuses head poses from which a board at an unknown place cannot give the mount.
pub(super) fn check_head_poses(
    rig: &Rig,
    views: &[View],
    pan_tilt: [usize; 2],
    heads: &[Isometry3<f64>],
) -> Result<(), MountError> {
    let mut kept: Vec<&Isometry3<f64>> = vec![];
    for head in heads {
        if kept.iter().all(|other| other.rotation.angle_to(&head.rotation) > SAME_POSE_RAD) {
            kept.push(head);
        }
    }
    if kept.len() < 2 {
        return Err(MountError::SamePose { distinct: kept.len(), needed: FEWEST_POSES });
    }
    // Axes of all rotations between views, in the head: one axis leaves one large eigenvalue.
    let mut axes = Matrix3::zeros();
    let mut pairs = 0.0;
    for (i, a) in heads.iter().enumerate() {
        for b in &heads[..i] {
            let turned = (a.rotation.inverse() * b.rotation).scaled_axis();
            axes += turned * turned.transpose();
            pairs += 1.0;
        }
    }
    let strengths = decompose::symmetric_eigenvalues(axes).unwrap_or_else(Vector3::zeros);
    let mut strengths: Vec<f64> =
        strengths.iter().map(|v| (v.max(0.0) / f64::max(pairs, 1.0)).sqrt()).collect();
    strengths.sort_by(f64::total_cmp);
    if strengths[1] < LEAST_SECOND_AXIS_RAD {
        let span = pan_tilt.map(|joint| {
            let angles = views.iter().map(|view| view.encoder_rad[joint]);
            let (low, high) = angles.fold((f64::MAX, f64::MIN), |(l, h), a| (l.min(a), h.max(a)));
            high - low
        });
        let [pan, tilt] =
            [rig.eyes.pan, rig.eyes.tilt].map(|joint| format!("\"{}\"", rig.joint_title(joint)));
        let (turned, missing) = if span[0] > span[1] { (pan, tilt) } else { (tilt, pan) };
        return Err(MountError::OneAxis { turned, missing });
    }
    if kept.len() < FEWEST_POSES {
        return Err(MountError::SamePose { distinct: kept.len(), needed: FEWEST_POSES });
    }
    Ok(())
}

/// What the views cannot tell, a sentence each.
pub(super) fn not_seen(
    rig: &Rig,
    target: &Target,
    layout: &Layout,
    priors: &Priors,
    covariance: &DMatrix<f64>,
) -> Vec<String> {
    let mut sentences = vec![];
    let block = |at: usize| -> Matrix3<f64> { covariance.fixed_view::<3, 3>(at, at).into_owned() };
    let more = match target {
        Target::UnknownBoard(_) => "turn the head further to the sides, up and down between views",
        Target::KnownPoints(_) => "look at more points, spread wider, from more head poses",
        Target::Fingertip { .. } => "bring the fingertip to more places, near and far, left and right",
    };
    for (direction, sigma_rad) in weak_directions(&block(0), WORST.1) {
        sentences.push(format!(
            "not seen: the eyes' turn about {}, known to ±{:.1}° only: {more}",
            axis_in_words(&direction),
            sigma_rad.to_degrees()
        ));
    }
    for (direction, sigma_m) in weak_directions(&block(3), WORST.0) {
        sentences.push(format!(
            "not seen: the eyes' place along {}, known to ±{:.0} mm only: {more}",
            axis_in_words(&direction),
            sigma_m * 1e3
        ));
    }
    if let (Some(at), Some(sd)) = (layout.zeros, priors.zero_rad) {
        for (k, joint) in [rig.eyes.pan, rig.eyes.tilt].into_iter().enumerate() {
            let sigma = covariance[(at + k, at + k)].sqrt();
            if sigma > NOTHING_LEARNED * sd {
                let name = rig.joint_title(joint);
                let rival = match (k, target) {
                    (0, Target::UnknownBoard(_)) => {
                        "it turns only the unknown place of the board: look at points whose place is known"
                    }
                    (1, _) => {
                        "it turns the eyes just as the mount does, so the two cannot be told apart, and need not be: together they are right"
                    }
                    _ => more,
                };
                sentences.push(format!(
                    "not seen: the zero of \"{name}\", left at ±{:.2}°: {rival}",
                    sd.to_degrees()
                ));
            }
        }
    }
    sentences
}

/// Directions whose standard deviation is above `worst`, the worst first.
fn weak_directions(covariance: &Matrix3<f64>, worst: f64) -> Vec<(Vector3<f64>, f64)> {
    let Some(eigen) = decompose::symmetric_eigen(*covariance) else { return vec![] };
    let mut weak: Vec<_> = (0..3)
        .map(|i| (eigen.eigenvectors.column(i).into_owned(), eigen.eigenvalues[i].max(0.0).sqrt()))
        .filter(|(_, sigma)| *sigma > worst)
        .collect();
    weak.sort_by(|a, b| b.1.total_cmp(&a.1));
    weak
}

fn axis_in_words(direction: &Vector3<f64>) -> String {
    const AXES: [&str; 3] =
        ["the head's x axis (forward)", "the head's y axis (to its left)", "the head's z axis (up)"];
    let strongest = direction.iamax();
    if direction[strongest].abs() > 0.9 {
        AXES[strongest].to_owned()
    } else {
        format!(
            "the direction ({:.2}, {:.2}, {:.2}) of the head's axes",
            direction.x, direction.y, direction.z
        )
    }
}
