//! `plumbline rig check` and `plumbline rig export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plumbline_offline::{self as offline, RigCheckReport, RigExportArgs, RigExportReport, RigFormat};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `rig check`.
#[derive(Debug, Args)]
pub struct Check {
    /// A rig file (rig.toml). The description (URDF) that it names lies beside it and is checked, too.
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

/// Arguments of `rig export`.
#[derive(Debug, Args)]
pub struct Export {
    /// Robot: the name of one that comes with the program (nico), or a rig file.
    #[arg(long, value_name = "NAME|FILE", default_value = "nico")]
    rig: String,
    /// Model with effects (rig-model.toml), as gap --add writes it; without it the robot is written as
    /// described.
    #[arg(long, value_name = "FILE")]
    rig_model: Option<PathBuf>,
    /// In which format.
    #[arg(long, value_enum)]
    format: Format,
    /// Where the robot is written.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A format that other programs read.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// The description of ROS: the robot's own file with other origins and two links for the cameras.
    Urdf,
    /// The model of MuJoCo: bodies, hinges with limits, masses, simple shapes; no motors.
    Mjcf,
}

/// Checks a rig file.
pub fn check(arguments: Check, output: &Output) -> anyhow::Result<()> {
    output.result(&offline::rig_check(&arguments.file)?, found)
}

fn found(report: &RigCheckReport) -> String {
    if report.ok {
        return format!("{} is sound\n", report.file.display());
    }
    let mut text =
        format!("{}: {}\n", report.file.display(), format::count(report.problems.len(), "problem"));
    for problem in &report.problems {
        let line = problem.line.map_or_else(String::new, |line| format!(":{line}"));
        text.push_str(&format!("  {}{line}: {}\n      {}\n", problem.file, problem.what, problem.fix));
    }
    text
}

/// Writes the robot with its effects.
pub fn export(arguments: Export, output: &Output) -> anyhow::Result<()> {
    let format = match arguments.format {
        Format::Urdf => RigFormat::Urdf,
        Format::Mjcf => RigFormat::Mjcf,
    };
    let Export { rig, rig_model, out, .. } = arguments;
    let report = offline::rig_export(&RigExportArgs { rig, rig_model, format, out }, output)?;
    output.result(&report, written)
}

fn written(report: &RigExportReport) -> String {
    let inside = match report.inside.is_empty() {
        true => "as described".to_owned(),
        false => format!("with {}", report.inside.join(", ")),
    };
    let mut text = format!("{} as {}: the robot {inside}\n", report.out.display(), report.format);
    for left in &report.left_out {
        text.push_str(&format!("  left out: {}: it {}\n", left.effect, left.reason));
    }
    text
}
