// What was measured is printed.
#![allow(clippy::print_stdout)]

use std::collections::{BTreeMap, BTreeSet};

use super::*;
use crate::robot::Rig;

fn screen() -> Touchscreen {
    Rig::built_in("nico").expect("comes with the program").touchscreen
}

fn area() -> TouchArea {
    TouchArea { u_px: [400.0, 1700.0], v_px: [450.0, 1000.0] }
}

fn plan(options: &PlanOptions) -> TouchPlan {
    TouchPlan::make(options, &screen()).expect("a proper plan")
}

fn with(patterns: Vec<Pattern>) -> PlanOptions {
    PlanOptions { patterns, ..PlanOptions::quick(area()) }
}

/// Touches of each group, by their numbers.
fn groups(plan: &TouchPlan) -> BTreeMap<&str, Vec<&PlannedTouch>> {
    let mut groups: BTreeMap<&str, Vec<&PlannedTouch>> = BTreeMap::new();
    for touch in &plan.touches {
        groups.entry(&touch.group).or_default().push(touch);
    }
    groups
}

/// Length of the way along the targets, m.
fn way_m(touches: &[PlannedTouch]) -> f64 {
    touches
        .windows(2)
        .map(|pair| screen().point_at(pair[0].target).distance_m(&screen().point_at(pair[1].target)))
        .sum()
}

#[test]
fn the_usual_plans_have_the_usual_size() {
    let first = plan(&PlanOptions::first(area()));
    assert!((75..=90).contains(&first.touches.len()), "{}", first.touches.len());
    let repeated: Vec<usize> = groups(&first).values().map(Vec::len).filter(|count| *count > 1).collect();
    assert!(repeated.len() >= 5 && repeated.iter().any(|count| *count >= 5), "{repeated:?}");
    assert!((22..=26).contains(&plan(&PlanOptions::quick(area())).touches.len()));
    assert_eq!(plan(&PlanOptions::check_reach(area(), 250, 3)).touches.len(), 250);
    assert_eq!(plan(&PlanOptions::place_screen(area())).touches.len(), 8);
    let few = |purpose| PlanOptions::few(area(), purpose, 7);
    let patterned = [Purpose::PlaceScreen, Purpose::Check].map(|purpose| plan(&few(purpose)).touches.len());
    assert_eq!(patterned, [5, 5]);
    assert_eq!(few(Purpose::Train).telling(), Some((12, 3)), "25 in all");
    let rich = plan(&PlanOptions::rich(area()));
    assert_eq!(rich.touches.len(), 17 * 2 * 3 * 2);
}

#[test]
fn what_tells_most_is_chosen_alone_and_with_the_arm() {
    let options = PlanOptions::few(area(), Purpose::Train, 7);
    assert_eq!(options.check(&screen()), Ok(()));
    assert_eq!(TouchPlan::make(&options, &screen()), Err(PlanError::TellingNeedsArm));
    let mut beside = options.clone();
    beside.patterns.push(Pattern::Corners);
    let on_block = PlanOptions { screen_heights_m: vec![0.06], ..options.clone() };
    for options in [beside, on_block] {
        assert_eq!(options.check(&screen()), Err(PlanError::TellingAlone));
    }
    let none = PlanOptions { patterns: vec![Pattern::Telling { places: 0, again: 3 }], ..options };
    assert!(matches!(none.check(&screen()), Err(PlanError::EmptyPattern { .. })));
}

#[test]
fn every_touch_is_numbered_and_lies_in_the_area() {
    for options in
        [PlanOptions::first(area()), PlanOptions::rich(area()), PlanOptions::check_reach(area(), 100, 9)]
    {
        let plan = plan(&options);
        for (i, touch) in plan.touches.iter().enumerate() {
            assert_eq!(touch.number, i + 1);
            assert!(area().contains(touch.target), "{touch:?}");
            assert!(!touch.set.is_empty() && !touch.group.is_empty());
        }
        assert_eq!(plan, super::tests::plan(&options), "the same options make the same plan");
    }
}

#[test]
fn a_group_is_one_command_from_one_side() {
    let plan = plan(&PlanOptions { repeats: 2, ..PlanOptions::rich(area()) });
    let mut states = BTreeSet::new();
    for (name, members) in groups(&plan) {
        let state =
            |t: &PlannedTouch| format!("{:?} {:?} {} {}", t.target, t.side, t.screen_height_m, t.payload_kg);
        assert!(members.iter().all(|touch| state(touch) == state(members[0])), "{name}");
        assert!(members.iter().all(|touch| touch.set == members[0].set), "{name}: one set, or folds leak");
        assert!(states.insert(state(members[0])), "{name}: one group for one state");
        assert!(members.len() >= 2);
    }
}

