//! Objects on the Live screen: boxes, list, places, detectors, in every state.

use std::sync::Arc;

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    DetectView, DetectorFacts, DetectorState, ObjectPlaceView, ObjectView, SeenBox,
};
use plumbline_engine::{Command, DetectCommand, DetectorChoice, LiveCommand, Products};
use plumbline_model::Point;
use plumbline_model::detection::{ClassNames, PixelBox};

use crate::fake::{Fake, click, says, shows};
use crate::made_up_objects::{banana, detect, facts, found, hand, live, tomato};

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
    assert!(says(&window, "Tomato, 331, −118, 82 ± 9 mm"));
    assert!(says(&window, "Banana, only the left eye: no place"));
    assert!(says(&window, "network 38, after") && says(&window, "43.8 ms a pair"));
    click(&mut window, "Tomato, 331, −118, 82 ± 9 mm");
    assert!(says(&window, "Tomato, from the left eye: 452.0 ± 8.4 mm"), "distance");
    assert!(says(&window, "x: 331.0 ± 7.8 mm"), "place in the robot's frame");
    click(&mut window, "Banana, only the left eye: no place");
    assert!(says(&window, "one eye alone tells no range"));
    assert!(says(&window, "nothing of this kind"));
}

#[test]
fn a_place_that_rests_on_what_nobody_measured_says_why_its_uncertainty_is_wide() {
    let why = "The ± is wide because nobody measured how the eyes sit in the head.";
    let unmeasured = |object: ObjectView| {
        let place = object.place.clone().map(|place| ObjectPlaceView { wide_because: Some(why), ..place });
        ObjectView { place, ..object }
    };
    for (object, is_told) in [(unmeasured(tomato()), true), (tomato(), false)] {
        let fake = Fake::over(live(DetectView { found: Some(Arc::new(found(vec![object]))), ..detect() }));
        let mut window = fake.window_of_size(settings(), TALL);
        click(&mut window, "Tomato, 331, −118, 82 ± 9 mm");
        assert_eq!(says(&window, why), is_told);
    }
}

#[test]
fn a_thing_of_known_shape_is_said_to_be_where_it_stands_and_what_the_eyes_alone_say() {
    let stands = tomato().place.ok().map(|place| ObjectPlaceView {
        point_in_robot: Point::new(0.325, -0.116, 0.077),
        sigma_m: [0.002, 0.001, 0.002],
        covariance_m2: nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(4e-6, 1e-6, 4e-6)),
        ..place
    });
    let fake = Fake::over(live(DetectView {
        found: Some(Arc::new(found(vec![ObjectView { stands, ..tomato() }]))),
        ..detect()
    }));
    let mut window = fake.window_of_size(settings(), TALL);
    click(&mut window, "Tomato, 325, −116, 77 ± 5 mm");
    assert!(says(&window, "x: 325.0 ± 3.9 mm") && !says(&window, "x: 331.0"));
    assert!(says(&window, "By its outline, standing on the table."));
    assert!(says(&window, "alone say 8.1 ± 8.4 mm beside"));
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    click(&mut window, "Tomato, 331, −118, 82 ± 9 mm");
    assert!(
        says(&window, "By its pixels and boxes in both eyes.") && !says(&window, "standing on the table")
    );
}

/// This object where the eyes see it now, pixels, and how sure they are.
fn seen_at(object: ObjectView, across_px: f32, confidence: f32) -> ObjectView {
    let area = PixelBox::from_middle(across_px, 240.0, 60.0, 60.0);
    let moved = |seen: &Option<SeenBox>| seen.clone().map(|seen| SeenBox { confidence, area, ..seen });
    ObjectView { left: moved(&object.left), right: moved(&object.right), ..object }
}

/// The lines of the list from top to bottom.
fn listed(window: &Harness<'_, PlumblineWindow>) -> Vec<String> {
    let rows = window.query_all_by_role(egui::accesskit::Role::ListBoxOption);
    let mut named: Vec<_> = rows
        .map(|row| (row.rect().top(), row.accesskit_node().label().unwrap_or_default()))
        .filter(|(_, label)| ["Banana", "Right hand", "Tomato"].iter().any(|name| label.starts_with(name)))
        .collect();
    named.sort_by(|a, b| a.0.total_cmp(&b.0));
    named.into_iter().map(|(_, label)| label).collect()
}

#[test]
fn lines_stay_where_they_are_when_another_object_becomes_the_surest() {
    let pair = |objects| live(DetectView { found: Some(Arc::new(found(objects))), ..detect() });
    let fake = Fake::over(pair(vec![seen_at(tomato(), 100.0, 0.9), hand(), banana()]));
    let mut window = fake.window_of_size(settings(), TALL);
    window.run_steps(2);
    let before = listed(&window);
    let begins = |names: &[&str], lines: &[String]| {
        names.len() == lines.len() && names.iter().zip(lines).all(|(name, line)| line.starts_with(name))
    };
    assert!(
        begins(&["Banana", "Right hand", "Tomato, 331"], &before),
        "by class, not by confidence: {before:?}"
    );
    // Another tomato comes, surer and farther left; the first one moves a little.
    let left_eye_alone = ObjectView { right: None, place: banana().place, ..tomato() };
    let newcomer = seen_at(left_eye_alone, 20.0, 0.95);
    fake.show(pair(vec![newcomer, banana(), hand(), seen_at(tomato(), 104.0, 0.5)]));
    window.run_steps(3);
    let after = listed(&window);
    let wanted = ["Banana", "Right hand", "Tomato, 331", "Tomato, only the left eye"];
    assert!(begins(&wanted, &after), "the first tomato keeps its line: {after:?}");
}

#[test]
fn a_leak_is_told_in_a_sentence() {
    let fake = Fake::over(live(detect()));
    let mut window = fake.window_of_size(settings(), TALL);
    assert!(!says(&window, "240 mm behind it"));
    click(&mut window, "Right hand, 331, −118, 82 mm, doubtful");
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
    click(&mut window, "Tomato, 331, −118, 82 ± 9 mm");
    fake.show(live(DetectView { found: Some(Arc::new(found(vec![banana()]))), ..detect() }));
    window.run_steps(3);
    assert!(says(&window, "The tomato that was chosen is not seen on this pair."));
    fake.show(live(detect()));
    window.run_steps(3);
    assert!(says(&window, "x: 331.0 ± 7.8 mm"), "it is chosen again when it is back");
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
                click(&mut window, "Right hand, 331, −118, 82 mm, doubtful");
            }
            window.run_steps(3);
            let image = window.render().expect("the test renderer draws");
            image
                .save(folder.join(format!("objects-{name}-{theme:?}.png")))
                .expect("a folder that can be written");
        }
    }
}
