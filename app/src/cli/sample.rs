//! `plumbline sample`: a made-up lab, to try the program without a camera.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, SampleArgs};

use super::output::Output;

/// Arguments of `sample`.
#[derive(Debug, Args)]
pub struct Sample {
    /// Folder that receives the pairs.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many chessboard pairs.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=500))]
    pairs: u16,
    /// The same seed gives the same images.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
}

/// Renders and writes.
pub fn run(arguments: Sample, output: &Output) -> anyhow::Result<()> {
    let args = SampleArgs { out: arguments.out, pairs: arguments.pairs.into(), seed: arguments.seed };
    let report = offline::write_sample(&args, output)?;
    output.result(&report, |report| {
        format!(
            "{} pairs of a chessboard of {}x{} inner corners, {} mm: {}\nthe table with toys: {}\n\
             These images are rendered; nothing measured comes from them.",
            report.pairs,
            report.board_inner_columns,
            report.board_inner_rows,
            report.square_mm,
            report.board.display(),
            report.table.display(),
        )
    })
}
