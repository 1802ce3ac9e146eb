//! Effects that were put in with the forward model: found, named, sized, and the gap closed.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

mod common;

use std::time::Instant;

use common::{Plan, elbow_zero, places, present, touches};
use plumbline_effects::Present;
use plumbline_gap::finding::ShownUnit;
use plumbline_gap::{Finding, Options, Verdict, find};
use plumbline_model::Unattended;

fn rich() -> Plan {
    Plan {
        places: 90,
        repeats: 2,
        payloads: vec![0.0, 0.25],
        sides: vec!["plus", "minus"],
        heights: vec![0.0, 0.06, 0.12],
        ..Plan::default()
    }
}

fn of_arm(id: &str, site: &str, values: &[f64]) -> Present {
    let some = touches(&Plan { places: 1, repeats: 1, ..Plan::default() }, &[], 1);
    present(&some, id, site, values)
}

/// Whether one of the classes holds the name.
fn names(finding: &Finding, hidden: &Present) -> bool {
    let is_it = |id: &str, site: &str| id == hidden.effect.id() && site == hidden.effect.site;
    finding.effects.iter().any(|effect| {
        is_it(&effect.id, &effect.site) || effect.class.iter().any(|member| is_it(&member.id, &member.site))
    })
}

#[test]
fn one_effect_is_named_and_sized_and_the_gap_closes() {
    let hidden = [
        elbow_zero(0.08),
        of_arm("joint-sag", "r_shoulder_y", &[0.012]),
        of_arm("screen-scale", "screen", &[0.03, -0.02]),
        of_arm("backlash", "r_shoulder_z", &[0.012]),
        of_arm("tip-offset", "tip", &[0.008, -0.006, 0.01]),
    ];
    for (seed, hidden) in hidden.iter().enumerate() {
        let measurements = touches(&rich(), std::slice::from_ref(hidden), 20 + seed as u64);
        let finding = find(&measurements, &Options::default(), &Unattended).expect("can be looked at");
        println!("{}@{}: {}", hidden.effect.id(), hidden.effect.site, finding.sentence);
        assert!(matches!(finding.verdict, Verdict::Named | Verdict::Class), "{:?}", finding.verdict);
        assert!(names(&finding, hidden), "{:?}", finding.effects);
        let shown = &finding.shown;
        assert_eq!(shown.unit, ShownUnit::Meter);
        let closure = shown.closure.expect("there was a gap");
        assert!(closure > 0.8, "{closure}: {} {} {}", shown.before, shown.after, shown.floor);
        let [low, high] = shown.closure_range.expect("many blocks");
        assert!(low <= closure && closure <= high);
        assert!(shown.inside_95 > 0.88, "{}", shown.inside_95);
        let unseen = shown.unseen.as_ref().expect("two weights");
        assert!(unseen.after < unseen.before || unseen.before < 1.2 * unseen.floor, "{unseen:?}");
        if let Some(effect) = finding.effects.iter().find(|effect| effect.id == hidden.effect.id()) {
            for (value, truth) in effect.values.iter().zip(&hidden.values) {
                assert!((value - truth).abs() < 0.25 * truth.abs() + 1e-3, "{value} for {truth}");
            }
        }
    }
}

#[test]
fn the_place_is_inferred_through_a_turned_eye() {
    let some = places(1, &[], 1e-4, 1);
    let hidden = present(&some, "eye-yaw", "right", &[0.01]);
    let measurements = places(2, std::slice::from_ref(&hidden), 5e-4, 2);
    let finding = find(&measurements, &Options::default(), &Unattended).expect("can be looked at");
    println!("{}", finding.sentence);
    assert!(finding.comparison.is_gap);
    let closure = finding.shown.closure.expect("there was a gap");
    assert!(closure > 0.85, "{closure}");
}

#[test]
fn five_thousand_rows_in_time() {
    let plan = Plan { places: 1250, repeats: 4, payloads: vec![0.0, 0.25], ..Plan::default() };
    let measurements = touches(&plan, &[elbow_zero(0.02)], 9);
    let start = Instant::now();
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(&measurements, &options, &Unattended).expect("can be looked at");
    println!("5000 rows in {:.1} s: {}", start.elapsed().as_secs_f64(), finding.sentence);
    assert!(finding.comparison.is_gap);
}
