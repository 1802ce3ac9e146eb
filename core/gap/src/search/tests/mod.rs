//! The search on sessions made with the own forward model: what must never happen there. How well it
//! does is judged by the blind test, on physics that shares no formula with it.

mod simulate;

use plumbline_model::Unattended;

use super::search;
use crate::finding::Verdict;
use crate::options::Options;
use simulate::{Bench, Plan};

fn options() -> Options {
    Options { advise: false, ..Options::default() }
}

#[test]
fn noise_alone_gets_no_name() {
    let bench = Bench::new(Plan::Plain);
    let named = (0..4)
        .filter(|&seed| {
            let (measurements, floor) = bench.case(seed).expect("can be made");
            let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
            !found.effects.is_empty()
        })
        .count();
    assert_eq!(named, 0);
}

#[test]
fn a_large_effect_is_named_and_sized() {
    let bench = Bench::new(Plan::Rich);
    let (measurements, floor) = bench.certain("joint-zero", "r_elbow_y", 0.06, 7).expect("can be made");
    let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.effects);
    assert_eq!(found.effects[0].id, "joint-zero");
    assert_eq!(found.effects[0].site, "r_elbow_y");
    let offset = &found.effects[0].parameters[0];
    assert!((offset.value - 0.06).abs() < 0.005, "{offset:?}");
    assert!(offset.low < 0.06 && 0.06 < offset.high, "{offset:?}");
}

#[test]
fn permuted_residuals_name_nothing() {
    let bench = Bench::new(Plan::Plain);
    let (mut measurements, floor) = bench.certain("joint-zero", "r_elbow_y", 0.03, 5).expect("can be made");
    bench.permute(&mut measurements, 11);
    let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
    let confident = found.verdict != Verdict::NotInLibrary && !found.effects.is_empty();
    assert!(!confident, "{:?} {:?}", found.verdict, found.effects);
}