#[test]
fn a_place_of_two_patterns_is_one_target() {
    let both = plan(&with(vec![Pattern::Grid { columns: 3, rows: 3 }, Pattern::Corners]));
    assert_eq!(both.touches.len(), 13);
    let groups = groups(&both);
    assert_eq!(groups.len(), 9);
    assert_eq!(groups.values().filter(|members| members.len() == 2).count(), 4);
}

#[test]
fn repeats_are_spread_over_the_run() {
    for options in [PlanOptions::first(area()), PlanOptions { repeats: 3, ..PlanOptions::quick(area()) }] {
        let plan = plan(&options);
        for pair in plan.touches.windows(2) {
            assert_ne!(pair[0].target, pair[1].target, "touch {} repeats the one before", pair[1].number);
        }
        let most = groups(&plan).into_values().max_by_key(Vec::len).expect("a group");
        let numbers: Vec<usize> = most.iter().map(|touch| touch.number).collect();
        let span = numbers[numbers.len() - 1] - numbers[0];
        assert!(2 * span > plan.touches.len(), "{numbers:?} of {}", plan.touches.len());
        // Each third of the run sees the whole area.
        for third in plan.touches.chunks(plan.touches.len() / 3) {
            let columns: Vec<f64> = third.iter().map(|touch| touch.target.u_px).collect();
            let reach = columns.iter().fold(f64::MIN, |a, b| a.max(*b))
                - columns.iter().fold(f64::MAX, |a, b| a.min(*b));
            assert!(third.len() < 5 || reach > 0.7 * 1300.0, "{reach}");
        }
    }
}

#[test]
fn ways_are_short() {
    let random = plan(&PlanOptions::check_reach(area(), 100, 4));
    let straight = way_m(&random.touches);
    let mut shuffled = random.touches.clone();
    shuffled.sort_by_key(|touch| touch.group.clone());
    println!("way through 100 targets {straight:.2} m, in random order {:.2} m", way_m(&shuffled));
    assert!(straight < 0.25 * way_m(&shuffled));
    // A grid is walked along its rows or columns: no step is longer than a diagonal.
    let grid = plan(&with(vec![Pattern::Grid { columns: 6, rows: 5 }]));
    let pitch_m = 0.2474e-3 * 1300.0 / 5.0;
    assert!(way_m(&grid.touches) < 29.0 * pitch_m * 1.3, "{}", way_m(&grid.touches));
}

#[test]
fn the_largest_plan_is_made_quickly() {
    let start = std::time::Instant::now();
    let plan = plan(&PlanOptions::check_reach(area(), MOST_TOUCHES, 4));
    let took = start.elapsed();
    println!(
        "{} touches are planned in {took:.0?}, a way of {:.1} m",
        plan.touches.len(),
        way_m(&plan.touches)
    );
    assert!(took.as_secs_f64() < 2.0, "{took:?}");
}

#[test]
fn what_needs_hands_changes_rarely() {
    let plan = plan(&PlanOptions::rich(area()));
    assert_eq!(plan.changes().len(), 5, "three heights with two weights each");
    // The weight stays on while the screen is lifted.
    let states: Vec<(f64, f64)> = plan
        .changes()
        .iter()
        .map(|n| &plan.touches[n - 1])
        .map(|t| (t.screen_height_m, t.payload_kg))
        .collect();
    assert_eq!(states, [(0.0, 0.25), (0.06, 0.25), (0.06, 0.0), (0.12, 0.0), (0.12, 0.25)]);
}

#[test]
fn both_sides_touch_the_same_targets() {
    let plan = plan(&PlanOptions { sides: Sides::LeftAndRight, ..PlanOptions::first(area()) });
    let of = |side: Side| -> Vec<String> {
        let mut targets: Vec<String> = plan
            .touches
            .iter()
            .filter(|touch| touch.side == side)
            .map(|touch| format!("{:?}", touch.target))
            .collect();
        targets.sort();
        targets
    };
    assert_eq!(of(Side::Left), of(Side::Right));
    assert!(of(Side::Above).is_empty());
}

#[test]
fn seeds_move_random_targets_only() {
    let of = |seed| plan(&PlanOptions::check_reach(area(), 20, seed));
    assert_ne!(of(1).touches, of(2).touches);
    let grid = |seed| plan(&PlanOptions { seed, ..PlanOptions::first(area()) }).touches;
    assert_eq!(grid(1), grid(2));
    let sets: BTreeSet<String> = of(1).touches.into_iter().map(|touch| touch.set).collect();
    assert_eq!(sets.len(), 4, "{sets:?}");
}

#[test]
fn plans_survive_a_file() {
    let plan = plan(&PlanOptions::rich(area()));
    let text = toml::to_string(&plan).expect("text");
    assert_eq!(toml::from_str::<TouchPlan>(&text).expect("a plan"), plan);
}

