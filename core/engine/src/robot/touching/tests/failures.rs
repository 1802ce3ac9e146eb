//! What ends a touch before its time: where the arm stands, or above the screen.

use std::time::Duration;

use plumbline_hardware::joints::{HoldReason, Motion, MoveOutcome, Refusal, ScreenGone, Unheard};
use plumbline_model::robot::Posture;

use super::bench::{Asked, Bench, TARGET};
use crate::robot::touch_order::{TouchOrder, TouchRun, TouchStage};

const STAGES: [TouchStage; 5] = [
    TouchStage::Approaching,
    TouchStage::Settling,
    TouchStage::Lowering,
    TouchStage::Dwelling,
    TouchStage::Retreating,
];

/// A touch in a stage; one that only moves lead to is held there.
fn bench_in(stage: TouchStage) -> Bench {
    let mut bench = Bench::new();
    match stage {
        TouchStage::Approaching => {
            bench.arm().outcome = None;
            bench.start();
            bench.collect();
        }
        TouchStage::Retreating => {
            bench.start();
            bench.until_stage(TouchStage::Dwelling);
            bench.arm().outcome = None;
            bench.until_stage(stage);
        }
        _ => {
            bench.start();
            bench.until_stage(stage);
        }
    }
    assert_eq!(bench.stages.last(), Some(&stage));
    bench
}

fn interrupted(end: TouchRun) -> String {
    match end {
        TouchRun::Interrupted(text) => text,
        other => panic!("{other:?}"),
    }
}

fn missed(end: TouchRun) -> String {
    match end {
        TouchRun::Missed(text) => text,
        other => panic!("{other:?}"),
    }
}

/// Nothing is asked of the arm any more but to hold.
fn stands(bench: &mut Bench) {
    let before = bench.arm().asked.len();
    for _ in 0..200 {
        assert_eq!(bench.tick(), None);
    }
    let asked = bench.arm().asked.clone();
    assert!(asked[before..].iter().all(|asked| *asked == Asked::Hold), "{:?}", &asked[before..]);
    assert!(!bench.worker.is_lowering() && bench.worker.touching.title().is_none());
}

#[test]
fn stop_ends_every_stage_where_the_arm_is() {
    for stage in STAGES {
        let mut bench = bench_in(stage);
        let asked = bench.arm().asked.len();
        bench.switches.stop.press();
        let text = interrupted(bench.until_end(|_| {}));
        assert!(text.contains("STOP was pressed") && text.contains("go on"), "{text}");
        let moved = bench.arm().asked[asked..].iter().any(|asked| *asked != Asked::Hold);
        assert!(!moved, "{stage:?}");
        stands(&mut bench);
    }
}

#[test]
fn a_lost_port_ends_every_stage() {
    for stage in STAGES {
        let mut bench = bench_in(stage);
        bench.arm().gone = Some("the cable was pulled".to_owned());
        let text = interrupted(bench.until_end(|_| {}));
        assert!(text.contains("cable was pulled"), "{stage:?}: {text}");
        stands(&mut bench);
    }
}

#[test]
fn a_joint_without_torque_ends_every_stage() {
    for stage in STAGES {
        let mut bench = bench_in(stage);
        bench.arm().torque_on = false;
        let text = interrupted(bench.until_end(|_| {}));
        assert!(text.contains("has no torque"), "{stage:?}: {text}");
        stands(&mut bench);
    }
}

#[test]
fn disconnecting_ends_it() {
    let mut bench = bench_in(TouchStage::Lowering);
    bench.worker.control(crate::robot::command::RobotCommand::Disconnect.into());
    let text = interrupted(bench.collect().expect("it is over"));
    assert!(text.contains("disconnected"), "{text}");
    assert_eq!(bench.arm().asked.last(), Some(&Asked::Hold));
}

