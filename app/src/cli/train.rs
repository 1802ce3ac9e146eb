//! `plumbline train`: a correction model from the touches of a session.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plumbline_offline::{self as offline, TrainArgs, TrainReport};
use plumbline_widgets::format;

use super::output::Output;
use crate::operator::snapshot::models::Method;

/// Arguments of `train`.
#[derive(Debug, Args)]
pub struct Train {
    /// Folder of a session with touches.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// What to train: m1 (placement of the screen and measured heights), m2 (a network for x and y,
    /// measured heights) or m3 (a network for x, y and z).
    #[arg(long, value_enum)]
    model: Model,
    /// Receives the model: ONNX if its name ends in .onnx, else JSON.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The same seed gives the same model.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How networks are trained: as this program does it, or as published (Adam, 200 epochs).
    #[arg(long, value_enum, default_value_t = Recipe::Evidence)]
    recipe: Recipe,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Model {
    M1,
    M2,
    M3,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Recipe {
    /// Regularized by the evidence, three networks averaged.
    Evidence,
    /// Adam 1e-3, batches of 16, 200 epochs, one network.
    Published,
}

/// Trains, cross-validates by blocks, and writes the model.
pub fn run(arguments: Train, output: &Output) -> anyhow::Result<()> {
    let args = TrainArgs {
        session: arguments.session,
        method: match arguments.model {
            Model::M1 => Method::M1,
            Model::M2 => Method::M2,
            Model::M3 => Method::M3,
        },
        out: arguments.out,
        seed: arguments.seed,
        published_recipe: arguments.recipe == Recipe::Published,
    };
    let report = offline::train(&args, output)?;
    output.result(&report, text)
}

fn text(report: &TrainReport) -> String {
    let mm = |value_mm: f64| format::mm(value_mm * 1e-3);
    let [low, high] = report.cross_validated_mean_interval_mm;
    let mut text = format!(
        "{} trained on {} touches in {}\n  error on these: {} mean, {} rms in the plane; {} rms of the height\n  error on held-out touches ({}): {} mean (95 %: {} to {}), {} rms in the plane; {} rms of the height\n",
        report.model.to_uppercase(),
        report.rows,
        format::ms(report.seconds),
        mm(report.train_mean_mm),
        mm(report.train_rms_mm),
        mm(report.train_height_rms_mm),
        format::count(report.blocks.len(), "block"),
        mm(report.cross_validated_mean_mm),
        mm(low),
        mm(high),
        mm(report.cross_validated_rms_mm),
        mm(report.cross_validated_height_rms_mm),
    );
    if let Some(floor_mm) = report.noise_floor_mm {
        text.push_str(&format!("  repeats spread by {} rms: no model gets below that\n", mm(floor_mm)));
    }
    if let Some(area_cm2) = report.border_cm2 {
        text.push_str(&format!("  trusted inside a border of {area_cm2:.0} cm²\n"));
    }
    for reason in &report.left_out {
        text.push_str(&format!("  left out: {reason}\n"));
    }
    text
}
