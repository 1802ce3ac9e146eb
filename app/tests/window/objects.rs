//! Objects on the Live screen: boxes, list, places, detectors, in every state.

use std::sync::Arc;

use egui::Key;
use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{DetectView, DetectorFacts, DetectorState};
use plumbline_engine::{Command, DetectCommand, DetectorChoice, LiveCommand, Products};
use plumbline_model::detection::ClassNames;

use crate::fake::{Fake, click, says, shows};
use crate::made_up_objects::{banana, detect, facts, found, live};

fn settings() -> WindowSettings {
    WindowSettings { screen: Screen::Live, ..WindowSettings::default() }
}

/// All of the inspector is seen.
const TALL: [f32; 2] = [1440.0, 1700.0];

fn wanted(sent: &[Command]) -> Vec<bool> {
    let want = |command: &Command| match command {
        Command::Live(LiveCommand::Want(Products { detections, .. })) => Some(*detections),
        _ => None,
    };
    sent.iter().filter_map(want).collect()
}

#[test]
fn the_list_says_what_is_where_and_a_click_tells_all() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    assert!(says(&window, "Tomato, 331, −118, 82 ± 4 mm"));
    assert!(says(&window, "Banana, only the left eye: no place"));
    assert!(says(&window, "network 38.2") && says(&window, "43.8 ms a pair"));
    click(&mut window, "Tomato, 331, −118, 82 ± 4 mm");
    assert!(says(&window, "Tomato, from the left eye: 452.0 ± 4.3 mm"), "distance");
    assert!(says(&window, "x: 331.0 ± 4.0 mm"), "place in the robot's frame");
    click(&mut window, "Banana, only the left eye: no place");
    assert!(says(&window, "one eye alone tells no range"));
    assert!(says(&window, "nothing of this kind"));
}

#[test]
fn a_leak_is_told_in_a_sentence() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    assert!(!says(&window, "240 mm behind it"));
    click(&mut window, "RightHand, 331, −118, 82 ± 4 mm");
    assert!(says(&window, "240 mm behind it"));
}

#[test]
fn key_b_hides_the_boxes_and_ends_detecting() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    window.key_press(Key::B);
    window.run_steps(3);
    assert_eq!(wanted(&fake.take_all_sent()).last(), Some(&false));
    assert!(!says(&window, "Tomato, 331"));
    click(&mut window, "Boxes");
    assert_eq!(wanted(&fake.take_all_sent()).last(), Some(&true));
    assert!(says(&window, "Tomato, 331"));
}

#[test]
fn chips_and_buttons_send_what_they_say() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    click(&mut window, "Show Banana");
    click(&mut window, "Count anew");
    click(&mut window, "Off");
    let hide = DetectCommand::Show { class: "Banana".to_owned(), shown: false };
    let expected: [Command; 3] =
        [hide.into(), DetectCommand::ResetRates.into(), DetectCommand::Use(DetectorChoice::Off).into()];
    assert_eq!(fake.take_sent(), expected);
}

#[test]
fn a_detector_file_is_asked_for() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    click(&mut window, "Choose a detector…");
    window.event(egui::Event::Text("best.onnx".to_owned()));
    window.run_steps(2);
    click(&mut window, "Open");
    let expected = DetectCommand::Use(DetectorChoice::File("best.onnx".into()));
    assert_eq!(fake.take_sent(), [Command::from(expected)]);
}

#[test]
fn names_that_disagree_stand_side_by_side() {
    let exchanged =
        ClassNames::new(["Banana", "Duck", "RightHand", "Mushroom", "Onion", "Orange", "LeftHand", "Tomato"]);
    let facts = DetectorFacts {
        other_names: Some((exchanged, "the data.yaml beside the file".to_owned())),
        ..facts()
    };
    let detect = DetectView { detector: DetectorState::Ready(Arc::new(facts)), ..detect() };
    let fake = Fake::over(live(detect));
    let window = fake.window_of_size(settings(), TALL);
    assert!(says(&window, "Check the classes: 2 of them are named differently"));
    assert!(says(&window, "≠"));
}

