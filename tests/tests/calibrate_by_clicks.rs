//! The whole way of an operator, by clicks in a window over the real engine: open a folder of
//! pairs, use them all, solve, accept, look at depth. The pairs are rendered for the test, so
//! the true geometry is known.

use egui_kittest::kittest::Queryable as _;
use plumbline_model::Unattended;
use plumbline_offline::{SampleArgs, write_sample};
use plumbline_tests::{Window, click, type_over, until, view, window};

/// Fewer than ten are doubted.
const PAIRS: usize = 11;

/// A click on a bar chooses the pair; dropping it asks for another solution.
fn drop_a_pair_and_take_it_back(window: &mut Window) {
    let pair = "pair_03.png";
    window.get_all_by_label_contains(&format!("{pair}, left eye")).next().expect("a bar").click();
    window.run_steps(3);
    click(window, &format!("Drop pair {pair}"));
    click(window, &format!("Solve {} pairs again", PAIRS - 1));
    until(window, "the solution without the pair", |window| {
        let view = view(window);
        let proposal = view.eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none());
        proposal.is_some_and(|proposal| proposal.calibration.per_pair.len() == PAIRS - 1)
    });
    click(window, &format!("Restore {pair}"));
    click(window, &format!("Solve {PAIRS} pairs again"));
    until(window, "the solution with the pair", |window| {
        let view = view(window);
        let proposal = view.eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none());
        proposal.is_some_and(|proposal| proposal.calibration.per_pair.len() == PAIRS)
    });
}

#[test]
fn from_a_folder_of_pairs_to_depth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = SampleArgs { out: folder.path().join("sample"), pairs: PAIRS, seed: 1 };
    let sample = write_sample(&args, &Unattended).expect("a folder that can be written");
    let mut window = window(&folder.path().join("data"), None);

    click(&mut window, "Open a folder of pairs…");
    type_over(&mut window, &sample.board);
    click(&mut window, "Open");

    click(&mut window, "Calibrate the eyes");
    click(&mut window, &format!("Use all {PAIRS} pairs of this folder"));
    click(&mut window, &format!("Solve {PAIRS} pairs"));

    // The result opens by itself, with a verdict in words.
    until(&mut window, "the verdict", |window| window.query_all_by_label_contains("Good:").next().is_some());
    let proposal = view(&window).eyes.proposal.clone().expect("a verdict is on a proposal");
    let summary = proposal.calibration.summary.clone().expect("a solution has figures");
    assert!(summary.rms_stereo_px < 0.3, "{summary:?}");
    let baseline_m = proposal.calibration.cameras.baseline_m();
    assert!((baseline_m - 0.0699).abs() < 0.5e-3, "the rendered eyes are 69.9 mm apart, not {baseline_m} m");

    drop_a_pair_and_take_it_back(&mut window);

    click(&mut window, "Accept calibration");
    until(&mut window, "the calibration in use", |window| view(window).eyes.in_use.is_some());
    assert!(view(&window).eyes.proposal.is_none());

    let exported = folder.path().join("exported.yaml");
    click(&mut window, "Accept");
    click(&mut window, "Plumbline file…");
    type_over(&mut window, &exported);
    click(&mut window, "Save");
    until(&mut window, "the exported file", |_| exported.is_file());

    click(&mut window, "Live");
    until(&mut window, "depth", |window| view(window).live.disparity.is_some());
    let rectified = window.query_all_by_label("Left").next().is_some();
    assert!(rectified, "the rectified pair is drawn");
}
