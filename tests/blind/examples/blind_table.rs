//! Makes blind cases, searches each, scores the answers and prints the table.
//!
//! `cargo run --release -p plumbline-blind --example blind_table -- [--generator lean|worn|arms|eyes] [--cases N] [--seed S]
//! [--only single,pair,…] [--kind touch-drag,…] [--plan plain|rich] [--first N] [--no-show] [--list] [--threads N] [--dump FILE]`
//!
//! Cases are kept under `target/blind`, so that a search can be repeated without the physics. Without `--threads` there
//! are as many as the machine runs at a time; the answers do not depend on it (with held-out rows one thing does: rows are
//! held out one by one only where that is quick). `--kind` picks the cases that were to hide one of these first.
//! `--dump` writes a line of JSON about each effect that is listed,
//! [`plumbline_blind::names::Line`].

#![allow(clippy::print_stdout)]

use std::io::Write as _;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use plumbline_blind::answer::{Answer, Plan, Source};
use plumbline_blind::bench::Bench;
use plumbline_blind::case::{self, Case};
use plumbline_blind::design::Planner;
use plumbline_blind::hide::{Kinds, Wish};
use plumbline_blind::physics::Generator;
use plumbline_blind::recipe::Family;
use plumbline_blind::score::Score;
use plumbline_blind::verdict::Verdict;
use plumbline_blind::{BlindError, arms, eyes, mix, names, parallel, table, words};
use plumbline_gap::Options;
use serde_json::Value;

#[path = "../judge/mod.rs"]
mod judge;
#[path = "../judge/told.rs"]
mod told;
use judge::AnyError;

/// Cases are made anew when the physics changes.
fn physics(generator: Source) -> &'static str {
    match generator {
        Source::Arms => "v11",
        _ => "v10",
    }
}

struct Arguments {
    generator: Source,
    cases: usize,
    seed: u64,
    only: Option<Vec<String>>,
    kinds: Option<Vec<String>>,
    plan: Option<String>,
    first: usize,
    show: bool,
    list: bool,
    threads: NonZeroUsize,
    dump: Option<PathBuf>,
}

fn arguments() -> Result<Arguments, AnyError> {
    let mut read = Arguments {
        generator: Source::Lean,
        cases: 200,
        seed: 1000,
        only: None,
        kinds: None,
        plan: None,
        first: 0,
        show: true,
        list: false,
        threads: parallel::all_threads(),
        dump: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--generator" => read.generator = value()?.parse()?,
            "--cases" => read.cases = value()?.parse()?,
            "--seed" => read.seed = value()?.parse()?,
            "--only" => read.only = Some(value()?.split(',').map(str::to_owned).collect()),
            "--kind" => read.kinds = Some(value()?.split(',').map(str::to_owned).collect()),
            "--plan" => read.plan = Some(value()?),
            "--first" => read.first = value()?.parse()?,
            "--no-show" => read.show = false,
            "--list" => read.list = true,
            "--threads" => read.threads = value()?.parse().map_err(|why| format!("--threads: {why}"))?,
            "--dump" => read.dump = Some(value()?.into()),
            other => return Err(format!("{other} is not known: see the head of this file").into()),
        }
    }
    Ok(read)
}

fn main() -> Result<(), AnyError> {
    let arguments = arguments()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let generator: &str = arguments.generator.into();
    let folder = target.join("blind").join(format!(
        "{}-{generator}-{}-{}",
        physics(arguments.generator),
        arguments.seed,
        arguments.cases
    ));
    let bench = Bench::usual()?;
    let planner = Planner::new(&bench)?;
    let orders: Vec<Order<'_>> = orders(&arguments, &bench, &planner)
        .into_iter()
        .skip(arguments.first)
        .filter(|order| {
            arguments.only.as_ref().is_none_or(|only| only.contains(&words::word(order.family)))
                && arguments
                    .kinds
                    .as_ref()
                    .is_none_or(|kinds| order.kind.is_some_and(|kind| kinds.iter().any(|one| one == kind)))
                && arguments.plan.as_ref().is_none_or(|plan| *plan == words::word(order.plan))
        })
        .collect();
    make_missing(&orders, &folder, arguments.threads)?;
    let options = Options { show: arguments.show, advise: false, ..Options::default() };
    let searched = parallel::in_order(&orders, arguments.threads, "search", |order| {
        search(&folder.join("cases").join(format!("{:03}", order.number)), &options)
    })?;
    let mut score = Score::default();
    let mut dump =
        arguments.dump.as_ref().map(std::fs::File::create).transpose()?.map(std::io::BufWriter::new);
    for (order, searched) in orders.iter().zip(&searched) {
        let Ok(answer) = Answer::read(&answer_file(&folder, order.number)) else { continue };
        match searched {
            Ok((verdict, told)) => {
                score.count(&answer, verdict);
                for line in names::lines(&answer, arguments.seed, verdict, told) {
                    dump.as_mut()
                        .map_or(Ok(()), |dump| writeln!(dump, "{}", serde_json::to_string(&line)?))?;
                }
            }
            Err(why) => score.count_failure(&answer, why),
        }
        if arguments.list {
            list(&answer, searched.as_ref().map(|(verdict, _)| verdict));
        }
    }
    dump.map_or(Ok(()), |mut dump| dump.flush())?;
    println!(
        "{} cases, generator {generator}, seed {}\n\n{}",
        score.cases,
        arguments.seed,
        table::markdown(&score)
    );
    Ok(())
}

