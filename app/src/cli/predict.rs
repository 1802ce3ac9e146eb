//! `plumbline predict`: what the model says each row of a session should have measured.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, PredictArgs, PredictReport, PredictedRow};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `predict`.
#[derive(Debug, Args)]
pub struct Predict {
    /// Folder of a session.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// What to predict with in place of what the session names: a rig file, the screen.toml of a
    /// placed touchscreen, or a model with effects (rig-model.toml, as gap --add writes it).
    #[arg(long, value_name = "FILE")]
    rig_model: Option<PathBuf>,
}

/// Predicts every row.
pub fn run(arguments: Predict, output: &Output) -> anyhow::Result<()> {
    let args = PredictArgs { session: arguments.session, rig_model: arguments.rig_model };
    let report = offline::predict(&args, output)?;
    output.result(&report, text)
}

fn text(report: &PredictReport) -> String {
    let is_predicted = |row: &&PredictedRow| !matches!(row, PredictedRow::Poses { angles: None, .. });
    let rows = format::count(report.rows.iter().filter(is_predicted).count(), "row");
    let screen = if report.screen == "session" { "of the session" } else { "of the rig model" };
    let mut text = format!("{rows} predicted for {}, touchscreen {screen}\n", report.rig);
    if !report.effects.is_empty() {
        text.push_str(&format!("  with {}\n", report.effects.join(", ")));
    }
    for (angles, of) in [("encoder", "encoder readings"), ("commanded", "commanded angles")] {
        let count = report.rows.iter().filter(|row| angles_of(row) == Some(angles)).count();
        if count > 0 {
            text.push_str(&format!("  {} from {of}\n", format::count(count, "row")));
        }
    }
    for tip in &report.tips {
        text.push_str(&format!("  {} of {}: {}\n", format::count(tip.rows, "pose"), tip.tip, tip.words));
    }
    for gap in &report.gaps {
        text.push_str(&format!(
            "  {}: what was measured is {} beside it on average ({} rms) over {}\n",
            gap.table,
            format::mm(gap.mean_mm * 1e-3),
            format::mm(gap.rms_mm * 1e-3),
            format::count(gap.rows, "row"),
        ));
    }
    for row in &report.rows {
        text.push_str(&line(row));
    }
    text
}

fn angles_of(row: &PredictedRow) -> Option<&'static str> {
    match row {
        PredictedRow::Touches { angles, .. } => Some(angles),
        PredictedRow::Poses { angles, .. } => *angles,
        PredictedRow::Localizations { .. } => None,
    }
}

fn line(row: &PredictedRow) -> String {
    let place = |x_m: Option<f64>, y_m: Option<f64>, z_m: Option<f64>| match (x_m, y_m, z_m) {
        (Some(x_m), Some(y_m), Some(z_m)) => format::position_mm([x_m, y_m, z_m]),
        _ => "not known".to_owned(),
    };
    match *row {
        PredictedRow::Touches { touch_u_px, touch_v_px, above_glass_m, angles } => format!(
            "  touch  {}  {} above the glass  ({angles})\n",
            format::pixel_position([touch_u_px, touch_v_px]),
            format::mm(above_glass_m)
        ),
        PredictedRow::Localizations {
            est_x_m,
            est_y_m,
            est_z_m,
            corrected_x_m,
            corrected_y_m,
            corrected_z_m,
            ..
        } => format!(
            "  localization  should be {}  corrected {}\n",
            place(est_x_m, est_y_m, est_z_m),
            place(corrected_x_m, corrected_y_m, corrected_z_m)
        ),
        PredictedRow::Poses { angles: None, .. } => "  pose  not predicted\n".to_owned(),
        PredictedRow::Poses { meas_x_m, meas_y_m, meas_z_m, angles: Some(angles), .. } => {
            format!("  pose  {}  ({angles})\n", place(meas_x_m, meas_y_m, meas_z_m))
        }
    }
}
