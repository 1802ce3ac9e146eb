//! Attempts that something breaks off in the middle of a way: the arm holds where it is, the record says
//! what happened, and in the world that is left the next grasp works, by a program that begins anew.

use std::sync::Arc;

use plumbline_correction::tables::{HeightPoint, HeightTable};
use plumbline_grasp::published::HandHeights;
use plumbline_grasp::{Body, Corrections, Failure, Halt, Method, Outcome, Record, ServoState, Step};
use plumbline_model::robot::{Posture, Rig};
use plumbline_twin::{Lockstep, Scenario, Toy};

use super::super::attempt::{Bench, Meddler};
use super::bad_inputs::{HandHidden, assert_honest};
use super::{bench_of, bench_with, failure, task};
use crate::twin_body::TwinBody;

const EASY_M: [f64; 2] = [0.3, -0.1];
/// In every step that moves.
const STEPS: [Step; 5] = [Step::Approach, Step::Align, Step::Lower, Step::Close, Step::Lift];
/// What holds moves by less within a second, rad.
const HOLDS_RAD: f64 = 0.02;
/// Before it goes home the palm rises by so much, m.
const UP_M: f64 = 0.12;
const SPEED_RAD_S: f64 = 0.5;

fn perfect() -> Bench {
    bench_of(Scenario::built_in("perfect").expect("valid"))
}

/// Breaks a step off in the middle of its first way; keeps what goes to disk.
struct Breaks {
    at: Step,
    halt: Halt,
    /// From then on the servos are so hot, °C.
    hot_c: Option<f64>,
    is_broken: bool,
    kept: Vec<String>,
}

impl Breaks {
    fn new(at: Step, halt: Halt) -> Self {
        Self { at, halt, hot_c: None, is_broken: false, kept: vec![] }
    }
}

impl Meddler for Breaks {
    fn moves(&mut self, step: Step, way: &[Posture], twin: &mut Lockstep) -> Result<(), Halt> {
        if step != self.at || self.is_broken {
            return Ok(());
        }
        self.is_broken = true;
        let half = way.len() / 2;
        let from = half.checked_sub(1).map_or_else(|| twin.commanded().clone(), |before| way[before].clone());
        let middle = from.toward(&way[half], 0.5);
        twin.follow(&[&way[..half], &[middle]].concat(), SPEED_RAD_S);
        Err(self.halt.clone())
    }

    fn feels(&mut self, _step: Step, servos: &mut [ServoState]) {
        if let Some(hot_c) = self.hot_c.filter(|_| self.is_broken) {
            servos.iter_mut().for_each(|servo| servo.temperature_c = Some(hot_c));
        }
    }

    fn keeps(&mut self, record: &Record) {
        self.kept.push(serde_json::to_string(record).expect("a record is text"));
    }
}

/// The arm stands; fingers may still give way around what they hold.
fn assert_holds(what: &str, bench: &Bench, world: &mut TwinBody) {
    let arm = bench.grasper().planner(Method::M5).arm().joints().to_vec();
    let (sent, stood) = (world.commanded().expect("known"), world.twin().encoders().of(&arm));
    world.wait(1.0).expect("nobody ends it");
    let moved = world.twin().encoders().of(&arm).into_iter().zip(stood).map(|(now, then)| (now - then).abs());
    let moved_rad = moved.fold(0.0, f64::max);
    assert!(moved_rad < HOLDS_RAD, "{what}: moves by {moved_rad} rad");
    assert_eq!(sent, world.commanded().expect("known"), "{what}");
}

/// Up, then home, as the button does it; then somebody lays the thing down again.
fn home(bench: &Bench, world: &mut TwinBody, toy: Toy) {
    let planner = bench.grasper().planner(Method::M5);
    let arm = planner.arm();
    let from = world.commanded().expect("known");
    let mut way = planner.vertical(arm.heading_rad(&from), &from, UP_M);
    let up = way.last().unwrap_or(&from);
    way.push(up.with(arm.joints(), &arm.rig().home().of(arm.joints())));
    world.follow(&way, SPEED_RAD_S).expect("nobody ends it");
    world.twin().place_toy(toy, EASY_M[0], EASY_M[1]).expect("on the table");
    world.wait(1.0).expect("nobody ends it");
}

