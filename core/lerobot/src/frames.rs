//! Which pairs are frames, and what was read, told and known of each.

use jiff::Timestamp;
use plumbline_recording::{JointGoal, JointReading, Recording, RecordingError, Told};

/// A pair that is in the data set, and what belongs to it.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Which pair of the recording.
    pub pair: usize,
    /// When it was captured.
    pub at: Timestamp,
    /// The reading of joints before it.
    reading: usize,
    /// What joints were told last before the next pair: the answer to this one; `None`: nobody says.
    goals: Option<usize>,
    /// Where the left eye was in the robot: rows of a matrix 4 by 4.
    pub robot_from_left: Option<[[f64; 4]; 4]>,
}

/// A joint that was told nothing in some pairs: it was limp, or nobody had commanded it yet.
#[derive(Clone, Debug, PartialEq)]
pub struct NotCommanded {
    /// Its name in the robot's description.
    pub joint: String,
    /// In so many pairs.
    pub frames: usize,
}

/// All frames of a recording.
#[derive(Debug)]
pub(crate) struct Frames {
    pub frames: Vec<Frame>,
    /// Joints of the first reading: of those each pair from then on has an angle.
    pub joints: Vec<String>,
    /// Joints that were told something in every frame.
    pub actions: Vec<String>,
    /// The others.
    pub not_commanded: Vec<NotCommanded>,
    readings: Vec<Told<Vec<JointReading>>>,
    goals: Vec<Told<Vec<JointGoal>>>,
}

impl Frames {
    /// Of all pairs that have a reading of joints before them.
    ///
    /// # Errors
    /// When the recording cannot be read any more.
    pub fn of(recording: &mut Recording) -> Result<Self, RecordingError> {
        let (readings, goals) = (recording.joints()?, recording.goals()?);
        let places = recording.robot_from_left()?;
        let frame = |pair: usize| {
            let at = recording.captured_at(pair)?;
            let reading = last_until(&readings, at)?;
            let told = match recording.captured_at(pair + 1) {
                Some(next) => last_until(&goals, next),
                None => goals.len().checked_sub(1),
            };
            // It is written with each pair; what is older was of another posture of the head.
            let place = last_until(&places, at).map(|k| &places[k]).filter(|place| place.at == at);
            Some(Frame { pair, at, reading, goals: told, robot_from_left: place.map(|place| place.what) })
        };
        let frames: Vec<Frame> = (0..recording.pair_count()).filter_map(frame).collect();
        let first = readings.first().map_or(&[][..], |first| &first.what);
        let joints: Vec<String> = first.iter().map(|joint| joint.name.clone()).collect();
        let mut of = Self { frames, joints, actions: vec![], not_commanded: vec![], readings, goals };
        of.tell_commanded();
        Ok(of)
    }

    /// A policy learns from numbers: a joint that was told nothing for a while has none then, and is left out.
    fn tell_commanded(&mut self) {
        for joint in &self.joints {
            let is_told = |frame: &&Frame| self.goal(frame, joint).is_some();
            let without = self.frames.len() - self.frames.iter().filter(is_told).count();
            if without == 0 {
                self.actions.push(joint.clone());
            } else {
                self.not_commanded.push(NotCommanded { joint: joint.clone(), frames: without });
            }
        }
    }

    /// Angles of joints as each was read last, rad.
    pub fn angles(&self, frame: &Frame) -> Vec<f32> {
        let last = |name: &String| {
            let all = self.readings[..=frame.reading].iter().rev().flat_map(|reading| &reading.what);
            all.into_iter().find(|joint| joint.name == *name).map(|joint| joint.angle_rad as f32)
        };
        self.joints.iter().filter_map(last).collect()
    }

    /// What the joints of `actions` were told, rad.
    pub fn commanded(&self, frame: &Frame) -> Vec<f32> {
        self.actions.iter().filter_map(|joint| self.goal(frame, joint)).map(|rad| rad as f32).collect()
    }

    fn goal(&self, frame: &Frame, joint: &str) -> Option<f64> {
        let told = &self.goals[frame.goals?].what;
        told.iter().find(|goal| goal.name == joint).map(|goal| goal.angle_rad)
    }
}

/// Which was told last, at this time or before it.
fn last_until<T>(told: &[Told<T>], at: Timestamp) -> Option<usize> {
    told.partition_point(|told| told.at <= at).checked_sub(1)
}
