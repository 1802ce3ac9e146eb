//! What was written is read; what was cut is whole up to its last second.

use std::fs;
use std::path::{Path, PathBuf};

use jiff::{SignedDuration, Timestamp};
use plumbline_model::EyesThen;
use plumbline_model::robot::default_rig;
use plumbline_recording::{
    About, Attached, EyePlaces, JointGoal, JointReading, Jpeg, Level, Note, Recording, RecordingError,
    RecordingWriter, Topic, Whose,
};
use serde_json::json;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn start() -> Timestamp {
    "2026-11-21T10:04:00.25Z".parse().expect("a time")
}

fn after(seconds: f64) -> Timestamp {
    start() + SignedDuration::try_from_secs_f64(seconds).expect("a time")
}

fn about() -> About {
    let rig = Attached {
        name: "rig.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        bytes: b"x = 1".into(),
    };
    About {
        software: "plumbline test".to_owned(),
        rig: "nico".to_owned(),
        of_twin: true,
        attached: vec![rig],
        cameras: None,
    }
}

/// Bytes that tell which image they stand for.
fn images(number: u64) -> [Jpeg; 2] {
    let bytes = |eye: u8| [&[0xff, 0xd8, eye][..], &number.to_le_bytes(), &[eye; 3000]].concat();
    [Jpeg(bytes(1)), Jpeg(bytes(2))]
}

fn joints(angle_rad: f64) -> Vec<JointReading> {
    vec![
        JointReading { name: "head_z".to_owned(), angle_rad, speed_rad_s: Some(0.25) },
        JointReading { name: "head_y".to_owned(), angle_rad: -angle_rad, speed_rad_s: None },
    ]
}

/// Ten pairs a second, angles with each, a note and a command each second.
fn write(file: &Path, seconds: u64) -> RecordingWriter {
    let mut writer = RecordingWriter::create(file, start(), &about()).expect("begun");
    for number in 0..10 * seconds {
        let at = after(number as f64 * 0.1);
        writer.pair(at, number, images(number), Some(0.004)).expect("written");
        writer.joints(at, &joints(number as f64 * 0.01)).expect("written");
        if number % 10 == 0 {
            let note = Note { level: Level::Warning, text: format!("second {}", number / 10) };
            writer.note(at, &note).expect("written");
            writer.told(Topic::Commands, at, &json!({ "command": "go", "n": number })).expect("written");
        }
    }
    writer
}

fn written(folder: &Path, seconds: u64) -> PathBuf {
    let file = folder.join("log.mcap");
    let counts = write(&file, seconds).finish().expect("finished");
    assert_eq!((counts.pairs, counts.messages), (10 * seconds, 12 * seconds));
    file
}

/// All of it is as it was written, up to the last pair; how many there are.
fn check(recording: &mut Recording) -> usize {
    let pairs = recording.pair_count();
    for index in 0..pairs {
        let pair = recording.pair(index).expect("readable");
        assert_eq!((u64::from(pair.number), pair.at), (index as u64, after(index as f64 * 0.1)));
        assert_eq!(pair.images, images(index as u64));
        assert!((pair.right_later_s - 0.004).abs() < 1e-9, "{}", pair.right_later_s);
        assert_eq!(recording.captured_at(index), Some(pair.at));
    }
    let told = recording.joints().expect("readable");
    assert!(told.len().abs_diff(pairs) <= 1);
    for (index, told) in told.iter().enumerate() {
        assert_eq!((told.at, &told.what), (after(index as f64 * 0.1), &joints(index as f64 * 0.01)));
    }
    for (second, told) in recording.notes().expect("readable").iter().enumerate() {
        assert_eq!((told.what.level, &told.what.text), (Level::Warning, &format!("second {second}")));
    }
    for (second, told) in recording.told(Topic::Commands).expect("readable").iter().enumerate() {
        assert_eq!(told.what, json!({ "command": "go", "n": 10 * second }));
    }
    pairs
}

