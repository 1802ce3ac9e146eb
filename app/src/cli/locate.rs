//! `plumbline locate`: where in space points of the left image are.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, LocateArgs, LocateReport, LocatedPoint};
use plumbline_widgets::format;

use super::calibrate::say_notes;
use super::common::Cameras;
use super::output::Output;

/// Arguments of `locate`.
#[derive(Debug, Args)]
pub struct Locate {
    #[command(flatten)]
    cameras: Cameras,
    /// Raw image of the left eye.
    #[arg(long, value_name = "IMAGE")]
    left: PathBuf,
    /// Raw image of the right eye, of the same moment.
    #[arg(long, value_name = "IMAGE")]
    right: PathBuf,
    /// Table with the columns u_px and v_px: pixels of the raw left image, (0, 0) at the center
    /// of the top-left pixel.
    #[arg(long, value_name = "CSV")]
    points: PathBuf,
}

/// Locates every point of the table.
pub fn run(arguments: Locate, output: &Output) -> anyhow::Result<()> {
    let args = LocateArgs {
        cameras: arguments.cameras.cameras,
        left: arguments.left,
        right: arguments.right,
        points: arguments.points,
    };
    let report = offline::locate(&args, output)?;
    say_notes(&report.notes);
    output.result(&report, text)
}

fn text(report: &LocateReport) -> String {
    let found = report.points.iter().filter(|point| point.x_m.is_some()).count();
    let mut text = format!(
        "{found} of {} located, in the left camera's frame\n",
        format::count(report.points.len(), "point")
    );
    for point in &report.points {
        text.push_str(&line(point));
    }
    text
}

fn line(point: &LocatedPoint) -> String {
    let at = format::pixel_position([point.u_px, point.v_px]);
    match (point.x_m, point.y_m, point.z_m, point.sigma_m) {
        (Some(x), Some(y), Some(z), Some(sigma)) => {
            format!("  {at}  {} ± {}\n", format::position_mm([x, y, z]), format::mm(sigma))
        }
        _ => format!("  {at}  {}\n", point.reason.as_deref().unwrap_or("not found")),
    }
}
