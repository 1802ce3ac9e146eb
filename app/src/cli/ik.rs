//! `plumbline ik`: the joint angles that bring a tip to targets.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, IkArgs, IkReport, IkSolution};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `ik`.
#[derive(Debug, Args)]
pub struct Ik {
    /// Robot: the name of one that comes with the program (nico), or a rig file.
    #[arg(long, value_name = "NAME|FILE", default_value = "nico")]
    rig: String,
    /// Link that shall go to the targets, for example right_palm_center or right_index_tip.
    #[arg(long, value_name = "FRAME")]
    tip: String,
    /// Table with the columns x_m, y_m, z_m (robot frame) and, for whole poses, roll_rad, pitch_rad,
    /// yaw_rad about the fixed axes x, y, z in this order; yaw_rad alone asks for the heading of
    /// the tip's x axis.
    #[arg(long, value_name = "CSV")]
    targets: PathBuf,
    /// Turns the tip's z axis up as nearly as the arm can without leaving the target: for grasps
    /// from above.
    #[arg(long)]
    upright: bool,
    /// Model with effects (rig-model.toml), as gap --add writes it: the angles are those that must be
    /// commanded so that the real arm gets to the targets.
    #[arg(long, value_name = "FILE")]
    rig_model: Option<PathBuf>,
}

/// Solves every target of the table, each from the home pose.
pub fn run(arguments: Ik, output: &Output) -> anyhow::Result<()> {
    let args = IkArgs {
        rig: arguments.rig,
        tip: arguments.tip,
        targets: arguments.targets,
        upright: arguments.upright,
        rig_model: arguments.rig_model,
    };
    let report = offline::ik(&args, output)?;
    output.result(&report, text)
}

fn text(report: &IkReport) -> String {
    let targets = format::count(report.solutions.len(), "target");
    let mut text = format!("{} of {targets} reached by {}\n", report.reached, report.tip);
    match report.effects.is_empty() {
        true => text.push_str(&format!("  robot {}\n", report.model)),
        false => text.push_str(&format!("  robot {}: {}\n", report.model, report.effects.join(", "))),
    }
    for solution in &report.solutions {
        text.push_str(&line(solution));
    }
    text
}

fn line(solution: &IkSolution) -> String {
    let angles: Vec<String> = solution
        .joints
        .iter()
        .map(|(name, angle_rad)| format!("{name} {}", format::joint_degrees(*angle_rad)))
        .collect();
    format!(
        "  {}  {}  {}  {}\n",
        solution.status,
        format::mm(solution.position_error_m),
        format::degrees(solution.orientation_error_rad),
        angles.join("  ")
    )
}
