//! `plumbline commission`: a twin just switched on becomes ready to grasp, without a person.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, CommissionArgs, CommissionReport, CommissionStep};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `commission`.
#[derive(Debug, Args)]
pub struct Commission {
    /// The twin: the name of a scenario that comes with the program (lab, perfect), or a scenario file.
    #[arg(long, value_name = "NAME|FILE")]
    twin: String,
    /// The same seed gives the same course.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder of the lab that comes of it, as --data-dir of the window takes it. Started again on the
    /// same folder, the work goes on after the last step that was finished.
    #[arg(long, value_name = "LAB")]
    out: PathBuf,
}

/// Does the steps that are not done yet, and says what came of all.
pub fn run(arguments: Commission, output: &Output) -> anyhow::Result<()> {
    let args = CommissionArgs { twin: arguments.twin, seed: arguments.seed, out: arguments.out };
    let report = offline::commission(&args, output)?;
    output.result(&report, text)
}

fn text(report: &CommissionReport) -> String {
    let mut text = format!(
        "Ready after {:.1} min of the robot: {}, {}\n",
        report.robot_minutes,
        format::count(report.touches, "touch"),
        format::count(report.board_views, "board view"),
    );
    for step in &report.steps {
        text.push_str(&line(step));
    }
    let places = &report.place_error_mm;
    text.push_str(&format!(
        "Judged: the tomato is found at {} of {} places, {} off (median), {} (95 %)\n",
        places.found,
        places.places,
        mm(places.median),
        mm(places.p95)
    ));
    let palm = &report.palm_error_mm;
    text.push_str(&format!(
        "        the palm is {} off where it is sent (median), {} beside an object that the eyes found\n",
        mm(palm.median),
        mm(palm.to_object_median)
    ));
    if let Some(share) = palm.within_95 {
        text.push_str(&format!(
            "        {} are stated for it (1σ); {:.0} % of its errors lie inside of the stated 95 %\n",
            mm(palm.stated),
            100.0 * share
        ));
    }
    let touches = &report.touch_error_mm;
    text.push_str(&format!(
        "        new touches miss by {} inside of the touched area, {} outside; by {} without corrections\n",
        mm(touches.inside),
        mm(touches.outside),
        mm(touches.uncorrected)
    ));
    text.push_str(&format!(
        "        M3 from the same touches misses by {} inside, {} outside\n",
        mm(touches.m3_inside),
        mm(touches.m3_outside)
    ));
    text
}

fn line(step: &CommissionStep) -> String {
    let mut text = format!("  {}: {:.1} min", step.name, step.minutes);
    if step.before_mm.is_some() || step.after_mm.is_some() {
        text.push_str(&format!(
            "; {} before, {} after ({})",
            mm(step.before_mm),
            mm(step.after_mm),
            step.error_of
        ));
    }
    text.push('\n');
    for note in &step.notes {
        text.push_str(&format!("    {note}\n"));
    }
    text
}

fn mm(value_mm: Option<f64>) -> String {
    value_mm.map_or_else(|| "not known".to_owned(), |value_mm| format::mm(value_mm * 1e-3))
}
