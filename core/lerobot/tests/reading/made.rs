//! A recording to export.

use std::path::Path;

use jiff::{SignedDuration, Timestamp};
use plumbline_model::EyesThen;
use plumbline_model::robot::default_rig;
use plumbline_recording::{About, Attached, EyePlaces, JointReading, Jpeg, RecordingWriter};

fn at(seconds: f64) -> Timestamp {
    let start: Timestamp = "2026-11-21T10:04:00Z".parse().expect("a time");
    start + SignedDuration::try_from_secs_f64(seconds).expect("a time")
}

/// A picture of one gray.
fn jpeg(gray: u8) -> Jpeg {
    let image = image::RgbImage::from_pixel(64, 48, image::Rgb([gray, gray, gray]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Jpeg).expect("encoded");
    Jpeg(bytes.into_inner())
}

fn joints(angle_rad: f64) -> Vec<JointReading> {
    let joint = |name: &str, angle_rad| JointReading { name: name.to_owned(), angle_rad, speed_rad_s: None };
    vec![joint("head_z", angle_rad), joint("head_y", -0.5)]
}

/// Where the left eye is in the robot, and the right one against it, in all pairs.
pub(crate) fn places() -> EyePlaces {
    let rig = default_rig();
    let robot_from_left = rig.robot_from_left(&rig.home());
    EyePlaces { robot_from_left, right_from_left: rig.eyes.cameras.right_from_left }
}

/// Twenty pairs a second for six seconds; angles from 0.2 s on. It says where the eyes were.
pub(crate) fn recorded(file: &Path) {
    recorded_with(file, Some(&places()));
}

/// The same, of a program that may not say where the eyes were.
pub(crate) fn recorded_with(file: &Path, places: Option<&EyePlaces>) {
    let rig = Attached {
        name: "rig.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        bytes: b"name = 1".into(),
    };
    let about = About {
        software: "plumbline test".to_owned(),
        rig: "nico".to_owned(),
        of_twin: true,
        cameras: None,
        attached: vec![rig],
    };
    let mut writer = RecordingWriter::create(file, at(0.0), &about).expect("begun");
    for number in 0..120 {
        let time = at(0.05 * f64::from(number));
        if number >= 4 {
            writer.joints(time, &joints(0.01 * f64::from(number))).expect("written");
        }
        let images = [jpeg((number % 200) as u8), jpeg(250)];
        writer.pair(time, number as u64, images, None).expect("written");
        writer.eyes(time, number as u64, &EyesThen::default(), places).expect("written");
    }
    writer.finish().expect("finished");
}
