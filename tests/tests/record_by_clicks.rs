//! What works live is recorded and played again, by keys and clicks in a window over the real engine and the
//! real twin.

use egui_kittest::kittest::Queryable as _;
use plumbline_engine::SourceSpec;
use plumbline_engine::view::{RecordingState, SourceStatus};
use plumbline_recording::{FILE, Recording, Topic};
use plumbline_tests::{Window, eye_renderer, until, view, window};

fn pairs(window: &Window) -> u64 {
    match &view(window).recording.state {
        RecordingState::On { so_far, .. } => so_far.pairs,
        _ => 0,
    }
}

#[test]
fn the_twin_is_recorded_and_played_again() {
    if eye_renderer().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(folder.path(), Some("perfect"));
    until(&mut window, "the twin's eyes", |window| {
        let view = view(window);
        view.source.status == SourceStatus::Running && view.robot.measured.is_some()
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
    assert_eq!(stop, serde_json::json!({ "workflow": "recording", "command": "stop" }));

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
    let length = view(&window).source.replay.expect("just seen").length;
    assert_eq!(length, last.so_far.pairs);
    assert!(window.query_all_by_label("Position in the recording").next().is_some(), "it can be scrubbed");
}
