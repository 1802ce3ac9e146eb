//! Touches with a made-up arm and a made-up screen: every stage, and everything that can go wrong.

mod away;
mod bench;
mod failures;
mod twin;

use std::time::Duration;

use plumbline_model::robot::Posture;

use self::bench::{Asked, Bench, TARGET};
use super::lowering::Descent;
use crate::robot::command::{Destination, JogRates, RobotCommand};
use crate::robot::control::RobotControl;
use crate::robot::touch_order::{TouchRun, TouchStage};
use crate::robot::view::MotionState;

#[test]
fn a_touch_goes_through_its_stages_and_measures_at_the_contact() {
    let mut bench = Bench::new();
    bench.start();
    let end = bench.until_end(|bench| bench.touch_at_the_glass());
    use TouchStage::{Approaching, Dwelling, Lowering, Retreating, Settling};
    assert_eq!(bench.stages, [Approaching, Settling, Lowering, Dwelling, Retreating]);
    let TouchRun::Touched(measured) = end else { panic!("{end:?}") };
    assert_eq!((measured.pixel.u_px, measured.pixel.v_px), (TARGET[0], TARGET[1]));
    let commanded: Vec<f64> = measured.commanded_rad.iter().map(|a| a.expect("commanded")).collect();
    let tip = bench.chain.robot_from_tip(&commanded).translation_m();
    let beside_m = (tip.x - bench.sent.coords.x).hypot(tip.y - bench.sent.coords.y);
    assert!(beside_m < 1e-4, "{beside_m}");
    assert!((tip.z - bench.sent.coords.z).abs() < 5e-4, "{}", tip.z);
    let told = measured.commanded_tip.expect("known").coords.coords;
    assert!((told - tip).norm() < 1e-12, "{told}");
    for list in [&measured.encoder_rad, &measured.later_encoder_rad, &measured.load, &measured.temperature_c]
    {
        assert_eq!(list.iter().flatten().count(), 6, "{list:?}");
    }
    // Encoders differ from the goals by what the made-up arm sags, and are those of the contact.
    for (encoder, goal) in measured.encoder_rad.iter().flatten().zip(&commanded) {
        assert!((encoder - goal - bench::SAG_RAD).abs() < 1e-9);
    }
    assert_eq!(measured.direction.len(), 6);
    assert!(measured.direction.iter().any(|sign| *sign != 0));
    assert!((1.9..2.3).contains(&measured.move_secs), "40 mm at 20 mm/s: {}", measured.move_secs);
    let up = bench.arm().commanded.clone();
    assert!(up.distance_rad(&bench.order.lower[0]) < 1e-9, "it is above again");
}

#[test]
fn encoders_that_are_read_late_are_waited_for_and_do_not_cost_the_goals() {
    let measured_with = |silent| {
        let mut bench = Bench::new();
        bench.order.dwell = Duration::from_millis(100);
        bench.arm().silent = silent;
        bench.start();
        match bench.until_end(|bench| bench.touch_at_the_glass()) {
            TouchRun::Touched(measured) => measured,
            other => panic!("{other:?}"),
        }
    };
    let late = measured_with(Duration::from_millis(400));
    assert!(late.encoder_rad.iter().all(Option::is_some), "{late:?}");
    let never = measured_with(Duration::from_secs(60));
    assert!(never.encoder_rad.iter().all(Option::is_none), "{never:?}");
    assert!(never.commanded_rad.iter().all(Option::is_some) && never.commanded_tip.is_some());
}

#[test]
fn only_joints_of_the_arm_move_and_the_tip_stays_on_its_line() {
    let mut bench = Bench::new();
    bench.start();
    bench.until_end(|bench| bench.touch_at_the_glass());
    let asked = bench.arm().asked.clone();
    let joints = asked.iter().flat_map(Asked::joints);
    let arm = bench.rig.arm("right").expect("it has one");
    assert!(joints.into_iter().all(|joint| arm.joints.contains(&joint) || arm.hand.contains(&joint)));
    let mut heights = vec![];
    for posture in bench.arm().followed.clone() {
        let tip = bench.chain.robot_from_tip_in(&posture).translation_m();
        let beside_m = (tip.x - bench.sent.coords.x).hypot(tip.y - bench.sent.coords.y);
        assert!(beside_m < 1e-4, "{beside_m}");
        heights.push(tip.z);
    }
    assert!(heights.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9), "always down");
    assert!(heights.len() > 300, "a goal at least every 8 ms: {}", heights.len());
}

