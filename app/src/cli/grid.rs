//! `plumbline grid`: places on a grid of known targets.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, GridArgs, GridReport};

use super::output::Output;

/// Arguments of `grid`.
#[derive(Debug, Args)]
pub struct Grid {
    /// Session with localizations.csv: true places and estimates.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
}

/// Judges the places.
pub fn run(arguments: Grid, output: &Output) -> anyhow::Result<()> {
    let Grid { session } = arguments;
    let report = offline::grid(&GridArgs { session }, output)?;
    output.result(&report, text)
}

fn text(report: &GridReport) -> String {
    let mut text = String::new();
    for one in &report.corrections {
        let name = match one.correction {
            "none" => "no correction",
            "pivot-published" => "pivot, as published",
            "pivot-fitted" => "pivot, fitted to these places",
            _ => "pivot, each place by a fit to the others",
        };
        text.push_str(&format!(
            "  {name}: mean {:.1} mm, median {:.1} mm, worst {:.1} mm of {} places\n",
            one.mean_mm,
            one.median_mm,
            one.worst_mm,
            one.places.len()
        ));
    }
    text
}
