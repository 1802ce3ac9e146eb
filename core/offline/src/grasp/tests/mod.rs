//! Grasps of a twin that is exactly as described, with nothing learned.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

mod bad_inputs;
mod beside;
mod broken_off;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_engine::trials::Experiment;
use plumbline_engine::trials::store::begin;
use plumbline_grasp::attempt::{HandFinder, RenderedHand};
use plumbline_grasp::{
    Corrections, Failure, Halt, Hand, HandChoice, Knowledge, Method, Order, Outcome, Record, Step, tracks,
};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{StereoCalibration, Unattended};
use plumbline_twin::{Lockstep, Scenario, Toy};

use super::attempt::{Bench, Task};
use super::trials::{carry_out, conclude};

fn bench(scenario: &str) -> Bench {
    bench_of(Scenario::built_in(scenario).expect("valid"))
}

/// With nothing learned.
pub(super) fn bench_of(scenario: Scenario) -> Bench {
    bench_with(scenario, Rig::built_in("nico").expect("valid"), Corrections::default())
}

pub(super) fn task(method: Method, toy: Toy, at_m: [f64; 2]) -> Task {
    let order = Order { method, hand: HandChoice::Right, object: toy.name().to_owned(), near_m: None };
    Task { order, toy, at_m, seed: 1 }
}

/// With these corrections alone, on a robot with these arms.
pub(super) fn bench_with(scenario: Scenario, rig: Rig, corrections: Corrections) -> Bench {
    let rig = Arc::new(rig);
    let knowledge = Knowledge {
        model: RobotModel::nominal(rig.clone()),
        described: rig.clone(),
        calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
        corrections,
    };
    let shown = rig.clone();
    let mut finder = move |hand: Hand| -> Option<Box<dyn HandFinder>> {
        Some(Box::new(RenderedHand::of_rig(&shown, hand.palm()).expect("a hand")))
    };
    Bench::new(rig, scenario, knowledge, &mut finder).expect("a bench")
}

pub(super) fn failure(record: &Record) -> Option<Failure> {
    match record.outcome {
        Some(Outcome::Failed { failure, .. }) => Some(failure),
        _ => None,
    }
}

#[test]
fn the_left_hand_lifts_what_the_right_one_does_not_reach_well() {
    let mut bench = bench("perfect");
    let with = |hand, at_m| Task {
        order: Order { hand, ..task(Method::M5, Toy::Tomato, at_m).order },
        ..task(Method::M5, Toy::Tomato, at_m)
    };
    for (hand, at_m, used) in [
        (HandChoice::Left, [0.3, 0.1], Hand::Left),
        (HandChoice::Auto, [0.2, 0.3], Hand::Left),
        (HandChoice::Auto, [0.3, -0.2], Hand::Right),
    ] {
        let (record, judged) = bench.attempt(&with(hand, at_m)).expect("done");
        assert_eq!(record.hand, used, "{at_m:?}");
        assert_eq!(record.outcome, Some(Outcome::Success), "{at_m:?}");
        assert!(judged.lifted && judged.alignment_m.is_some_and(|m| m < 0.005), "{judged:?}");
    }
    let refused = Order { hand: HandChoice::Left, ..task(Method::M4, Toy::Tomato, [0.3, 0.1]).order };
    let (record, _) =
        bench.attempt(&Task { order: refused, ..with(HandChoice::Left, [0.3, 0.1]) }).expect("done");
    let Some(Outcome::Refused { why }) = &record.outcome else { panic!("{:?}", record.outcome) };
    assert!(why.contains("right hand only") && record.moments.is_empty(), "{why}");
}

#[test]
fn a_hand_that_the_robot_lacks_is_refused_by_name() {
    let mut rig = Rig::built_in("nico").expect("valid");
    rig.arms.retain(|arm| arm.name == "right");
    let mut bench = bench_with(Scenario::built_in("perfect").expect("valid"), rig, Corrections::default());
    let mut left = task(Method::M5, Toy::Tomato, [0.3, -0.1]);
    left.order.hand = HandChoice::Left;
    let (record, judged) = bench.attempt(&left).expect("done");
    let Some(Outcome::Refused { why }) = &record.outcome else { panic!("{:?}", record.outcome) };
    assert!(why.contains("no arm called left") && !judged.lifted, "{why}");
}

