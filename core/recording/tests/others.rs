//! What others read of a recording: the Python package of MCAP, with the schemas that stand in the file.

use std::path::Path;
use std::process::Command;

use jiff::{SignedDuration, Timestamp};
use plumbline_model::EyesThen;
use plumbline_model::robot::default_rig;
use plumbline_recording::{
    About, Attached, EyePlaces, JointGoal, JointReading, Jpeg, Level, Note, Outline, RecordingWriter, Topic,
};
use serde_json::{Value, json};

/// Reads all messages with their own schemas, and says what they hold.
const READER: &str = r#"
import json, sys
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
found = {"messages": {}, "attachments": {}, "schemas": {}}
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    summary = reader.get_summary()
    found["statistics"] = summary.statistics.message_count
    found["chunks"] = len(summary.chunk_indexes)
    for schema, channel, message, decoded in reader.iter_decoded_messages(topics=[t for t in sys.argv[2:]]):
        found["schemas"][channel.topic] = schema.name
        values = found["messages"].setdefault(channel.topic, [])
        if schema.name == "foxglove.CompressedImage":
            values.append([decoded.format, decoded.frame_id, decoded.data.hex(), decoded.timestamp.ToNanoseconds()])
        elif schema.name == "foxglove.JointStates":
            values.append([[j.name, j.position] for j in decoded.joints])
        elif schema.name == "foxglove.Log":
            values.append([decoded.level, decoded.message])
        elif schema.name == "foxglove.FrameTransforms":
            values.append([[t.parent_frame_id, t.child_frame_id, t.translation.z, t.rotation.w] for t in decoded.transforms])
        elif schema.name == "foxglove.ImageAnnotations":
            values.append([[p.type, [[c.x, c.y] for c in p.points]] for p in decoded.points] + [t.text for t in decoded.texts])
        elif schema.name == "foxglove.CameraCalibration":
            values.append([decoded.width, decoded.height, decoded.distortion_model, list(decoded.K), list(decoded.D)])
    for _, channel, message in reader.iter_messages(topics=["/commands", "/eyes/state"]):
        found["messages"].setdefault(channel.topic, []).append(json.loads(message.data))
    for attachment in reader.iter_attachments():
        found["attachments"][attachment.name] = attachment.data.decode()
print(json.dumps(found))
"#;

/// What the package says of a file; `None`, with a word on the console, where it is not there.
fn read_by_python(file: &Path) -> Option<Value> {
    let readers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.native/readers");
    if !readers.join("mcap").exists() {
        plumbline_model::measured_data::left_out(
            "the Python package mcap is not here; ./plumbline test fetches it",
        );
        return None;
    }
    let topics = Topic::ALL
        .map(Topic::name)
        .into_iter()
        .filter(|name| !["/commands", "/detections", "/eyes/state"].contains(name));
    let told = Command::new("python3")
        .args(["-c", READER])
        .arg(file)
        .args(topics)
        .env("PYTHONPATH", readers)
        .output();
    let told = told.expect("Python is there");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    Some(serde_json::from_slice(&told.stdout).expect("JSON"))
}

