//! `plumbline calibrate stereo` and `plumbline calibrate check`.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{
    self as offline, CalibrateArgs, CalibrateReport, CheckArgs, CheckReport, PairErrors, Rejected,
};
use plumbline_widgets::format;

use super::common::{BoardPairs, Cameras, Lens, listed};
use super::output::{Output, say};

/// Arguments of `calibrate stereo`.
#[derive(Debug, Args)]
pub struct Stereo {
    #[command(flatten)]
    pairs: BoardPairs,
    /// Lens model of both eyes.
    #[arg(long, value_enum, default_value_t)]
    model: Lens,
    /// Where the calibration is written, with the corners and options it was made from.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Arguments of `calibrate check`.
#[derive(Debug, Args)]
pub struct Check {
    #[command(flatten)]
    cameras: Cameras,
    #[command(flatten)]
    pairs: BoardPairs,
}

/// Solves and writes.
pub fn stereo(arguments: Stereo, output: &Output) -> anyhow::Result<()> {
    let args = CalibrateArgs {
        left: arguments.pairs.left,
        right: arguments.pairs.right,
        board: arguments.pairs.board,
        square_m: arguments.pairs.square_mm / 1000.0,
        model: arguments.model.into(),
        exclude: arguments.pairs.exclude,
        out: Some(arguments.out.clone()),
    };
    let report = offline::calibrate_stereo(&args, output)?;
    say_notes(&report.notes);
    output
        .result(&report, |report| format!("{}\nwritten to {}", stereo_text(report), arguments.out.display()))
}

fn stereo_text(report: &CalibrateReport) -> String {
    let unseen = report.cross_validated_px.map_or("not computed".to_owned(), format::px);
    let mut text = format!(
        "{} used of {} with the board in both eyes\n\
         stereo rms       {} (left {}, right {})\n\
         on unseen pairs  {unseen}\n\
         epipolar         {}\n\
         squares          {:.3} mm, scattered by {:.3} mm\n\
         baseline         {:.3} mm\n",
        format::count(report.pairs_used, "pair"),
        report.pairs_found,
        format::px(report.rms_stereo_px),
        format::px(report.rms_left_px),
        format::px(report.rms_right_px),
        format::px(report.epipolar_px),
        report.square_mm_mean,
        report.square_mm_sd,
        report.baseline_mm,
    );
    let corners = report.corners_left_out.iter().map(|corner| {
        format!(
            "{}, {} eye, corner {}: {} off",
            corner.pair,
            corner.eye,
            corner.corner,
            format::px(corner.error_px)
        )
    });
    text.push_str(&listed("bad corners left out:", corners));
    text.push_str(&rejected(&report.pairs_rejected));
    text.push_str(&worst(&report.per_pair));
    text
}

/// Measures.
pub fn check(arguments: Check, output: &Output) -> anyhow::Result<()> {
    let args = CheckArgs {
        cameras: arguments.cameras.cameras,
        left: arguments.pairs.left,
        right: arguments.pairs.right,
        board: arguments.pairs.board,
        square_m: arguments.pairs.square_mm / 1000.0,
        exclude: arguments.pairs.exclude,
    };
    let report = offline::check(&args, output)?;
    say_notes(&report.notes);
    output.result(&report, check_text)
}

fn check_text(report: &CheckReport) -> String {
    let mut text = format!(
        "{} with the board in both eyes\n\
         reprojection     {}\n\
         epipolar         {}\n\
         squares          {:.3} mm, scattered by {:.3} mm\n",
        format::count(report.pairs, "pair"),
        format::px(report.reprojection_px),
        format::px(report.epipolar_px),
        report.square_mm_mean,
        report.square_mm_sd,
    );
    text.push_str(&rejected(&report.pairs_rejected));
    text.push_str(&worst(&report.per_pair));
    text
}

fn rejected(pairs: &[Rejected]) -> String {
    listed("pairs not used:", pairs.iter().map(|pair| format!("{}: {}", pair.name, pair.reason)))
}

/// The three pairs that fit worst.
fn worst(pairs: &[PairErrors]) -> String {
    let error = |pair: &PairErrors| pair.left_px.unwrap_or(0.0).max(pair.right_px.unwrap_or(0.0));
    let mut sorted: Vec<&PairErrors> = pairs.iter().collect();
    sorted.sort_by(|a, b| error(b).total_cmp(&error(a)));
    let px = |error: Option<f64>| error.map_or(format::NONE.to_owned(), format::px);
    let line =
        |pair: &&PairErrors| format!("{}: left {}, right {}", pair.name, px(pair.left_px), px(pair.right_px));
    listed("worst pairs:", sorted.iter().take(3).map(line))
}

/// What was noticed about the files.
pub fn say_notes(notes: &[String]) {
    for note in notes {
        say(note);
    }
}