#[test]
fn what_was_written_is_read_in_any_order() {
    let folder = folder();
    let file = written(folder.path(), 5);
    let mut recording = Recording::open(&file).expect("a recording");
    assert_eq!(&Whose::read(&file).expect("a recording"), recording.whose());
    assert!(recording.is_whole());
    assert_eq!(recording.software(), "plumbline test");
    assert_eq!((recording.whose().rig.as_deref(), recording.whose().of_twin), (Some("nico"), true));
    assert_eq!(recording.attached(), about().attached);
    assert_eq!(check(&mut recording), 50);
    for index in [49, 0, 31, 30, 12] {
        assert_eq!(recording.pair(index).expect("readable").images, images(index as u64));
    }
    let beyond = recording.pair(50).expect_err("there are 50");
    assert!(matches!(beyond, RecordingError::NoSuchPair { index: 50, pairs: 50 }));
    assert_eq!(recording.captured_at(50), None);
}

#[test]
fn how_much_is_missing_stands_in_the_file_and_is_not_known_of_one_that_was_cut() {
    let folder = folder();
    let [file, cut] = ["log.mcap", "cut.mcap"].map(|name| folder.path().join(name));
    let mut writer = write(&file, 2);
    writer.set_dropped(7);
    writer.finish().expect("finished");
    let mut recording = Recording::open(&file).expect("a recording");
    assert_eq!((recording.dropped(), recording.is_whole()), (Some(7), true));
    assert_eq!(check(&mut recording), 20);
    assert_eq!(recording.whose().rig.as_deref(), Some("nico"), "what stands at its beginning is still known");
    let bytes = fs::read(&file).expect("there");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");
    assert_eq!(Recording::open(&cut).expect("a recording").dropped(), None);
}

#[test]
fn what_was_cut_anywhere_is_whole_up_to_its_last_second() {
    let folder = folder();
    let file = written(folder.path(), 4);
    let bytes = fs::read(&file).expect("there");
    let cut = folder.path().join("cut.mcap");
    let mut most = 0;
    for length in (0..bytes.len()).step_by(bytes.len() / 97) {
        fs::write(&cut, &bytes[..length]).expect("written");
        match Recording::open(&cut) {
            Ok(mut recording) => {
                let pairs = check(&mut recording);
                // A second of the file holds ten pairs.
                let share = length as f64 / bytes.len() as f64;
                assert!(pairs as f64 >= 40.0 * share - 12.0, "{pairs} pairs of {length} bytes");
                assert!(pairs >= most);
                // What was cut may be nothing but the index behind the last pair.
                assert!(pairs.is_multiple_of(10) && (!recording.is_whole() || pairs == 40), "{pairs} pairs");
                most = pairs;
            }
            Err(error) => assert!(length < 4096, "{length} bytes: {error}"),
        }
    }
    assert!(most >= 30, "{most}");
}

#[test]
fn damage_ends_a_recording_and_never_gives_wrong_images() {
    let folder = folder();
    let file = written(folder.path(), 3);
    let bytes = fs::read(&file).expect("there");
    let broken = folder.path().join("broken.mcap");
    for at in (8..bytes.len()).step_by(bytes.len() / 53) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x41;
        fs::write(&broken, bytes).expect("written");
        let Ok(mut recording) = Recording::open(&broken) else { continue };
        for index in 0..recording.pair_count() {
            if let Ok(pair) = recording.pair(index) {
                assert_eq!(pair.images, images(u64::from(pair.number)), "byte {at}, pair {index}");
            }
        }
    }
}

