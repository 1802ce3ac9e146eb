//! How long a search of many poses of a large arm takes, and how soon it stops when it is cancelled.
//!
//! `cargo run --release -p plumbline-blind --example pace -- [--rows N] [--joints N] [--seed S] [--cancels N]`

#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::{Duration, Instant};

use plumbline_blind::arms::{self, Arm, Ask};
use plumbline_blind::case::write_session;
use plumbline_blind::recipe::Family;
use plumbline_gap::{GapError, Options, find};
use plumbline_model::{CancelledFrom, Unattended};

#[path = "../judge/mod.rs"]
mod judge;
use judge::AnyError;

/// Arms that are drawn at most until one has the joints that were asked for.
const MOST_DRAWN: usize = 400;

fn main() -> Result<(), AnyError> {
    let (mut rows, mut joints, mut seed, mut cancels) = (1500, 7, 1000, 30);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--rows" => rows = value()?.parse()?,
            "--joints" => joints = value()?.parse()?,
            "--seed" => seed = value()?.parse()?,
            "--cancels" => cancels = value()?.parse()?,
            other => return Err(format!("{other} is not known: see the head of this file").into()),
        }
    }
    // Where nothing is off there is nothing to look through.
    let wishes = arms::recipes(MOST_DRAWN, seed).into_iter().filter(|wish| wish.family == Family::Pair);
    let (case, mut arm) = wishes
        .filter_map(|wish| Arm::make(&wish).ok())
        .find(|(_, arm)| arm.joints() == joints)
        .ok_or("no such arm was drawn")?;
    let session = arm.again(Ask::MorePlaces, rows)?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let folder = target.join("blind").join(format!("pace-{seed}-{joints}-{rows}"));
    write_session(&session, &arm.files(), &arm.slides(), &folder)?;
    let measurements = judge::read_all(&[&folder])?;
    println!(
        "{} rows of an arm of {joints} joints, hidden: {:?}",
        measurements.rows.len(),
        case.answer.hidden.iter().map(|hidden| hidden.named()).collect::<Vec<_>>()
    );
    for show in [false, true] {
        let options = Options { show, ..Options::default() };
        let start = Instant::now();
        let finding = find(&measurements, &options, &Unattended)?;
        let took = start.elapsed();
        println!(
            "{} held-out rows: {:.1} s, {:?} {:?}",
            if show { "with" } else { "without" },
            took.as_secs_f64(),
            finding.verdict,
            finding.effects.iter().map(|effect| format!("{}@{}", effect.id, effect.site)).collect::<Vec<_>>()
        );
        let mut late: Vec<(Duration, Duration, String)> = vec![];
        for k in 0..cancels {
            let wait = took.mul_f64((f64::from(k) + 0.5) / f64::from(cancels));
            let context = CancelledFrom::after(wait);
            if matches!(find(&measurements, &options, &context), Err(GapError::Cancelled(_))) {
                late.push((context.late(), wait, context.doing()));
            }
        }
        late.sort();
        for (late, wait, doing) in late.iter().rev().take(5) {
            println!(
                "  cancelled after {:.2} s ({doing}): {} ms later",
                wait.as_secs_f64(),
                late.as_millis()
            );
        }
    }
    Ok(())
}
