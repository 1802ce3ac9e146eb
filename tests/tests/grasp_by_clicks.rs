//! An operator grasps a thing, by clicks in a window over the real engine and the real twin: chooses,
//! plans, grasps, says what was seen.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable as _;
use plumbline_engine::view::{GraspOutcome, GraspPhase, GraspStep, LampState};
use plumbline_tests::{click, click_containing, eye_renderer, for_a_while, until, view, window};

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
        window.query_all_by_label("The tomato is held.").next().is_some()
    });
    click(&mut window, "Held");
    until(&mut window, "the word to be kept", |window| {
        view(window).grasp.attempts.first().is_some_and(|attempt| attempt.told == Some(true))
    });
}
