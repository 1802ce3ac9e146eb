//! `plumbline health`: whether the calibration of the eyes still holds.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, CalibrationHealth, HealthArgs, HealthReport};
use plumbline_widgets::format;

use super::calibrate::say_notes;
use super::output::Output;

/// Arguments of `health`.
#[derive(Debug, Args)]
pub struct Health {
    /// Session with ordinary pairs under stereo/left and stereo/right, or in its log.mcap; no board is needed,
    /// but something with texture.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Calibration in use; without it the cameras.yaml of the session, or the rig-cameras.yaml of a recording.
    #[arg(long, value_name = "FILE")]
    cameras: Option<PathBuf>,
    /// Calibration that might take its place: both are judged on the same images.
    #[arg(long, value_name = "FILE")]
    proposed: Option<PathBuf>,
}

/// Judges the calibrations.
pub fn run(arguments: Health, output: &Output) -> anyhow::Result<()> {
    let Health { session, cameras, proposed } = arguments;
    let report = offline::health(&HealthArgs { session, cameras, proposed }, output)?;
    say_notes(&report.notes);
    output.result(&report, text)
}

fn text(report: &HealthReport) -> String {
    let mut text = format!("{}\n", report.sentence);
    text.push_str(&line("in use", &report.in_use));
    if let Some(proposed) = &report.proposed {
        text.push_str(&line("proposed", proposed));
    }
    text.push_str(&format!(
        "  {} places in {} pairs, {:.1} s\n",
        report.matches, report.pairs, report.seconds
    ));
    text
}

fn line(title: &str, health: &CalibrationHealth) -> String {
    format!(
        "  {title}: {:.1} mm near, {:.1} mm in the middle, {:.1} ± {:.1} mm far; turned by {:.3}°; {:.3} px off the \
         epipolar planes\n",
        health.near_mm,
        health.middle_mm,
        health.far_mm,
        format::NORMAL_95 * health.far_sigma_mm,
        health.turn_deg,
        health.epipolar_px
    )
}
