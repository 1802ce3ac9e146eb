//! Objects on the Live screen, by clicks in a window over the real engine and real networks: a
//! detector is chosen, its boxes are there, a threshold moves at once on a picture that stands
//! still, and detectors that are none or that throw leave the rest as it is.

use std::path::{Path, PathBuf};

use egui_kittest::kittest::Queryable as _;
use image::{Rgb, RgbImage};
use plumbline_engine::view::DetectorState;
use plumbline_tests::{Window, click, type_over, until, view, window};

fn network(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/vision/tests/detectors").join(name)
}

/// Two pairs of small pictures.
fn pictures(folder: &Path) -> PathBuf {
    for eye in ["left", "right"] {
        let side = folder.join("pairs").join(eye);
        std::fs::create_dir_all(&side).expect("a folder that can be written");
        for (name, red) in [("a.png", 200), ("b.png", 90)] {
            RgbImage::from_pixel(64, 64, Rgb([red, 120, 40])).save(side.join(name)).expect("written");
        }
    }
    folder.join("pairs")
}

/// Waits until the detector that was asked for before is there or refused: what stands in the
/// inspector moves then.
fn settled(window: &mut Window) {
    until(window, "the detector to settle", |window| {
        let detect = &view(window).detect;
        let settled = !matches!(detect.detector, DetectorState::None | DetectorState::Loading { .. });
        settled
            && detect.opening.is_none()
            && (detect.facts().is_none() || detect.found.is_some() || detect.failed.is_some())
    });
    window.run_steps(3);
}

/// Clicks what may have to be scrolled to.
fn reach(window: &mut Window, label: &str) {
    until(window, label, |window| window.query_all_by_label(label).next().is_some());
    // What was clicked before may still change what stands above.
    window.run_steps(10);
    window.get_all_by_label(label).next().expect("just seen").scroll_to_me();
    window.run_steps(20);
    click(window, label);
}

fn choose(window: &mut Window, file: &Path) {
    settled(window);
    reach(window, "Choose a detector…");
    type_over(window, file);
    click(window, "Open");
}

fn boxes(window: &Window) -> usize {
    view(window).detect.found.as_ref().map_or(0, |found| found.objects.len())
}

fn says(window: &Window, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

#[allow(clippy::print_stdout, reason = "says why it was skipped")]
#[test]
fn detectors_are_chosen_tried_and_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pairs = pictures(folder.path());
    let mut window = window(&folder.path().join("data"), None);
    click(&mut window, "Open a folder of pairs…");
    type_over(&mut window, &pairs);
    click(&mut window, "Open");
    until(&mut window, "a picture", |window| view(window).live.raw.is_some());

    choose(&mut window, &network("raw.onnx"));
    until(&mut window, "the detector, or why there is none", |window| {
        let detect = &view(window).detect;
        matches!(&detect.detector, DetectorState::Ready(facts) if facts.name == "raw.onnx")
            || matches!(&detect.detector, DetectorState::Failed { name, .. } if name == "raw.onnx")
    });
    if let DetectorState::Failed { why, .. } = &view(&window).detect.detector {
        assert!(why.contains("ONNX Runtime") && why.contains("./plumbline setup"), "{why}");
        assert!(view(&window).live.raw.is_some(), "the pictures go on");
        plumbline_model::measured_data::left_out(why);
        return;
    }
    // Three things in either eye; nothing is paired without a calibration.
    until(&mut window, "boxes", |window| boxes(window) == 6);
    let found = view(&window).detect.found.clone().expect("just seen");
    assert!(found.no_places_because.as_ref().is_some_and(|why| why.contains("calibrat")), "{found:?}");
    assert!(found.timing.network.as_nanos() > 0, "{:?}", found.timing);

    // A class less, at once, on a picture that stands still.
    let first = found.objects[0].name.clone();
    reach(&mut window, &format!("Show {first}"));
    until(&mut window, "the others", |window| boxes(window) == 4);
    reach(&mut window, "Show all classes");
    until(&mut window, "all again", |window| boxes(window) == 6);

    // What is no detector is refused, and the one in use goes on.
    let text = folder.path().join("text.onnx");
    std::fs::write(&text, "this is no network").expect("written");
    choose(&mut window, &text);
    until(&mut window, "the reason", |window| says(window, "not a usable ONNX file"));
    assert_eq!(boxes(&window), 6);

    // Names that disagree cannot be missed.
    let named = folder.path().join("named.onnx");
    std::fs::copy(network("raw.onnx"), &named).expect("copied");
    let mut names: Vec<String> = found.names.iter().map(|(_, name)| format!("'{name}'")).collect();
    names.reverse();
    std::fs::write(folder.path().join("data.yaml"), format!("names: [{}]\n", names.join(", ")))
        .expect("written");
    choose(&mut window, &named);
    until(&mut window, "both lists", |window| says(window, "Check the classes"));

    // One that throws on every image says so; pictures and window go on.
    choose(&mut window, &network("throwing.onnx"));
    until(&mut window, "what it says", |window| view(window).detect.failed.is_some());
    assert!(view(&window).live.raw.is_some() && boxes(&window) == 0);
    settled(&mut window);
    reach(&mut window, "Off");
    until(&mut window, "no detector", |window| view(window).detect.detector == DetectorState::Off);
}
