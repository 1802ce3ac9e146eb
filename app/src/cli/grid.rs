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
    /// Effects of the eyes that are undone in each place, in the ray and the disparity: a file that the window keeps, or
    /// that gap has written.
    #[arg(long, value_name = "FILE")]
    rig_model: Option<PathBuf>,
}

/// Judges the places.
pub fn run(arguments: Grid, output: &Output) -> anyhow::Result<()> {
    let Grid { session, rig_model } = arguments;
    let report = offline::grid(&GridArgs { session, rig_model }, output)?;
    output.result(&report, text)
}

fn text(report: &GridReport) -> String {
    let mut text = String::new();
    for one in &report.corrections {
        let name = match one.correction {
            "none" => "no correction",
            "pivot-published" => "pivot, as published",
            "pivot-fitted" => "pivot, fitted to these places",
            "rig-model" => "effects of the rig model",
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
