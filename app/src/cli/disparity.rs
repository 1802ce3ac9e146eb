//! `plumbline disparity`: the disparity of a pair.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use plumbline_offline::{self as offline, DisparityArgs, DisparityReport};
use plumbline_widgets::format;

use super::calibrate::say_notes;
use super::output::Output;

/// Arguments of `disparity`.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("geometry").args(["cameras", "rectified"]).required(true))]
pub struct Disparity {
    /// Image of the left eye.
    #[arg(long, value_name = "IMAGE")]
    left: PathBuf,
    /// Image of the right eye, of the same moment.
    #[arg(long, value_name = "IMAGE")]
    right: PathBuf,
    /// Stereo calibration of the raw images; they are aimed at the table and rectified first.
    /// Two files for ROS camera_info, left eye first.
    #[arg(long, value_name = "FILE", num_args = 1..=2)]
    cameras: Vec<PathBuf>,
    /// The images are rectified already: rows are epipolar lines.
    #[arg(long)]
    rectified: bool,
    /// Largest disparity that is searched, pixels. Nearer things are not seen.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1023))]
    max_disparity: u32,
    /// Where the disparity is written: PFM, pixels, +infinity where there is none.
    #[arg(long, value_name = "FILE.pfm")]
    out: PathBuf,
}

/// Matches and writes.
pub fn run(arguments: Disparity, output: &Output) -> anyhow::Result<()> {
    let args = DisparityArgs {
        left: arguments.left,
        right: arguments.right,
        cameras: arguments.cameras,
        max_disparity_px: arguments.max_disparity,
        out: Some(arguments.out.clone()),
    };
    let report = offline::disparity(&args, output)?;
    say_notes(&report.notes);
    output.result(&report, |report| format!("{}written to {}", text(report), arguments.out.display()))
}

fn text(report: &DisparityReport) -> String {
    let mut text = format!(
        "{}×{} px, {:.1} ms\n{} of the pixels have a disparity, {} agreed on by both eyes\n",
        report.width_px,
        report.height_px,
        report.milliseconds,
        format::percent(report.valid_fraction),
        format::percent(report.measured_fraction),
    );
    if let Some(geometry) = &report.geometry {
        text.push_str(&format!(
            "depth = {:.3} px × {:.3} mm / disparity, along an axis turned down by {}\n",
            geometry.f_px,
            geometry.baseline_m * 1000.0,
            format::degrees(geometry.down_rad),
        ));
    }
    text
}
