//! A newcomer commissions a twin by one button alone: from just switched on to the first good grasp, in a
//! window over the real engine and the real twin.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline_engine::view::{CommissionFigure, CommissionStep};
use plumbline_tests::{Window, click, eye_renderer, until, view, window};

/// The touches alone take minutes: the twin's clock is the real one.
const LONGEST: Duration = Duration::from_secs(3000);

/// From the first start to an accepted model.
const MOST_CLICKS: usize = 45;

/// Views of the board: in the hand, and as it lies on the table.
const MOST_VIEWS: usize = 20;

/// After the first good grasp it is looked once more so much later, s of the twin.
const LATER_S: f64 = 10.0;

/// The button that leads on, if it can be pressed just now.
fn next(window: &Window) -> Option<String> {
    let mut found = window.query_all_by_label_contains("Next: ");
    let node = found.find(|node| !node.accesskit_node().is_disabled())?;
    node.accesskit_node().label()
}

fn commission(scenario: &str) {
    if eye_renderer().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    // What was commissioned can be kept, for `plumbline grasp-trials --lab`.
    let kept = std::env::var_os("PLUMBLINE_KEEP_LAB").map(PathBuf::from);
    let data = kept.unwrap_or_else(|| folder.path().join("data"));
    let mut window = window(&data, Some(scenario));
    until(&mut window, "the twin's joints", |window| view(window).robot.measured.is_some());
    until(&mut window, "what was done before", |window| view(window).commission.is_known);
    assert!(view(&window).commission.is_untouched());
    click(&mut window, "Commission");

    let began = Instant::now();
    let mut pressed: Vec<String> = vec![];
    // Clicks until a model is in use, the one that opened commissioning among them.
    let mut until_model = None;
    loop {
        until(&mut window, "the next button", |window| next(window).is_some() || began.elapsed() > LONGEST);
        assert!(began.elapsed() < LONGEST, "{pressed:#?}, {:?}", view(&window).notices);
        let label = next(&window).expect("just seen");
        println!("{:6.1} s  {label}", began.elapsed().as_secs_f64());
        if label == "Next: finish" {
            break;
        }
        // The same again and again leads nowhere.
        let last = pressed.iter().rev().take_while(|earlier| **earlier == label).count();
        assert!(last < 4, "{pressed:#?}, {:?}", view(&window).notices);
        pressed.push(label.clone());
        click(&mut window, &label);
        if until_model.is_none() && view(&window).commission.of(CommissionStep::Effects).is_some() {
            until_model = Some(1 + pressed.len());
        }
        // It is gray once it was pressed; then what was asked for shows, or it can be pressed again.
        until(&mut window, "the press", |window| next(window).is_none());
    }

    let done = view(&window).commission.clone();
    for step in CommissionStep::ALL {
        println!("{step:?}: {:?}", done.of(step));
    }
    let spent = done.spent;
    println!(
        "{scenario}: {:.1} min, {} touches, {} views, {} presses",
        spent.time.as_secs_f64() / 60.0,
        spent.touches,
        spent.views,
        pressed.len()
    );
    assert!(done.is_done());
    println!("{until_model:?} clicks from the first start to an accepted model");
    assert!(until_model.is_some_and(|clicks| clicks <= MOST_CLICKS), "{until_model:?}: {pressed:#?}");
    let held = done.of(CommissionStep::Grasp).map(|done| done.figure.clone());
    assert_eq!(held, Some(CommissionFigure::Held("Tomato".to_owned())));
    let attempt = view(&window).grasp.attempts.first().cloned().expect("it was grasped");
    assert!(attempt.told == Some(true) && attempt.is_success());
    // A person's word may be wrong: what is held does not stand on the table.
    let height_m = |window: &Window| {
        let toys = view(window).twin.toys.clone();
        toys.iter().find(|toy| toy.name == "tomato").and_then(|toy| toy.place).map(|at| at.coords.z)
    };
    assert!(height_m(&window).is_some_and(|height_m| height_m > 0.1), "{:?}", height_m(&window));
    // And stays in the hand.
    let now_s = view(&window).twin.time_s;
    until(&mut window, "ten seconds of the twin", |window| view(window).twin.time_s >= now_s + LATER_S);
    assert!(height_m(&window).is_some_and(|height_m| height_m > 0.1), "{:?}", height_m(&window));
    assert!(spent.touches == 25 && (16..=MOST_VIEWS).contains(&spent.views), "{spent:?}");

    click(&mut window, "Next: finish");
    until(&mut window, "its end", |window| !view(window).commission.is_on);
    assert!(view(&window).commission.is_done(), "what was done stays done");
}

#[test]
#[ignore = "takes a quarter of an hour: touches and grasps take as long as the robot's"]
fn a_perfect_twin_is_commissioned_by_the_next_button_alone() {
    commission("perfect");
}

#[test]
#[ignore = "takes a quarter of an hour: touches and grasps take as long as the robot's"]
fn a_twin_like_the_lab_is_commissioned_by_the_next_button_alone() {
    // Or another one, of a scenario file.
    let scenario = std::env::var("PLUMBLINE_SCENARIO").unwrap_or_else(|_| "lab".to_owned());
    commission(&scenario);
}