#[test]
fn nobody_at_the_window_ends_it_on_the_way_and_on_the_way_down() {
    let silence = HoldReason::NoHeartbeat(Duration::from_secs(2));
    let mut bench = Bench::new();
    bench.arm().outcome = Some(MoveOutcome::Held(silence.clone()));
    bench.start();
    let text = interrupted(bench.until_end(|_| {}));
    assert!(text.contains("window did not answer"), "{text}");
    for stage in [TouchStage::Lowering, TouchStage::Dwelling] {
        let mut bench = bench_in(stage);
        bench.arm().motion = Motion::Holding(silence.clone());
        let text = interrupted(bench.until_end(|_| {}));
        assert!(text.contains("window did not answer"), "{text}");
        stands(&mut bench);
    }
}

#[test]
fn joints_that_were_not_heard_end_it_as_what_may_be_tried_again() {
    let (joint, name) = (Bench::new().chain.joints()[0], "Right elbow".to_owned());
    let held = [
        HoldReason::NoAnswer { joint, name: name.clone(), servo: 5, cycles: 6 },
        HoldReason::Slow {
            joint,
            name: name.clone(),
            age: Duration::from_millis(90),
            since: Duration::from_secs(2),
        },
        HoldReason::Refused(Refusal::Unknown { joint, name: name.clone(), why: Unheard::TooBusy }),
    ];
    for reason in held {
        for stage in [TouchStage::Lowering, TouchStage::Dwelling] {
            let mut bench = bench_in(stage);
            bench.arm().motion = Motion::Holding(reason.clone());
            let end = bench.until_end(|_| {});
            let TouchRun::Unheard(text) = end else { panic!("{reason:?}: {end:?}") };
            assert!(text.contains("Right elbow") && text.contains("was held where it was"), "{text}");
            stands(&mut bench);
        }
    }
    // What is hot, heavy or blocked is for a person to look at.
    let hot = Refusal::Hot { joint, name: name.clone(), temperature_c: 71.0, limit_c: 70.0 };
    for reason in [
        HoldReason::Refused(hot),
        HoldReason::Heavy { joint, name: name.clone(), load: 0.9, limit: 0.7 },
        HoldReason::NotFollowing { joint, name, behind_rad: 0.1, since: Duration::from_secs(2) },
    ] {
        let mut bench = bench_in(TouchStage::Lowering);
        bench.arm().motion = Motion::Holding(reason);
        interrupted(bench.until_end(|_| {}));
    }
}

#[test]
fn a_refused_move_or_goal_ends_it_with_the_reason() {
    let refusal = Refusal::Guarded("the elbow would meet the table".to_owned());
    let mut bench = Bench::new();
    bench.arm().refuse = Some(refusal.clone());
    bench.start();
    let text = interrupted(bench.collect().expect("at once"));
    assert!(text.contains("elbow would meet the table"), "{text}");
    stands(&mut bench);

    let mut bench = Bench::new();
    bench.arm().outcome = Some(MoveOutcome::Refused(refusal.clone()));
    bench.start();
    assert!(interrupted(bench.until_end(|_| {})).contains("elbow"));

    let mut bench = bench_in(TouchStage::Lowering);
    bench.arm().refusal = Some((1, refusal));
    assert!(interrupted(bench.until_end(|_| {})).contains("elbow"));
    stands(&mut bench);
}

#[test]
fn an_old_refusal_does_not_end_a_new_touch() {
    let mut bench = Bench::new();
    bench.arm().refusal = Some((3, Refusal::Busy));
    bench.start();
    let end = bench.until_end(|bench| bench.touch_at_the_glass());
    assert!(matches!(end, TouchRun::Touched(_)), "{end:?}");
}

#[test]
fn a_screen_that_is_gone_ends_it() {
    let mut bench = bench_in(TouchStage::Lowering);
    bench.show(Err(ScreenGone));
    let text = interrupted(bench.until_end(|_| {}));
    assert!(text.contains("The touchscreen is gone"), "{text}");
    stands(&mut bench);
}