#[test]
fn a_tomato_is_lifted_and_the_record_says_how() {
    let (record, judged) =
        bench("perfect").attempt(&task(Method::M5, Toy::Tomato, [0.3, -0.1])).expect("done");
    assert_eq!(record.outcome, Some(Outcome::Success));
    assert!(judged.lifted && judged.failure.is_none(), "{judged:?}");
    assert!(
        judged.alignment_m.is_some_and(|m| m < 0.005) && judged.camera_error_m.is_some_and(|m| m < 0.005)
    );
    assert!(record.seconds.is_some_and(|s| s < 25.0), "{:?}", record.seconds);
    assert!(record.iterations.iter().all(|look| look.hand_m.is_some()) && !record.iterations.is_empty());
    let after: Vec<Step> = record.moments.iter().map(|moment| moment.after).collect();
    for step in [Step::Approach, Step::Lower, Step::Close, Step::Lift, Step::Check] {
        assert!(after.contains(&step), "{step:?} is in the record");
    }
}

#[test]
fn the_hand_closes_where_the_looks_together_want_it() {
    let mut bench = bench("perfect");
    let (record, judged) = bench.attempt(&task(Method::M5, Toy::Tomato, [0.3, -0.1])).expect("done");
    assert!(judged.lifted, "{judged:?}");
    let arm = bench.grasper().planner(Method::M5).arm();
    let modeled = |step: Step| {
        let moment = record.moments.iter().rev().find(|moment| moment.after == step).expect("a moment");
        arm.palm(&Posture::new(moment.commanded_rad.clone())).coords.coords
    };
    let hand = Vector3::from(record.iterations.last().and_then(|look| look.hand_m).expect("a hand"));
    let wanted = Vector3::from(record.wanted_m.expect("a plan"));
    // The last look leaves less than a millimeter, which is undone on the way down.
    let left_m = (wanted - hand).xy().norm();
    assert!(left_m > 1e-4, "nothing to undo: {left_m} m");
    let closes = modeled(Step::Lower) + hand - modeled(Step::Align);
    assert!((wanted - closes).norm() < 5e-4, "{wanted} {closes}");
}

#[test]
fn what_is_not_seen_or_out_of_reach_moves_nothing() {
    let mut bench = bench("perfect");
    let moved = |record: &Record| !record.moments.is_empty();
    let mut nowhere = task(Method::M5, Toy::Duck, [0.3, -0.1]);
    nowhere.order.object = "tomato".to_owned();
    let (record, _) = bench.attempt(&nowhere).expect("done");
    assert_eq!(failure(&record), Some(Failure::NotSeen), "{:?}", record.outcome);
    assert!(!moved(&record));
    let (record, judged) = bench.attempt(&task(Method::M5, Toy::Tomato, [0.45, 0.35])).expect("done");
    assert!(
        matches!(&record.outcome, Some(Outcome::Refused { why }) if why.contains("nearer")),
        "{:?}",
        record.outcome
    );
    assert!(judged.refused && !moved(&record));
    let (record, _) = bench.attempt(&task(Method::M3, Toy::Tomato, [0.3, -0.1])).expect("done");
    assert!(
        matches!(&record.outcome, Some(Outcome::Refused { why }) if why.contains("Models")),
        "{:?}",
        record.outcome
    );
}

#[test]
fn stopped_in_any_step_the_record_says_so_and_the_next_grasp_works() {
    let mut bench = bench("perfect");
    let task = task(Method::M5, Toy::Tomato, [0.3, -0.1]);
    for step in [Step::Approach, Step::Align, Step::Lower, Step::Close, Step::Lift] {
        let mut stop = |now: Step, _: &mut Lockstep| if now == step { Err(Halt::Stopped) } else { Ok(()) };
        let (record, judged) = bench.attempt_disturbed(&task, &mut stop).expect("done");
        if step == Step::Align && record.iterations.len() < 2 {
            // It stood right at the first look.
            continue;
        }
        assert_eq!(failure(&record), Some(Failure::Halted), "{step:?}: {:?}", record.outcome);
        assert!(!judged.lifted, "{step:?}");
    }
    let (record, _) = bench.attempt(&task).expect("done");
    assert_eq!(record.outcome, Some(Outcome::Success));
}

