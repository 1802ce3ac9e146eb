//! `plumbline bench`: accuracy and speed on measured data, beside what is wanted and what peers reach.

use clap::Args;
use plumbline_model::measured_data;
use plumbline_offline::{self as offline, BenchReport, Figure};

use super::bench_window;
use super::output::{Output, say};

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct Bench {}

/// Measures.
pub fn run(_arguments: Bench, output: &Output) -> anyhow::Result<()> {
    let mut report = offline::bench(output)?;
    match measured_data::folder("nico-chessboard") {
        Ok(pairs) => report.figures.extend(bench_window::figures(&pairs)),
        Err(why) => say(&format!("the window is not measured: {why}")),
    }
    output.result(&report, text)
}

/// A line per figure: what, number, target, peer and the ratio to it.
fn text(report: &BenchReport) -> String {
    let width = report.figures.iter().map(|figure| figure.what.chars().count()).max().unwrap_or(0);
    let mut text = format!("{} threads\n", report.threads);
    for figure in &report.figures {
        text.push_str(&format!("{:width$}  {}\n", figure.what, numbers(figure)));
    }
    text
}

fn numbers(figure: &Figure) -> String {
    let Some(value) = figure.value else {
        return figure.note.clone().unwrap_or_else(|| "not measured".to_owned());
    };
    let mut text = format!("{:>9} {:7}", four_digits(value), figure.unit);
    if let Some(limit) = figure.at_most {
        let verdict = if figure.is_met() == Some(true) { "met" } else { "MISSED" };
        text.push_str(&format!("at most {:<6} {verdict:7}", four_digits(limit)));
    }
    if let Some(peer) = &figure.peer {
        let ratio = value / peer.value;
        text.push_str(&format!("{} {}, ratio {ratio:.3}", peer.name, four_digits(peer.value)));
    }
    text
}

fn four_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (3 - value.abs().max(1e-4).log10().floor() as i32).clamp(0, 5) as usize;
    format!("{value:.digits$}")
}
