//! The whole way of an operator, by clicks in a window over the real engine: open a folder of
//! pairs, use them all, solve, accept, look at depth. The pairs are rendered for the test, so
//! the true geometry is known.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, WindowOptions};
use plumbline_engine::offline::{SampleArgs, write_sample};
use plumbline_engine::{Engine, EngineSettings};
use plumbline_model::Unattended;

type Window = Harness<'static, PlumblineWindow>;

/// Fewer than ten are doubted.
const PAIRS: usize = 11;
const PATIENCE: Duration = Duration::from_secs(120);

fn window(data_dir: &Path) -> Window {
    let data_dir = Some(data_dir.to_owned());
    Harness::builder().with_size([1280.0, 800.0]).build_eframe(|creation| {
        let engine = Engine::start(EngineSettings { data_dir, source: None, twin: None }, Arc::new(|| {}));
        PlumblineWindow::new(&creation.egui_ctx, Box::new(engine), WindowOptions::default())
    })
}

/// Draws frames until something holds.
fn until(window: &mut Window, what: &str, holds: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    loop {
        window.step();
        if holds(window) {
            return;
        }
        if start.elapsed() > PATIENCE {
            let view = window.state().view();
            panic!("waited in vain for {what}; jobs {:?}, messages {:?}", view.jobs, view.notices);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn click_once_there(window: &mut Window, label: &str) {
    until(window, label, |window| window.query_all_by_label(label).next().is_some());
    window.get_all_by_label(label).next().expect("just seen").click();
    window.run_steps(3);
}

/// Types a path into the field that has the focus, in place of what stands there.
fn type_over(window: &mut Window, path: &Path) {
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.run_steps(1);
    window.event(egui::Event::Text(path.to_str().expect("a path in letters").to_owned()));
    window.run_steps(2);
}

/// A click on a bar chooses the pair; dropping it asks for another solution.
fn drop_a_pair_and_take_it_back(window: &mut Window) {
    let pair = "pair_03.png";
    window.get_all_by_label_contains(&format!("{pair}, left eye")).next().expect("a bar").click();
    window.run_steps(3);
    click_once_there(window, &format!("Drop pair {pair}"));
    click_once_there(window, &format!("Solve {} pairs again", PAIRS - 1));
    until(window, "the solution without the pair", |window| {
        let view = window.state().view();
        let proposal = view.eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none());
        proposal.is_some_and(|proposal| proposal.calibration.per_pair.len() == PAIRS - 1)
    });
    click_once_there(window, &format!("Restore {pair}"));
    click_once_there(window, &format!("Solve {PAIRS} pairs again"));
    until(window, "the solution with the pair", |window| {
        let view = window.state().view();
        let proposal = view.eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none());
        proposal.is_some_and(|proposal| proposal.calibration.per_pair.len() == PAIRS)
    });
}

#[test]
fn from_a_folder_of_pairs_to_depth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = SampleArgs { out: folder.path().join("sample"), pairs: PAIRS, seed: 1 };
    let sample = write_sample(&args, &Unattended).expect("a folder that can be written");
    let mut window = window(&folder.path().join("data"));

    click_once_there(&mut window, "Open a folder of pairs…");
    type_over(&mut window, &sample.board);
    click_once_there(&mut window, "Open");

    click_once_there(&mut window, "Calibrate the eyes");
    click_once_there(&mut window, &format!("Use all {PAIRS} pairs of this folder"));
    click_once_there(&mut window, &format!("Solve {PAIRS} pairs"));

    // The result opens by itself, with a verdict in words.
    until(&mut window, "the verdict", |window| window.query_all_by_label_contains("Good:").next().is_some());
    let proposal = window.state().view().eyes.proposal.clone().expect("a verdict is on a proposal");
    let summary = proposal.calibration.summary.clone().expect("a solution has figures");
    assert!(summary.rms_stereo_px < 0.3, "{summary:?}");
    let baseline_m = proposal.calibration.cameras.baseline_m();
    assert!((baseline_m - 0.0699).abs() < 0.5e-3, "the rendered eyes are 69.9 mm apart, not {baseline_m} m");

    drop_a_pair_and_take_it_back(&mut window);

    click_once_there(&mut window, "Accept calibration");
    until(&mut window, "the calibration in use", |window| window.state().view().eyes.in_use.is_some());
    assert!(window.state().view().eyes.proposal.is_none());

    let exported = folder.path().join("exported.yaml");
    click_once_there(&mut window, "Accept");
    click_once_there(&mut window, "Plumbline file…");
    type_over(&mut window, &exported);
    click_once_there(&mut window, "Save");
    until(&mut window, "the exported file", |_| exported.is_file());

    click_once_there(&mut window, "Live");
    until(&mut window, "depth", |window| window.state().view().live.disparity.is_some());
    let rectified = window.query_all_by_label("Left").next().is_some();
    assert!(rectified, "the rectified pair is drawn");
}
