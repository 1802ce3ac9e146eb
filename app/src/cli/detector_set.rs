//! `plumbline detector-set`: labeled images for training a detector, drawn by the twin.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, DetectorSetArgs, SetWorld};

use super::output::Output;

/// Arguments of `detector-set`.
#[derive(Debug, Args)]
pub struct DetectorSet {
    /// Folder that receives the set in YOLO format.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many image pairs.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pairs: u32,
    /// The same seed gives the same set; every pair depends on the seed and its number alone.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Number of the first pair, to draw a set in parts or to go on with it.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000_000))]
    first: u32,
    /// Share of the pairs that is kept for validation, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.1)]
    val_share: f64,
    /// Draws the set on which detectors are judged, never trained: always the same 300 pairs.
    #[arg(long, conflicts_with_all = ["pairs", "seed", "first", "val_share"])]
    held_out: bool,
    /// Draws the running twin as its window shows it, with only toys, arms and head at random; else
    /// everything is randomised.
    #[arg(long)]
    as_twin: bool,
}

/// Draws and writes.
pub fn run(arguments: DetectorSet, output: &Output) -> anyhow::Result<()> {
    let world = if arguments.as_twin { SetWorld::Twin } else { SetWorld::Randomised };
    let args = if arguments.held_out {
        DetectorSetArgs::held_out(arguments.out, world)
    } else {
        DetectorSetArgs {
            out: arguments.out,
            pairs: arguments.pairs as usize,
            seed: arguments.seed,
            first: arguments.first as usize,
            val_share: arguments.val_share,
            world,
        }
    };
    let report = offline::detector_set(&args, output)?;
    output.result(&report, |report| {
        let boxes: Vec<String> =
            report.boxes.iter().map(|count| format!("{} {}", count.class, count.boxes)).collect();
        format!(
            "{} pairs, drawn by {}: {}\nboxes: {}\nimages without a box: {}",
            report.pairs,
            report.device,
            report.data_yaml.display(),
            boxes.join(", "),
            report.images_without_label
        )
    })
}
