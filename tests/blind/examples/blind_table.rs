//! Makes blind cases, searches each, scores the answers and prints the table.
//!
//! `cargo run --release -p plumbline-blind --example blind_table -- [--generator lean|worn|arms|eyes] [--cases N] [--seed S]
//! [--only single,pair,…] [--plan plain|rich] [--first N] [--no-show] [--list]`
//!
//! Cases are kept under `target/blind`, so that a search can be repeated without the physics.

#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use plumbline_blind::answer::{Answer, Plan, Source};
use plumbline_blind::bench::Bench;
use plumbline_blind::case::{self, Case};
use plumbline_blind::design::Planner;
use plumbline_blind::hide::{Kinds, Wish};
use plumbline_blind::physics::Generator;
use plumbline_blind::recipe::Family;
use plumbline_blind::score::{Score, Verdict};
use plumbline_blind::{BlindError, arms, eyes, mix, table, words};
use plumbline_gap::Options;

#[path = "../judge/mod.rs"]
mod judge;
use judge::AnyError;

/// Cases are made anew when the physics changes.
const PHYSICS: &str = "v9";
const THREADS: usize = 2;

struct Arguments {
    generator: Source,
    cases: usize,
    seed: u64,
    only: Option<Vec<String>>,
    plan: Option<String>,
    first: usize,
    show: bool,
    list: bool,
}

fn arguments() -> Result<Arguments, AnyError> {
    let mut read = Arguments {
        generator: Source::Lean,
        cases: 200,
        seed: 1000,
        only: None,
        plan: None,
        first: 0,
        show: true,
        list: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--generator" => read.generator = value()?.parse()?,
            "--cases" => read.cases = value()?.parse()?,
            "--seed" => read.seed = value()?.parse()?,
            "--only" => read.only = Some(value()?.split(',').map(str::to_owned).collect()),
            "--plan" => read.plan = Some(value()?),
            "--first" => read.first = value()?.parse()?,
            "--no-show" => read.show = false,
            "--list" => read.list = true,
            other => return Err(format!("{other} is not known: see the head of this file").into()),
        }
    }
    Ok(read)
}

fn main() -> Result<(), AnyError> {
    let arguments = arguments()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let generator: &str = arguments.generator.into();
    let folder =
        target.join("blind").join(format!("{PHYSICS}-{generator}-{}-{}", arguments.seed, arguments.cases));
    let bench = Bench::usual()?;
    let planner = Planner::new(&bench)?;
    let orders: Vec<Order<'_>> = orders(&arguments, &bench, &planner)
        .into_iter()
        .skip(arguments.first)
        .filter(|order| {
            arguments.only.as_ref().is_none_or(|only| only.contains(&words::word(order.family)))
                && arguments.plan.as_ref().is_none_or(|plan| *plan == words::word(order.plan))
        })
        .collect();
    make_missing(&orders, &folder);
    let options = Options { show: arguments.show, advise: false, ..Options::default() };
    let next = AtomicUsize::new(0);
    let judged: Vec<Vec<(usize, Result<Verdict, String>)>> = std::thread::scope(|scope| {
        let work = || {
            let mut judged = vec![];
            while let Some(order) = orders.get(next.fetch_add(1, Ordering::Relaxed)) {
                let verdict =
                    judge::search(&folder.join("cases").join(format!("{:03}", order.number)), &options)
                        .map_err(|error| error.to_string());
                judged.push((order.number, verdict));
            }
            judged
        };
        let threads: Vec<_> = (0..THREADS)
            .filter_map(|i| {
                std::thread::Builder::new().name(format!("search-{i}")).spawn_scoped(scope, work).ok()
            })
            .collect();
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect()
    });
    let mut judged: Vec<_> = judged.into_iter().flatten().collect();
    judged.sort_by_key(|(number, _)| *number);
    let mut score = Score::default();
    for (number, verdict) in &judged {
        let Ok(answer) = Answer::read(&answer_file(&folder, *number)) else { continue };
        match verdict {
            Ok(verdict) => score.count(&answer, verdict),
            Err(why) => score.count_failure(&answer, why),
        }
        if arguments.list {
            list(&answer, verdict);
        }
    }
    println!(
        "{} cases, generator {generator}, seed {}\n\n{}",
        score.cases,
        arguments.seed,
        table::markdown(&score)
    );
    Ok(())
}

fn answer_file(folder: &Path, number: usize) -> PathBuf {
    folder.join("answers").join(format!("{number:03}.json"))
}

/// A case that shall be judged.
struct Order<'a> {
    number: usize,
    family: Family,
    plan: Plan,
    make: Box<dyn Fn() -> Result<Case, BlindError> + Send + Sync + 'a>,
}

