//! An operator grasps a thing, by clicks in a window over the real engine and the real twin: chooses,
//! plans, grasps, says what was seen.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable as _;
use plumbline_engine::view::{GraspOutcome, GraspPhase, GraspStep, LampState};
use plumbline_tests::{Window, click, click_containing, eye_renderer, for_a_while, until, view, window};

/// What is held is higher than it stood by more than this, m…
const LIFTED_M: f64 = 0.04;
/// …and so long after the window has said so, s of the twin.
const LATER_S: f64 = 10.0;

/// Height of the tomato's middle, as the twin's physics have it.
fn tomato_m(window: &Window) -> Option<f64> {
    let toys = view(window).twin.toys.clone();
    toys.iter().find(|toy| toy.name == "tomato").and_then(|toy| toy.place).map(|at| at.coords.z)
}

#[test]
fn a_tomato_is_planned_grasped_and_judged() {
    if eye_renderer().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(&folder.path().join("data"), Some("perfect"));
    until(&mut window, "the twin's joints", |window| view(window).robot.measured.is_some());
    click_containing(&mut window, "Grasp");
    until(&mut window, "the eyes", |window| view(window).live.raw.is_some());
    for_a_while(&mut window, Duration::from_secs(1));
    click(&mut window, "Tomato");
    until(&mut window, "the choice", |window| view(window).grasp.target.class.as_deref() == Some("Tomato"));
    until(&mut window, "ready", |window| view(window).grasp.trouble().is_none());
    click(&mut window, "Plan");
    until(&mut window, "the plan", |window| view(window).grasp.plan.is_some());
    until(&mut window, "its end", |window| view(window).grasp.phase == GraspPhase::Idle);
    assert!(view(&window).grasp.attempts.is_empty(), "planning grasps nothing");
    let stood_m = tomato_m(&window);
    let began = Instant::now();
    click(&mut window, "Grasp tomato with M5");
    until(&mut window, "the first lamp", |window| {
        let run = view(window).grasp.run.clone();
        run.is_some_and(|run| run.lamps.contains(&(GraspStep::Approach, LampState::Lit)))
    });
    assert!(window.query_all_by_label("Approach under way").next().is_some());
    until(&mut window, "the end", |window| view(window).grasp.phase == GraspPhase::Idle);
    let run = view(&window).grasp.run.clone().expect("there was one");
    println!(
        "{:?} after {:.1?}, {:?}",
        run.outcome,
        began.elapsed(),
        run.iterations.iter().map(|look| look.distance_m).collect::<Vec<_>>()
    );
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
    until(&mut window, "the result", |window| {
        window.query_all_by_label("Fingers and eyes say: the tomato is held.").next().is_some()
    });
    // What the window says is not believed: ten seconds later it is looked where the tomato is.
    let (stood_m, now_s) = (stood_m.expect("it stands on the table"), view(&window).twin.time_s);
    until(&mut window, "ten seconds of the twin", |window| view(window).twin.time_s >= now_s + LATER_S);
    let height_m = tomato_m(&window).expect("it is somewhere");
    println!("the tomato is {:.0} mm higher than it stood", 1e3 * (height_m - stood_m));
    assert!(height_m - stood_m > LIFTED_M, "it lies on the table: {height_m} m, it stood at {stood_m} m");
    assert!(
        window.query_all_by_label("Fingers and eyes say: the tomato is held.").next().is_some(),
        "and the window says so still"
    );
    click(&mut window, "Held");
    until(&mut window, "the word to be kept", |window| {
        view(window).grasp.attempts.first().is_some_and(|attempt| attempt.told == Some(true))
    });
}
