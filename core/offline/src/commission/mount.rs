//! Step mount: how the eyes sit in the head, from the views of the lying board. Where it lies is not
//! known to anybody.

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_model::{Eye, JobContext, StereoCameras};
use plumbline_twin::default_board;
use plumbline_vision::mount::{HeadView, MountOptions, Target, calibrate_mount};

use super::error::CommissionError;
use super::eyes::table_views;
use super::lab::Lab;
use super::steps::Step;

/// Solves and puts the mount in use.
pub(super) fn run(lab: &Lab, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step =
        Step::new("mount", "place of the lying board from head poses that were not solved with, rms");
    let calibration = lab.calibration()?;
    let views = table_views(lab)?;
    let target = Target::UnknownBoard(default_board());
    let options = MountOptions::default();
    let (used, back): (Vec<_>, Vec<_>) = views.iter().cloned().enumerate().partition(|(i, _)| i % 4 != 1);
    let plain =
        |views: Vec<(usize, HeadView)>| -> Vec<HeadView> { views.into_iter().map(|(_, v)| v).collect() };
    let (used, back) = (plain(used), plain(back));
    let cameras = &calibration.cameras;
    let with_eyes = Rig {
        eyes: plumbline_model::robot::EyeMount { cameras: *cameras, ..lab.rig.eyes.clone() },
        ..(*lab.rig).clone()
    };
    step.before_mm = wander_mm(&with_eyes, cameras, &used, &back);
    match calibrate_mount(&lab.rig, &calibration, &used, &target, &options, context) {
        Ok(tried) => step.after_mm = wander_mm(&tried.applied_to(&lab.rig), cameras, &used, &back),
        Err(error) => step.notes.push(format!("Nothing was held back: {error}.")),
    }
    let mut mount = calibrate_mount(&lab.rig, &calibration, &views, &target, &options, context)?;
    // The views are those that the eyes were calibrated with.
    mount.evidence.minutes_since_on =
        calibration.evidence.as_ref().and_then(|evidence| evidence.minutes_since_on);
    step.notes.push(format!("{} views, {:.3} px.", mount.per_view.len(), mount.rms_px));
    step.notes.extend(mount.not_seen.iter().chain(&mount.remarks).cloned());
    lab.accept_mount(&mount)?;
    Ok(step)
}

/// How far the board's corners seem to lie, from head poses held back, from where they seem to lie on
/// the mean of the others; rms, mm.
pub(super) fn wander_mm(
    rig: &Rig,
    cameras: &StereoCameras,
    used: &[HeadView],
    back: &[HeadView],
) -> Option<f64> {
    let corners = |view: &HeadView| -> Vec<Option<Vector3<f64>>> {
        let (Some(left), Some(right)) = (view.pixels(Eye::Left), view.pixels(Eye::Right)) else {
            return vec![];
        };
        let robot_from_left = rig.robot_from_left(&view.posture);
        let place = |(left, right): (&Option<_>, &Option<_>)| {
            Some((robot_from_left * cameras.triangulate((*left)?, (*right)?)?).coords.coords)
        };
        left.iter().zip(right).map(place).collect()
    };
    let of_used: Vec<_> = used.iter().map(corners).collect();
    let mean = |corner: usize| -> Option<Vector3<f64>> {
        let seen: Vec<Vector3<f64>> =
            of_used.iter().filter_map(|view| view.get(corner).copied().flatten()).collect();
        (!seen.is_empty()).then(|| seen.iter().sum::<Vector3<f64>>() / seen.len() as f64)
    };
    let (mut squares, mut count) = (0.0, 0.0);
    for view in back.iter().map(corners) {
        for (corner, place) in view.iter().enumerate() {
            if let (Some(place), Some(mean)) = (place, mean(corner)) {
                squares += (place - mean).norm_squared();
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| 1e3 * f64::sqrt(squares / count))
}
