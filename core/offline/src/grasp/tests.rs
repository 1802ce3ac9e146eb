//! Grasps of a twin that is exactly as described, with nothing learned.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_grasp::attempt::RenderedHand;
use plumbline_grasp::{Corrections, Knowledge, Method, Order};
use plumbline_model::StereoCalibration;
use plumbline_model::robot::Rig;
use plumbline_twin::{Scenario, Toy};

use super::attempt::{Bench, Task};

fn bench(scenario: &str) -> Bench {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let knowledge = Knowledge {
        model: RobotModel::nominal(rig.clone()),
        described: rig.clone(),
        calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras.clone())),
        corrections: Corrections::default(),
    };
    let finder = Box::new(RenderedHand::of_rig(&rig, "right_palm_center").expect("a hand"));
    Bench::new(rig, Scenario::built_in(scenario).expect("valid"), knowledge, Some(finder)).expect("a bench")
}

#[test]
#[ignore = "minutes; figures for who works on grasps"]
fn everywhere() {
    for scenario in ["perfect", "lab"] {
        let mut bench = bench(scenario);
        for at_m in super::PLACES_M {
            let order = Order { method: Method::M5, object: "tomato".to_owned(), near_m: None };
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

/// Figures of a lab that is commissioned in the folder `PLUMBLINE_LAB` (or was), of the twin
/// `PLUMBLINE_TWIN`, by the methods `PLUMBLINE_METHODS`.
#[test]
#[ignore = "minutes; figures for who works on grasps"]
fn in_a_lab() {
    let told = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.to_owned());
    let (lab, twin) = (told("PLUMBLINE_LAB", "target/lab"), told("PLUMBLINE_TWIN", "lab"));
    let seed = told("PLUMBLINE_SEED", "1").parse().expect("a number");
    let context = plumbline_model::Unattended;
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
        twin,
        lab: lab.into(),
        methods,
        attempts,
        positions: None,
        object: told("PLUMBLINE_OBJECT", "tomato"),
        seed,
        shard: None,
        out: out.path().to_owned(),
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