#[test]
fn every_state_of_the_detector_has_its_words() {
    let state = |detector| DetectView { detector, found: None, ..detect() };
    let name = || "best.onnx".to_owned();
    let failed = DetectorState::Failed { name: name(), why: "It is no ONNX file.".to_owned() };
    let cases = [
        (state(DetectorState::Off), "Detection is off."),
        (state(DetectorState::Loading { name: name() }), "Reading best.onnx"),
        (state(failed), "best.onnx cannot be used"),
        (DetectView { found: None, ..detect() }, "Looking at the first pair."),
        (DetectView { found: Some(Arc::new(found(vec![]))), ..detect() }, "Nothing was found on this pair."),
        (
            DetectView { failed: Some("The image is empty.".to_owned()), found: None, ..detect() },
            "The image is empty.",
        ),
        (
            DetectView { stale: Some("Boxes of 2.1 s before this picture.".to_owned()), ..detect() },
            "2.1 s before",
        ),
        (DetectView { refused: Some("CUDA is not here.".to_owned()), ..detect() }, "CUDA is not here."),
    ];
    for (detect, words) in cases {
        let fake = Fake::over(live(detect));
        let window = fake.window_of_size(settings(), TALL);
        assert!(says(&window, words), "{words}");
    }
}

#[test]
fn an_object_that_is_gone_is_said_to_be_gone() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    click(&mut window, "Tomato, 331, −118, 82 ± 4 mm");
    fake.show(live(DetectView { found: Some(Arc::new(found(vec![banana()]))), ..detect() }));
    window.run_steps(3);
    assert!(says(&window, "The tomato that was chosen is not seen on this pair."));
    fake.show(live(detect()));
    window.run_steps(3);
    assert!(says(&window, "x: 331.0 ± 4.0 mm"), "it is chosen again when it is back");
}

#[test]
fn boxes_are_drawn_in_both_themes() {
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for size in [[1280.0, 800.0], [3840.0, 2160.0]] {
            let fake = Fake::over(live(detect()));
            let window = fake.window_of_size(WindowSettings { theme, ..settings() }, size);
            assert!(shows(&window, "Left eye, as delivered"), "{theme:?} {size:?}");
        }
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_objects() {
    let folder = crate::fake::picture_folder();
    let exchanged =
        ClassNames::new(["Banana", "Duck", "RightHand", "Mushroom", "Onion", "Orange", "LeftHand", "Tomato"]);
    let differing = DetectorFacts {
        other_names: Some((exchanged, "the data.yaml beside the file".to_owned())),
        ..facts()
    };
    let failed = DetectorState::Failed {
        name: "best.onnx".to_owned(),
        why: "best.onnx is not a usable ONNX file (it is empty): export the detector again with format=onnx."
            .to_owned(),
    };
    let stale = Some("Boxes of 2.1 s before this picture: the detector does not keep up.".to_owned());
    let states = [
        ("found", detect(), true),
        ("names", DetectView { detector: DetectorState::Ready(Arc::new(differing)), ..detect() }, false),
        ("failed", DetectView { detector: failed, found: None, ..detect() }, false),
        ("stale", DetectView { stale, ..detect() }, true),
    ];
    for (name, detect, choose) in states {
        for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
            let fake = Fake::over(live(detect.clone()));
            let settings = WindowSettings { theme, ..settings() };
            let mut window = fake.window_with(settings, [1440.0, 1100.0], true);
            if choose {
                click(&mut window, "RightHand, 331, −118, 82 ± 4 mm");
            }
            window.run_steps(3);
            let image = window.render().expect("the test renderer draws");
            image
                .save(folder.join(format!("objects-{name}-{theme:?}.png")))
                .expect("a folder that can be written");
        }
    }
}