#[test]
fn what_is_no_recording_says_so() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let said = |file: &Path| Recording::open(file).map(|_| ()).expect_err("it is none").to_string();
    assert!(said(&file).contains("check that the disk is there"));
    for (bytes, why) in [
        (&b""[..], "nothing in it"),
        (b"\x89PNG\r\n\x1a\n and more than eight bytes of it", "does not begin as MCAP does"),
        (b"\x89MCAP0\r\n", "nothing in it"),
    ] {
        fs::write(&file, bytes).expect("written");
        assert!(said(&file).contains(why), "{}", said(&file));
    }
    let refused = RecordingWriter::create(&file, start(), &about()).err().expect("there is a file already");
    assert!(matches!(refused, RecordingError::Io { .. }));
}

#[test]
fn what_does_not_fit_a_topic_is_refused() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    for (topic, told) in [(Topic::Joints, json!({})), (Topic::Commands, json!([1, 2]))] {
        let refused = writer.told(topic, start(), &told).expect_err("it does not fit").to_string();
        assert!(refused.contains(topic.name()) && refused.contains("no object of JSON"), "{refused}");
    }
    assert_eq!(writer.counts().messages, 0);
}

#[test]
fn a_clock_that_goes_back_loses_nothing() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    let times = [5.0, 5.1, 2.0, 2.1, 9.0];
    for (number, second) in times.into_iter().enumerate() {
        writer.pair(after(second), number as u64, images(number as u64), None).expect("written");
    }
    writer.finish().expect("finished");
    let mut recording = Recording::open(&file).expect("a recording");
    let read: Vec<Timestamp> =
        (0..recording.pair_count()).map(|index| recording.pair(index).expect("readable").at).collect();
    assert_eq!(read, times.map(after));
}

#[test]
fn how_the_eyes_were_is_read_with_each_pair_and_its_absence_is_no_zero() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let rig = default_rig();
    let robot_from_left = rig.robot_from_left(&rig.home());
    let places = EyePlaces { robot_from_left, right_from_left: rig.eyes.cameras.right_from_left };
    let then = |number: u64| EyesThen {
        on_s: (number > 0).then_some(600.0 + number as f64),
        head_rad: (number < 3).then_some([0.1, -0.01 * number as f64]),
    };
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    for number in 0..5 {
        let at = after(0.5 * number as f64);
        writer.pair(at, number, images(number), None).expect("written");
        // Of the fourth pair nothing is known.
        let then = if number == 3 { EyesThen::default() } else { then(number) };
        writer.eyes(at, number, &then, (number < 3).then_some(&places)).expect("written");
    }
    writer.finish().expect("finished");
    let mut recording = Recording::open(&file).expect("a recording");
    for number in [4, 0, 3, 1] {
        let expected = if number == 3 { EyesThen::default() } else { then(number) };
        assert_eq!(recording.pair(number as usize).expect("readable").eyes, expected, "pair {number}");
    }
    let told = recording.robot_from_left().expect("readable");
    assert_eq!(told.len(), 3);
    let matrix = robot_from_left.isometry.to_homogeneous();
    for (row, values) in told[1].what.iter().enumerate() {
        for (column, value) in values.iter().enumerate() {
            assert!((value - matrix[(row, column)]).abs() < 1e-9, "{row}, {column}: {value}");
        }
    }
    // One of an older version says nothing of it.
    let mut older = Recording::open(&written(tempfile::tempdir().expect("a folder").path(), 1)).expect("one");
    assert!(older.pair(0).expect("readable").eyes.is_unknown());
    assert!(older.robot_from_left().expect("readable").is_empty());
}

