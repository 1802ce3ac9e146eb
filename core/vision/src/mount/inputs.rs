//! Inputs read and checked, every refusal in words.

use nalgebra::{Isometry3, Vector2, Vector3};
use plumbline_model::robot::Rig;
use plumbline_model::{Eye, StereoCameras};

use super::error::MountError;
use super::problem::{Neck, Seen};
use super::types::{HeadView, MountOptions, Target};

/// The joints between base and eyes.
pub(super) fn neck(rig: &Rig) -> Result<Neck, MountError> {
    let refused = |what: String| MountError::Rig { rig: rig.name.clone(), what };
    let link = &rig.description.links()[rig.eyes.link.0].name;
    let chain = rig.chain(link).map_err(|error| refused(error.to_string()))?;
    let place = |joint| {
        chain.joints().iter().position(|known| *known == joint).ok_or_else(|| {
            let name = &rig.description.joint(joint).name;
            refused(format!(
                "the joint {name} does not move the eyes, which sit on {link}: correct [eyes] in the rig file"
            ))
        })
    };
    let pan_tilt = [place(rig.eyes.pan)?, place(rig.eyes.tilt)?];
    if !rig.eyes.head_from_left.isometry.to_homogeneous().iter().all(|c| c.is_finite()) {
        return Err(refused(
            "its nominal mount holds a value that is not a number: correct [eyes] in the rig file".to_owned(),
        ));
    }
    Ok(Neck { chain, pan_tilt })
}

/// Points in the target's own frame, and where that frame is expected in the robot's.
pub(super) fn target_points(target: &Target) -> Result<(Vec<Vector3<f64>>, Isometry3<f64>), MountError> {
    match target {
        Target::UnknownBoard(board) => {
            Ok((board.corners().iter().map(|c| c.coords.coords).collect(), Isometry3::identity()))
        }
        Target::KnownPoints(points) => {
            if let Some(k) = points.iter().position(|p| !p.coords.iter().all(|c| c.is_finite())) {
                let what = format!("known point {} of the target", k + 1);
                return Err(MountError::NotFinite { what, remedy: "give its place in meters".to_owned() });
            }
            // About their middle, so that their orientation does not move them as a whole.
            let middle =
                points.iter().map(|p| p.coords.coords).sum::<Vector3<f64>>() / points.len().max(1) as f64;
            let centered = points.iter().map(|p| p.coords.coords - middle).collect();
            Ok((centered, Isometry3::translation(middle.x, middle.y, middle.z)))
        }
        Target::Fingertip { .. } => Ok((vec![Vector3::zeros()], Isometry3::identity())),
    }
}

pub(super) fn check_options(options: &MountOptions) -> Result<(), MountError> {
    let positive = [
        ("encoder_tick_rad", options.encoder_tick_rad),
        ("tip_sd_m", options.tip_sd_m),
        ("robust_px", options.robust_px),
        ("head_zero_sd_rad", options.head_zero_sd_rad.unwrap_or(1.0)),
    ];
    for (option, value) in positive {
        if !(value > 0.0 && value.is_finite()) {
            return Err(MountError::Option { option, value, expected: "a positive number" });
        }
    }
    let not_negative = [
        ("head_angle_sd_rad", options.head_angle_sd_rad),
        ("known_place_sd_m", options.known_place_sd_m),
        ("known_turn_sd_rad", options.known_turn_sd_rad),
    ];
    for (option, value) in not_negative {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(MountError::Option { option, value, expected: "zero or a positive number" });
        }
    }
    Ok(())
}

pub(super) fn check_cameras(cameras: &StereoCameras) -> Result<(), MountError> {
    let lenses = Eye::BOTH.into_iter().flat_map(|eye| cameras.camera(eye).model.parameters());
    let between = cameras.right_from_left.isometry.to_homogeneous();
    if lenses.chain(between.iter().copied()).all(f64::is_finite) {
        return Ok(());
    }
    let what = "a value of the eyes' calibration".to_owned();
    Err(MountError::NotFinite { what, remedy: "calibrate the eyes again, or load another file".to_owned() })
}

pub(super) fn check_view(rig: &Rig, view: &HeadView, points: usize) -> Result<(), MountError> {
    let name = &view.name;
    let joints = rig.description.movable_count();
    if view.posture.len() != joints {
        let what = format!(
            "view \"{name}\" has {} joint angles, the robot has {joints} joints: take the views with the same rig file",
            view.posture.len()
        );
        return Err(MountError::Rig { rig: rig.name.clone(), what });
    }
    if !view.posture.is_finite() {
        let what = format!("a joint angle of view \"{name}\"");
        return Err(MountError::NotFinite {
            what,
            remedy: "check the servo bus and take the view again".to_owned(),
        });
    }
    for eye in Eye::BOTH {
        let Some(pixels) = view.pixels(eye) else { continue };
        if pixels.len() != points {
            return Err(MountError::WrongCount {
                view: name.clone(),
                eye,
                found: pixels.len(),
                expected: points,
            });
        }
        if !pixels.iter().flatten().all(|p| p.u_px.is_finite() && p.v_px.is_finite()) {
            let what = format!("a pixel in the {eye} image of view \"{name}\"");
            return Err(MountError::NotFinite {
                what,
                remedy: "delete the view and take it again".to_owned(),
            });
        }
    }
    Ok(())
}

pub(super) fn seen_of(view: &HeadView) -> Vec<Seen> {
    let mut seen = vec![];
    for eye in Eye::BOTH {
        for (index, pixel) in view.pixels(eye).into_iter().flatten().enumerate() {
            if let Some(pixel) = pixel {
                let measured_px = Vector2::new(pixel.u_px, pixel.v_px);
                seen.push(Seen { eye, index, measured_px, left_out: false });
            }
        }
    }
    seen
}