#[test]
fn the_bus_lost_or_the_program_killed_in_any_step_the_arm_holds_and_the_next_grasp_works() {
    let (mut bench, mut next) = (perfect(), perfect());
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task).expect("a world");
    for at in STEPS {
        let mut breaks = Breaks::new(at, Halt::Lost("the bus does not answer".to_owned()));
        let (record, _) = bench.attempt_in(&mut world, &task, &mut breaks).expect("nothing is kept");
        assert_eq!(failure(&record), Some(Failure::Halted), "{at:?}: {:?}", record.outcome);
        let Some(Outcome::Failed { why, .. }) = &record.outcome else { unreachable!("just seen") };
        assert!(why.contains("does not answer") && record.step == Some(at), "{at:?}: {why}");
        assert_holds(&format!("{at:?}"), &bench, &mut world);
        // All that a program which was killed in this step would have left on disk.
        let left: Record = serde_json::from_str(breaks.kept.last().expect("kept")).expect("a record");
        assert_eq!((left.step, &left.outcome), (Some(at), &None));
        assert!(left.wanted_m.is_some() && left.chosen.is_some(), "{at:?}");
        home(&next, &mut world, Toy::Tomato);
        let (record, judged) = next.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
        assert_eq!(record.outcome, Some(Outcome::Success), "after {at:?}");
        assert!(judged.lifted, "after {at:?}");
        home(&next, &mut world, Toy::Tomato);
    }
}

/// Moves the thing away before the hand closes for the first time; breaks off what comes when it is tried again.
struct BreaksAgain {
    breaks: Breaks,
    is_again: bool,
}

impl Meddler for BreaksAgain {
    fn moves(&mut self, step: Step, way: &[Posture], twin: &mut Lockstep) -> Result<(), Halt> {
        if self.is_again {
            return self.breaks.moves(step, way, twin);
        }
        if step == Step::Close {
            twin.place_toy(Toy::Tomato, EASY_M[0], EASY_M[1] + 0.12).expect("on the table");
        }
        Ok(())
    }

    fn keeps(&mut self, record: &Record) {
        self.is_again |= record.step == Some(Step::Again);
        self.breaks.keeps(record);
    }
}

#[test]
fn lost_or_killed_while_it_tries_again_the_record_says_how_the_first_try_ended() {
    let (mut bench, mut next) = (perfect(), perfect());
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task).expect("a world");
    for at in [Step::Again, Step::Approach, Step::Lift] {
        let breaks = Breaks::new(at, Halt::Lost("the bus does not answer".to_owned()));
        let mut meddler = BreaksAgain { breaks, is_again: false };
        let (record, _) = bench.attempt_in(&mut world, &task, &mut meddler).expect("nothing is kept");
        assert!(meddler.is_again && meddler.breaks.is_broken, "{at:?}: {:?}", record.outcome);
        assert_eq!((failure(&record), record.step), (Some(Failure::Halted), Some(at)));
        assert_holds(&format!("again, {at:?}"), &bench, &mut world);
        let left: Record = serde_json::from_str(meddler.breaks.kept.last().expect("kept")).expect("a record");
        for (what, record) in [("ended", &record), ("killed", &left)] {
            assert_eq!(record.earlier.len(), 1, "{what} in {at:?}");
            let Outcome::Failed { failure, .. } = &record.earlier[0].outcome else {
                panic!("{what} in {at:?}: {:?}", record.earlier[0].outcome)
            };
            assert!(
                matches!(failure, Failure::ReachWrong | Failure::Slipped),
                "{what} in {at:?}: {failure:?}"
            );
        }
        assert_eq!((left.step, &left.outcome), (Some(at), &None));
        home(&next, &mut world, Toy::Tomato);
        let (record, judged) = next.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
        assert!(judged.lifted && record.is_success(), "after {at:?}: {:?}", record.outcome);
        home(&next, &mut world, Toy::Tomato);
    }
}

#[test]
fn before_each_step_goes_to_disk_how_far_it_came() {
    let mut bench = perfect();
    let mut nothing = Breaks::new(Step::Again, Halt::Stopped);
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let (record, _) = bench.attempt_disturbed(&task, &mut nothing).expect("done");
    assert_eq!(record.outcome, Some(Outcome::Success));
    let kept: Vec<Record> =
        nothing.kept.iter().map(|text| serde_json::from_str(text).expect("a record")).collect();
    let steps: Vec<Step> = kept.iter().filter_map(|record| record.step).collect();
    assert_eq!(steps, Step::ALL);
    assert!(kept.iter().all(|record| record.outcome.is_none()));
    assert!(kept.windows(2).all(|pair| pair[0].moments.len() <= pair[1].moments.len()));
}