#[test]
fn what_is_taken_away_or_pushed_on_the_way_is_not_called_held() {
    let mut bench = bench("perfect");
    let task = task(Method::M5, Toy::Tomato, [0.3, -0.1]);
    let mut take = |now: Step, twin: &mut Lockstep| {
        if now == Step::Lower {
            twin.remove_toy(Toy::Tomato);
        }
        Ok(())
    };
    let (record, judged) = bench.attempt_disturbed(&task, &mut take).expect("done");
    assert_eq!(failure(&record), Some(Failure::Slipped), "{:?}", record.outcome);
    // It was looked for once more, and not found.
    assert!(record.earlier.len() == 1 && !judged.lifted, "{record:?}");
    let mut push = |now: Step, twin: &mut Lockstep| {
        if now == Step::Lower {
            twin.place_toy(Toy::Tomato, 0.3, 0.2).expect("on the table");
        }
        Ok(())
    };
    let (record, judged) = bench.attempt_disturbed(&task, &mut push).expect("done");
    // The only one of its class is followed; at the first try it was not called held.
    assert!(judged.lifted && !judged.at_first && record.earlier.len() == 1, "{:?}", record.outcome);
    assert!(matches!(record.earlier[0].outcome, Outcome::Failed { .. }), "{:?}", record.earlier);
}

#[test]
fn what_is_missed_is_looked_for_and_grasped_once_more() {
    let mut bench = bench("perfect");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join(tracks::FILE);
    bench.track_in(file.clone());
    let mut pushes = |task: &Task| {
        let mut times = 0;
        let mut push = |now: Step, twin: &mut Lockstep| {
            if now == Step::Lower && times == 0 {
                times += 1;
                twin.place_toy(Toy::Tomato, 0.35, -0.17).expect("on the table");
            }
            Ok(())
        };
        bench.attempt_disturbed(task, &mut push).expect("done")
    };
    let (record, judged) = pushes(&task(Method::M5, Toy::Tomato, [0.3, -0.1]));
    assert_eq!(record.outcome, Some(Outcome::Success), "{:?}", record.earlier);
    assert!(judged.lifted && !judged.at_first && record.earlier.len() == 1);
    assert!(matches!(record.earlier[0].outcome, Outcome::Failed { .. }), "{:?}", record.earlier);
    assert!(record.standing_m.is_some_and(|[x, y]| (x - 0.35).hypot(y + 0.17) < 0.02));
    let kept: Record = serde_json::from_str(&serde_json::to_string(&record).expect("text")).expect("read");
    assert_eq!(kept, record);
    tracks_say_the_same(&std::fs::read_to_string(&file).expect("kept"), &record, bench.rig());
}

#[test]
fn what_cannot_be_kept_is_not_begun() {
    let mut bench = bench("perfect");
    let folder = tempfile::tempdir().expect("a folder");
    // A folder is no file.
    bench.track_in(folder.path().to_owned());
    let mut steps = 0;
    let mut count = |_: Step, _: &mut Lockstep| {
        steps += 1;
        Ok(())
    };
    let refused = bench.attempt_disturbed(&task(Method::M5, Toy::Tomato, [0.3, -0.1]), &mut count);
    let why = refused.map(|(record, _)| record.outcome).expect_err("it is not begun").to_string();
    assert!(why.contains(&folder.path().display().to_string()), "{why}");
    assert_eq!(steps, 0, "nothing has moved");
}

/// The joints over time, of both tries: as often as is said, each row of the step that was under way, and where a
/// step had ended there the record has the joints, too.
fn tracks_say_the_same(text: &str, record: &Record, rig: &Rig) {
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a header");
    let rows: Vec<Vec<&str>> = lines.collect();
    assert!(head.len() == 2 + 2 * rig.servos.len() && rows.iter().all(|row| row.len() == head.len()));
    let time_s = |row: &[&str]| row[0].parse::<f64>().expect("a time");
    for pair in rows.windows(2) {
        let apart_s = time_s(&pair[1]) - time_s(&pair[0]);
        assert!((apart_s - tracks::EVERY_S).abs() < 2e-3, "{apart_s} s at {}", pair[0][0]);
    }
    let mut steps: Vec<&str> = rows.iter().map(|row| row[head.len() - 1]).collect();
    steps.dedup();
    let ended = |step: &str| steps.iter().filter(|of| **of == step).count();
    assert_eq!((ended("approach"), ended("close"), ended("again")), (2, 2, 1), "{steps:?}");
    for moment in &record.moments {
        let last = rows.iter().rfind(|row| time_s(row) <= moment.at_s + 1e-9).expect("a row");
        assert!(moment.at_s - time_s(last) < tracks::EVERY_S + 2e-3, "at {} s", moment.at_s);
        for (k, encoder_rad) in moment.encoder_rad.iter().enumerate() {
            // A finger may still close between two rows.
            let measured_rad: f64 = last[1 + 2 * k].parse().expect("all are heard");
            assert!((measured_rad - encoder_rad).abs() < 0.1, "{} at {} s", head[1 + 2 * k], moment.at_s);
            let commanded_rad: f64 = last[2 + 2 * k].parse().expect("all are known");
            let sent_rad = moment.commanded_rad[rig.servos[k].joint.0];
            assert!((commanded_rad - sent_rad).abs() < 1e-3, "{} at {} s", head[2 + 2 * k], moment.at_s);
        }
    }
    let (bytes, lasted_s) = (text.len(), rows.len() as f64 * tracks::EVERY_S);
    println!("{bytes} bytes in {lasted_s:.1} s");
    assert!((bytes as f64) < 6000.0 * lasted_s + 2000.0, "{bytes} bytes in {lasted_s:.1} s");
}