/// Cases of a generator.
fn orders<'a>(arguments: &Arguments, bench: &'a Bench, planner: &'a Planner<'a>) -> Vec<Order<'a>> {
    let touches = |generator| {
        let recipes = mix::recipes(generator, arguments.cases, arguments.seed);
        let order = |recipe: plumbline_blind::recipe::Recipe| Order {
            number: recipe.number,
            family: recipe.family,
            plan: recipe.design.into(),
            make: Box::new(move || case::make_or_smaller(bench, planner, &recipe)),
        };
        recipes.into_iter().map(order).collect()
    };
    match arguments.generator {
        Source::Lean => touches(Generator::Lean),
        Source::Worn => touches(Generator::Worn),
        Source::Arms => of_wishes(arms::recipes(arguments.cases, arguments.seed), arms::make),
        Source::Eyes => of_wishes(eyes::recipes(arguments.cases, arguments.seed), eyes::make),
    }
}

fn of_wishes<'a, K: Kinds + Send + Sync>(
    wishes: Vec<Wish<K>>,
    make: fn(&Wish<K>) -> Result<Case, BlindError>,
) -> Vec<Order<'a>> {
    let order = |wish: Wish<K>| Order {
        number: wish.number,
        family: wish.family,
        plan: wish.plan,
        make: Box::new(move || make(&wish)),
    };
    wishes.into_iter().map(order).collect()
}

/// Makes the cases that are not there yet.
fn make_missing(orders: &[Order<'_>], folder: &Path) {
    let missing: Vec<&Order<'_>> =
        orders.iter().filter(|order| !answer_file(folder, order.number).exists()).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for i in 0..THREADS {
            let work = || {
                while let Some(order) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let made = (order.make)();
                    let written = match &made {
                        Ok(case) => case::write(case, &folder.join("cases"), &folder.join("answers")),
                        Err(_) => Ok(()),
                    };
                    if let Some(error) = made.err().or(written.err()) {
                        eprintln!("case {:03} was not made: {error}", order.number);
                    }
                }
            };
            let _ = std::thread::Builder::new().name(format!("physics-{i}")).spawn_scoped(scope, work);
        }
    });
}

fn list(answer: &Answer, verdict: &Result<Verdict, String>) {
    let hidden: Vec<String> =
        answer.hidden.iter().map(|hidden| format!("{} {:.1}σ", hidden.named(), hidden.size_sigmas)).collect();
    let said = match verdict {
        Ok(verdict) => {
            let names: Vec<String> = verdict
                .effects
                .iter()
                .map(|f| {
                    let others: Vec<&str> = f.class.iter().skip(1).map(String::as_str).collect();
                    let size = f.size_sigmas.map_or_else(String::new, |size| format!(" {size:.1}σ"));
                    format!("{}@{} {:.2}{size} {others:?}", f.id, f.site, f.probability)
                })
                .collect();
            format!("{} {} ({:.1} s)", verdict.verdict, names.join(", "), verdict.seconds.unwrap_or(f64::NAN))
        }
        Err(why) => why.clone(),
    };
    let outside = verdict.as_ref().map_or_else(|_| vec![], |verdict| sizes(answer, verdict));
    let outside = if outside.is_empty() { String::new() } else { format!(" SIZES {}", outside.join(", ")) };
    println!(
        "{:03} {} {}{}: {} → {said}{outside}",
        answer.case,
        words::word(answer.family),
        words::word(answer.design),
        if answer.dirt.is_empty() { "" } else { " dirt" },
        hidden.join(", ")
    );
}

/// How far parameters of rightly named effects are off, in standard deviations of their interval; what is outside of
/// it with its numbers.
fn sizes(answer: &Answer, verdict: &Verdict) -> Vec<String> {
    let mut outside = vec![];
    for hidden in &answer.hidden {
        let same =
            |found: &&plumbline_blind::score::Found| found.id == hidden.id && found.site == hidden.site;
        let Some(found) = verdict.effects.iter().find(same) else { continue };
        for (name, truth) in &hidden.parameters {
            let number = |end: &str| found.parameters.get(name)?.get(end)?.as_f64();
            let (Some(low), Some(high)) = (number("low"), number("high")) else { continue };
            let value = number("value").unwrap_or(f64::NAN);
            let sd = (high - low) / (2.0 * 1.96);
            outside.push(format!("{name} {:+.1}", (value - truth) / sd));
            if *truth < low || *truth > high {
                outside.push(format!("OUTSIDE {}.{name} {truth:.4} not in {low:.4} to {high:.4}", hidden.id));
            }
        }
    }
    outside
}
