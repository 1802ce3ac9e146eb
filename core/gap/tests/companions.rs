//! Two effects at once are two names, though something smooth could stand for one of them.

#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

mod common;

use common::{Plan, present, touches};
use plumbline_effects::Present;
use plumbline_gap::{Options, find};
use plumbline_model::Unattended;

/// A horn that slipped at a moment, s.
fn slipped(site: &str, step_rad: f64, at_s: f64) -> Present {
    let some = touches(&Plan { places: 4, repeats: 1, ..Plan::default() }, &[], 1);
    let mut one = present(&some, "slipped-horn", site, &[step_rad]);
    one.effect = one.effect.with_shape(Some(at_s));
    one
}

#[test]
fn two_horns_that_slipped_are_both_named() {
    let options = Options { show: false, advise: false, ..Options::default() };
    let mut found = 0;
    for seed in 0..6 {
        // Repeats follow each other: time goes with the place.
        let plan = Plan { places: 40, noise_m: 0.8e-3, ..Plan::default() };
        let hidden = [slipped("r_elbow_y", -0.018, 330.0), slipped("r_shoulder_y", 0.016, 640.0)];
        let finding =
            find(&touches(&plan, &hidden, 60 + seed), &options, &Unattended).expect("can be looked at");
        let names = |site: &str| {
            finding.effects.iter().any(|effect| {
                effect.id == "slipped-horn" && effect.class.iter().any(|member| member.site == site)
            })
        };
        println!("{:?} {}", finding.verdict, finding.sentence);
        found += usize::from(names("r_elbow_y") && names("r_shoulder_y"));
    }
    assert!(found >= 5, "{found} of 6");
}
