//! One grasp, and what may come between.

use std::time::{Duration, Instant};

use plumbline_grasp::Failure;
use plumbline_twin::Toy;

use super::bench::{Bench, words};
use crate::command::{GraspCommand, HandStep, RobotCommand};
use crate::view::{GraspOutcome, GraspStep, LampState, MotionState, SinceHeld, View};

const EASY_M: [f64; 2] = [0.32, -0.15];

#[test]
fn a_thing_is_grasped_put_down_and_grasped_again() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    bench.send(GraspCommand::Plan);
    let view = bench.until("a plan", |view| view.grasp.plan.is_some());
    let plan = view.grasp.plan.clone().expect("just seen");
    println!("plan: {:?} {:.0?} mm, {:?}", plan.object, plan.at_m.map(|m| m * 1e3), plan.duration);
    assert!((plan.at_m[0] - EASY_M[0]).hypot(plan.at_m[1] - EASY_M[1]) < 0.01, "{plan:?}");
    assert!(!view.grasp.phase.moves());
    bench.until_idle();
    let began = Instant::now();
    let run = bench.grasp();
    println!(
        "{} in {:.1?}: {:?} fingers {:?}",
        words(run.outcome.as_ref()),
        began.elapsed(),
        run.lamps,
        run.fingers_open_rad
    );
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
    assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
    assert!(run.lamps.iter().all(|(_, lamp)| *lamp == LampState::Done), "{:?}", run.lamps);
    let record = bench.kept();
    assert_eq!(record.outcome, Some(GraspOutcome::Success));
    the_joints_were_followed(&bench.kept_tracks(), record.seconds.expect("it lifted"));
    bench.send(GraspCommand::Judge { attempt: run.name.clone(), held: false });
    bench.until("the word of the operator", |view| {
        view.grasp.attempts.first().is_some_and(|attempt| attempt.told == Some(false))
    });
    assert_eq!(bench.kept().told_by_operator, Some(false));
    bench.send(GraspCommand::Hand(HandStep::Place));
    bench.until("it to begin", |view| view.grasp.phase.moves());
    let view = bench.until_idle();
    let said = view.notices.last().map(|notice| notice.text.clone());
    assert!(!said.as_deref().is_some_and(|text| text.contains("Put down")), "{said:?}");
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

/// About ten rows a second to the end, the steps in their order, and arms that move where they are sent.
fn the_joints_were_followed(rows: &[Vec<String>], lifted_s: f64) {
    let time_s = |row: &Vec<String>| row[0].parse::<f64>().expect("a time");
    assert!(rows.windows(2).all(|pair| time_s(&pair[0]) < time_s(&pair[1])));
    assert!(rows.last().is_some_and(|row| time_s(row) > lifted_s), "they end at {:?}", rows.last());
    // A machine that is busy with other tests reads less often.
    let per_s = rows.len() as f64 / lifted_s;
    assert!((2.0..20.0).contains(&per_s), "{per_s:.1} rows a second");
    let mut steps: Vec<&str> = rows.iter().filter_map(|row| row.last()).map(String::as_str).collect();
    steps.dedup();
    for step in ["approach", "lower", "close", "lift", "check"] {
        assert!(steps.contains(&step), "{step} is not in {steps:?}");
    }
    let moves = |column: usize| {
        let angles_rad: Vec<f64> = rows.iter().filter_map(|row| row[column].parse().ok()).collect();
        let (least, most) = angles_rad.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        most - least
    };
    let columns = rows[0].len();
    let moved = (1..columns - 1).step_by(2).filter(|column| moves(*column) > 0.1).count();
    let sent = (2..columns - 1).step_by(2).filter(|column| moves(*column) > 0.1).count();
    assert!(moved >= 5 && sent >= 5, "{moved} joints moved, {sent} were sent somewhere");
}

#[test]
fn stop_ends_it_the_arm_holds_and_the_next_one_works() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    bench.send(GraspCommand::Grasp);
    bench.until_step(GraspStep::Approach);
    std::thread::sleep(Duration::from_millis(300));
    bench.stop();
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("STOP")),
        "{}",
        words(run.outcome.as_ref())
    );
    let view = bench.until("it holds", |view| matches!(view.robot.motion, MotionState::Holding { .. }));
    assert!(view.robot.stopped);
    assert_eq!(bench.kept().step, Some(GraspStep::Approach));
    bench.send(RobotCommand::ReleaseStop);
    bench.until("STOP to be released", |view| !view.robot.stopped);
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

#[test]
fn what_is_held_and_slips_out_later_is_told() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
    // It stays in the hand, and nothing else is said.
    let now_s = bench.until_idle().twin.time_s;
    let view = bench.until("ten seconds", |view| view.twin.time_s >= now_s + 10.0);
    let since = |view: &View| view.grasp.run.as_ref().map(|run| run.since);
    assert_eq!(since(&view), Some(SinceHeld::Held), "{:?}", view.notices);
    assert!(view.grasp.attempts[0].is_success());

    bench.remove(Toy::Tomato);
    let view = bench.until("that it is gone", |view| matches!(since(view), Some(SinceHeld::Slipped(_))));
    let said = view.notices.iter().any(|notice| notice.text.contains("was held and has slipped out of the"));
    assert!(said, "{:?}", view.notices);
    bench.until("it to be kept", |view| view.grasp.attempts[0].slipped_after.is_some());
    let record = bench.kept();
    assert!(record.slipped_after_s.is_some_and(|after_s| after_s > 5.0) && !record.is_success());
    assert_eq!(record.outcome, Some(GraspOutcome::Success), "what it took itself for stays");
}

#[test]
fn what_was_taken_away_is_not_taken_for_held() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    bench.send(GraspCommand::Grasp);
    bench.until_step(GraspStep::Approach);
    bench.remove(Toy::Tomato);
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(matches!(&run.outcome, Some(GraspOutcome::Failed { .. })), "{}", words(run.outcome.as_ref()));
    assert!(!view.grasp.attempts[0].is_success());
}

#[test]
fn pause_holds_within_a_step_and_the_bus_lost_in_the_air_is_told() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    bench.send(GraspCommand::Grasp);
    bench.until_step(GraspStep::Approach);
    std::thread::sleep(Duration::from_millis(400));
    bench.send(GraspCommand::Pause);
    bench.until("a pause", |view| view.grasp.phase.is_paused());
    std::thread::sleep(Duration::from_millis(700));
    let stood = bench.until("angles", |view| view.robot.measured.is_some()).robot.measured.clone();
    std::thread::sleep(Duration::from_millis(700));
    let stands = bench.until("angles", |view| view.robot.measured.is_some()).robot.measured.clone();
    let (stood, stands) = (stood.expect("read"), stands.expect("read"));
    assert!(stood.distance_rad(&stands) < 0.01, "it moved by {:.3} rad", stood.distance_rad(&stands));
    bench.send(GraspCommand::Resume);
    bench.until("it to go on", |view| !view.grasp.phase.is_paused());
    std::thread::sleep(Duration::from_millis(200));
    bench.send(RobotCommand::Disconnect);
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("not known any more")),
        "{}",
        words(run.outcome.as_ref())
    );
}
