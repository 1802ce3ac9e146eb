//! `plumbline lerobot`: a recording as a LeRobot data set.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, LerobotArgs, LerobotReport};

use super::output::Output;

/// Arguments of `lerobot`.
#[derive(Debug, Args)]
pub struct Lerobot {
    /// Session with a recording, log.mcap.
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Folder that receives the data set; empty or new.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What was being done, a sentence.
    #[arg(long, value_name = "TEXT", default_value = "Recorded with Plumbline.")]
    task: String,
}

/// Writes it.
pub fn run(arguments: Lerobot, output: &Output) -> anyhow::Result<()> {
    let Lerobot { session, out, task } = arguments;
    let report = offline::lerobot(&LerobotArgs { session, out, task }, output)?;
    output.result(&report, text)
}

fn text(report: &LerobotReport) -> String {
    let mut text = format!(
        "{} frames at {:.1} Hz with {} joints: {}\n",
        report.frames,
        report.rate_hz,
        report.joints.len(),
        report.out.display()
    );
    if report.left_out > 0 {
        text.push_str(&format!("{} pairs from before angles were read are not in it.\n", report.left_out));
    }
    if report.actions.is_empty() {
        text.push_str(
            "No joint was told something in every pair, as far as the recording says it: there is no action.\n",
        );
    } else if !report.not_commanded.is_empty() {
        let named = report.not_commanded.iter().map(|(joint, frames)| format!("{joint} ({frames})"));
        text.push_str(&format!(
            "Not in its action, because nothing told them where to be in so many pairs: {}.\n",
            named.collect::<Vec<_>>().join(", ")
        ));
    }
    if !report.has_cameras {
        text.push_str(
            "The recording has no calibration of the eyes that can be read: intrinsics and extrinsics are not in it.\n",
        );
    }
    if !report.has_places {
        text.push_str(
            "The recording does not say how the head stood in any pair: where the eyes were in the robot is not in it.\n",
        );
    } else if report.without_place > 0 {
        text.push_str(&format!(
            "Where the eyes were in the robot is not known of {} of them; it is NaN there.\n",
            report.without_place
        ));
    }
    text
}
