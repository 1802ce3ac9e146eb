//! `plumbline gap`: finds where model and measurement disagree, names what is missing, and shows the
//! gap shrink.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{self as offline, GapArgs, GapReport};
use plumbline_widgets::{format, parameter, probability};

use super::output::Output;
use crate::operator::snapshot::gap::{
    Candidate, Comparison, CoordinateComparison, Finding, NamedEffect, NextExperiment, Shown, ShownUnit,
    Unexplained,
};
use crate::operator::words::{self, sentence};

/// So many effects are written out, the others by their titles.
const MOST_EFFECTS: usize = 3;

/// Arguments of `gap`.
#[derive(Debug, Args)]
pub struct Gap {
    /// Folders of sessions of one robot, looked at together.
    #[arg(long, value_name = "DIR", num_args = 1.., required = true)]
    session: Vec<PathBuf>,
    /// What to compare with in place of what the first session names: a rig file, the screen.toml of a
    /// placed touchscreen, or a model with effects, whose own gap is then looked for.
    #[arg(long, value_name = "FILE")]
    rig_model: Option<PathBuf>,
    /// Writes a model with all effects that were found; needs --out.
    #[arg(long, requires = "out")]
    add: bool,
    /// Receives the model, for --rig-model of this command, predict and ik. Where nothing can be added
    /// it is written as it was.
    #[arg(long, value_name = "FILE", requires = "add")]
    out: Option<PathBuf>,
    /// Receives a page about it: PDF if its name ends in .pdf, else HTML.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// The same seed gives the same answer.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Compares, finds, names, shows.
pub fn run(arguments: Gap, output: &Output) -> anyhow::Result<()> {
    let args = GapArgs {
        sessions: arguments.session,
        rig_model: arguments.rig_model,
        seed: arguments.seed,
        add_to: arguments.out.filter(|_| arguments.add),
        report: arguments.report,
    };
    let report = offline::gap(&args, output)?;
    output.result(&report, text)
}

fn text(report: &GapReport) -> String {
    let finding = &report.finding;
    let mut text = format!("{}\n", finding.sentence);
    for warning in &finding.warnings {
        text.push_str(&format!("Note: {}\n", sentence(warning)));
    }
    compared(&mut text, &finding.comparison);
    found(&mut text, finding);
    shown(&mut text, &finding.shown, finding.comparison.is_noise_known());
    unexplained(&mut text, &finding.unexplained);
    if let Some(next) = &finding.next {
        next_experiment(&mut text, next);
    }
    left_out(&mut text, finding);
    if !report.added.is_empty() {
        let added: Vec<String> =
            report.added.iter().map(|name| words::effect::of_effect(name, &finding.effects)).collect();
        text.push_str(&format!("Added to the model: {}\n", added.join(", ")));
    }
    text.push_str(&format!("Searched for {}\n", format::ms(finding.seconds)));
    text
}

/// "12.3 mm", in the unit of a natural coordinate.
fn coordinate(of: &CoordinateComparison, value: f64) -> String {
    use crate::operator::snapshot::gap::Unit;
    match of.unit {
        Unit::Meter => format::mm(value),
        Unit::Radian => format::degrees(value),
        Unit::Pixel => format::px(value),
    }
}

fn compared(text: &mut String, comparison: &Comparison) {
    text.push_str(&format!(
        "\nCompared: {} at {}",
        format::count(comparison.rows, "row"),
        format::count(comparison.cells, "distinct pose"),
    ));
    let outliers = comparison.rows.saturating_sub(comparison.rows_kept);
    if outliers > 0 {
        text.push_str(&format!(", {} set aside", format::count(outliers, "outlier")));
    }
    text.push('\n');
    for kind in &comparison.kinds {
        for of in &kind.coordinates {
            text.push_str(&format!(
                "  {:<22} differs by {:<10} noise {:<10} {} of the gap\n",
                of.name,
                coordinate(of, of.rms),
                coordinate(of, of.floor),
                format::percent(of.share)
            ));
        }
    }
    if !comparison.is_noise_known() {
        text.push_str(&format!("  {}\n", comparison.floor_from().sentence()));
        return;
    }
    text.push_str(&format!(
        "  {} noise deviations beyond the noise (noise from {}), p = {}\n",
        format::significant(comparison.size_sigmas, 2),
        comparison.floor_from().words(),
        p_value(comparison.p_value)
    ));
}

/// Probabilities that are next to nothing are said so.
fn p_value(p: f64) -> String {
    if p < 1e-4 { "less than 0.0001".to_owned() } else { format::significant(p, 2) }
}

fn found(text: &mut String, finding: &Finding) {
    if finding.effects.is_empty() {
        return;
    }
    text.push_str("\nFound:\n");
    for effect in finding.effects.iter().take(MOST_EFFECTS) {
        one(text, effect, &finding.candidates);
    }
    let more: Vec<&str> =
        finding.effects.iter().skip(MOST_EFFECTS).map(|effect| effect.title.as_str()).collect();
    if !more.is_empty() {
        text.push_str(&format!("  and {} more: {}\n", more.len(), more.join("; ")));
    }
}

fn one(text: &mut String, effect: &NamedEffect, candidates: &[Candidate]) {
    let (told, zero): (Vec<_>, Vec<_>) = effect.parameters.iter().partition(|found| found.is_told());
    let not_told = words::effect::not_told(told.len(), zero.len());
    text.push_str(&format!(
        "  {}, {} sure\n",
        words::capitalized(&effect.title),
        probability::percent(effect.probability)
    ));
    for found in told {
        let said = match &found.text {
            Some(text) => words::effect::choice(text, candidates),
            None => format!(
                "{} ({}, 95 %)",
                parameter::value(&found.name, found.value),
                parameter::interval(&found.name, found.low, found.high)
            ),
        };
        text.push_str(&format!("    {}: {said}\n", parameter::words(&found.name)));
    }
    if let Some(said) = not_told {
        text.push_str(&format!("    {said}\n"));
    }
    if effect.class.len() > 1 {
        text.push_str(&format!(
            "    one of {} names that these data cannot tell apart ({} that it is one of them):\n",
            effect.class.len(),
            format::percent(effect.class_probability)
        ));
        for member in &effect.class {
            text.push_str(&format!("      {} {}\n", format::percent(member.probability), member.title));
        }
        if let Some(split) = &effect.split_by {
            text.push_str(&format!("    to tell them apart: {split}\n"));
        }
    }
    if let Some(runner_up) = words::effect::runner_up(effect, candidates) {
        text.push_str(&format!("    {runner_up}\n"));
    }
    if let Some(why) = &effect.not_addable {
        text.push_str(&format!("    cannot be added: {why}\n"));
    }
}

fn shown(text: &mut String, shown: &Shown, is_noise_known: bool) {
    let of = |value: f64| match shown.unit {
        ShownUnit::Meter => format::mm(value),
        ShownUnit::Pixel => format::px(value),
    };
    if shown.rows == 0 {
        return;
    }
    let noise = if is_noise_known {
        format!("noise alone would leave {}", of(shown.floor))
    } else {
        "nothing tells the noise".to_owned()
    };
    text.push_str(&format!(
        "\nOn {} that were not used ({}): {} before, {} after; {noise}\n",
        format::count(shown.rows, "row"),
        shown.blocks,
        of(shown.before),
        of(shown.after)
    ));
    if let Some(closure) = shown.closure.filter(|_| is_noise_known) {
        let range = shown.closure_range.map_or_else(String::new, |[low, high]| {
            format!(" ({} to {}, 95 %)", format::percent(low), format::percent(high))
        });
        text.push_str(&format!("  {} of the gap is closed{range}\n", format::percent(closure)));
    }
    if let Some(unseen) = &shown.unseen {
        text.push_str(&format!(
            "  {}, held out as a whole: {} before, {} after{}\n",
            unseen.what,
            of(unseen.before),
            of(unseen.after),
            if is_noise_known { format!(", noise {}", of(unseen.floor)) } else { String::new() }
        ));
    }
}

fn unexplained(text: &mut String, left: &Unexplained) {
    text.push_str(&format!(
        "\nUnexplained: p = {} that noise alone leaves the rest; {} that something outside of the library is at work\n",
        p_value(left.p_value),
        format::percent(left.probability)
    ));
    for on in &left.depends_on {
        let formula = on.formula.as_ref().map_or_else(String::new, |formula| format!(": {formula}"));
        text.push_str(&format!(
            "  {} depends on {} ({} of the rest){formula}\n",
            on.of,
            on.on,
            format::percent(on.share)
        ));
    }
}

fn next_experiment(text: &mut String, next: &NextExperiment) {
    text.push_str(&format!(
        "\nNext: {} ({}, about {} min; then {} sure). {}\n",
        next.what,
        format::count(next.count, "measurement"),
        format::significant(next.minutes, 2),
        format::percent(next.expected_probability),
        next.why
    ));
}

fn left_out(text: &mut String, finding: &Finding) {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for row in &finding.left_out {
        match reasons.iter_mut().find(|(why, _)| *why == row.why) {
            Some((_, count)) => *count += 1,
            None => reasons.push((&row.why, 1)),
        }
    }
    for (why, count) in reasons {
        text.push_str(&format!("Left out: {}, {why}\n", format::count(count, "row")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::snapshot::gap::sample;

    fn said(finding: Finding) -> String {
        let mut report = GapReport::of(finding);
        report.added = report.finding.effects.iter().map(|e| format!("{}@{}", e.id, e.site)).collect();
        text(&report)
    }

    #[test]
    fn people_read_no_raw_ids() {
        for finding in [sample::named(), sample::class(), sample::not_in_library(), sample::pixels()] {
            let said = said(finding);
            assert!(said.contains("Runner-up: "), "{said}");
            for raw in ["@", "r_elbow_y", "r_shoulder_y", "joint-", "link-"] {
                assert!(!said.contains(raw), "{raw} in {said}");
            }
        }
    }

    #[test]
    fn warnings_stand_right_below_the_verdict() {
        let mut finding = sample::named();
        finding.warnings = vec!["there are too few repeats".to_owned()];
        let said = said(finding);
        let verdict_and_warning = said.lines().take(2).collect::<Vec<_>>().join(" ");
        assert!(verdict_and_warning.ends_with("Note: There are too few repeats."), "{said}");
    }

    #[test]
    fn at_most_three_effects_are_written_out_and_values_that_may_be_zero_are_counted() {
        let crowded = said(sample::crowded());
        assert!(crowded.contains("and 4 more: "), "{crowded}");
        let mut finding = sample::named();
        let parameter = &mut finding.effects[0].parameters[0];
        (parameter.value, parameter.low, parameter.high) = (0.0123, -0.01, 0.0346);
        let said = said(finding);
        assert!(said.contains("Its size is not told from zero.") && !said.contains("0.705"), "{said}");
    }
}