/// What the search says of a case, and what else it says of each name.
fn search(case: &Path, options: &Options) -> Result<(Verdict, Vec<Value>), String> {
    // A case that breaks the search is a case without a verdict, and the others have theirs.
    let found = catch_unwind(AssertUnwindSafe(|| judge::search_all(&[case], options)));
    let finding = found.map_err(|_| "the search panicked".to_owned())?.map_err(|error| error.to_string())?;
    Ok((judge::verdict(&finding), told::told(&finding)))
}

fn answer_file(folder: &Path, number: usize) -> PathBuf {
    folder.join("answers").join(format!("{number:03}.json"))
}

/// A case that shall be judged.
struct Order<'a> {
    number: usize,
    family: Family,
    plan: Plan,
    /// What it was to hide first,.
    kind: Option<&'static str>,
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
            kind: recipe.kind.map(plumbline_blind::secret::Kind::id),
            make: Box::new(move || case::make_or_smaller(bench, planner, &recipe)),
        };
        recipes.into_iter().map(order).collect()
    };
    match arguments.generator {
        Source::Lean => touches(Generator::Lean),
        Source::Worn => touches(Generator::Worn),
        Source::Arms => {
            of_wishes(arms::recipes(arguments.cases, arguments.seed), arms::make, |kind| kind.into())
        }
        Source::Eyes => of_wishes(eyes::recipes(arguments.cases, arguments.seed), eyes::make, eyes::Kind::id),
    }
}

fn of_wishes<'a, K: Kinds + Send + Sync>(
    wishes: Vec<Wish<K>>,
    make: fn(&Wish<K>) -> Result<Case, BlindError>,
    id: fn(K) -> &'static str,
) -> Vec<Order<'a>> {
    let order = |wish: Wish<K>| Order {
        number: wish.number,
        family: wish.family,
        plan: wish.plan,
        kind: wish.kind.map(id),
        make: Box::new(move || make(&wish)),
    };
    wishes.into_iter().map(order).collect()
}

/// Makes the cases that are not there yet.
fn make_missing(orders: &[Order<'_>], folder: &Path, threads: NonZeroUsize) -> std::io::Result<()> {
    let missing: Vec<&Order<'_>> =
        orders.iter().filter(|order| !answer_file(folder, order.number).exists()).collect();
    parallel::in_order(&missing, threads, "physics", |order| {
        let made = (order.make)();
        let written = match &made {
            Ok(case) => case::write(case, &folder.join("cases"), &folder.join("answers")),
            Err(_) => Ok(()),
        };
        if let Some(error) = made.err().or(written.err()) {
            eprintln!("case {:03} was not made: {error}", order.number);
        }
    })?;
    Ok(())
}

fn list(answer: &Answer, verdict: Result<&Verdict, &String>) {
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
                    let beside =
                        if f.beside.is_empty() { String::new() } else { format!(" beside {:?}", f.beside) };
                    format!("{}@{} {:.2}{size} {others:?}{beside}", f.id, f.site, f.probability)
                })
                .collect();
            format!("{} {} ({:.1} s)", verdict.verdict, names.join(", "), verdict.seconds.unwrap_or(f64::NAN))
        }
        Err(why) => why.to_owned(),
    };
    let outside = verdict.map_or_else(|_| vec![], |verdict| sizes(answer, verdict));
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
            |found: &&plumbline_blind::verdict::Found| found.id == hidden.id && found.site == hidden.site;
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
