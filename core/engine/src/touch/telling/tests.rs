use plumbline_model::Unattended;
use plumbline_model::touch_plan::{Finger, PlanOptions, Purpose, TouchArea};

use super::super::plan::{Corrector, PlanRequest, make};
use super::super::testing::rig;
use super::*;
use crate::motion::ScreenPlace;

fn area(finger: Finger) -> TouchArea {
    let reached = TouchArea::reached_by(&rig(), finger.tip()).expect("a finger");
    reached.expect("it reaches some of the screen")
}

#[test]
fn touches_that_tell_most_differ_in_how_the_hand_is_held_and_say_their_noise() {
    let rig = rig();
    let options = PlanOptions::few(area(Finger::Right), Purpose::Train, 1);
    let (places, again) = options.telling().expect("commissioning learns where touches tell most");
    let place = ScreenPlace::Measured;
    let request = PlanRequest { rig: rig.clone(), place, options, corrector: Corrector::None };
    let plan = make(&request, &Unattended).expect("a plan");
    assert_eq!(plan.touches.len(), places + again);
    assert_eq!(plan.reachable(), plan.touches.len(), "{:?}", plan.view().refusals);
    let mut holds: Vec<String> = plan.touches.iter().map(|aim| format!("{:?}", aim.hold)).collect();
    holds.sort();
    holds.dedup();
    assert!(holds.len() >= 3, "one way of holding the hand does not tell joints apart: {holds:?}");
    let groups = |name: &str| plan.touches.iter().filter(|aim| aim.touch.group == name).count();
    let twice = plan.touches.iter().filter(|aim| groups(&aim.touch.group) == 2).count();
    assert_eq!(twice, 2 * again);
    assert!(plan.touches.windows(2).all(|two| two[0].touch.group != two[1].touch.group), "not at once again");

    // How the hand is held is kept with the plan, and plans of earlier have none.
    let text = serde_json::to_string(&plan).expect("plain data");
    let again: super::super::plan::RunPlan = serde_json::from_str(&text).expect("as it was written");
    assert!(again.touches.iter().zip(&plan.touches).all(|(a, b)| a.hold == b.hold));
}

#[test]
fn each_touch_that_is_added_leaves_less_open_and_the_choice_begins_alike() {
    let rig = rig();
    let planner = Planner::new(&rig, Finger::Right.tip(), ScreenPlace::Measured).expect("it points");
    let possible = candidates(&planner, &area(Finger::Right), &Unattended).expect("not cancelled");
    let choose = |count, again| choose(&rig, Finger::Right, &possible, count, again).expect("an arm");
    let (few, many) = (choose(5, 0), choose(8, 2));
    assert_eq!(few[..], many[..5], "what tells most is chosen first");
    assert_eq!(many.len(), 10);
    let all = choose(possible.len() + 3, 0);
    assert_eq!(all.len(), possible.len(), "no more than there are");
}
