//! `plumbline lerobot`: a recording as a LeRobot data set.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, LerobotArgs, LerobotReport};

use super::output::Output;

/// Arguments of `lerobot`.
#[derive(Debug, Args)]
pub struct Lerobot {
    /// Session with a recording, log.mcap.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Folder that receives the data set; empty or new.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What was being done, a sentence.
    #[arg(long, value_name = "TEXT", default_value = "Recorded with Plumbline.")]
    task: String,
}

/// Writes it.
pub fn run(arguments: Lerobot, output: &Output) -> anyhow::Result<()> {
    let Lerobot { session, out, task } = arguments;
    let report = offline::lerobot(&LerobotArgs { session, out, task }, output)?;
    output.result(&report, text)
}

fn text(report: &LerobotReport) -> String {
    format!("Written to {}.\n{}\n", report.out.display(), report.said.join("\n"))
}
