//! An operator calibrates the arm on the touchscreen, by clicks in a window over the real engine
//! and the real twin: the screen is placed, targets are touched, models are trained on them, M3
//! is taken into use, and new targets are touched through it.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use std::time::Duration;

use egui_kittest::kittest::Queryable as _;
use plumbline_engine::models::Method;
use plumbline_engine::view::{StepState, TouchFigures, TouchPhase};
use plumbline_model::Point;
use plumbline_model::session::Session;
use plumbline_model::touch_plan::Finger;
use plumbline_tests::{
    Window, click, click_containing, for_a_while, type_over, until, view, window, window_of_size,
};

/// Waits for the end of a run; a run that a busy machine interrupted goes on by itself or by a click.
fn finish_run(window: &mut Window, what: &str) {
    const GO_ON: &str = "Go on with touch";
    until(window, what, |window| {
        matches!(view(window).touch.phase, TouchPhase::Running { .. } | TouchPhase::Paused { .. })
    });
    loop {
        until(window, what, |window| {
            view(window).touch.phase == TouchPhase::Finished
                || window.query_all_by_label_contains(GO_ON).next().is_some()
        });
        if view(window).touch.phase == TouchPhase::Finished {
            return;
        }
        if let Some(button) = window.query_all_by_label_contains(GO_ON).next() {
            button.click();
        }
        for_a_while(window, Duration::from_millis(300));
    }
}

fn figures(window: &Window) -> TouchFigures {
    view(window).touch.figures.expect("there are touches")
}

fn place_the_screen(window: &mut Window) {
    click_containing(window, "Plan to touch the corners");
    until(window, "the plan", |window| view(window).touch.phase == TouchPhase::Planned);
    assert!(view(window).touch.counts.touched == 0, "planning touches nothing");
    click_containing(window, "Touch the corners");
    finish_run(window, "the corners");
    until(window, "the place of the screen", |window| view(window).touch.placement_proposal.is_some());
    assert!(view(window).touch.placement.is_none(), "a proposal is not in use before it is accepted");
    click(window, "Use this place of the screen");
    until(window, "it in use", |window| view(window).touch.placement.is_some());
}

fn touch_targets(window: &mut Window) -> TouchFigures {
    click(window, "Quick");
    until(window, "the plan", |window| {
        let touch = &view(window).touch;
        touch.phase == TouchPhase::Planned
            && touch.plan.as_ref().is_some_and(|plan| plan.options.screen_heights_m.len() == 1)
    });
    let reachable = view(window).touch.plan.as_ref().expect("just seen").reachable;
    assert!(reachable >= 12, "only {reachable} in reach");
    click(window, &format!("Touch {reachable} targets"));

    // Paused in the middle, and gone on with.
    until(window, "three touches", |window| view(window).touch.counts.touched >= 3);
    click_containing(window, "Pause");
    until(window, "the pause", |window| matches!(view(window).touch.phase, TouchPhase::Paused { .. }));
    let done = view(window).touch.counts.touched;
    for_a_while(window, Duration::from_secs(2));
    assert_eq!(view(window).touch.counts.touched, done, "nothing goes on by itself");
    click_containing(window, "Go on with touch");
    finish_run(window, "the targets");

    let folder = view(window).touch.session.clone().expect("a run has a session");
    let session = Session::read(&folder).expect("a session that can be read");
    let rows = session.touches.as_ref().map_or(0, |table| table.row_count());
    assert_eq!(rows, view(window).touch.counts.touched, "every touch is on disk");
    figures(window)
}

fn train_and_use_m3(window: &mut Window) {
    // The touches measured the place of the screen once more; that waits in its tile, and nothing waits for it.
    click_containing(window, "Train models");
    click_containing(window, "Train M1, M2 and M3 on");
    until(window, "the models", |window| view(window).models.comparison.is_some());
    assert!(view(window).models.in_use.is_none(), "nothing is used before it is accepted");
    click(window, "Use M3");
    until(window, "M3 in use", |window| {
        view(window).models.in_use.as_ref().is_some_and(|model| model.method() == Method::M3)
    });
    until(window, "the map", |window| view(window).models.map.is_some());
    assert_eq!(view(window).models.step, StepState::Done);
    for errors in ["Before", "After"] {
        click(window, errors);
    }
}

#[test]
fn the_screen_is_placed_touched_learned_and_touched_better() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(&folder.path().join("data"), Some("lab"));
    until(&mut window, "the twin's joints", |window| view(window).robot.measured.is_some());
    click_containing(&mut window, "Touch");
    place_the_screen(&mut window);
    let before = touch_targets(&mut window);
    train_and_use_m3(&mut window);

    click_containing(&mut window, "Check M3 with new touches");
    until(&mut window, "the plan of the check", |window| {
        view(window).touch.phase == TouchPhase::Planned
            && view(window).touch.correct_with == Some(Method::M3.into())
    });
    let reachable = view(&window).touch.plan.as_ref().expect("just seen").reachable;
    click(&mut window, &format!("Touch {reachable} targets"));
    finish_run(&mut window, "the check");
    let after = figures(&window);
    println!("mean error {:.2} mm before, {:.2} mm with M3", before.mean_m * 1e3, after.mean_m * 1e3);
    assert!(after.mean_m < 0.6 * before.mean_m, "{before:?} {after:?}");
}

