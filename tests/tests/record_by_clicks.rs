//! What works live is recorded and played again, by keys and clicks in a window over the real engine and the
//! real twin.

use std::path::Path;
use std::process::Command;

use egui_kittest::kittest::Queryable as _;
use jiff::Timestamp;
use plumbline_engine::SourceSpec;
use plumbline_engine::eyes::store::Store;
use plumbline_engine::ground::World;
use plumbline_engine::view::{RecordingState, SourceStatus};
use plumbline_model::measured_data::left_out;
use plumbline_model::robot::default_rig;
use plumbline_model::{CameraModel, EyesThen, StereoCalibration};
use plumbline_recording::{FILE, Recording, Topic};
use plumbline_tests::{Window, eye_renderer, until, view, window};
use serde_json::{Value, json};

/// Reads a recording with the schemas that stand in it, and says how much of what is there.
const READER: &str = r#"
import json, sys
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
found = {"counts": {}, "jpegs": 0, "joints": [], "lenses": {}, "attached": {}, "metadata": {}}
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for schema, channel, message, decoded in reader.iter_decoded_messages(topics=sys.argv[2:]):
        found["counts"][channel.topic] = found["counts"].get(channel.topic, 0) + 1
        if schema.name == "foxglove.CompressedImage":
            whole = decoded.data[:2] == b"\xff\xd8" and decoded.data[-2:] == b"\xff\xd9"
            found["jpegs"] += decoded.format == "jpeg" and whole
        elif schema.name == "foxglove.JointStates":
            found["joints"] = [joint.name for joint in decoded.joints]
        elif schema.name == "foxglove.CameraCalibration":
            found["lenses"][channel.topic] = [decoded.width, decoded.height, decoded.K[0]]
    for attachment in reader.iter_attachments():
        found["attached"][attachment.name] = attachment.data.decode()
    for metadata in reader.iter_metadata():
        found["metadata"][metadata.name] = metadata.metadata
print(json.dumps(found))
"#;

fn pairs(window: &Window) -> u64 {
    match &view(window).recording.state {
        RecordingState::On { so_far, .. } => so_far.pairs,
        _ => 0,
    }
}

/// What the Python package of MCAP, which is not ours, says of a file; `None`, with a word on the console, where it
/// is not there.
fn read_by_python(file: &Path) -> Option<Value> {
    let readers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.native/readers");
    if !readers.join("mcap").exists() {
        left_out("the Python package mcap is not here; ./plumbline test fetches it");
        return None;
    }
    let topics = [
        Topic::LeftEye,
        Topic::RightEye,
        Topic::Joints,
        Topic::LeftCalibration,
        Topic::RightCalibration,
        Topic::Transforms,
    ];
    let told = Command::new("python3")
        .args(["-c", READER])
        .arg(file)
        .args(topics.map(Topic::name))
        .env("PYTHONPATH", readers)
        .output()
        .expect("Python is there");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    Some(serde_json::from_slice(&told.stdout).expect("JSON"))
}

/// Others read as much in it as this program wrote, with what makes it whole by itself.
fn others_read(file: &Path, pairs: u64, readings: usize, dropped: u64) {
    let Some(found) = read_by_python(file) else { return };
    let of = |topic: Topic| found["counts"][topic.name()].as_u64();
    assert_eq!([Topic::LeftEye, Topic::RightEye].map(of), [Some(pairs); 2], "{}", found["counts"]);
    assert_eq!(found["jpegs"], 2 * pairs, "each image is a whole JPEG");
    assert_eq!(of(Topic::Joints), Some(readings as u64));
    assert!(of(Topic::Transforms).is_some_and(|told| told <= pairs), "where the eyes were");
    let joints = found["joints"].as_array().expect("names");
    assert!(
        ["head_z", "r_elbow_y", "l_elbow_y"].iter().all(|name| joints.contains(&json!(name))),
        "{joints:?}"
    );
    let lenses =
        [Topic::LeftCalibration, Topic::RightCalibration].map(|topic| &found["lenses"][topic.name()]);
    let cameras = default_rig().eyes.cameras;
    for (lens, camera) in lenses.into_iter().zip([&cameras.left, &cameras.right]) {
        assert_eq!([&lens[0], &lens[1]], [&json!(camera.width_px), &json!(camera.height_px)], "{lens}");
        let CameraModel::Fisheye(fisheye) = &camera.model else { panic!("NICO has fisheyes") };
        assert!(lens[2].as_f64().is_some_and(|fx_px| (fx_px - fisheye.fx_px).abs() < 1e-6), "{lens}");
    }
    let attached = |name: &str| found["attached"][name].as_str().unwrap_or_default();
    assert!(attached("robot.urdf").contains("<robot") && attached("rig.toml").contains("nico"));
    assert!(attached("rig-cameras.yaml").contains("left"), "{}", attached("rig-cameras.yaml"));
    assert_eq!(found["metadata"]["plumbline"], json!({ "rig": "nico", "of": "twin" }));
    assert_eq!(found["metadata"]["plumbline.end"]["dropped"], dropped.to_string());
}

