//! The way from the screen: it is gone through all limits, tells of itself, and can be stopped.

use plumbline_hardware::joints::MoveOutcome;
use plumbline_model::robot::Posture;

use super::bench::{Asked, Bench};
use crate::motion::{Planner, ScreenPlace};
use crate::robot::command::{Destination, RobotCommand};
use crate::robot::control::RobotControl;
use crate::robot::touch_order::{TouchRun, TouchStage, WithdrawOrder};

fn planner(bench: &Bench) -> Planner {
    Planner::new(&bench.rig, "right_index_tip", ScreenPlace::Measured).expect("it can point at the screen")
}

/// An arm that hovers over its target, and the order to go home from there.
fn hovering() -> (Bench, WithdrawOrder) {
    let bench = Bench::new();
    let hovers = bench.order.lower[0].clone();
    bench.arm().commanded = hovers.clone();
    let beside_m = bench.order.beside_m;
    let way = planner(&bench).away(&hovers, beside_m).expect("a free way");
    let tip = bench.order.tip.clone();
    (bench, WithdrawOrder { number: Some(8), order: 2, tip, way, beside_m, speed_rad_s: 0.6 })
}

fn begin(bench: &mut Bench, order: &WithdrawOrder) {
    bench.worker.control(RobotControl::Withdraw(Box::new(order.clone())));
}

/// What is told of the order until it ends, or nothing more comes.
fn told(bench: &mut Bench) -> Vec<TouchRun> {
    let mut told = vec![];
    for _ in 0..50 {
        for news in bench.worker.take_touch_news() {
            assert_eq!((news.order, news.number), (2, Some(8)));
            told.push(news.state);
        }
        bench.pass();
    }
    told
}

#[test]
fn the_arm_goes_home_and_only_its_own_joints_move() {
    let (mut bench, order) = hovering();
    begin(&mut bench, &order);
    assert_eq!(told(&mut bench), [TouchRun::Doing(TouchStage::Withdrawing), TouchRun::Away]);
    let home = bench.rig.home();
    let arm = bench.rig.arm("right").expect("it has one").clone();
    let stands = bench.arm().commanded.of(&arm.joints);
    assert!(stands.iter().zip(home.of(&arm.joints)).all(|(is, home)| (is - home).abs() < 1e-9));
    let moved: Vec<_> = bench.arm().asked.iter().flat_map(Asked::joints).collect();
    assert!(!moved.is_empty());
    assert!(moved.iter().all(|joint| arm.joints.contains(joint) || arm.hand.contains(joint)));
}

#[test]
fn nothing_else_moves_the_arm_meanwhile_and_it_is_said_what_it_does() {
    let (mut bench, order) = hovering();
    bench.arm().outcome = None;
    begin(&mut bench, &order);
    assert_eq!(bench.worker.touching.title().as_deref(), Some("away from the screen"));
    let asked = bench.arm().asked.len();
    bench.worker.control(RobotCommand::Preview(Destination::Pose { name: "home".to_owned() }).into());
    assert!(bench.worker.refusal.clone().unwrap_or_default().contains("busy (away from the screen)"));
    bench.worker.begin_touch(bench.order.clone(), bench.now);
    let news = bench.worker.take_touch_news();
    let refused = news.iter().find(|news| news.order == bench.order.order).map(|news| news.state.clone());
    assert!(matches!(refused, Some(TouchRun::Interrupted(text)) if text.contains("busy")), "{news:?}");
    assert_eq!(bench.arm().asked.len(), asked);
}

#[test]
fn stop_interrupts_it_and_the_arm_holds() {
    let (mut bench, order) = hovering();
    bench.arm().outcome = None;
    begin(&mut bench, &order);
    bench.switches.stop.press();
    let told = told(&mut bench);
    assert!(
        matches!(told.last(), Some(TouchRun::Interrupted(text)) if text.contains("STOP was pressed")),
        "{told:?}"
    );
    assert_eq!(bench.arm().asked.last(), Some(&Asked::Hold));
    begin(&mut bench, &order);
    let news = bench.worker.take_touch_news();
    assert!(
        matches!(&news[..], [one] if matches!(&one.state, TouchRun::Interrupted(text) if text.contains("Release it"))),
        "{news:?}"
    );
}

#[test]
fn one_that_is_not_wanted_any_more_ends_where_the_arm_stands() {
    let (mut bench, order) = hovering();
    bench.arm().outcome = None;
    begin(&mut bench, &order);
    bench.worker.control(RobotControl::AbandonTouch);
    let told = told(&mut bench);
    assert!(matches!(told.last(), Some(TouchRun::Missed(_))), "{told:?}");
    assert_eq!(bench.arm().asked.last(), Some(&Asked::Hold));
    assert_eq!(bench.worker.touching.title(), None);
}

#[test]
fn a_way_that_is_none_is_not_gone() {
    let (mut bench, order) = hovering();
    let bad = [
        WithdrawOrder { way: vec![Posture::new(vec![0.0; 3])], ..order.clone() },
        WithdrawOrder { speed_rad_s: f64::NAN, ..order.clone() },
        WithdrawOrder { beside_m: nalgebra::Vector3::repeat(f64::NAN), ..order.clone() },
    ];
    for bad in bad {
        begin(&mut bench, &bad);
        let news = bench.worker.take_touch_news();
        assert!(
            matches!(&news[..], [one] if matches!(&one.state, TouchRun::Interrupted(text) if text.contains("Plan anew"))),
            "{news:?}"
        );
    }
    assert!(bench.arm().asked.is_empty());
    bench.arm().outcome = Some(MoveOutcome::Replaced);
    begin(&mut bench, &order);
    let told = told(&mut bench);
    assert!(
        matches!(told.last(), Some(TouchRun::Interrupted(text)) if text.contains("moved the arm")),
        "{told:?}"
    );
}