/// What a finger that goes on deeper may do, nothing may any more when its touch is over.
#[test]
fn what_a_touch_may_meet_and_how_low_is_over_with_it() {
    let refusing = |bench: &Bench| {
        use crate::robot::touching::Hand as _;
        let paths = bench.worker.paths();
        let low = bench.order.lower.last().expect("a way down").clone();
        (paths.check(&bench.order.lower[0], &low).is_err(), paths.floor().up_m())
    };
    for how in ["ends", "is abandoned", "is interrupted"] {
        let mut bench = Bench::new();
        bench.order.deeper_m = 0.012;
        assert_eq!(refusing(&bench), (true, 0.0), "{how}: before");
        bench.start();
        bench.until_stage(TouchStage::Lowering);
        assert_eq!(refusing(&bench), (false, -0.012), "{how}: while it is lowered");
        match how {
            "ends" => drop(bench.until_end(|bench| bench.touch_at_the_glass())),
            "is abandoned" => {
                bench.worker.abandon_touch();
                drop(bench.until_end(|_| {}));
            }
            _ => {
                bench.show(Err(ScreenGone));
                drop(bench.until_end(|_| {}));
            }
        }
        assert_eq!(refusing(&bench), (true, 0.0), "{how}: afterward");
    }
    // More than is believed of an arm is not begun.
    let mut bench = Bench::new();
    bench.order.deeper_m = 0.05;
    bench.start();
    assert!(matches!(bench.collect(), Some(TouchRun::Interrupted(_))));
}

/// Glass that is broken feels nothing: the finger stays above where it is sent, and is not sent deeper.
#[test]
fn a_finger_that_pushes_on_what_the_screen_does_not_feel_is_told_from_one_in_the_air() {
    let mut bench = Bench::new();
    bench.start();
    bench.until_stage(TouchStage::Lowering);
    let text = missed(bench.until_end(|bench| {
        let pushes = bench.height_m() < 0.0;
        bench.arm().load = if pushes { 0.5 } else { 0.1 };
    }));
    assert!(text.contains("does not feel"), "{text}");
}

#[test]
fn without_a_contact_it_ends_above_after_the_lowest_place() {
    let mut bench = Bench::new();
    bench.start();
    let lowest_m = std::cell::Cell::new(1.0f64);
    let end = bench.until_end(|bench| lowest_m.set(lowest_m.get().min(bench.height_m())));
    assert_eq!(end, TouchRun::MetNothing);
    assert!(lowest_m.get() < -0.009, "it went on below the glass: {}", lowest_m.get());
    assert!(bench.height_m() > 0.039, "it is up again");
}

#[test]
fn a_contact_elsewhere_is_not_taken_and_the_arm_goes_up() {
    let mut bench = bench_in(TouchStage::Lowering);
    bench.show(Ok(Some(bench.contact([TARGET[0] - 400.0, TARGET[1]]))));
    let text = missed(bench.until_end(|_| {}));
    assert!(text.contains("400 px from the target"), "{text}");
    assert_eq!(bench.stages.last(), Some(&TouchStage::Retreating));
    assert!(bench.height_m() > 0.039);
}

#[test]
fn what_lies_on_the_screen_already_is_not_the_finger() {
    let mut bench = bench_in(TouchStage::Settling);
    bench.show(Ok(Some(bench.contact(TARGET))));
    let text = missed(bench.until_end(|_| {}));
    assert!(text.contains("before the finger was lowered"), "{text}");
    assert!(bench.arm().followed.is_empty(), "it was not lowered");
    // A contact of the touch before, long over, is none of this one.
    let mut bench = Bench::new();
    let mut over = bench.contact(TARGET);
    over.is_down = false;
    bench.show(Ok(Some(over)));
    bench.start();
    bench.until_stage(TouchStage::Lowering);
}

