//! Messages as they stand in the file.

use foxglove::messages::{
    CameraCalibration, CompressedImage, FrameTransforms, ImageAnnotations, JointState, JointStates, Log,
    Timestamp as FoxgloveTime, log,
};
use foxglove::{Encode, Schema};
use jiff::Timestamp;
use plumbline_model::{Camera, CameraModel, Eye};

use crate::error::RecordingError;
use crate::topic::Topic;

/// A joint as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReading {
    /// Its name in the robot's description.
    pub name: String,
    /// Angle, rad.
    pub angle_rad: f64,
    /// Angular speed, rad/s, where it is known.
    pub speed_rad_s: Option<f64>,
}

/// A joint that holds, or goes, where it was told to.
#[derive(Clone, Debug, PartialEq)]
pub struct JointGoal {
    /// Its name in the robot's description.
    pub name: String,
    /// The angle it was sent last, rad.
    pub angle_rad: f64,
}

/// How a message is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// To be known.
    Info,
    /// To be heeded.
    Warning,
    /// Something went wrong.
    Error,
}

/// A message for the operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// How it is meant.
    pub level: Level,
    /// A sentence.
    pub text: String,
}

/// The frame of an eye's images: x right, y down, z along the line of sight.
pub(crate) fn frame_of(eye: Eye) -> &'static str {
    match eye {
        Eye::Left => "left_eye_optical",
        Eye::Right => "right_eye_optical",
    }
}

/// Nanoseconds since 1970 (UTC), which a recording counts in; the format has none before it.
pub(crate) fn nanoseconds(at: Timestamp) -> u64 {
    u64::try_from(at.as_nanosecond()).unwrap_or(0)
}

/// The moment of so many nanoseconds; `None` beyond what a calendar has.
pub(crate) fn moment(nanoseconds: u64) -> Option<Timestamp> {
    Timestamp::from_nanosecond(i128::from(nanoseconds)).ok()
}

pub(crate) fn time(at: Timestamp) -> Option<FoxgloveTime> {
    let nanoseconds = nanoseconds(at);
    let seconds = u32::try_from(nanoseconds / 1_000_000_000).ok()?;
    FoxgloveTime::new_checked(seconds, (nanoseconds % 1_000_000_000) as u32)
}

pub(crate) fn image(eye: Eye, at: Timestamp, jpeg: Vec<u8>) -> CompressedImage {
    CompressedImage {
        timestamp: time(at),
        frame_id: frame_of(eye).to_owned(),
        data: jpeg.into(),
        format: "jpeg".to_owned(),
    }
}

pub(crate) fn joints(at: Timestamp, readings: &[JointReading]) -> JointStates {
    let state = |reading: &JointReading| JointState {
        name: reading.name.clone(),
        position: Some(reading.angle_rad),
        velocity: reading.speed_rad_s,
        acceleration: None,
        effort: None,
    };
    JointStates { timestamp: time(at), joints: readings.iter().map(state).collect() }
}

pub(crate) fn readings(states: JointStates) -> Vec<JointReading> {
    let reading = |state: JointState| {
        Some(JointReading { name: state.name, angle_rad: state.position?, speed_rad_s: state.velocity })
    };
    states.joints.into_iter().filter_map(reading).collect()
}

/// Goals are states that are wanted: the schema has no other place for them.
pub(crate) fn goals(at: Timestamp, goals: &[JointGoal]) -> JointStates {
    let reading = |goal: &JointGoal| JointReading {
        name: goal.name.clone(),
        angle_rad: goal.angle_rad,
        speed_rad_s: None,
    };
    joints(at, &goals.iter().map(reading).collect::<Vec<_>>())
}

pub(crate) fn wanted(states: JointStates) -> Vec<JointGoal> {
    let goal = |JointReading { name, angle_rad, .. }| JointGoal { name, angle_rad };
    readings(states).into_iter().map(goal).collect()
}

pub(crate) fn log(at: Timestamp, note: &Note) -> Log {
    let level = match note.level {
        Level::Info => log::Level::Info,
        Level::Warning => log::Level::Warning,
        Level::Error => log::Level::Error,
    };
    Log {
        timestamp: time(at),
        level: level as i32,
        message: note.text.clone(),
        name: "plumbline".to_owned(),
        file: String::new(),
        line: 0,
    }
}

pub(crate) fn note(log: Log) -> Note {
    let level = match log.level {
        level if level == log::Level::Warning as i32 => Level::Warning,
        level if level >= log::Level::Error as i32 => Level::Error,
        _ => Level::Info,
    };
    Note { level, text: log.message }
}

/// Lens of an eye. The skew of a fisheye stands in its matrix, which readers take it from or leave out.
pub(crate) fn calibration(eye: Eye, at: Timestamp, camera: &Camera) -> CameraCalibration {
    let ([fx, fy, cx, cy], skew, (model, d)) = match &camera.model {
        CameraModel::Fisheye(lens) => (
            [lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px],
            lens.skew_px,
            ("kannala_brandt", lens.k.to_vec()),
        ),
        CameraModel::Pinhole(lens) => {
            ([lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px], 0.0, ("plumb_bob", vec![0.0; 5]))
        }
    };
    CameraCalibration {
        timestamp: time(at),
        frame_id: frame_of(eye).to_owned(),
        width: camera.width_px,
        height: camera.height_px,
        distortion_model: model.to_owned(),
        d,
        k: vec![fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: vec![fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
}

/// What a topic's messages are: schema and encoding.
pub(crate) fn kind(topic: Topic) -> (Schema, String) {
    fn of<T: Encode>() -> (Schema, String) {
        (T::get_schema().expect("schemas of Foxglove are part of the library"), T::get_message_encoding())
    }
    match topic {
        Topic::LeftEye | Topic::RightEye => of::<CompressedImage>(),
        Topic::LeftCalibration | Topic::RightCalibration => of::<CameraCalibration>(),
        Topic::Joints | Topic::Goals => of::<JointStates>(),
        Topic::Notes => of::<Log>(),
        Topic::Commands => json("plumbline.Command"),
        Topic::Detections => json("plumbline.Detections"),
        Topic::Eyes => json("plumbline.Eyes"),
        Topic::Transforms => of::<FrameTransforms>(),
        Topic::LeftAnnotations | Topic::RightAnnotations => of::<ImageAnnotations>(),
    }
}

fn json(name: &str) -> (Schema, String) {
    let schema = serde_json::json!({ "title": name, "type": "object" });
    (Schema::new(name, "jsonschema", schema.to_string().into_bytes()), "json".to_owned())
}

pub(crate) fn bytes<T: Encode>(topic: Topic, message: &T) -> Result<Vec<u8>, RecordingError> {
    let mut bytes = Vec::with_capacity(message.encoded_len().unwrap_or(256));
    let refused = |error: T::Error| RecordingError::Message { topic: topic.name(), what: error.to_string() };
    message.encode(&mut bytes).map_err(refused)?;
    Ok(bytes)
}