#[test]
fn an_area_within_the_border_is_on_the_screen() {
    let inner = TouchArea::within(&screen(), 0.02);
    assert!(inner.corners().into_iter().all(|corner| screen().contains(corner)));
    let edge_m = screen().point_at(inner.corners()[0]).distance_m(&screen().origin);
    assert!((edge_m - 0.02 * std::f64::consts::SQRT_2).abs() < 1e-9, "{edge_m}");
}

#[test]
fn plans_that_cannot_be_made_say_what_to_do() {
    let says = |options: PlanOptions, words: &str| {
        let message = TouchPlan::make(&options, &screen()).expect_err("refused").to_string();
        assert!(message.contains(words), "\"{words}\" is not in: {message}");
    };
    let quick = PlanOptions::quick(area());
    let of_area = |u_px, v_px| PlanOptions { area: TouchArea { u_px, v_px }, ..quick.clone() };
    says(of_area([700.0, 700.0], [450.0, 1000.0]), "is empty");
    says(of_area([900.0, 700.0], [450.0, 1000.0]), "is empty");
    says(of_area([f64::NAN, 700.0], [450.0, 1000.0]), "is empty");
    says(of_area([400.0, 2500.0], [450.0, 1000.0]), "beyond the screen of 1920×1080");
    says(of_area([400.0, f64::INFINITY], [450.0, 1000.0]), "beyond the screen");
    says(with(vec![]), "no pattern");
    says(with(vec![Pattern::Grid { columns: 0, rows: 3 }]), "grid has no target");
    says(with(vec![Pattern::Random { count: 0 }]), "random pattern has no target");
    says(with(vec![Pattern::Lines { horizontal: 1, vertical: 0, diagonal: 0, points: 1 }]), "two targets");
    says(with(vec![Pattern::Lines { horizontal: 0, vertical: 0, diagonal: 3, points: 5 }]), "two diagonals");
    says(with(vec![Pattern::Again { targets: 2, times: 2 }]), "nothing to be repeated");
    says(PlanOptions { repeats: 0, ..quick.clone() }, "zero times");
    says(PlanOptions { repeats: 500, ..quick.clone() }, "more than 2000");
    says(PlanOptions { repeats: usize::MAX, ..quick.clone() }, "more than 2000");
    says(with(vec![Pattern::Grid { columns: usize::MAX, rows: 2 }]), "more than 2000");
    says(PlanOptions { screen_heights_m: vec![], ..quick.clone() }, "screen heights is empty");
    says(PlanOptions { screen_heights_m: vec![0.06, 0.06], ..quick.clone() }, "twice");
    says(PlanOptions { payloads_kg: vec![-0.1], ..quick.clone() }, "holds -0.1");
    says(PlanOptions { payloads_kg: vec![f64::NAN], ..quick.clone() }, "holds NaN");
    let line = Pattern::Lines { horizontal: 1, vertical: 0, diagonal: 0, points: 5 };
    says(PlanOptions { purpose: Purpose::PlaceScreen, ..with(vec![line]) }, "on a line");
}

#[test]
fn the_largest_rectangle_is_found() {
    // Everything but the far left corner: either what is right of it or what is near of it.
    let corner = |pixel: Pixel<Screen>| pixel.u_px < 300.0 && pixel.v_px < 700.0;
    let area = TouchArea::largest_where(&screen(), |pixel| !corner(pixel)).expect("an area");
    assert!(area.u_px[0] > 300.0 && area.u_px[0] < 450.0, "{area:?}");
    assert!(area.u_px[1] > 1850.0 && area.v_px[0] < 60.0 && area.v_px[1] > 1020.0, "{area:?}");
    assert!(TouchArea::largest_where(&screen(), |_| false).is_none());
    let mut one = false;
    let single = TouchArea::largest_where(&screen(), |_| !std::mem::replace(&mut one, true));
    assert!(single.is_none(), "a single place is no area");
    let whole = TouchArea::largest_where(&screen(), |_| true).expect("an area");
    assert_eq!(whole, TouchArea::within(&screen(), 0.01));
}

#[test]
fn arms_reach_their_own_side() {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let start = std::time::Instant::now();
    let right = TouchArea::reached_by(&rig, "right_index_tip").expect("a tip").expect("an area");
    println!("the right finger reaches {right:?}, found in {:.0?}", start.elapsed());
    let left = TouchArea::reached_by(&rig, "left_index_tip").expect("a tip").expect("an area");
    let middle = |area: &TouchArea| 0.5 * (area.u_px[0] + area.u_px[1]);
    assert!(middle(&right) > middle(&left), "{right:?} and {left:?}");
    assert!(TouchPlan::make(&PlanOptions::first(right), &screen()).is_ok());
    assert!(TouchArea::reached_by(&rig, "nose").is_err());
}