#[test]
fn too_much_load_ends_the_lowering_and_the_arm_goes_up() {
    let mut bench = bench_in(TouchStage::Lowering);
    let limit = bench.rig.gate.load;
    bench.arm().load = -0.95 * limit;
    let text = missed(bench.until_end(|_| {}));
    assert!(text.contains("pushed against something"), "{text}");
    assert!(bench.height_m() > 0.039);
    // Less is what an arm carries.
    let mut bench = Bench::new();
    bench.arm().load = 0.85 * limit;
    bench.start();
    let end = bench.until_end(|bench| bench.touch_at_the_glass());
    assert!(matches!(end, TouchRun::Touched(_)), "{end:?}");
}

#[test]
fn abandoned_it_goes_up_from_the_glass_and_holds_elsewhere() {
    for stage in STAGES {
        let mut bench = bench_in(stage);
        if stage == TouchStage::Lowering {
            bench.until(|bench| bench.height_m() < 0.03);
        }
        bench.arm().outcome = Some(MoveOutcome::Arrived { residual_rad: 0.0 });
        let asked = bench.arm().asked.len();
        bench.worker.abandon_touch();
        let text = match stage {
            TouchStage::Retreating => continue,
            TouchStage::Approaching | TouchStage::Settling => missed(bench.collect().expect("at once")),
            _ => missed(bench.until_end(|_| {})),
        };
        assert!(text.contains("left out"), "{text}");
        let new = bench.arm().asked[asked..].to_vec();
        match stage {
            TouchStage::Approaching => assert_eq!(new, [Asked::Hold]),
            TouchStage::Settling => assert_eq!(new, []),
            _ => {
                assert!(matches!(new[..], [Asked::Move(_)]), "{new:?}");
                assert!(bench.height_m() > 0.039);
            }
        }
        stands(&mut bench);
    }
}

#[test]
fn orders_that_make_no_sense_move_nothing() {
    let bench = Bench::new();
    let good = bench.order.clone();
    let short = Posture::new(vec![0.0; 3]);
    let orders = [
        TouchOrder { lower: vec![], lower_tip: vec![], ..good.clone() },
        TouchOrder { lower_tip: good.lower_tip[1..].to_vec(), ..good.clone() },
        TouchOrder { approach: vec![short], ..good.clone() },
        TouchOrder { lower_speed_m_s: 0.0, ..good.clone() },
        TouchOrder { speed_rad_s: f64::NAN, ..good.clone() },
        TouchOrder { plausible_px: f64::NAN, ..good.clone() },
        TouchOrder { tip: "nose".to_owned(), ..good.clone() },
    ];
    for order in orders {
        let mut bench = Bench::new();
        bench.order = order.clone();
        bench.start();
        let text = interrupted(bench.collect().expect("at once"));
        assert!(text.contains("Plan anew"), "{text}");
        assert_eq!(bench.arm().asked, []);
    }
    let mut bench = Bench::new();
    bench.worker.arm = None;
    bench.start();
    assert!(interrupted(bench.collect().expect("at once")).contains("Connect first"));
    let mut bench = Bench::new();
    bench.switches.stop.press();
    bench.start();
    assert!(interrupted(bench.collect().expect("at once")).contains("STOP is pressed"));
    assert_eq!(bench.arm().asked, []);
}

#[test]
fn a_way_through_the_table_is_not_begun() {
    let mut bench = Bench::new();
    let joints = ["r_shoulder_y", "r_elbow_y", "r_arm_x"]
        .map(|name| bench.rig.description.find_joint(name).expect("NICO"));
    bench.order.approach[0] = bench.rig.home().with(&joints, &[0.3, 3.1, 0.1]);
    bench.start();
    let text = interrupted(bench.collect().expect("at once"));
    assert!(text.contains("would run into"), "{text}");
    assert!(bench.arm().asked.iter().all(|asked| *asked == Asked::Hold));
}
