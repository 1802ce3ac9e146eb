//! The gap in words: verdicts, units, names of effects.

use plumbline_engine::View;
use plumbline_widgets::format::{self, Quantity};

use crate::operator::snapshot::gap::{
    CoordinateComparison, Experiment, Finding, Knowledge, NamedEffect, Shown, ShownUnit, Unit, Verdict, What,
};

/// Quantity of a natural coordinate; residuals in SI.
pub fn quantity(of: &CoordinateComparison) -> Quantity {
    match of.unit {
        Unit::Meter => Quantity::Length,
        Unit::Radian => Quantity::Angle,
        Unit::Pixel => Quantity::Pixels,
    }
}

/// What was measured.
pub fn kind(what: What) -> &'static str {
    match what {
        What::Touch => "touches",
        What::Pose => "poses measured from outside",
        What::OrientedPose => "poses measured with their orientation",
        What::Place => "places that the eyes estimated",
        What::EyePoints => "image points",
    }
}

/// Quantity of held-out errors.
pub fn held_out(unit: ShownUnit) -> Quantity {
    match unit {
        ShownUnit::Meter => Quantity::Length,
        ShownUnit::Pixel => Quantity::Pixels,
    }
}

/// "6.71 mm" of a number of the finding.
pub fn error(shown: &Shown, value: f64) -> String {
    held_out(shown.unit).text(value)
}

/// The verdict, short enough for a heading.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoGap => "No gap",
        Verdict::Named => "Found and named",
        Verdict::Class => "Found, but not one name",
        Verdict::NotInLibrary => "Not one of the known effects",
    }
}

/// "joint zero of the right elbow": the kind in its short name, and where it sits.
pub fn short(effect: &NamedEffect) -> String {
    named(&effect.id, &effect.site, &effect.title)
}

/// The same from its parts.
pub fn named(id: &str, site: &str, title: &str) -> String {
    let kind = id.replace('-', " ");
    match title.split_once(": ") {
        Some((whose, _)) if whose.to_lowercase().starts_with("every ") => {
            format!("{kind} of {}", lower(whose))
        }
        Some((whose, _)) => format!("{kind} of the {}", lower(whose)),
        None if matches!(site, "" | "screen" | "tip" | "base" | "eyes") => kind,
        None => format!("{kind} of {}", site.replace('_', " ")),
    }
}

/// Names of parts begin small inside of a sentence; abbreviations stay.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if second.is_lowercase() => first.to_lowercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}

/// What the data say about a candidate: a word, and what it means.
pub fn knowledge(knowledge: &Knowledge) -> (&'static str, String) {
    match knowledge {
        Knowledge::Dead => ("dead", "It would do nothing to these rows.".to_owned()),
        Knowledge::Flat => ("flat", "It would do less than the noise.".to_owned()),
        Knowledge::TradeOff(with) => (
            "trade-off",
            format!("Seen only together with {}: they can trade against each other.", with.join(", ")),
        ),
        Knowledge::NotPinned => {
            ("not pinned", "Its size is hardly better known after than before.".to_owned())
        }
        Knowledge::AtBound => ("at bound", "Its fit sits at the end of what is plausible.".to_owned()),
        Knowledge::Known => ("known", "Its size is known.".to_owned()),
    }
}

/// "92.0 % of the gap is closed (85.0 to 97.0 %)".
pub fn closure(shown: &Shown) -> Option<String> {
    let closure = shown.closure?;
    let range = shown.closure_range.map_or_else(String::new, |[low, high]| {
        let low = Quantity::Ratio.number(low);
        format!(" ({low} to {}, 95 %)", format::percent(high))
    });
    Some(format!("{} of the gap is closed{range}.", format::percent(closure)))
}

/// Whether the answer can be trusted, a sentence per reason.
pub fn trust(finding: &Finding) -> Vec<String> {
    let comparison = &finding.comparison;
    let mut said = vec![];
    let p = if comparison.p_value < 1e-4 {
        "less than 0.0001".to_owned()
    } else {
        format::significant(comparison.p_value, 2)
    };
    said.push(format!(
        "What the model leaves is {} noise deviations beyond the noise; by noise alone so much comes with a probability of {p}.",
        format::significant(comparison.size_sigmas, 2),
    ));
    said.push(if comparison.floor_from_repeats {
        "The noise is known from repeats of the same command.".to_owned()
    } else {
        "No command was repeated: the noise is estimated from near neighbors and is approximate.".to_owned()
    });
    let outliers = comparison.rows.saturating_sub(comparison.rows_kept);
    if outliers > 0 {
        said.push(format!(
            "{} far off all others and set aside.",
            match outliers {
                1 => "1 row lies".to_owned(),
                n => format!("{n} rows lie"),
            }
        ));
    }
    said
}

/// "Add joint zero of the right elbow to the model".
pub fn add_label(view: &View, effects: &[usize]) -> String {
    let Some(shown) = &view.gap.shown else { return String::new() };
    match effects {
        [one] => match shown.finding.effects.get(*one) {
            Some(effect) => format!("Add {} to the model", short(effect)),
            None => String::new(),
        },
        several => format!("Add {} effects to the model", several.len()),
    }
}

/// "Touch 40 targets: repeat with a 250 g weight".
pub fn touch_label(view: &View) -> String {
    let next = view.gap.finding().and_then(|finding| finding.next.as_ref());
    let Some(next) = next else { return "Plan the next experiment".to_owned() };
    let how = match next.kind {
        Experiment::OtherSide => " from the other side",
        Experiment::Weight => " with a weight",
        Experiment::RaisedScreen => " on a raised screen",
        Experiment::OtherPosture => " with another posture of the elbow",
        Experiment::Slower => " more slowly",
        Experiment::Repeats => " again",
        _ => "",
    };
    format!("Touch {}{how}", format::count(next.count, "target"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_are_called_by_kind_and_place() {
        let title = "Right elbow: zero position off";
        assert_eq!(named("joint-zero", "r_elbow_y", title), "joint zero of the right elbow");
        assert_eq!(named("axis-skew", "", "Every joint: axis not square"), "axis skew of every joint");
        assert_eq!(named("screen-tilt", "screen", "screen tilted or shifted"), "screen tilt");
        assert_eq!(named("link-length", "forearm_r", "wrong length"), "link length of forearm r");
    }
}