#[test]
fn two_shards_put_together_are_one_run_byte_for_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let experiment = Experiment {
        format: plumbline_engine::trials::FORMAT,
        twin: "perfect".to_owned(),
        methods: vec![Method::M5],
        attempts: 1,
        positions_m: vec![[0.3, -0.2], [0.3, 0.1], [0.4, 0.0]],
        hand: HandChoice::Auto,
        object: "Tomato".to_owned(),
        seed: 7,
        lab: None,
    };
    let run = |name: &str, shard| {
        let out = folder.path().join(name);
        begin(&out, &experiment).expect("begun");
        let mut bench = bench("perfect");
        carry_out(&experiment, &mut bench, (Toy::Tomato, shard, false), &out, &Unattended)
            .expect("carried out");
        (conclude(&out, &experiment).expect("concluded"), out)
    };
    let (whole, whole_in) = run("whole", None);
    let (_, first) = run("first", Some((1, 2)));
    let (part, second) = run("second", Some((2, 2)));
    assert_eq!((whole.missing, part.missing), (0, 2));
    let merged_in = folder.path().join("merged");
    let merged = super::merge_trials(&[second.clone(), first], &merged_in).expect("merged");
    assert_eq!(merged, whole);
    let files = |at: &Path| -> Vec<(PathBuf, Vec<u8>)> {
        let mut found = vec![];
        for folder in [at.to_owned(), at.join("attempts")] {
            for entry in std::fs::read_dir(&folder).expect("there").flatten().filter(|e| e.path().is_file()) {
                let name = entry.path().strip_prefix(at).expect("inside").to_owned();
                found.push((name, std::fs::read(entry.path()).expect("readable")));
            }
        }
        found.sort();
        found
    };
    assert_eq!(files(&whole_in), files(&merged_in));
    let is_tracks = |(name, text): &&(PathBuf, Vec<u8>)| {
        name.to_string_lossy().ends_with("-m5.tracks.csv") && text.starts_with(b"t_s,")
    };
    assert_eq!(files(&merged_in).iter().filter(is_tracks).count(), 3, "the joints of every attempt");
    // One that was interrupted goes on with what is missing, and is the same.
    let before = files(&whole_in);
    for ending in ["json", "tracks.csv"] {
        std::fs::remove_file(whole_in.join("attempts").join(format!("00001-m5.{ending}")))
            .expect("it was there");
    }
    let (again, _) = run("whole", None);
    assert_eq!((again, files(&whole_in)), (whole, before));
    // Another experiment is not mixed in.
    let other = Experiment { seed: 8, ..experiment.clone() };
    let refused = begin(&whole_in, &other).expect_err("another one").to_string();
    assert!(refused.contains("another experiment"), "{refused}");
    assert!(super::merge_trials(&[], &merged_in).is_err());
}

#[test]
#[ignore = "minutes; figures for who works on grasps"]
fn everywhere() {
    for scenario in ["perfect", "lab"] {
        let mut bench = bench(scenario);
        for at_m in super::PLACES_M {
            let order = Order { hand: HandChoice::Auto, ..task(Method::M5, Toy::Tomato, at_m).order };
            let began = std::time::Instant::now();
            let task = Task { order, toy: Toy::Tomato, at_m, seed: 1 };
            let (record, judged) = bench.attempt(&task).expect("carried out");
            println!(
                "{scenario} {at_m:?}: {:?} lifted {} camera {:.1?} mm align {:.1?} hand {:.1?} looks {} reach {:.1?} fingers {:.2?} {:.1?} s, wall {:.1} s",
                record.outcome,
                judged.lifted,
                judged.camera_error_m.map(|m| m * 1e3),
                judged.alignment_m.map(|m| m * 1e3),
                judged.hand_error_m.map(|m| m * 1e3),
                record.iterations.len(),
                judged.reach_error_m.map(|m| m * 1e3),
                record.fingers_open_rad,
                record.seconds,
                began.elapsed().as_secs_f64(),
            );
        }
    }
}