#[test]
fn a_servo_that_gets_too_hot_on_the_way_ends_it_and_when_it_is_cool_the_next_grasp_works() {
    let mut bench = perfect();
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task).expect("a world");
    let halt = Halt::Refused("the shoulder is too hot".to_owned());
    for at in [Step::Lower, Step::Lift] {
        let hot_c = world.rig().gate.hot_c + 5.0;
        let mut breaks = Breaks { hot_c: Some(hot_c), ..Breaks::new(at, halt.clone()) };
        let (record, _) = bench.attempt_in(&mut world, &task, &mut breaks).expect("nothing is kept");
        assert_eq!(failure(&record), Some(Failure::Halted), "{at:?}: {:?}", record.outcome);
        assert_holds(&format!("{at:?}"), &bench, &mut world);
        // While it is hot nothing moves.
        let (record, _) = bench.attempt_in(&mut world, &task, &mut breaks).expect("nothing is kept");
        let Some(Outcome::Refused { why }) = &record.outcome else { panic!("{:?}", record.outcome) };
        assert!(why.contains("let it cool down") && record.moments.is_empty(), "{why}");
        home(&bench, &mut world, Toy::Tomato);
        let (record, judged) = bench.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
        assert!(judged.lifted && record.is_success(), "after {at:?}: {:?} {:?}", record.outcome, record.seen);
        home(&bench, &mut world, Toy::Tomato);
    }
}

/// Eyes that give no pair from a step on.
struct Blinded(Step);

impl Meddler for Blinded {
    fn blinds(&mut self, step: Step) -> Result<(), Halt> {
        let said = "none came within 20 s: look whether they are open";
        if step == self.0 { Err(Halt::Blind(said.to_owned())) } else { Ok(()) }
    }
}

#[test]
fn eyes_that_are_lost_on_the_way_end_it_and_what_nobody_saw_lifted_is_not_called_held() {
    let mut bench = perfect();
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task).expect("a world");
    for at in [Step::Look, Step::Align, Step::Check] {
        let (record, judged) =
            bench.attempt_in(&mut world, &task, &mut Blinded(at)).expect("nothing is kept");
        assert_eq!(failure(&record), Some(Failure::EyesLost), "{at:?}: {:?}", record.outcome);
        let Some(Outcome::Failed { why, .. }) = &record.outcome else { unreachable!("just seen") };
        assert!(why.contains("the eyes give no pairs") && why.contains("look whether"), "{at:?}: {why}");
        assert_eq!(record.step, Some(at));
        assert_eq!(judged.lifted, at == Step::Check, "{at:?}");
        assert!(at != Step::Look || record.moments.is_empty(), "nothing moved");
        assert_holds(&format!("{at:?}"), &bench, &mut world);
        if at != Step::Look {
            home(&bench, &mut world, Toy::Tomato);
        }
    }
    let (record, judged) = bench.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
    assert!(judged.lifted && record.is_success(), "{:?}", record.outcome);
}

/// M4 with the table as flat as described for the hand.
fn with_heights() -> Bench {
    let rig = Rig::built_in("nico").expect("valid");
    let height_m = rig.touchscreen.origin.coords.z;
    let points = (0..45).map(|k| HeightPoint {
        x_m: 0.15 + 0.07 * f64::from(k % 5),
        y_m: -0.42 + 0.09 * f64::from(k / 5),
        height_m,
    });
    let table = HeightTable::new(points.collect()).expect("a table");
    let hand = Some(Arc::new(HandHeights::new(&table, []).expect("usable")));
    let corrections = Corrections { hand, ..Corrections::default() };
    bench_with(Scenario::built_in("perfect").expect("valid"), rig, corrections)
}

#[test]
fn a_hand_that_is_hidden_from_both_eyes_ends_m4_with_the_reason_and_the_next_grasp_works() {
    let mut bench = with_heights();
    let task_m4 = task(Method::M4, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task_m4).expect("a world");
    let (record, judged) =
        bench.attempt_in(&mut world, &task_m4, &mut HandHidden::default()).expect("nothing is kept");
    assert_eq!(failure(&record), Some(Failure::HandWrong), "{:?}", record.outcome);
    assert!(record.iterations.iter().all(|look| look.hand_m.is_none()) && !record.iterations.is_empty());
    assert_honest("M4", &record, &judged);
    assert_holds("M4", &bench, &mut world);
    home(&bench, &mut world, Toy::Tomato);
    let (record, judged) = bench
        .attempt_in(&mut world, &task(Method::M5, Toy::Tomato, EASY_M), &mut ())
        .expect("nothing is kept");
    assert!(judged.lifted && record.is_success(), "{:?}", record.outcome);
}

#[test]
fn after_a_hand_that_was_hidden_the_next_grasp_in_the_same_world_works() {
    let mut bench = perfect();
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let mut world = bench.world(&task).expect("a world");
    let (record, judged) =
        bench.attempt_in(&mut world, &task, &mut HandHidden::default()).expect("nothing is kept");
    assert!(record.iterations.iter().all(|look| look.hand_m.is_none()), "{:?}", record.iterations);
    assert_honest("M5", &record, &judged);
    assert_holds("M5", &bench, &mut world);
    home(&bench, &mut world, Toy::Tomato);
    let (record, judged) = bench.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
    assert!(judged.lifted && record.is_success(), "{:?}", record.outcome);
}
