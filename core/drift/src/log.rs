//! What was watched, as rows of a session: the gap search tells from them what turns, and with which law.

use nalgebra::{Rotation3, Vector3};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::{LocalizationRow, LocalizationTable};
use plumbline_model::{Pixel, Point, Raw};

use crate::monitor::Sample;

/// At most so many looks, spread over all: what no law tells of one look it does not tell of the next either, so
/// more of them would say nothing more.
const MOST_LOOKS: usize = 16;
/// Fewer looks, or a shorter time (s), are not explained: no law shows in them.
const LEAST_LOOKS: usize = 12;
const LEAST_TIME_S: f64 = 180.0;
/// Places across the table, shares of its half width: near, in the middle, far.
const ACROSS: [f64; 3] = [-0.6, 0.0, 0.6];

/// Why what was watched cannot be explained yet.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LogError {
    /// Too short.
    #[error(
        "it was watched for {minutes:.1} min with {looks} looks: go on for at least 3 min, better 10, so that the course \
         in time shows"
    )]
    TooShort {
        /// Looks so far.
        looks: usize,
        /// From the first to the last, min.
        minutes: f64,
    },
    /// The head looks elsewhere.
    #[error("the eyes do not see the table as the head stands: turn it toward the table, then explain again")]
    TableNotSeen,
}

/// Three places on the table and where they come out in the course of time, by how each eye has turned: rows of
/// `localizations.csv`, estimates as the rig without any effect has them. At the first look they come out where
/// they are: what was off before is in none of them.
///
/// # Errors
/// When it is too little, or the eyes do not see the places.
pub fn log_of(rig: &Rig, posture: &Posture, samples: &[Sample]) -> Result<LocalizationTable, LogError> {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Err(LogError::TooShort { looks: 0, minutes: 0.0 });
    };
    let span_s = last.at_s - first.at_s;
    if is_too_short(samples.len(), span_s) {
        return Err(LogError::TooShort { looks: samples.len(), minutes: span_s / 60.0 });
    }
    let head = [rig.eyes.pan, rig.eyes.tilt];
    let head_joints = head.map(|joint| rig.description.joints()[joint.0].name.clone()).to_vec();
    let head_rad: Vec<Option<f64>> = head.iter().map(|joint| Some(posture[*joint])).collect();
    let mut rows = Vec::new();
    for sample in spread(samples, first.at_s, span_s) {
        for (name, at) in places(rig) {
            let ([left, right], estimate) =
                comes_out(rig, posture, at, sample.look.turns_rad).ok_or(LogError::TableNotSeen)?;
            rows.push(LocalizationRow {
                truth: Some(at),
                estimate: Some(estimate),
                left: Some(left),
                right: Some(right),
                head_rad: head_rad.clone(),
                t_secs: Some(sample.at_s),
                object: Some(name.to_owned()),
                ..LocalizationRow::default()
            });
        }
    }
    Ok(LocalizationTable::from_rows(head_joints, &rows))
}

/// Whether so many looks over so long (s) show no law of time.
pub fn is_too_short(looks: usize, span_s: f64) -> bool {
    looks < LEAST_LOOKS || span_s < LEAST_TIME_S
}

/// Looks at even distances in time, each once.
fn spread(samples: &[Sample], from_s: f64, span_s: f64) -> Vec<&Sample> {
    let mut chosen: Vec<&Sample> = Vec::new();
    for k in 0..MOST_LOOKS {
        let at_s = from_s + span_s * k as f64 / (MOST_LOOKS - 1) as f64;
        let next = samples.partition_point(|sample| sample.at_s < at_s).min(samples.len() - 1);
        if chosen.last().is_none_or(|last| last.at_s < samples[next].at_s) {
            chosen.push(&samples[next]);
        }
    }
    chosen
}

/// Near, in the middle and far, from the robot's right to its left.
fn places(rig: &Rig) -> [(&'static str, Point<plumbline_model::Robot>); 3] {
    let [near_m, far_m] = rig.work_patch.x_range_m;
    let [right_m, left_m] = rig.work_patch.y_range_m;
    let at = |name, x_m: f64, share: f64| {
        let y_m = 0.5 * (right_m + left_m) + share * 0.5 * (left_m - right_m);
        (name, Point::new(x_m, y_m, rig.table.height_m))
    };
    [
        at("near", near_m, ACROSS[0]),
        at("middle", 0.5 * (near_m + far_m), ACROSS[1]),
        at("far", far_m, ACROSS[2]),
    ]
}

/// Where both eyes see a place when each has turned (rad, own axes), and where it comes out. A place alone does not tell
/// an eye that nods against the other from both that nod: where the right one sees it lower than the left one does.
fn comes_out(
    rig: &Rig,
    posture: &Posture,
    at: Point<plumbline_model::Robot>,
    turns_rad: [Vector3<f64>; 2],
) -> Option<([Pixel<Raw>; 2], Point<plumbline_model::Robot>)> {
    let robot_from_left = rig.robot_from_left(posture);
    let cameras = &rig.eyes.cameras;
    let in_left = robot_from_left.inverse() * at;
    let in_right = cameras.right_from_left * in_left;
    let [left, right] = turns_rad.map(Rotation3::new);
    let left = cameras.left.project(&(left * in_left.coords.coords)).ok()?;
    let right = cameras.right.project(&(right * in_right.coords.coords)).ok()?;
    Some(([left, right], robot_from_left * cameras.triangulate(left, right)?))
}
