//! The answer in a sentence or two, for someone in the lab.

use crate::finding::{Finding, FoundParameter, NamedEffect, Shown, ShownUnit, Verdict};

/// What was found, in words.
pub(crate) fn of(finding: &Finding) -> String {
    match finding.verdict {
        Verdict::NoGap => no_gap(finding),
        Verdict::Named | Verdict::Class => {
            let found: Vec<String> = finding.effects.iter().map(effect).collect();
            format!("{} {}", found.join(" "), shrink(&finding.shown))
        }
        Verdict::NotInLibrary => not_in_library(finding),
    }
}

fn no_gap(finding: &Finding) -> String {
    let (shown, comparison) = (&finding.shown, &finding.comparison);
    let approximate = if comparison.floor_from_repeats { "" } else { " (estimated from near neighbors)" };
    let first = if comparison.is_gap {
        "Model and measurement differ by less than the noise, and nothing in that has a name."
    } else {
        "Model and measurement agree within the noise: there is no gap to close."
    };
    format!(
        "{first} Once the frame is placed, the mean error is {}, and noise alone leaves {}{approximate}.",
        size(shown.before, shown.unit),
        size(shown.floor, shown.unit)
    )
}

fn not_in_library(finding: &Finding) -> String {
    let shown = &finding.shown;
    let gap = format!(
        "There is a gap ({} where noise alone leaves {}), and no effect of the library explains it.",
        size(shown.before, shown.unit),
        size(shown.floor, shown.unit)
    );
    let depends: Vec<&str> = finding.unexplained.depends_on.iter().map(|on| on.on.as_str()).take(2).collect();
    let on = if depends.is_empty() {
        String::new()
    } else {
        format!(" What is left depends on the {}.", depends.join(" and the "))
    };
    let partly: Vec<&str> = finding.effects.iter().map(|effect| effect.title.as_str()).take(2).collect();
    let partly = if partly.is_empty() {
        String::new()
    } else {
        format!(" It looks partly like: {}.", partly.join("; "))
    };
    format!("{gap}{on}{partly}")
}

fn effect(effect: &NamedEffect) -> String {
    let parameters: Vec<String> = effect.parameters.iter().filter_map(parameter).collect();
    let sized = if parameters.is_empty() { String::new() } else { format!(": {}", parameters.join(", ")) };
    let others: Vec<&str> = effect.class.iter().skip(1).map(|member| member.title.as_str()).take(3).collect();
    let title = capital(&effect.title);
    if others.is_empty() {
        return format!("{title}{sized}.");
    }
    let split =
        effect.split_by.as_ref().map_or(String::new(), |split| format!(" To tell them apart: {split}."));
    format!("{title}{sized}; the data cannot tell it from: {}.{split}", others.join("; "))
}

/// A parameter in the units of the lab, as far as its name says its unit.
fn parameter(parameter: &FoundParameter) -> Option<String> {
    let FoundParameter { name, value, low, high, .. } = parameter;
    let (scale, unit, what) = if let Some(what) = name.strip_suffix("_rad_per_nm") {
        (1f64.to_degrees(), "° per N m", what)
    } else if let Some(what) = name.strip_suffix("_nm_per_rad") {
        (1.0, " N m/rad", what)
    } else if let Some(what) = name.strip_suffix("_rad") {
        (1f64.to_degrees(), "°", what)
    } else if let Some(what) = name.strip_suffix("_per_m") {
        (1.0, " per m", what)
    } else if let Some(what) = name.strip_suffix("_m_per_n") {
        (1e3, " mm per N", what)
    } else if let Some(what) = name.strip_suffix("_m") {
        (1e3, " mm", what)
    } else if let Some(what) = name.strip_suffix("_kg") {
        (1e3, " g", what)
    } else if let Some(what) = name.strip_suffix("_px") {
        (1.0, " px", what)
    } else if let Some(what) = name.strip_suffix("_secs").or_else(|| name.strip_suffix("_s")) {
        (1.0, " s", what)
    } else if name.starts_with("scale") || name == "ratio" || name == "fraction" || name == "weight" {
        (100.0, " %", name.as_str())
    } else {
        return None;
    };
    let (low, high) = (low * scale, high * scale);
    let digits = digits(high - low);
    let number = |value: f64| format!("{value:.digits$}");
    Some(format!(
        "{} {}{unit} ({} to {})",
        what.replace('_', " "),
        number(value * scale),
        number(low),
        number(high)
    ))
}

/// Decimals that show two digits of an interval.
fn digits(width: f64) -> usize {
    if !(width > 0.0) || !width.is_finite() {
        return 2;
    }
    (1.0 - width.log10()).floor().clamp(0.0, 4.0) as usize
}

fn shrink(shown: &Shown) -> String {
    let rows = match shown.unit {
        ShownUnit::Meter | ShownUnit::Pixel if shown.closure.is_none() => {
            return format!("The mean error is {}.", size(shown.before, shown.unit));
        }
        _ => "rows that were not used",
    };
    format!(
        "With it the error on {rows} falls from {} to {}; noise alone leaves {}.",
        size(shown.before, shown.unit),
        size(shown.after, shown.unit),
        size(shown.floor, shown.unit)
    )
}

fn size(value: f64, unit: ShownUnit) -> String {
    match unit {
        ShownUnit::Meter => format!("{:.1} mm", value * 1e3),
        ShownUnit::Pixel => format!("{value:.2} px"),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