#[test]
fn what_joints_were_told_is_read_beside_where_they_were_and_that_nothing_was_told_any_more_too() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let goal = |name: &str, angle_rad| JointGoal { name: name.to_owned(), angle_rad };
    let told = [vec![goal("head_z", 0.3), goal("head_y", -0.2)], vec![goal("head_y", -0.1)], vec![]];
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    for (second, goals) in told.iter().enumerate() {
        writer.joints(after(second as f64), &joints(0.1)).expect("written");
        writer.goals(after(second as f64), goals).expect("written");
    }
    writer.finish().expect("finished");
    let mut recording = Recording::open(&file).expect("a recording");
    let read = recording.goals().expect("readable");
    assert_eq!(read.iter().map(|told| told.at).collect::<Vec<_>>(), [after(0.0), after(1.0), after(2.0)]);
    assert_eq!(read.into_iter().map(|told| told.what).collect::<Vec<_>>(), told);
    assert_eq!(recording.joints().expect("readable").len(), 3, "where they were is not mixed up with it");
    // One of an older version says nothing of it.
    let mut older = Recording::open(&written(tempfile::tempdir().expect("a folder").path(), 1)).expect("one");
    assert!(older.goals().expect("readable").is_empty());
}

#[test]
fn what_cannot_be_said_of_the_eyes_is_not_known() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    writer.pair(start(), 7, images(7), None).expect("written");
    let then = EyesThen { on_s: Some(-1.0), head_rad: Some([500.0, 0.0]) };
    writer.eyes(start(), 7, &then, None).expect("written");
    writer.finish().expect("finished");
    let mut recording = Recording::open(&file).expect("a recording");
    assert!(recording.pair(0).expect("readable").eyes.is_unknown());
}

#[test]
fn a_pair_is_seen_though_what_is_said_of_its_eyes_is_damaged() {
    let folder = folder();
    let file = folder.path().join("log.mcap");
    let mut writer = RecordingWriter::create(&file, start(), &about()).expect("begun");
    writer.pair(start(), 0, images(0), None).expect("written");
    writer.told(Topic::Eyes, start(), &json!({ "eyes_on_s": "long" })).expect("written");
    writer.finish().expect("finished");
    let pair = Recording::open(&file).expect("a recording").pair(0).expect("readable");
    assert!(pair.images == images(0) && pair.eyes.is_unknown(), "{:?}", pair.eyes);
}

#[test]
fn a_chunk_that_was_not_whole_when_it_was_looked_at_is_read_again() {
    let folder = folder();
    let file = written(folder.path(), 4);
    let bytes = fs::read(&file).expect("there");
    let growing = folder.path().join("growing.mcap");
    // As over a network: all of its length is there, and some of its bytes are not.
    let mut holed = bytes.clone();
    let hole = holed.len() * 5 / 8;
    holed[hole..hole + 64].fill(0x41);
    fs::write(&growing, holed).expect("written");
    let mut recording = Recording::open(&growing).expect("a recording");
    let pairs = check(&mut recording);
    assert!(pairs > 0 && pairs < 40 && !recording.is_whole(), "{pairs} pairs");
    assert_eq!(recording.go_on().expect("readable"), 0, "nothing has come");
    fs::write(&growing, &bytes).expect("written");
    assert_eq!(recording.go_on().expect("readable"), 40 - pairs);
    assert!(check(&mut recording) == 40 && recording.is_whole());
}

#[test]
fn a_recording_that_is_still_written_is_read_on() {
    let folder = folder();
    let file = written(folder.path(), 4);
    let bytes = fs::read(&file).expect("there");
    let growing = folder.path().join("growing.mcap");
    // As a program finds it that looks now and then: cut anywhere.
    fs::write(&growing, &bytes[..bytes.len() / 3]).expect("written");
    let mut recording = Recording::open(&growing).expect("a recording");
    let mut pairs = check(&mut recording);
    assert!(pairs > 0 && !recording.is_whole());
    assert_eq!(recording.go_on().expect("readable"), 0, "nothing has come");
    for length in [bytes.len() / 2, bytes.len() / 2 + 1, bytes.len() * 3 / 4, bytes.len()] {
        fs::write(&growing, &bytes[..length]).expect("written");
        pairs += recording.go_on().expect("readable");
        assert_eq!(check(&mut recording), pairs, "{length} bytes");
    }
    assert!(pairs == 40 && recording.is_whole());
    assert_eq!(recording.go_on().expect("readable"), 0, "it has ended");
}
