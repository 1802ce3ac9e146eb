//! Follows what the search asks for: makes blind arms, searches each, does the experiment that it names, searches again,
//! at most twice, and holds what was promised against what came of it.
//!
//! `cargo run --release -p plumbline-blind --example followed -- [--cases N] [--seed S] [--list]`

#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};

use plumbline_blind::answer::Answer;
use plumbline_blind::arms::{self, Arm};
use plumbline_blind::case::{write, write_session};
use plumbline_blind::followed::{Case, Outcome, Step, is_judged, markdown, stated};
use plumbline_gap::Options;
use plumbline_gap::finding::Finding;

#[path = "../judge/mod.rs"]
mod judge;
use judge::AnyError;

/// Experiments that are done at most.
const MOST: usize = 2;

fn main() -> Result<(), AnyError> {
    let (mut cases, mut seed, mut is_listed) = (60, 1000, false);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--cases" => cases = value()?.parse()?,
            "--seed" => seed = value()?.parse()?,
            "--list" => is_listed = true,
            other => return Err(format!("{other} is not known: see the head of this file").into()),
        }
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let folder = target.join("blind").join(format!("followed-{seed}-{cases}"));
    let mut followed = vec![];
    for wish in arms::recipes(cases, seed) {
        let Ok((case, arm)) = Arm::make(&wish) else {
            eprintln!("case {:03} was not made", wish.number);
            continue;
        };
        if !is_judged(&case.answer) {
            continue;
        }
        write(&case, &folder.join("cases"), &folder.join("answers"))?;
        let first = folder.join("cases").join(format!("{:03}", case.answer.case));
        match follow(first, &case.answer, arm, is_listed) {
            Ok(case) => followed.push(case),
            Err(why) => println!("case {:03} got no verdict: {why}", case.answer.case),
        }
    }
    println!("{} cases, generator arms, seed {seed}\n\n{}", followed.len(), markdown(&followed));
    Ok(())
}

/// Searches, and does what is asked for.
fn follow(first: PathBuf, answer: &Answer, mut arm: Arm, is_listed: bool) -> Result<Case, AnyError> {
    let options = Options { show: false, ..Options::default() };
    let mut folders = vec![first];
    let mut finding = judge::search_all(&folders, &options)?;
    let mut case = Case { outcomes: vec![outcome(answer, &finding)], steps: vec![] };
    while case.steps.len() < MOST {
        // Once names are settled what is asked for tells sizes, and no names.
        let open = case.outcomes.last().is_some_and(|last| !last.is_one_name);
        let Some(next) = finding.next.as_ref().filter(|_| open) else { break };
        let asked = serde_json::to_value(next.kind)?;
        let session = arm.again(asked.as_str().unwrap_or_default().parse()?, next.count)?;
        let folder = with_suffix(&folders[0], &format!("-{}", folders.len()));
        write_session(&session, &arm.files(), &arm.slides(), &folder)?;
        folders.push(folder);
        let promised = next.expected_probability;
        finding = judge::search_all(&folders, &options)?;
        let verdict = judge::verdict(&finding);
        let after = Outcome::of(answer, &verdict);
        case.outcomes.push(after);
        case.steps.push(Step { promised, stated: stated(answer, &verdict), is_right: after.is_right });
        if is_listed {
            println!(
                "    {} promised {promised:.2} → {}",
                asked.as_str().unwrap_or_default(),
                told(&finding)
            );
        }
    }
    if is_listed {
        let hidden: Vec<String> =
            answer.hidden.iter().map(|h| format!("{} {:.1}σ", h.named(), h.size_sigmas)).collect();
        println!("{:03} {} {:?}", answer.case, hidden.join(", "), case.outcomes);
    }
    Ok(case)
}

fn outcome(answer: &Answer, finding: &Finding) -> Outcome {
    Outcome::of(answer, &judge::verdict(finding))
}

fn told(finding: &Finding) -> String {
    let names: Vec<String> = finding
        .effects
        .iter()
        .map(|effect| {
            format!("{}@{} {:.2} ({})", effect.id, effect.site, effect.probability, effect.class.len())
        })
        .collect();
    format!("{:?} {}", finding.verdict, names.join(", "))
}

fn with_suffix(folder: &Path, suffix: &str) -> PathBuf {
    let mut name = folder.file_name().unwrap_or_default().to_owned();
    name.push(suffix);
    folder.with_file_name(name)
}