#[test]
fn the_window_is_told_what_the_touch_does_and_nothing_else_moves_the_arm() {
    let mut bench = Bench::new();
    bench.start();
    bench.until_stage(TouchStage::Lowering);
    let news = bench.worker.take_news().expect("there is a touch");
    match &news.robot.motion {
        MotionState::Moving { what, .. } => assert_eq!(what, "touch 7: lowering"),
        other => panic!("{other:?}"),
    }
    let asked = bench.arm().asked.len();
    let controls: [RobotControl; 4] = [
        RobotCommand::Preview(Destination::Pose { name: "home".to_owned() }).into(),
        RobotCommand::RunPreview.into(),
        RobotCommand::Jog(JogRates { velocity_m_s: [0.0, 0.0, 0.03], yaw_rad_s: 0.0 }).into(),
        RobotControl::TurnHead { pan_rad: 0.2, tilt_rad: -0.5 },
    ];
    for control in controls {
        bench.worker.refusal = None;
        bench.worker.control(control.clone());
        let refusal = bench.worker.refusal.clone().unwrap_or_default();
        assert!(refusal.contains("busy (touch 7: lowering)"), "{control:?}: {refusal}");
    }
    assert_eq!(bench.arm().asked.len(), asked);
    // And the touch goes on.
    let end = bench.until_end(|bench| bench.touch_at_the_glass());
    assert!(matches!(end, TouchRun::Touched(_)), "{end:?}");
}

#[test]
fn a_second_order_is_refused_and_the_first_goes_on() {
    let mut bench = Bench::new();
    bench.start();
    bench.until_stage(TouchStage::Settling);
    let second = crate::robot::TouchOrder { order: 99, ..bench.order.clone() };
    bench.worker.begin_touch(second, bench.now);
    let news = bench.worker.take_touch_news();
    let refused = news.iter().find(|news| news.order == 99).map(|news| news.state.clone());
    assert!(matches!(refused, Some(TouchRun::Interrupted(text)) if text.contains("busy")), "{news:?}");
    let end = bench.until_end(|bench| bench.touch_at_the_glass());
    assert!(matches!(end, TouchRun::Touched(_)), "{end:?}");
}

#[test]
fn it_waits_until_the_encoders_stand_still_but_not_forever() {
    let mut bench = Bench::new();
    bench.start();
    bench.until_stage(TouchStage::Settling);
    let began = bench.now;
    // Trembles for a second, by more than a tick.
    bench.until(|bench| {
        let trembles = bench.now < began + Duration::from_secs(1);
        bench.arm().tremble_rad = if trembles { 0.004 } else { 0.0 };
        bench.stages.last() == Some(&TouchStage::Lowering)
    });
    let waited = bench.now - began;
    assert!((1.1..1.4).contains(&waited.as_secs_f64()), "{waited:?}");
    assert!(bench.worker.take_notes().is_empty());

    let mut bench = Bench::new();
    bench.start();
    bench.until_stage(TouchStage::Settling);
    let began = bench.now;
    bench.arm().tremble_rad = 0.004;
    bench.until(|bench| bench.stages.last() == Some(&TouchStage::Lowering));
    let waited = (bench.now - began).as_secs_f64();
    assert!((2.9..3.2).contains(&waited), "{waited}");
    let notes = bench.worker.take_notes();
    assert!(notes.iter().any(|(_, text)| text.contains("did not stand still")), "{notes:?}");
}

#[test]
fn contacts_of_the_touch_window_count_where_there_is_no_twin() {
    let mut bench = Bench::new();
    bench.worker.begin_touch(bench.order.clone(), bench.now);
    bench.until_stage(TouchStage::Lowering);
    let end = bench.until_end(|bench| {
        if bench.height_m() <= 0.0 {
            let contact = bench.contact(TARGET);
            bench.worker.control(RobotControl::Contact(contact));
        }
    });
    assert!(matches!(end, TouchRun::Touched(_)), "{end:?}");
}

#[test]
fn a_descent_begins_above_ends_at_the_lowest_and_is_even() {
    let bench = Bench::new();
    let descent = Descent::new(&bench.order).expect("it leads down");
    let height = |posture: &Posture| bench.chain.robot_from_tip_in(posture).translation_m().z;
    assert_eq!(descent.at(0.0), bench.order.lower[0]);
    assert_eq!(Some(&descent.at(1.0)), bench.order.lower.last());
    let top_m = height(&descent.at(0.0));
    for step in 0..=100 {
        let way_m = descent.length_m() * f64::from(step) / 100.0;
        let error_m = height(&descent.at(way_m)) - (top_m - way_m);
        assert!(error_m.abs() < 1e-5, "{error_m}");
    }
    let joints = bench.chain.joints();
    let signs = descent.direction(0.03, joints);
    let (before, after) = (descent.at(0.027), descent.at(0.031));
    for (joint, sign) in joints.iter().zip(signs) {
        assert_eq!(f64::from(sign), (after[*joint] - before[*joint]).signum(), "{joint:?}");
    }
    let flat = crate::robot::TouchOrder {
        lower_tip: vec![bench.sent; bench.order.lower.len()],
        ..bench.order.clone()
    };
    assert!(Descent::new(&flat).is_none());
}
