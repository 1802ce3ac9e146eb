//! `plumbline-fuzz [--cases N] [--seed N] [--only NAME] [--workers N] [--patience SECONDS] [--keep FOLDER]`
//! runs changed inputs through all readers and prints a table; exit status 1 when there is a finding.
//! `--list` names the readers, `--replay FOLDER` runs a finding again, `--seeds FOLDER` writes what cases
//! begin with.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program of the command line")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use plumbline_fuzz::readers;
use plumbline_fuzz::run::{Options, replay, run, work};
use plumbline_fuzz::seeds::{self, Problem};

fn main() -> ExitCode {
    match of_arguments(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(code) => code,
        Err(problem) => {
            eprintln!("plumbline-fuzz: {problem}");
            ExitCode::from(2)
        }
    }
}

fn of_arguments(arguments: &[String]) -> Result<ExitCode, Problem> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut options = Options::new(std::env::current_exe()?, 10_000, 1);
    options.tell = true;
    let mut rest = words.as_slice();
    while let Some((name, after)) = rest.split_first() {
        let (value, left) = after.split_first().map_or((None, after), |(value, left)| (Some(*value), left));
        let given = || value.ok_or_else(|| format!("{name} wants a value"));
        rest = left;
        match *name {
            "--worker" => {
                let [reader, seeds, scratch, seed, from, to, memory] = after else {
                    return Err("--worker wants what the watching process gives".into());
                };
                let cases = from.parse()?..to.parse()?;
                work(reader, Path::new(seeds), Path::new(scratch), seed.parse()?, cases, memory.parse()?)?;
                return Ok(ExitCode::SUCCESS);
            }
            "--list" => {
                for reader in readers::all() {
                    println!("{:28} {:>4}  {}", reader.name, reader.weight, reader.files.join(" "));
                }
                return Ok(ExitCode::SUCCESS);
            }
            "--seeds" => {
                seeds::make(Path::new(given()?))?;
                return Ok(ExitCode::SUCCESS);
            }
            "--replay" => {
                let (verdict, said) = replay(Path::new(given()?), options.memory)?;
                println!("{}: {said}", verdict.name());
                return Ok(if verdict.is_finding() { ExitCode::FAILURE } else { ExitCode::SUCCESS });
            }
            "--cases" => options.cases = given()?.parse()?,
            "--seed" => options.seed = given()?.parse()?,
            "--workers" => options.workers = given()?.parse()?,
            "--patience" => options.patience = Duration::from_secs_f64(given()?.parse()?),
            "--only" => options.only = given()?.to_owned(),
            "--keep" => options.keep = Some(PathBuf::from(given()?)),
            other => return Err(format!("{other} is not known; there are --cases, --seed, --only, --workers, --patience, --keep, --list, --seeds and --replay").into()),
        }
    }
    let summary = run(&options)?;
    for finding in &summary.findings {
        println!("{} {}: {} ({})", finding.reader, finding.index, finding.verdict.name(), finding.change);
        println!("    {}", finding.said);
    }
    for problem in &summary.not_run {
        println!("not run: {problem}");
    }
    println!("{summary}");
    println!("{} cases, seed {}, {} findings", summary.cases(), options.seed, summary.defects());
    Ok(if summary.defects() > 0 || !summary.not_run.is_empty() {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}
