//! The score as a Markdown table.

use std::fmt::Write as _;

use crate::mix::SIZES;
use crate::score::{Naming, Score, Share, median};
use crate::words::nearest_size;

/// The whole score.
pub fn markdown(score: &Score) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "| what | wanted | reached | 95 % interval |\n|---|---|---|---|");
    let mut line = |what: &str, wanted: &str, share: &Share| {
        let _ = writeln!(text, "| {what} | {wanted} | {} | {} |", percent(share), range(share));
    };
    let [clean, dirty] = &score.null_named;
    let all = Share { hits: clean.hits + dirty.hits, of: clean.of + dirty.of };
    line("nothing hidden: named", "≤ 1 %", &all);
    line("– only dirt hidden: named", "", dirty);
    line("– a gap without a name claimed", "", &score.null_gap);
    for (plan, naming) in &score.singles_visible {
        line(&format!("one effect ≥ 1 σ, {plan}: class right"), "≥ 95 %", &naming.class);
        let wanted = if plan == "rich" { "≥ 85 %" } else { "" };
        line(&format!("one effect ≥ 1 σ, {plan}: exact"), wanted, &naming.exact);
    }
    for ((family, plan), naming) in &score.several {
        let wanted = if family == "pair" { "≥ 90 %" } else { "≥ 80 %" };
        line(&format!("{family}, {plan}: all classes found"), wanted, &naming.class);
        let visible = score.several_visible.get(&(family.clone(), plan.clone())).copied().unwrap_or_default();
        if visible.class.of < naming.class.of {
            line(&format!("– of those with ≥ 1 σ each: {family}, {plan}"), wanted, &visible.class);
        }
    }
    for (plan, said) in &score.nameless {
        line(&format!("not in the library, {plan}: said so"), "≥ 95 %", said);
    }
    line("not in the library: confident wrong name", "≤ 3 %", &score.nameless_named);
    if score.crowd_said.of > 0 {
        line("a little off everywhere: said that no few names are all", "", &score.crowd_said);
        line("– a few sure names said to be all", "", &score.crowd_named);
        line("– confident wrong name", "≤ 3 %", &score.crowd_wrong);
    }
    line("all names given: wrong", "", &score.wrong_names);
    line("names stated with > 0.8: wrong", "", &score.wrong_confident);
    line("95 % intervals that hold the truth", "93–97 %", &score.coverage);
    let _ = writeln!(
        text,
        "| parameter error at 2 σ, median | ≤ 10 % | {} | of {} |\n| gap closed on held-out rows, median | ≥ 0.90 | {} | of {} |\n| stated probabilities off by (ECE) | ≤ 0.04 | {} | of {} names; {} by chance |\n| time of a search, median and longest | ≤ 4 s | {} s, {:.1} s | of {} |",
        median(&score.parameter_errors).map_or_else(|| "–".to_owned(), |e| format!("{:.1} %", 100.0 * e)),
        score.parameter_errors.len(),
        median(&score.closures).map_or_else(|| "–".to_owned(), |c| format!("{c:.2}")),
        score.closures.len(),
        score.calibration_error().map_or_else(|| "–".to_owned(), |e| format!("{e:.3}")),
        score.stated.iter().map(|(_, names, _)| names).sum::<usize>(),
        score.calibration_error_by_chance().map_or_else(|| "–".to_owned(), |e| format!("{e:.3}")),
        median(&score.seconds).map_or_else(|| "–".to_owned(), |s| format!("{s:.1}")),
        score.seconds.iter().copied().fold(0.0, f64::max),
        score.seconds.len(),
    );
    singles(&mut text, score);
    kinds(&mut text, score);
    for (case, why) in &score.failed {
        let _ = writeln!(text, "\ncase {case:03} got no verdict: {why}");
    }
    text
}

fn singles(text: &mut String, score: &Score) {
    let _ = writeln!(
        text,
        "\n| one effect, class right / exact (cases) | {} |",
        SIZES.map(|s| format!("{s} σ")).join(" | ")
    );
    let _ = writeln!(text, "|---|{}", "---|".repeat(SIZES.len()));
    let plans: std::collections::BTreeSet<&String> = score.singles.keys().map(|(plan, _)| plan).collect();
    for plan in plans {
        let cells = SIZES.map(|size| {
            let naming = score.singles.get(&(plan.clone(), nearest_size(size)));
            naming.map_or_else(|| "–".to_owned(), both)
        });
        let _ = writeln!(text, "| {plan} | {} |", cells.join(" | "));
    }
}

fn kinds(text: &mut String, score: &Score) {
    let _ = writeln!(text, "\n| kind, one effect ≥ 1 σ | class right / exact (cases) |\n|---|---|");
    for (kind, naming) in &score.singles_by_kind {
        let _ = writeln!(text, "| {kind} | {} |", both(naming));
    }
    let _ = writeln!(text, "\n| not in the library | said so |\n|---|---|");
    for (kind, said) in &score.nameless_by_kind {
        let _ = writeln!(text, "| {kind} | {} |", percent(said));
    }
    let _ = writeln!(text, "\n| stated probability | right | names |\n|---|---|---|");
    for (sum, names, right) in score.stated.iter().filter(|(_, names, _)| *names > 0) {
        let n = *names as f64;
        let _ = writeln!(text, "| {:.2} | {:.2} | {names} |", sum / n, *right as f64 / n);
    }
}

fn both(naming: &Naming) -> String {
    let share = |share: &Share| share.value().map_or_else(|| "–".to_owned(), |v| format!("{:.0}", 100.0 * v));
    format!("{} / {} % ({})", share(&naming.class), share(&naming.exact), naming.class.of)
}

fn percent(share: &Share) -> String {
    share.value().map_or_else(
        || "– (0)".to_owned(),
        |value| format!("{:.0} % ({} of {})", 100.0 * value, share.hits, share.of),
    )
}

fn range(share: &Share) -> String {
    if share.of == 0 {
        return "–".to_owned();
    }
    let [low, high] = share.interval();
    format!("{:.0}–{:.0} %", 100.0 * low, 100.0 * high)
}