#[test]
fn the_left_finger_touches_the_glass() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(&folder.path().join("data"), Some("lab"));
    until(&mut window, "the twin's joints", |window| view(window).robot.measured.is_some());
    click(&mut window, "Touch");
    click(&mut window, "Quick");
    until(&mut window, "the plan", |window| view(window).touch.phase == TouchPhase::Planned);
    click(&mut window, "Left index finger");
    until(&mut window, "the other plan", |window| {
        let touch = &view(window).touch;
        let plan = touch.plan.as_ref().filter(|_| touch.phase == TouchPhase::Planned);
        plan.is_some_and(|plan| plan.options.finger == Finger::Left && plan.reachable >= 12)
    });
    assert!(window.query_all_by_label_contains("The left arm touches the glass").next().is_some());
    let right_arm = |window: &Window| {
        let view = view(window);
        let (rig, measured) = view.robot.rig.clone().zip(view.robot.measured.clone()).expect("connected");
        let chain = rig.chain(Finger::Right.tip()).expect("a tip");
        measured.of(chain.joints())
    };
    let before = right_arm(&window);
    let reachable = view(&window).touch.plan.as_ref().expect("just seen").reachable;
    click(&mut window, &format!("Touch {reachable} targets"));
    until(&mut window, "three touches", |window| view(window).touch.counts.touched >= 3);
    let turned = before.iter().zip(right_arm(&window)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(turned < 0.02, "the right arm stays, it turned by {turned} rad");
    let session = view(&window).touch.session.clone().expect("a run has a session");
    click_containing(&mut window, "Pause");
    until(&mut window, "the pause", |window| matches!(view(window).touch.phase, TouchPhase::Paused { .. }));
    let manifest = Session::read(&session).expect("a session that can be read").manifest;
    assert_eq!(manifest.chain.map(|chain| chain.tip).as_deref(), Some(Finger::Left.tip()));
}

/// Clicks that the screen stands as it was asked for, which nobody may be asked while a finger is over it.
fn put_the_screen(window: &mut Window, height_m: f64) {
    until(
        window,
        "to be asked for the screen",
        |window| matches!(view(window).touch.phase, TouchPhase::Waiting { prepare: Some((asked_m, _)), .. } if asked_m == height_m),
    );
    let view = view(window);
    let (rig, measured) = view.robot.rig.clone().zip(view.robot.measured.clone()).expect("connected");
    let tip = rig.chain(Finger::Right.tip()).expect("a tip").robot_from_tip_in(&measured).translation_m();
    let above_m = rig.touchscreen.height_above_m(Point::new(tip.x, tip.y, tip.z));
    assert!(above_m > 0.2, "the finger is {above_m} m above the glass");
    click(window, "Done, go on");
}

#[test]
fn the_screen_is_raised_once_the_finger_is_away_and_put_back_before_the_run_is_over() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // So high that the whole plan can be clicked without scrolling.
    let mut window = window_of_size(&folder.path().join("data"), Some("lab"), egui::vec2(1280.0, 1300.0));
    until(&mut window, "the twin's joints", |window| view(window).robot.measured.is_some());
    click(&mut window, "Touch");
    click_containing(&mut window, "Plan to touch the corners");
    until(&mut window, "the plan", |window| view(window).touch.phase == TouchPhase::Planned);
    click(&mut window, "Heights of the screen");
    type_over(&mut window, "0, 60");
    window.key_press(egui::Key::Enter);
    until(&mut window, "the plan on a block", |window| {
        let touch = &view(window).touch;
        let plan = touch.plan.as_ref().filter(|_| touch.phase == TouchPhase::Planned);
        plan.is_some_and(|plan| plan.options.screen_heights_m == [0.0, 0.06] && plan.reachable >= 6)
    });
    click_containing(&mut window, "Touch the corners");
    put_the_screen(&mut window, 0.06);
    put_the_screen(&mut window, 0.0);
    until(&mut window, "the end", |window| view(window).touch.phase == TouchPhase::Finished);
    let touch = view(&window).touch.clone();
    assert_eq!(touch.counts.touched, touch.plan.as_ref().expect("a plan").reachable, "{:?}", touch.counts);
    let session = Session::read(touch.session.as_ref().expect("its folder")).expect("readable");
    let heights: Vec<_> =
        session.touches.expect("touches").rows().filter_map(|row| row.screen_height_m).collect();
    assert!(heights.contains(&0.0) && heights.contains(&0.06), "{heights:?}");
}
