//! An attempt that stops after each step: where it holds, what it says, and what ends it there.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_grasp::{Failure, Record, Step};
use plumbline_twin::Toy;

use super::bench::{Bench, words};
use crate::command::{GraspCommand, GraspTarget, HandStep, RobotCommand};
use crate::view::{BetweenSteps, GraspOutcome, GraspPhase, GraspStep, LampState, View};

const EASY_M: [f64; 2] = [0.32, -0.15];
/// A person looks so long before each step.
const LOOKS: Duration = Duration::from_millis(600);

/// The next hold, or the end.
fn until_held(bench: &Bench) -> (Option<BetweenSteps>, Arc<View>) {
    let view = bench.until("a hold or the end", |view| {
        view.grasp.between().is_some() || view.grasp.phase == GraspPhase::Idle
    });
    (view.grasp.between(), view)
}

fn go_on(bench: &Bench) {
    bench.send(GraspCommand::Resume);
    bench.until("it to go on", |view| view.grasp.between().is_none());
}

fn begin(bench: &Bench) {
    bench.send(GraspCommand::Target(GraspTarget { class: Some("Tomato".to_owned()), near_m: None }));
    bench.send(GraspCommand::StopAfterEachStep(true));
    bench.begin();
}

fn halted(record: &Record) -> String {
    match &record.outcome {
        Some(GraspOutcome::Failed { failure: Failure::Halted, why }) => why.clone(),
        other => panic!("it was halted: {}", words(other.as_ref())),
    }
}

/// When the lift was done, clock of the robot, s.
fn lifted_at_s(record: &Record) -> f64 {
    let lift = record.moments.iter().rev().find(|moment| moment.after == Step::Lift);
    lift.expect("it was lifted").at_s
}

#[test]
fn it_holds_after_each_step_until_it_is_told_to_go_on_and_with_the_switch_off_goes_through() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    begin(&bench);
    let (mut nexts, mut held) = (vec![], Duration::ZERO);
    while let (Some(BetweenSteps { done, next }), view) = until_held(&bench) {
        let began = Instant::now();
        assert!(view.grasp.phase.is_paused());
        let run = view.grasp.run.clone().expect("it is under way");
        assert!(done == next || run.lamps.contains(&(done, LampState::Done)), "{done:?}: {:?}", run.lamps);
        assert!(done == next || run.lamps.contains(&(next, LampState::Dark)), "{next:?}: {:?}", run.lamps);
        assert_eq!(bench.kept().step, Some(done), "what is done is on disk while it holds");
        nexts.push(next);
        if next == GraspStep::Lower {
            let moved_rad = bench.creeps_rad();
            assert!(moved_rad < 0.01, "it holds, and moves by {moved_rad} rad");
        }
        bench.until("a look", |_| began.elapsed() > LOOKS);
        if next == GraspStep::Lift {
            bench.send(GraspCommand::StopAfterEachStep(false));
            bench.until("the switch", |view| !view.grasp.stops_after_each);
            assert_eq!(bench.until("a hold", |_| true).grasp.between(), Some(BetweenSteps { done, next }));
        }
        held += began.elapsed();
        go_on(&bench);
    }
    // The hand may be looked at more than once.
    let looks = nexts.iter().filter(|next| **next == GraspStep::Align).count();
    assert!(looks >= 2, "{nexts:?}");
    nexts.dedup();
    let wanted = [GraspStep::Approach, GraspStep::Align, GraspStep::Lower, GraspStep::Close, GraspStep::Lift];
    assert_eq!(nexts, wanted, "with the switch off the rest follows by itself");
    let record = bench.kept();
    assert_eq!(record.outcome, Some(GraspOutcome::Success), "{}", words(record.outcome.as_ref()));
    let (seconds, held_s) = (record.seconds.expect("it was lifted"), held.as_secs_f64());
    let at_s = lifted_at_s(&record);
    assert!(at_s - seconds > held_s - 0.1, "lifted at {at_s} s, held for {held_s} s, it took {seconds} s");
}

#[test]
fn what_ends_it_while_it_holds_is_in_its_record_with_the_step_that_was_done() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    begin(&bench);
    let (held, _) = until_held(&bench);
    assert_eq!(held, Some(BetweenSteps { done: GraspStep::Plan, next: GraspStep::Approach }));
    go_on(&bench);
    let (held, _) = until_held(&bench);
    assert_eq!(held, Some(BetweenSteps { done: GraspStep::Approach, next: GraspStep::Align }));
    bench.send(GraspCommand::End);
    let view = bench.until_idle();
    let record = bench.kept();
    let why = halted(&record);
    assert!(why.contains("ended by the operator") && why.contains("after approach, before align"), "{why}");
    assert_eq!((record.step, record.seconds), (Some(Step::Approach), None));
    let lamps = &view.grasp.run.as_ref().expect("there was one").lamps;
    assert!(lamps.iter().all(|(_, lamp)| *lamp != LampState::Failed), "no step has failed: {lamps:?}");

    // The switch stays; STOP ends it as always. A hand over the thing would hide it.
    bench.hand(HandStep::Home);
    bench.settle();
    bench.begin();
    let (held, view) = until_held(&bench);
    assert!(view.grasp.stops_after_each && held.is_some());
    bench.stop();
    bench.until_idle();
    let record = bench.kept();
    let why = halted(&record);
    assert!(why.contains("STOP was pressed") && why.contains("after plan, before approach"), "{why}");
    bench.send(RobotCommand::ReleaseStop);
    bench.until("STOP to be released", |view| !view.robot.stopped);
}
