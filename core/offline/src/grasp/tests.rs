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
