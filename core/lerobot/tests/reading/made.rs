//! A recording to export.

use std::path::Path;

use jiff::{SignedDuration, Timestamp};
use plumbline_model::EyesThen;
use plumbline_model::robot::default_rig;
use plumbline_recording::{About, Attached, EyePlaces, JointGoal, JointReading, Jpeg, RecordingWriter};

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

/// Pan that is commanded after a pair of this number was taken, rad: the head follows it.
pub(crate) fn commanded_rad(number: u32) -> f64 {
    0.01 * f64::from(number) + 0.03
}

/// What is said of a pair.
pub(crate) struct Said {
    pub places: Option<EyePlaces>,
    pub goals: Option<Vec<JointGoal>>,
}

fn goal(name: &str, angle_rad: f64) -> JointGoal {
    JointGoal { name: name.to_owned(), angle_rad }
}

/// Twenty pairs a second for six seconds; angles from 0.2 s on. It says where the eyes were, and what both joints of
/// the head were told.
pub(crate) fn recorded(file: &Path) {
    recorded_with(file, |number| Said {
        places: Some(places()),
        goals: Some(vec![goal("head_z", commanded_rad(number)), goal("head_y", -0.5)]),
    });
}

/// The same, of a head that is limp up and down from the pair 60 to the pair 69, and while it turns in three pairs
/// nobody knows where the eyes are.
pub(crate) fn recorded_with_gaps(file: &Path) {
    recorded_with(file, |number| Said {
        places: Some(places()).filter(|_| !(30..33).contains(&number)),
        goals: Some(match number {
            60..70 => vec![goal("head_z", commanded_rad(number))],
            _ => vec![goal("head_z", commanded_rad(number)), goal("head_y", -0.5)],
        }),
    });
}

/// The same, with a calibration of the eyes inside.
pub(crate) fn recorded_carrying(file: &Path, calibration: &[u8]) {
    let calibration = Attached {
        name: "rig-cameras.yaml".to_owned(),
        media_type: "application/yaml".to_owned(),
        bytes: calibration.into(),
    };
    write(file, vec![calibration], |_| Said { places: None, goals: None });
}

/// The same, of a program that may not say where the eyes were, or what was told.
pub(crate) fn recorded_with(file: &Path, said: impl Fn(u32) -> Said) {
    let rig = Attached {
        name: "rig.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        bytes: b"name = 1".into(),
    };
    write(file, vec![rig], said);
}

fn write(file: &Path, attached: Vec<Attached>, said: impl Fn(u32) -> Said) {
    let about = About {
        software: "plumbline test".to_owned(),
        rig: "nico".to_owned(),
        of_twin: true,
        cameras: None,
        attached,
    };
    let mut writer = RecordingWriter::create(file, at(0.0), &about).expect("begun");
    for number in 0..120 {
        let time = at(0.05 * f64::from(number));
        if number >= 4 {
            writer.joints(time, &joints(0.01 * f64::from(number))).expect("written");
        }
        let images = [jpeg((number % 200) as u8), jpeg(250)];
        let said = said(number);
        writer.pair(time, number.into(), images, None).expect("written");
        let then = EyesThen::default();
        writer.eyes(time, number.into(), &then, said.places.as_ref()).expect("written");
        // Soon after the pair: whoever commands has seen it.
        if let Some(goals) = said.goals {
            writer.goals(at(0.05 * f64::from(number) + 0.02), &goals).expect("written");
        }
    }
    writer.finish().expect("finished");
}
