//! The joints over time while a grasp goes on: a table beside its record.

use std::fmt::Write as _;
use std::path::Path;

use plumbline_model::files::{FileError, Growing};
use plumbline_model::robot::Rig;

use crate::record::Step;

/// The table, in the folder of an attempt.
pub const FILE: &str = "tracks.csv";
/// Time between two rows, s: about 12 a second. A robot that answers more slowly has fewer.
pub const EVERY_S: f64 = 0.08;

/// A joint at a moment. What is not known is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointAt {
    /// By its encoder, rad.
    pub measured_rad: Option<f64>,
    /// Where it was sent last, rad.
    pub commanded_rad: Option<f64>,
}

/// All joints that servos move at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct JointsAt {
    /// Clock of the robot, s.
    pub at_s: f64,
    /// In the order of the rig's servos.
    pub joints: Vec<JointAt>,
}

/// The table while it is written: `t_s`, of each joint `NAME_rad` and `NAME_commanded_rad`, and `step`. Every row
/// is on disk when it was added.
#[derive(Debug)]
pub struct Tracks {
    file: Growing,
    joints: usize,
    step: Option<Step>,
}

impl Tracks {
    /// Begins one, in place of what was in the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn begin(file: &Path, rig: &Rig) -> Result<Self, FileError> {
        let mut head = "t_s".to_owned();
        for servo in &rig.servos {
            let joint = &servo.joint_name;
            head.push_str(&format!(",{joint}_rad,{joint}_commanded_rad"));
        }
        head.push_str(",step\n");
        Ok(Self { file: Growing::begin(file, head)?, joints: rig.servos.len(), step: None })
    }

    /// From now on rows are of this step.
    pub fn step(&mut self, step: Step) {
        self.step = Some(step);
    }

    /// Adds rows.
    ///
    /// # Errors
    /// When they cannot be written; then none of them is in the file.
    pub fn add(&mut self, rows: &[JointsAt]) -> Result<(), FileError> {
        let step = self.step.map_or_else(String::new, |step| step.title().to_lowercase());
        let mut text = String::new();
        for row in rows {
            text.push_str(&format!("{:.3}", row.at_s));
            for joint in (0..self.joints).map(|k| row.joints.get(k).copied().unwrap_or_default()) {
                cell(&mut text, joint.measured_rad);
                cell(&mut text, joint.commanded_rad);
            }
            text.push_str(&format!(",{step}\n"));
        }
        if text.is_empty() { Ok(()) } else { self.file.add(text) }
    }
}

/// A tenth of a milliradian is far less than a tick of any encoder here.
fn cell(text: &mut String, angle_rad: Option<f64>) {
    text.push(',');
    if let Some(angle_rad) = angle_rad.filter(|angle_rad| angle_rad.is_finite()) {
        // Writing into a text does not fail.
        let _ = write!(text, "{angle_rad:.4}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(at_s: f64, joints: Vec<JointAt>) -> JointsAt {
        JointsAt { at_s, joints }
    }

    #[test]
    fn every_row_has_a_cell_for_every_joint_and_what_was_not_heard_is_empty() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join(FILE);
        let mut tracks = Tracks::begin(&file, &rig).expect("writable");
        let known = JointAt { measured_rad: Some(0.123_46), commanded_rad: Some(-1.0) };
        let silent = JointAt { measured_rad: None, commanded_rad: Some(0.5) };
        let all = vec![known; rig.servos.len()];
        tracks.add(&[at(0.0, all.clone())]).expect("writable");
        tracks.step(Step::Approach);
        let mut one_silent = all.clone();
        one_silent[1] = silent;
        one_silent[2].measured_rad = Some(f64::NAN);
        tracks.add(&[at(0.08, all), at(0.16, one_silent)]).expect("writable");
        tracks.step(Step::Align);
        tracks.add(&[at(0.24, vec![])]).expect("writable");
        tracks.add(&[]).expect("nothing to write");

        let text = std::fs::read_to_string(&file).expect("there");
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let head = &rows[0];
        let names: Vec<&str> = rig.servos.iter().map(|servo| servo.joint_name.as_str()).collect();
        assert_eq!(head[0], "t_s");
        assert_eq!(head[1..3], [format!("{}_rad", names[0]), format!("{}_commanded_rad", names[0])]);
        assert_eq!(head.last(), Some(&"step"));
        assert!(rows.len() == 5 && rows.iter().all(|row| row.len() == 2 * names.len() + 2), "{text}");
        assert_eq!((rows[1][1], rows[1][2], rows[1].last()), ("0.1235", "-1.0000", Some(&"")));
        assert_eq!((rows[2][0], rows[2].last()), ("0.080", Some(&"approach")));
        // The joint that was silent, and the one whose angle is no number.
        assert_eq!((rows[3][3], rows[3][4], rows[3][5]), ("", "0.5000", ""));
        assert!(rows[4][1..rows[4].len() - 1].iter().all(|cell| cell.is_empty()), "{text}");
    }
}
