//! An operator labels a small data set, exports it and judges a detector on it, by clicks in a window
//! over the real engine.

#![allow(clippy::print_stdout, reason = "says why a part was skipped")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Key, Modifiers, Pos2, Rect};
use egui_kittest::kittest::Queryable as _;
use image::{Rgb, RgbImage};
use plumbline_engine::View;
use plumbline_engine::view::LabelState;
use plumbline_tests::{Beginning, Window, click, click_containing, type_over, until, view, window};
use plumbline_vision::detect::{DetectError, Detector, DetectorOptions};
use plumbline_vision::yolo_set::{Split, YoloSet};

/// Four scenes of two eyes, minutes apart, each with a bright square.
fn make_set(folder: &Path) {
    for part in ["images", "labels"] {
        std::fs::create_dir_all(folder.join(part)).expect("made");
    }
    let names = "names:\n  0: Banana\n  1: Duck\n  2: LeftHand\n";
    std::fs::write(folder.join("data.yaml"), format!("train: images\nval: images\n{names}"))
        .expect("written");
    for scene in 0..4u32 {
        for eye in ["left", "right"] {
            let square = |x: u32, y: u32| (15..25).contains(&x) && (26..34).contains(&y);
            let image = RgbImage::from_fn(64, 64, |x, y| {
                if square(x, y) { Rgb([250, 220, 40]) } else { Rgb([90, 80 + scene as u8, 70]) }
            });
            let name = format!("{eye}_{}.250000.png", 1_767_628_000 + 100 * scene);
            image.save(folder.join("images").join(name)).expect("written");
        }
    }
}

fn open(window: &mut Window, folder: &Path) {
    click(window, "Detect");
    click(window, "Open a data set…");
    type_over(window, folder);
    click(window, "Open");
    until(window, "the first image", |window| {
        view(window).labels.shown.as_ref().is_some_and(|shown| matches!(shown.pixels, Some(Ok(_))))
    });
    window.run_steps(3);
}

/// The picture on the screen: the image fits the canvas.
fn canvas(window: &Window) -> Rect {
    let name = view(window).labels.shown.as_ref().expect("an image is shown").name.clone();
    let whole = window.get_by_label(&format!("Boxes of {name}")).rect();
    let side = whole.width().min(whole.height());
    Rect::from_center_size(whole.center(), egui::vec2(side, side))
}

/// Draws a box by dragging, in pixels of the image of 64 × 64.
fn drag(window: &mut Window, from: [f32; 2], to: [f32; 2]) {
    let canvas = canvas(window);
    let at = |[x, y]: [f32; 2]| -> Pos2 {
        canvas.min + egui::vec2(x / 64.0 * canvas.width(), y / 64.0 * canvas.height())
    };
    window.hover_at(at(from));
    window.run_steps(1);
    window.drag_at(at(from));
    window.run_steps(2);
    for part in [0.3, 0.7, 1.0] {
        let between = [0, 1].map(|i| from[i] + part * (to[i] - from[i]));
        window.hover_at(at(between));
        window.run_steps(1);
    }
    window.drop_at(at(to));
    window.run_steps(2);
}

fn boxes(window: &Window) -> usize {
    view(window).labels.shown.as_ref().map_or(0, |shown| shown.boxes.len())
}

/// What is on disk for the shown image.
fn on_disk(window: &Window, folder: &Path) -> String {
    let name = view(window).labels.shown.as_ref().expect("an image is shown").name.clone();
    std::fs::read_to_string(folder.join(format!("labels/{name}.txt"))).unwrap_or_default()
}

fn until_on_disk(window: &mut Window, folder: &Path, what: &str, holds: impl Fn(&str) -> bool) {
    until(window, what, |window| holds(&on_disk(window, folder)));
}

