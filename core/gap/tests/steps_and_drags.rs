//! A step is found where it is, not where the nearest moment was tried; a drag, whichever way it grows.

#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

mod common;

use common::{Plan, poses, present, touches};
use plumbline_effects::Present;
use plumbline_gap::finding::{Finding, NamedEffect};
use plumbline_gap::{Options, Verdict, find};
use plumbline_model::Unattended;

fn shaped(plan: &Plan, id: &str, site: &str, value: f64, shape: Option<f64>) -> Present {
    let mut one = present(&touches(plan, &[], 1), id, site, &[value]);
    one.effect = one.effect.with_shape(shape);
    one
}

fn found(plan: &Plan, hidden: &[Present], seed: u64) -> Finding {
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(&touches(plan, hidden, seed), &options, &Unattended).expect("can be looked at");
    println!("{:?} {}", finding.verdict, finding.sentence);
    finding
}

fn named<'a>(finding: &'a Finding, id: &str, site: &str) -> Option<&'a NamedEffect> {
    finding.effects.iter().find(|effect| effect.id == id && effect.site == site)
}

#[test]
fn the_moment_of_a_large_step_is_known_to_a_few_rows() {
    // 160 rows, 8 s apart: moments that are tried first lie 80 s apart.
    let plan = Plan { places: 40, repeats: 4, noise_m: 0.8e-3, ..Plan::default() };
    let mut narrow = 0;
    for (seed, at_s) in [(1, 444.0), (2, 676.0), (3, 860.0)] {
        let finding = found(&plan, &[shaped(&plan, "slipped-horn", "r_elbow_y", 0.05, Some(at_s))], seed);
        let slipped = named(&finding, "slipped-horn", "r_elbow_y").expect("named");
        let moment = slipped.parameters.iter().find(|one| one.name == "t_secs").expect("reported");
        println!("{at_s}: {} ({} to {})", moment.value, moment.low, moment.high);
        assert!(moment.low <= at_s && at_s <= moment.high, "{at_s}: {moment:?}");
        // Half of what lies between two moments that are tried first.
        assert!((moment.value - at_s).abs() < 40.0, "{at_s}: {moment:?}");
        narrow += usize::from(moment.high - moment.low <= 64.0);
        assert_eq!(finding.effects.len(), 1, "no companion stands for rows on the wrong side of the step");
    }
    // A moment of the first ones that suits best keeps their range.
    assert!(narrow >= 2, "{narrow} of 3");
}

#[test]
fn a_horn_that_slips_between_two_laps_of_an_arm_is_found_where_it_is() {
    // The flange goes here this way and there that way: along x, y and z the spread of repeats only looks wider, and what is
    // far off after a large slip looks like mishaps.
    let plan = Plan { places: 80, repeats: 2, noise_m: 0.4e-3, by_passes: true, ..Plan::default() };
    let some = poses(&plan, &[], 1);
    let at_s = some.rows[100].t_secs.expect("logged");
    for (seed, step_rad) in [(1, 0.012), (2, 0.08)] {
        let mut slip = present(&some, "slipped-horn", "r_shoulder_z", &[step_rad]);
        slip.effect = slip.effect.with_shape(Some(at_s));
        let options = Options { show: false, advise: false, ..Options::default() };
        let finding = find(&poses(&plan, &[slip], seed), &options, &Unattended).expect("can be looked at");
        println!("{:?} {}", finding.verdict, finding.sentence);
        assert_eq!(finding.verdict, Verdict::Named, "{}", finding.sentence);
        let slipped = named(&finding, "slipped-horn", "r_shoulder_z").expect("named");
        let step = slipped.parameters.iter().find(|one| one.name == "step_rad").expect("reported");
        assert!(step.low <= step_rad && step_rad <= step.high, "{step:?}");
        let set_aside = finding.comparison.residuals.iter().filter(|one| one.outlier).count();
        assert!(set_aside < 8, "{set_aside} of 160");
    }
}

#[test]
fn a_screen_that_was_knocked_and_turned_between_two_passes_is_no_noise() {
    // What the turn does to touches is nothing on average; the spread of repeats is nine times the noise.
    let plan = Plan { places: 36, repeats: 3, by_passes: true, ..Plan::default() };
    let mut knocked = present(&touches(&plan, &[], 1), "screen-bumped", "screen", &[-0.002, 0.003, 0.16]);
    knocked.effect = knocked.effect.with_shape(Some(580.0));
    let finding = found(&plan, &[knocked], 5);
    assert!(finding.comparison.is_gap, "{}", finding.sentence);
    let knock = named(&finding, "screen-bumped", "screen").expect("named");
    let yaw = knock.parameters.iter().find(|one| one.name == "yaw_rad").expect("reported");
    assert!(yaw.low <= 0.16 && 0.16 <= yaw.high, "{yaw:?}");
}

#[test]
fn a_screen_that_was_knocked_far_is_no_row_of_outliers() {
    let plan = Plan { places: 30, repeats: 2, by_passes: true, ..Plan::default() };
    for (seed, at_s) in [(1, 300.0), (2, 330.0)] {
        let mut knocked = present(&touches(&plan, &[], 1), "screen-bumped", "screen", &[0.02, -0.02, 0.05]);
        knocked.effect = knocked.effect.with_shape(Some(at_s));
        let finding = found(&plan, &[knocked], seed);
        println!("{:?}", finding.warnings);
        assert!(named(&finding, "screen-bumped", "screen").is_some(), "{}", finding.sentence);
        let set_aside = finding.warnings.iter().find(|words| words.contains("far from all others"));
        assert_eq!(set_aside, None);
    }
}

#[test]
fn a_drag_is_named_whichever_way_it_grows() {
    // Every finger comes in about as flat here, so which of the two it is stays open, and the interval reaches over both.
    let plan = Plan { places: 60, sides: vec!["plus", "minus"], noise_m: 0.6e-3, ..Plan::default() };
    for shape in [None, Some(1.0)] {
        let finding = found(&plan, &[shaped(&plan, "touch-drag", "tip", 0.004, shape)], 7);
        assert!(matches!(finding.verdict, Verdict::Named | Verdict::Class), "{}", finding.sentence);
        let drag = named(&finding, "touch-drag", "tip").expect("named");
        let way = drag.parameters.iter().find(|one| one.name == "drag_m").expect("reported");
        assert!(way.low <= 0.004 && 0.004 <= way.high, "{way:?}");
    }
}
