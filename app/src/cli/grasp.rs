//! `plumbline grasp` and `plumbline grasp-trials`: grasps on the twin, one or the whole experiment.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use plumbline_offline::{
    self as offline, GraspArgs, GraspMethod, GraspReport, HandChoice, Summary, TrialsArgs,
};
use plumbline_widgets::format;

use super::output::Output;

/// Arguments of `grasp`.
#[derive(Debug, Args)]
pub struct Grasp {
    /// Folder of a commissioned lab (see `plumbline commission`).
    #[arg(long, value_name = "FOLDER")]
    lab: PathBuf,
    /// The twin: name of a scenario, or a TOML file; without, the one that the lab was commissioned on.
    #[arg(long, value_name = "NAME|FILE")]
    twin: Option<String>,
    /// How: m1, m2, m3, m4 as published, m5 ours.
    #[arg(long, value_name = "METHOD", default_value = "m5", value_parser = method)]
    method: GraspMethod,
    /// With which hand: right, left, or auto, the one whose plan is best. M1 to M4 know the right one.
    #[arg(long, value_name = "HAND", default_value = "auto", value_parser = hand)]
    hand: HandChoice,
    /// What: tomato, mushroom, onion, orange.
    #[arg(long, value_name = "NAME", default_value = "tomato")]
    object: String,
    /// Where it stands: x and y in the robot frame, in meters.
    #[arg(long, value_name = "X,Y", default_value = "0.3,-0.1", value_parser = place, allow_hyphen_values = true)]
    at: [f64; 2],
    /// Of all that is drawn by chance.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Keeps the record, the joints over time and what both eyes saw in this folder.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

/// Arguments of `grasp-trials`.
#[derive(Debug, Args)]
pub struct GraspTrials {
    /// The twin: name of a scenario, or a TOML file; without, the one that the lab was commissioned on.
    #[arg(long, value_name = "NAME|FILE")]
    twin: Option<String>,
    /// Folder of a commissioned lab (see `plumbline commission`).
    #[arg(long, value_name = "FOLDER", required_unless_present = "merge")]
    lab: Option<PathBuf>,
    /// Methods to compare.
    #[arg(long, value_name = "LIST", default_value = "m1,m2,m3,m4,m5", value_delimiter = ',', value_parser = method)]
    methods: Vec<GraspMethod>,
    /// Attempts per position and method.
    #[arg(long, value_name = "N", default_value_t = 3)]
    attempts: usize,
    /// Table with the columns `x_m` and `y_m`; the 22 published positions without.
    #[arg(long, value_name = "CSV")]
    positions: Option<PathBuf>,
    /// With which hand: right, left, or auto, the one whose plan is best. M1 to M4 know the right one.
    #[arg(long, value_name = "HAND", default_value = "auto", value_parser = hand)]
    hand: HandChoice,
    /// What: tomato, mushroom, onion, orange.
    #[arg(long, value_name = "NAME", default_value = "tomato")]
    object: String,
    /// Of all that is drawn by chance.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only part K of N of the attempts; parts may run anywhere, and are put together with --merge.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<(usize, usize)>,
    /// Puts the folders of shards together.
    #[arg(long, value_name = "FOLDER", num_args = 1.., conflicts_with_all = ["lab", "shard"])]
    merge: Vec<PathBuf>,
    /// Where to. The same call on the same folder goes on where it was interrupted.
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// Keeps what both eyes saw in every attempt, in the folder `images`: about 2 MB each.
    #[arg(long)]
    images: bool,
}

/// Grasps once.
pub fn grasp(arguments: Grasp, output: &Output) -> anyhow::Result<()> {
    let Grasp { lab, twin, method, hand, object, at, seed, out } = arguments;
    let report = offline::grasp(&GraspArgs { twin, lab, method, hand, object, at_m: at, seed, out }, output)?;
    output.result(&report, told)
}

/// Runs the experiment, or puts shards of it together.
pub fn trials(arguments: GraspTrials, output: &Output) -> anyhow::Result<()> {
    let GraspTrials {
        twin,
        lab,
        methods,
        attempts,
        positions,
        hand,
        object,
        seed,
        shard,
        merge,
        out,
        images,
    } = arguments;
    let summary = match lab {
        Some(lab) => {
            let args = TrialsArgs {
                twin,
                lab,
                methods,
                attempts,
                positions,
                hand,
                object,
                seed,
                shard,
                out,
                images,
            };
            offline::grasp_trials(&args, output)?
        }
        None if merge.is_empty() => bail!("name the lab with --lab, or the folders of shards with --merge"),
        None => offline::merge_trials(&merge, &out)?,
    };
    output.result(&summary, table)
}

fn told(report: &GraspReport) -> String {
    let mut text = report.result.to_owned();
    if let Some(why) = &report.why {
        text.push_str(": ");
        text.push_str(why);
    }
    text.push_str(&format!("\n  with the {} hand, by the model \"{}\"\n", report.hand.name(), report.model));
    if let Some(seconds) = report.seconds {
        text.push_str(&format!("  {seconds:.1} s from the button to the end of the lift\n"));
    }
    if let Some(mm) = report.alignment_mm {
        let looks = format::count(report.iterations, "look");
        text.push_str(&format!("  {looks} at the hand, {mm:.1} mm beside at the last\n"));
    }
    text
}

fn table(summary: &Summary) -> String {
    let mut text =
        String::from("method   all            inside     hand    refused   palm off (mm)      time\n");
    for (name, of) in &summary.methods {
        let share = |part: usize, whole: usize| format!("{part}/{whole}");
        let mm = |value: Option<f64>| value.map_or("–".to_owned(), |mm| format!("{mm:.1}"));
        text.push_str(&format!(
            "{:8} {:7} {:>4.0} %   {:7}    {:7} {:5}     {:>4} … {:>5}   {:>6} s\n",
            name.to_uppercase(),
            share(of.successes, of.attempts),
            100.0 * of.successes as f64 / of.attempts.max(1) as f64,
            share(of.inside, of.inside_attempts),
            if of.hand_positions == 0 { "–".to_owned() } else { share(of.hand_located, of.hand_positions) },
            of.refused,
            mm(of.alignment_mm.median),
            mm(of.alignment_mm.worst),
            mm(of.seconds_median),
        ));
        for (failure, count) in &of.failures {
            text.push_str(&format!("           {failure} {count}\n"));
        }
    }
    if summary.missing > 0 {
        text.push_str(&format!("{} still to be made\n", format::count(summary.missing, "attempt")));
    }
    text
}

fn method(name: &str) -> Result<GraspMethod, String> {
    GraspMethod::from_name(name).ok_or_else(|| "give m1, m2, m3, m4 or m5".to_owned())
}

fn hand(name: &str) -> Result<HandChoice, String> {
    HandChoice::from_name(name).ok_or_else(|| "give auto, right or left".to_owned())
}

fn place(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([x, y]) if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err("give x and y in meters, for example 0.3,-0.1".to_owned()),
    }
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    parts
        .filter(|(k, n)| (1..=*n).contains(k))
        .ok_or_else(|| "give K/N with K from 1 to N, for example 2/8".to_owned())
}
