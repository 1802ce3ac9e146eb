//! A test bench: sessions made with the own forward model, and how well the search does on them.
//! Generator and search share formulas here, so this is for development and for calibrating
//! probabilities; the judge is the blind test on physics that shares none.

mod score;
mod simulate;

use plumbline_model::Unattended;
use rayon::prelude::*;

use super::search;
use crate::finding::Verdict;
use crate::options::Options;
use score::{Score, Tally};
use simulate::{Bench, Plan, Truth};

fn options() -> Options {
    Options { advise: false, ..Options::default() }
}

/// Run with
/// `cargo test --release -p plumbline-gap bench_table -- --ignored --nocapture`;
/// `CASES` and `FIRST` in the environment say how many of each kind and from which seed on.
#[test]
#[ignore = "takes minutes; prints a table"]
fn bench_table() {
    let number =
        |name: &str, or: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(or);
    let (cases, first) = (number("CASES", 20), number("FIRST", 1000));
    let only = std::env::var("ONLY").unwrap_or_default();
    let shown = std::env::var("SHOW").is_ok();
    let mut all = Tally::default();
    for plan in [Plan::Plain, Plan::Rich] {
        let bench = Bench::new(plan);
        for (title, truth) in simulate::menu() {
            let title = format!("{plan:?} {title}");
            if !title.contains(&only) {
                continue;
            }
            let scores: Vec<Score> = (first..first + cases)
                .into_par_iter()
                .filter_map(|seed| {
                    let (measurements, floor, answer) = bench.case(&truth, seed)?;
                    let start = std::time::Instant::now();
                    let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
                    let score = Score::of(&answer, &found, start.elapsed().as_secs_f64());
                    if shown {
                        println!("{seed} {}", score.line(&answer, &found));
                    }
                    Some(score)
                })
                .collect();
            let mut tally = Tally::default();
            scores.iter().for_each(|score| tally.add(score));
            all.merge(&scores);
            println!("{title:28} {tally}");
        }
    }
    println!("{:28} {all}", "all");
    println!("{}", all.calibration());
}

#[test]
fn noise_alone_gets_no_name() {
    let bench = Bench::new(Plan::Plain);
    let named = (0..4)
        .filter(|&seed| {
            let (measurements, floor, _) = bench.case(&Truth::null(), seed).expect("can be made");
            let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
            !found.effects.is_empty()
        })
        .count();
    assert_eq!(named, 0);
}

#[test]
fn a_large_effect_is_named_and_sized() {
    let bench = Bench::new(Plan::Rich);
    let (measurements, floor, answer) =
        bench.certain("joint-zero", "r_elbow_y", 0.06, 7).expect("can be made");
    let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.effects);
    assert_eq!(found.effects[0].id, answer[0].id());
    assert_eq!(found.effects[0].site, answer[0].site);
    let offset = &found.effects[0].parameters[0];
    assert!((offset.value - 0.06).abs() < 0.005, "{offset:?}");
    assert!(offset.low < 0.06 && 0.06 < offset.high, "{offset:?}");
}

#[test]
fn permuted_residuals_name_nothing() {
    let bench = Bench::new(Plan::Plain);
    let (mut measurements, floor, _) =
        bench.certain("joint-zero", "r_elbow_y", 0.03, 5).expect("can be made");
    bench.permute(&mut measurements, 11);
    let found = search(&measurements, &floor, &options(), &Unattended).expect("enough rows");
    let confident = found.verdict != Verdict::NotInLibrary && !found.effects.is_empty();
    assert!(!confident, "{:?} {:?}", found.verdict, found.effects);
}