#[test]
fn the_twin_is_recorded_and_played_again() {
    if eye_renderer().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    // Its eyes were calibrated before.
    let calibration = StereoCalibration::bare(default_rig().eyes.cameras);
    let store = Store::of_world(&World::Twin.folder(folder.path()));
    store.accept(&calibration, Timestamp::UNIX_EPOCH).expect("kept");
    let mut window = window(folder.path(), Some("perfect"));
    until(&mut window, "the twin's eyes", |window| {
        let view = view(window);
        view.source.status == SourceStatus::Running
            && view.robot.measured.is_some()
            && view.eyes.in_use.is_some()
    });
    window.key_press(egui::Key::R);
    until(&mut window, "some pairs", |window| pairs(window) >= 25);
    assert!(window.query_all_by_label_contains("Recording").next().is_some(), "the top line says so");
    window.key_press(egui::Key::R);
    until(&mut window, "the file", |window| view(window).recording.last.is_some());
    let last = view(&window).recording.last.clone().expect("just seen");

    let mut recording = Recording::open(&last.session.join(FILE)).expect("a recording");
    assert!(recording.is_whole() && recording.whose().of_twin);
    assert_eq!(recording.pair_count() as u64, last.so_far.pairs);
    let joints = recording.joints().expect("readable");
    assert!(joints.len() >= 3, "{} readings of joints", joints.len());
    let named = |name: &str| joints[0].what.iter().any(|joint| joint.name == name);
    assert!(named("head_z") && named("r_elbow_y") && named("l_elbow_y"));
    let asked = recording.told(Topic::Commands).expect("readable");
    let stop = asked.last().expect("at least that it ends").what.clone();
    assert_eq!(stop, json!({ "workflow": "recording", "command": "stop" }));
    assert_eq!(recording.dropped(), Some(last.so_far.dropped));
    let all = 0..recording.pair_count();
    let eyes: Vec<EyesThen> = all.map(|index| recording.pair(index).expect("readable").eyes).collect();
    assert!(eyes.iter().all(|then| then.on_s.is_some()), "{eyes:?}");
    // A busy machine may not hear a servo now and then.
    assert!(eyes.iter().any(|then| then.head_rad.is_some()), "{eyes:?}");
    others_read(&last.session.join(FILE), last.so_far.pairs, joints.len(), last.so_far.dropped);

    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
    window.run_steps(2);
    window.event(egui::Event::Text("play the last".to_owned()));
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    let of_it = SourceSpec::Recording { file: last.session.join(FILE), of_twin: true };
    until(&mut window, "the recording", |window| {
        let source = view(window).source.clone();
        source.spec.as_ref() == Some(&of_it) && source.replay.is_some_and(|replay| replay.position > Some(2))
    });
    until(&mut window, "for how long the eyes had been on", |window| {
        view(window).eyes.minutes_since_on.is_some()
    });
    let length = view(&window).source.replay.expect("just seen").length;
    assert_eq!(length, last.so_far.pairs);
    assert!(window.query_all_by_label("Position in the recording").next().is_some(), "it can be scrubbed");
}