#[test]
fn the_python_package_reads_what_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log.mcap");
    let at: Timestamp = "2026-11-21T10:04:00.25Z".parse().expect("a time");
    let cameras = default_rig().eyes.cameras;
    let rig = Attached {
        name: "rig.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        bytes: b"x = 1".into(),
    };
    let about = About {
        software: "plumbline".to_owned(),
        rig: "nico".to_owned(),
        of_twin: true,
        cameras: Some(cameras),
        attached: vec![rig],
    };
    let mut writer = RecordingWriter::create(&file, at, &about).expect("begun");
    for number in 0..25 {
        let at = at + SignedDuration::from_millis(100 * number);
        let image = |eye: u8| Jpeg(vec![0xff, 0xd8, eye, number as u8]);
        writer.pair(at, number as u64, [image(1), image(2)], Some(0.003)).expect("written");
        let angle = JointReading { name: "head_z".to_owned(), angle_rad: 0.5, speed_rad_s: None };
        writer.joints(at, &[angle]).expect("written");
    }
    let goal = JointGoal { name: "head_z".to_owned(), angle_rad: 0.75 };
    writer.goals(at, &[goal]).expect("written");
    writer.note(at, &Note { level: Level::Error, text: "lost".to_owned() }).expect("written");
    writer.told(Topic::Commands, at, &json!({ "command": "stop" })).expect("written");
    let default = default_rig();
    let robot_from_left = default.robot_from_left(&default.home());
    let places = EyePlaces { robot_from_left, right_from_left: cameras.right_from_left };
    let then = EyesThen { on_s: Some(61.5), head_rad: None };
    writer.eyes(at, 0, &then, Some(&places)).expect("written");
    let seen = Outline { box_px: [10.0, 20.0, 30.0, 50.0], text: "tomato 0.94".to_owned() };
    writer.outlines(at, &[vec![seen], vec![]]).expect("written");
    writer.finish().expect("finished");

    let Some(found) = read_by_python(&file) else { return };
    assert_eq!(found["statistics"], 25 * 3 + 9);
    assert!(found["chunks"].as_u64().is_some_and(|chunks| chunks >= 3), "{}", found["chunks"]);
    assert_eq!(found["attachments"], json!({ "rig.toml": "x = 1" }));
    let messages = &found["messages"];
    let begun = i64::try_from(at.as_nanosecond()).expect("in this century");
    assert_eq!(
        messages["/eyes/left/image"][7],
        json!(["jpeg", "left_eye_optical", "ffd80107", begun + 700_000_000])
    );
    assert_eq!(
        messages["/eyes/right/image"][7],
        json!(["jpeg", "right_eye_optical", "ffd80207", begun + 703_000_000])
    );
    assert_eq!(messages["/joints"][24], json!([["head_z", 0.5]]));
    assert_eq!(messages["/joints/goals"], json!([[["head_z", 0.75]]]));
    assert_eq!(found["schemas"]["/joints/goals"], "foxglove.JointStates");
    assert_eq!(messages["/notes"], json!([[4, "lost"]]));
    assert_eq!(messages["/commands"], json!([{ "command": "stop" }]));
    assert_eq!(found["schemas"]["/joints"], "foxglove.JointStates");
    assert_eq!(messages["/eyes/state"], json!([{ "eyes_on_s": 61.5, "head_rad": null }]));
    let [left, right] = [&messages["/tf"][0][0], &messages["/tf"][0][1]];
    assert_eq!((&left[0], &left[1]), (&json!("robot"), &json!("left_eye_optical")));
    assert_eq!((&right[0], &right[1]), (&json!("left_eye_optical"), &json!("right_eye_optical")));
    let height_m = left[2].as_f64().expect("a number");
    assert!((height_m - robot_from_left.isometry.translation.vector.z).abs() < 1e-9, "{height_m}");
    // 2 is a closed line in Foxglove's schema.
    let corners = json!([[10.5, 20.5], [30.5, 20.5], [30.5, 50.5], [10.5, 50.5]]);
    assert_eq!(messages["/eyes/left/annotations"][0], json!([[2, corners], "tomato 0.94"]));
    assert_eq!(messages["/eyes/right/annotations"][0], json!([]));
    let lens = &messages["/eyes/left/calibration"][0];
    assert_eq!((&lens[0], &lens[1], &lens[2]), (&json!(640), &json!(480), &json!("kannala_brandt")));
    let plumbline_model::CameraModel::Fisheye(left) = cameras.left.model else { panic!("NICO has fisheyes") };
    assert_eq!((&lens[3][0], &lens[3][5]), (&json!(left.fx_px), &json!(left.cy_px)));
    assert_eq!(lens[4], json!(left.k));
}
