//! `plumbline correct`: which point must be sent so that the fingertip lands on a pixel.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, CorrectArgs, CorrectReport, CorrectedPoint};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `correct`.
#[derive(Debug, Args)]
pub struct Correct {
    /// A correction model: as train writes it, ONNX, or the published weights as JSON.
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Table with the columns u_px, v_px: pixels of the touchscreen, (0, 0) is the center of the
    /// top-left one. Other columns are ignored.
    #[arg(long, value_name = "CSV")]
    points: PathBuf,
}

/// Asks the model for every pixel of the table.
pub fn run(arguments: Correct, output: &Output) -> anyhow::Result<()> {
    let args = CorrectArgs { model: arguments.model, points: arguments.points };
    let report = offline::correct(&args, output)?;
    output.result(&report, text)
}

fn text(report: &CorrectReport) -> String {
    let inside = report.points.iter().filter(|point| point.inside).count();
    let mut text = format!(
        "{} of {} lie inside the border of {}\n",
        inside,
        format::count(report.points.len(), "pixel"),
        report.model.to_uppercase()
    );
    for remark in &report.remarks {
        text.push_str(&format!("  note: {remark}\n"));
    }
    for point in &report.points {
        text.push_str(&line(point));
    }
    text
}

fn line(point: &CorrectedPoint) -> String {
    let place = format::position_mm([point.x_m, point.y_m, point.z_m]);
    let sigma = point.sigma_m.map_or("not known".to_owned(), format::mm_known_to);
    let side = if point.inside { "inside" } else { "outside" };
    format!("  {}  {place}  ± {sigma}  {side}\n", format::pixel_position([point.u_px, point.v_px]))
}