/// With which hand: `PLUMBLINE_HAND`.
fn hand_told() -> HandChoice {
    let told = std::env::var("PLUMBLINE_HAND").unwrap_or_else(|_| "auto".to_owned());
    HandChoice::from_name(&told).expect("auto, right or left")
}

/// Figures of a lab that is commissioned in the folder `PLUMBLINE_LAB` (or was), of the twin
/// `PLUMBLINE_TWIN`, by the methods `PLUMBLINE_METHODS`.
#[test]
#[ignore = "minutes; figures for who works on grasps"]
fn in_a_lab() {
    let told = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.to_owned());
    let (lab, twin) = (told("PLUMBLINE_LAB", "target/lab"), told("PLUMBLINE_TWIN", "lab"));
    let seed = told("PLUMBLINE_SEED", "1").parse().expect("a number");
    let context = Unattended;
    let args = crate::CommissionArgs { twin: twin.clone(), seed, out: lab.clone().into() };
    let commissioned = crate::commission(&args, &context).expect("commissioned");
    println!(
        "{:.1} min, place {:?}, touch {:?}",
        commissioned.robot_minutes, commissioned.place_error_mm, commissioned.touch_error_mm
    );
    for step in &commissioned.steps {
        println!(
            "{} {:.1} min {:?} -> {:?} {:?}",
            step.name, step.minutes, step.before_mm, step.after_mm, step.notes
        );
    }
    let methods = told("PLUMBLINE_METHODS", "m5");
    let methods: Vec<Method> = methods.split(',').filter_map(Method::from_name).collect();
    let attempts = told("PLUMBLINE_ATTEMPTS", "1").parse().expect("a number");
    let out = tempfile::tempdir().expect("a folder");
    let args = super::TrialsArgs {
        twin: Some(twin),
        lab: lab.into(),
        methods,
        attempts,
        positions: None,
        hand: hand_told(),
        object: told("PLUMBLINE_OBJECT", "tomato"),
        seed,
        shard: None,
        out: out.path().to_owned(),
        images: false,
    };
    let summary = super::grasp_trials(&args, &context).expect("carried out");
    for (name, of) in &summary.methods {
        println!(
            "{name}: {}/{} inside {}/{} hand {}/{} refused {} {:?} align {:?} reach {:?} camera {:?} {:?} s",
            of.successes,
            of.attempts,
            of.inside,
            of.inside_attempts,
            of.hand_located,
            of.hand_positions,
            of.refused,
            of.failures,
            of.alignment_mm,
            of.reach_error_mm,
            of.camera_error_mm,
            of.seconds_median,
        );
    }
    println!("{}", std::fs::read_to_string(out.path().join("attempts.csv")).expect("written"));
}

/// One grasp of the lab in `PLUMBLINE_LAB` at `PLUMBLINE_AT` (x,y), with all that is kept of it.
#[test]
#[ignore = "for who looks for why a grasp failed"]
fn one_in_a_lab() {
    let told = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.to_owned());
    let at_m: Vec<f64> = told("PLUMBLINE_AT", "0.3,-0.1").split(',').filter_map(|n| n.parse().ok()).collect();
    let method = Method::from_name(&told("PLUMBLINE_METHODS", "m5")).expect("a method");
    let scenario = crate::commission::scenario(&told("PLUMBLINE_TWIN", "lab")).expect("a twin");
    let lab = told("PLUMBLINE_LAB", "target/lab");
    let mut bench = super::trials::bench(lab.as_ref(), scenario, &[method], &Unattended).expect("a lab");
    for seed in 1..4 {
        let order = Order { hand: hand_told(), ..task(method, Toy::Tomato, [at_m[0], at_m[1]]).order };
        let task = Task { order, toy: Toy::Tomato, at_m: [at_m[0], at_m[1]], seed };
        let (mut record, judged) = bench.attempt(&task).expect("carried out");
        record.seen.clear();
        record.seen_after.clear();
        println!(
            "{judged:?}\n{:?} heading {:?} fingers {:?} over {:?}",
            record.outcome, record.heading_rad, record.fingers_open_rad, record.over_middle_m
        );
        for moment in &record.moments {
            let off: Vec<String> = moment
                .load
                .iter()
                .zip(&bench.rig().servos)
                .filter(|(_, s)| s.joint_name.starts_with(&record.hand.name()[..1]))
                .map(|(load, s)| {
                    format!("{}:{:.2}", s.joint_name.trim_start_matches(['r', 'l']), load.unwrap_or_default())
                })
                .collect();
            println!("{:?} {:.1} {}", moment.after, moment.at_s, off.join(" "));
        }
    }
}
