//! The screen Drift by clicks in a window over the real engine and the real twin: the eyes warm up twenty times as
//! fast as a clock, what they turn is explained by name, corrected and taken back, and a thing is laid on the grid.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use egui_kittest::kittest::Queryable as _;
use plumbline_engine::view::{DriftVerdict, GridDoing, SourceStatus};
use plumbline_model::Session;
use plumbline_tests::{Window, click, click_containing, eye_renderer, until, view, window};

/// What a scrolled tile hides comes into view first.
fn click_in_tile(window: &mut Window, label: &str) {
    until(window, label, |window| window.query_all_by_label(label).next().is_some());
    if let Some(node) = window.query_all_by_label(label).next() {
        node.scroll_to_me();
    }
    window.run_steps(8);
    click(window, label);
}

fn watched_s(window: &Window) -> f64 {
    let view = view(window);
    let course = view.drift.course.as_ref();
    course.and_then(|course| course.points.last()).map_or(0.0, |point| point.at_s)
}

fn far_mm(window: &Window) -> f64 {
    let view = view(window);
    let course = view.drift.course.as_ref();
    course.and_then(|course| course.points.last()).map_or(0.0, |point| 1e3 * point.off_m[2])
}

fn watch(window: &mut Window) {
    click_containing(window, "Drift");
    click(window, "Start watching");
    click(window, "Twin");
    click_in_tile(window, "×20");
    until(window, "the clock of the eyes to run", |window| view(window).twin.warm_up_pace > 19.0);
    until(window, "twelve minutes", |window| watched_s(window) > 720.0);
    let course = view(window).drift.course.clone().expect("watched");
    assert!(matches!(course.verdict, DriftVerdict::Warming { .. }), "{}", course.sentence);
    assert!(course.from_switching_on && far_mm(window) > 15.0, "{}", course.sentence);
    click_in_tile(window, "×1");
}

fn explain_and_correct(window: &mut Window) {
    let before_mm = far_mm(window);
    click(window, "Explain");
    until(window, "a name", |window| {
        let gap = view(window).gap.clone();
        gap.shown.is_some() && gap.searching.is_none()
    });
    click(window, "Correct from now on");
    until(window, "the correction", |window| {
        let view = view(window);
        !view.gap.model.effects.is_empty() && !view.drift.is_busy && far_mm(window) < 0.3 * before_mm
    });
    println!("{before_mm:.1} mm at the far end, corrected {:.1} mm", far_mm(window));
    click_containing(window, "Undo: ");
    until(window, "the model before", |window| {
        let view = view(window);
        view.gap.model.effects.is_empty() && !view.drift.is_busy && far_mm(window) > 0.7 * before_mm
    });
}

fn evaluate(window: &mut Window) {
    click(window, "9×4 evaluation");
    click_in_tile(window, "Begin 36 places");
    until(window, "three places", |window| {
        view(window).drift.grid.run.as_ref().is_some_and(|run| run.place > 3 && run.session.is_some())
    });
    click_in_tile(window, "End");
    until(window, "both figures", |window| {
        let grid = view(window).drift.grid.clone();
        let ended = grid.run.as_ref().is_some_and(|run| run.doing == GridDoing::Ended);
        let judged =
            |k: usize| grid.figures[k].as_ref().is_some_and(|figure| matches!(figure.judged, Some(Ok(_))));
        ended && judged(0) && judged(1)
    });
    let run = view(window).drift.grid.run.clone().expect("just seen");
    let session = Session::read(&run.session.expect("on disk")).expect("a session that can be read");
    let rows = session.localizations.expect("what was measured");
    assert!(rows.row_count() >= 3, "{}", rows.row_count());
    let first = rows.row(0).expect("a row");
    assert!(first.t_secs.is_some() && first.group.as_deref() == Some("1"), "{first:?}");
    assert!(
        window.query_all_by_label_contains("Mean ").next().is_some(),
        "the figures say how far off places are"
    );
}

#[test]
fn warming_up_is_watched_explained_corrected_and_taken_back() {
    if eye_renderer().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(folder.path(), Some("lab"));
    until(&mut window, "the twin's eyes", |window| {
        let view = view(window);
        view.source.status == SourceStatus::Running && view.robot.measured.is_some()
    });
    watch(&mut window);
    explain_and_correct(&mut window);
    evaluate(&mut window);
}