#[test]
fn boxes_are_drawn_corrected_taken_back_copied_and_exported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let set = folder.path().join("toys");
    make_set(&set);
    let beginning = Beginning::of(folder.path());
    let mut window = window(&folder.path().join("data"), None);
    open(&mut window, &set);

    drag(&mut window, [15.0, 26.0], [25.0, 34.0]);
    until(&mut window, "the box", |window| boxes(window) == 1);
    until_on_disk(&mut window, &set, "the box on disk", |text| text.starts_with("0 "));
    let drawn: Vec<f32> = on_disk(&window, &set)
        .split_whitespace()
        .skip(1)
        .map(|part| part.parse().expect("a number"))
        .collect();
    for (part, wanted) in drawn.iter().zip([20.0, 30.0, 10.0, 8.0]) {
        assert!((part * 64.0 - wanted).abs() < 0.5, "{drawn:?}");
    }

    // The new box is chosen: a number key changes its class.
    window.key_press(Key::Num2);
    until_on_disk(&mut window, &set, "the other class", |text| text.starts_with("1 "));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until_on_disk(&mut window, &set, "undo", |text| text.starts_with("0 "));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until(&mut window, "no box", |window| boxes(window) == 0);
    until(&mut window, "no label file", |window| {
        let labels = &view(window).labels;
        labels.images[0].state == LabelState::Unlabeled && on_disk(window, &set).is_empty()
    });
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    until_on_disk(&mut window, &set, "redo", |text| text.starts_with("0 "));
    // The disk may know of it before the window does.
    until(&mut window, "the box in the window", |window| boxes(window) == 1);

    // Moved by a drag in its middle.
    drag(&mut window, [20.0, 30.0], [30.0, 40.0]);
    until_on_disk(&mut window, &set, "the moved box", |text| {
        let middle = text.split_whitespace().nth(1).and_then(|part| part.parse::<f32>().ok());
        middle.is_some_and(|middle| (middle * 64.0 - 30.0).abs() < 0.7)
    });
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until_on_disk(&mut window, &set, "the box where it was drawn", |text| {
        let middle = text.split_whitespace().nth(1).and_then(|part| part.parse::<f32>().ok());
        middle.is_some_and(|middle| (middle * 64.0 - 20.0).abs() < 0.7)
    });

    // Every further image gets the boxes of the one before.
    for _ in 1..8 {
        let before = view(&window).labels.shown.as_ref().map(|shown| shown.index);
        window.key_press(Key::ArrowRight);
        until(&mut window, "the next image", |window| {
            let labels = &view(window).labels;
            labels.shown.as_ref().map(|shown| shown.index) != before
                && labels
                    .shown
                    .as_ref()
                    .is_some_and(|shown| shown.can_copy && matches!(shown.pixels, Some(Ok(_))))
        });
        window.key_press(Key::C);
        until_on_disk(&mut window, &set, "the copied box", |text| text.starts_with("0 "));
    }
    until(&mut window, "all images labeled", |window| view(window).labels.counts.labeled == 8);

    let export = folder.path().join("export");
    click_containing(&mut window, "Export…");
    type_over(&mut window, &export);
    click(&mut window, "Save");
    until(&mut window, "the export", |window| {
        view(window).labels.working.is_none() && export.join("data.yaml").is_file()
    });
    let written = YoloSet::read_all(&export.join("data.yaml")).expect("a good data set");
    assert_eq!(written.names.to_string(), "Banana, Duck, LeftHand");
    let of = |split| written.images.iter().filter(move |image| image.split == Some(split)).count();
    assert_eq!((of(Split::Train), of(Split::Val)), (6, 2), "whole scenes");
    beginning.leads_to_what_is_shown(window, |_| {}).ends_otherwise_an_hour_later();
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/vision/tests/detectors").join(name)
}

/// Labels that the tiny detector finds in part: a banana at 15–25, 26–34.
fn label(set: &Path, images: usize) {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(set.join("images")).expect("there").flatten().map(|entry| entry.path()).collect();
    files.sort();
    for image in files.iter().take(images) {
        let name = image.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = "0 0.3125 0.46875 0.15625 0.125\n1 0.1 0.1 0.1 0.1\n";
        std::fs::write(set.join(format!("labels/{name}.txt")), text).expect("written");
    }
}

/// How long a network takes on this machine is measured anew each time.
fn without_times(view: &mut View) {
    let scores = Arc::make_mut(&mut view.scores);
    let Some(table) = &mut scores.table else { return };
    for scores in Arc::make_mut(table).rows.iter_mut().flat_map(|row| &mut row.scores) {
        scores.times_ms = [0.0; 3];
    }
}

#[test]
fn a_detector_is_judged_and_a_cell_opens_its_images() {
    let model = fixture("raw.onnx");
    if let Err(DetectError::NoLibrary { .. }) = Detector::open(&model, &DetectorOptions::default()) {
        return plumbline_model::measured_data::left_out("ONNX Runtime is not installed");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let set = folder.path().join("toys");
    make_set(&set);
    label(&set, 8);
    let beginning = Beginning::of(folder.path());
    let mut window = window(&folder.path().join("data"), None);
    click(&mut window, "Detect");
    click(&mut window, "Scores");
    click_containing(&mut window, "Choose…");
    type_over(&mut window, &set);
    click(&mut window, "Open");
    click(&mut window, "Add a detector…");
    type_over(&mut window, &model);
    click(&mut window, "Open");
    until(&mut window, "the detector in the list", |window| {
        view(window).scores.models.iter().any(|listed| listed.file == model && listed.chosen)
    });
    click(&mut window, "Evaluate");
    until(&mut window, "the table", |window| view(window).scores.table.is_some());
    let table = view(&window).scores.table.clone().expect("just seen");
    let row = table.rows.iter().find(|row| row.model == "raw").expect("a row of it");
    let scores = row.scores.as_ref().expect("it could be judged");
    assert_eq!(scores.confusion[0][0], 8, "every banana is found");
    assert_eq!(scores.confusion[1][3], 8, "no duck is found where it is");

    let place = table.rows.iter().position(|row| row.model == "raw").expect("a row of it");
    if place > 0 {
        click(&mut window, "raw");
    }
    click(&mut window, "Duck missed: 8");
    until(&mut window, "the images of the cell", |window| {
        view(window).scores.cell.as_ref().is_some_and(|cell| cell.pictures.len() == 8)
    });
    click_containing(&mut window, "Image left_1767628000");
    until(&mut window, "the large picture", |window| view(window).scores.picture == Some(0));
    assert!(window.query_all_by_label_contains("Large picture of left_1767628000").next().is_some());

    let csv = folder.path().join("scores.csv");
    click(&mut window, "Export CSV…");
    type_over(&mut window, &csv);
    click(&mut window, "Save");
    until(&mut window, "the table on disk", |_| csv.is_file());
    let text = std::fs::read_to_string(&csv).expect("written");
    assert!(text.lines().any(|line| line.starts_with("raw,Banana,")), "{text}");
    beginning.leads_to_what_is_shown(window, without_times);
}
