//! The answer in a sentence or two, for someone in the lab.

use crate::finding::{
    Candidate, ClassMember, Finding, FloorSource, FoundParameter, NamedEffect, ShownUnit, Verdict,
};
use crate::titles::by_title;
use crate::watched::WATCHED;
use plumbline_model::{counted, number, parameter_units, parameter_words};

/// What was found, in words.
pub(crate) fn of(finding: &Finding) -> String {
    match finding.verdict {
        Verdict::NoGap => no_gap(finding),
        Verdict::Named | Verdict::Class if finding.many.is_some() => much(finding),
        Verdict::Named | Verdict::Class => {
            let told = finding.effects.iter().take(MOST_EFFECTS);
            let mut said: Vec<String> = told.map(|one| effect(one, &finding.candidates)).collect();
            said.extend(more(&finding.effects));
            said.extend(
                finding
                    .undetermined
                    .iter()
                    .skip_while(|one| one.parameters.len() == 1)
                    .take(1)
                    .map(|one| one.words.clone()),
            );
            said.push(shrink(finding));
            said.join(" ")
        }
        Verdict::NotInLibrary => not_in_library(finding),
    }
}

/// From this on a name among much that is off is said to be sure.
const SURE: f64 = 0.8;
/// So many effects are told, the others counted.
const MOST_EFFECTS: usize = 3;
/// So many of its parameters are told.
const MOST_PARAMETERS: usize = 3;

/// Where no few effects explain it: which of the names are sure.
fn much(finding: &Finding) -> String {
    let is_sure = |effect: &&NamedEffect| effect.probability > SURE && effect.class.len() < 2;
    let sure: Vec<&str> =
        finding.effects.iter().filter(is_sure).map(|effect| effect.title.as_str()).collect();
    let rest = finding.effects.len() - sure.len();
    let which = match (sure.is_empty(), rest) {
        (true, _) => "None of the names is sure.".to_owned(),
        (false, 0) => format!("Sure: {}.", sure.join("; ")),
        (false, 1) => format!("Sure: {}. The other name is not.", sure.join("; ")),
        (false, _) => format!("Sure: {}. The other {rest} names are not.", sure.join("; ")),
    };
    format!("Many things are a little off, more than these rows can tell apart. {which} {}", shrink(finding))
}

/// The effects that are not told one by one.
fn more(effects: &[NamedEffect]) -> Option<String> {
    let rest = effects.len().saturating_sub(MOST_EFFECTS);
    (rest > 0).then(|| format!("And {rest} more."))
}

fn no_gap(finding: &Finding) -> String {
    let (shown, comparison) = (&finding.shown, &finding.comparison);
    if !comparison.is_noise_known() {
        return format!(
            "The noise is not known, and nothing in the library explains what is left: once the frame is placed, the mean \
             error is {}. A few repeats of one pose would tell whether that is noise.",
            size(shown.before, shown.unit)
        );
    }
    if comparison.is_beyond_instrument() {
        return format!(
            "Nothing in the library explains what is left: once the frame is placed, the mean error is {}, and the \
             instrument alone leaves {}. A few repeats of one pose would tell whether the arm itself scatters so far.",
            size(shown.before, shown.unit),
            size(shown.floor, shown.unit)
        );
    }
    let approximate = approximate(comparison.floor_from());
    let first = if comparison.is_gap {
        "Model and measurement differ by less than the noise, and nothing in that has a name."
    } else {
        "Model and measurement agree within the noise: there is no gap to close."
    };
    // What servos do all alike has no name, but no gap does not mean that commands are kept.
    let servos = finding.warnings.iter().find(|words| words.starts_with("the servos give way"));
    let servos = servos.map_or(String::new(), |words| format!(" But {words}."));
    let is_placed = comparison.kinds.iter().any(|kind| kind.what.is_placed());
    let mean = if finding.warnings.iter().any(|words| words.contains(WATCHED)) {
        "Beside what is constant at the place that was watched, the mean error"
    } else if is_placed {
        "Once the frame is placed, the mean error"
    } else {
        "The mean error"
    };
    format!(
        "{first} {mean} is {}, and noise alone leaves {}{approximate}.{servos}",
        size(shown.before, shown.unit),
        size(shown.floor, shown.unit)
    )
}

fn approximate(source: FloorSource) -> &'static str {
    match source {
        FloorSource::Repeats => "",
        FloorSource::Instrument => " (by the instrument's own figure)",
        FloorSource::Neighbors => " (estimated from near neighbors)",
        FloorSource::Fitted => " (fitted: no measurement was repeated)",
    }
}

fn not_in_library(finding: &Finding) -> String {
    let shown = &finding.shown;
    let before = size(shown.before, shown.unit);
    let gap = if finding.comparison.is_noise_known() {
        format!("There is a gap ({before} where noise alone leaves {})", size(shown.floor, shown.unit))
    } else {
        format!(
            "The mean error is {before}, how much of it is noise is not known (too little was measured twice)"
        )
    };
    let depends = told_once(finding.unexplained.depends_on.iter().map(|on| on.on.as_str()));
    let on = if depends.is_empty() {
        String::new()
    } else {
        format!(" What is left depends on {}.", depends.join(" and "))
    };
    if finding.partial {
        let parts = finding.addable();
        // How large each is says little where it is no name, and stands beside it anyway.
        let told = parts.iter().take(MOST_EFFECTS).map(|i| finding.effects[*i].title.as_str());
        let mut told: Vec<String> = told.map(ToOwned::to_owned).collect();
        let more = parts.len().saturating_sub(MOST_EFFECTS);
        if more > 0 {
            told.push(format!("{more} more"));
        }
        return format!(
            "{gap}, and no name explains it. A part of it can be added: {}. {}{on}",
            told.join("; "),
            shrink_by_part(finding)
        );
    }
    let partly: Vec<&str> = finding.effects.iter().map(|effect| effect.title.as_str()).take(2).collect();
    let partly = if partly.is_empty() {
        String::new()
    } else {
        format!(" It looks partly like: {}.", partly.join("; "))
    };
    format!("{gap}, and no effect of the library explains it.{on}{partly}")
}

/// The parameters that stand out most, in their order, and the number of the others.
fn clearest(told: Vec<&FoundParameter>) -> (Vec<&FoundParameter>, usize) {
    let sure = |one: &FoundParameter| one.value.abs() / (one.high - one.low).max(f64::MIN_POSITIVE);
    let mut order: Vec<f64> = told.iter().map(|one| sure(one)).collect();
    order.sort_by(|a, b| b.total_cmp(a));
    let least = order.get(MOST_PARAMETERS - 1).copied().unwrap_or(0.0);
    let all = told.len();
    let kept: Vec<&FoundParameter> =
        told.into_iter().filter(|one| one.text.is_some() || sure(one) >= least).collect();
    let more = all - kept.len();
    (kept, more)
}

/// Whether it stands for every joint or link at once, and no single one could take its place.
fn is_family(effect: &NamedEffect) -> bool {
    let of_kind = effect.class.iter().skip(1).any(|member| member.id == effect.id);
    effect.title.starts_with("every ") && !of_kind
}

/// The values that are not told one by one: `more` that are told, and `zero` that are not told from zero.
fn rest(any_told: bool, more: usize, zero: usize) -> Option<String> {
    let verb = |count: usize| if count == 1 { "is" } else { "are" };
    let values = |count: usize| counted(count, "more value");
    match (any_told, more, zero) {
        (_, 0, 0) => None,
        (false, _, 1) => Some("its size is not told from zero".to_owned()),
        (false, _, _) => Some(format!("none of its {zero} values is told from zero")),
        (true, _, 0) => Some(values(more)),
        (true, 0, _) => Some(format!("{} {} not told from zero", values(zero), verb(zero))),
        (true, _, _) => {
            let all = values(more + zero);
            Some(format!("{all}, {zero} of which {} not told from zero", verb(zero)))
        }
    }
}

fn effect(effect: &NamedEffect, candidates: &[Candidate]) -> String {
    let (told, zero): (Vec<&FoundParameter>, Vec<&FoundParameter>) =
        effect.parameters.iter().partition(|one| one.is_told());
    let any_told = !told.is_empty();
    let (told, more) = clearest(told);
    let mut parameters: Vec<String> = told.into_iter().filter_map(|one| parameter(one, candidates)).collect();
    parameters.extend(rest(any_told, more, zero.len()));
    let sized = if parameters.is_empty() { String::new() } else { format!(": {}", parameters.join(", ")) };
    let others: Vec<&str> = effect.class.iter().skip(1).map(|member| member.title.as_str()).take(3).collect();
    let beside = beside(&effect.beside);
    let family = if is_family(effect) { " (no single one explains it)" } else { "" };
    let title = format!("{}{family}", capital(&effect.title));
    if let Some(why) = &effect.not_addable {
        return format!("{title}{sized}; {why}.");
    }
    if others.is_empty() {
        return format!("{title}{sized}.{beside}");
    }
    let split =
        effect.split_by.as_ref().map_or(String::new(), |split| format!(" To tell them apart: {split}."));
    format!("{title}{sized}; the data cannot tell it from: {}.{split}{beside}", others.join("; "))
}

/// What a part of an effect may be instead.
fn beside(members: &[ClassMember]) -> String {
    let titles: Vec<&str> = members.iter().map(|member| member.title.as_str()).take(3).collect();
    match titles.is_empty() {
        true => String::new(),
        false => {
            format!(" A part of it may be another effect, which acts alike here: {}.", titles.join("; "))
        }
    }
}

/// A parameter in the units of the lab, as far as its name says its unit.
fn parameter(parameter: &FoundParameter, candidates: &[Candidate]) -> Option<String> {
    let FoundParameter { name, value, low, high, .. } = parameter;
    let unit = parameter_units::of(name)?;
    let (said, [value, low, high]) = parameter_words::directed(name, [*value, *low, *high]);
    let said = by_title(name, said, candidates);
    let [value, low, high] = [value, low, high].map(|si| si * unit.per_si);
    let decimals = number::decimals(high - low);
    let size = parameter_units::with_unit(&fixed(value, decimals), Some(unit));
    let (low, high) = (fixed(low, decimals), fixed(high, decimals));
    Some(format!("{said} {size} ({low} to {high})"))
}

fn fixed(value: f64, decimals: usize) -> String {
    number::fixed(value, decimals).unwrap_or_else(|| "not known".to_owned())
}

fn shrink(finding: &Finding) -> String {
    let shown = &finding.shown;
    if shown.closure.is_none() {
        return format!("The mean error is {}.", size(shown.before, shown.unit));
    }
    falls(finding, shown.after)
}

/// How the error falls on rows that were not used.
fn falls(finding: &Finding, after: f64) -> String {
    let shown = &finding.shown;
    let noise = if finding.comparison.is_noise_known() {
        format!("noise alone leaves {}", size(shown.floor, shown.unit))
    } else {
        "nothing tells how much of that is noise".to_owned()
    };
    format!(
        "With it the error on rows that were not used falls from {} to {}; {noise}.",
        size(shown.before, shown.unit),
        size(after, shown.unit)
    )
}

/// The same of what may be added, and of all that was found beside it.
fn shrink_by_part(finding: &Finding) -> String {
    let shown = &finding.shown;
    let Some(part) = &shown.part else { return shrink(finding) };
    let all = size(shown.after, shown.unit);
    format!(
        "{} All that was found leaves {all}, but the rest of it cannot be added.",
        falls(finding, part.after)
    )
}

fn size(value: f64, unit: ShownUnit) -> String {
    match unit {
        ShownUnit::Meter => format!("{} mm", fixed(value * 1e3, decimals_of_mm(value * 1e3))),
        ShownUnit::Pixel => format!("{} px", fixed(value, 2)),
    }
}

/// Decimals of a length as the window and the tables beside the sentence write it: one result is one number.
fn decimals_of_mm(value: f64) -> usize {
    match value.abs() {
        small if small < 9.995 => 2,
        middle if middle < 99.95 => 1,
        _ => 0,
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// What the rest depends on, the first two: several things may depend on one, which is told once.
fn told_once<'a>(on: impl Iterator<Item = &'a str>) -> Vec<String> {
    let is_clause = |on: &str| on.starts_with("where ") || on.starts_with("how ");
    let article = |on: &str| if is_clause(on) { on.to_owned() } else { format!("the {on}") };
    let mut told: Vec<String> = vec![];
    for on in on.map(|on| article(on.trim_start_matches("the "))) {
        if told.len() < 2 && !told.contains(&on) {
            told.push(on);
        }
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, value: f64, low: f64, high: f64) -> FoundParameter {
        FoundParameter { name: name.to_owned(), value, low, high, text: None }
    }

    #[test]
    fn what_several_things_depend_on_is_told_once() {
        let all = ["time", "time", "where the elbow came from", "angle of the elbow"];
        assert_eq!(told_once(all.into_iter()), ["the time", "where the elbow came from"]);
    }

    #[test]
    fn sizes_are_told_in_the_words_and_units_of_the_lab() {
        let told =
            |name: &str, value: f64, low: f64, high: f64| parameter(&found(name, value, low, high), &[]);
        let said = [
            (told("rot_x_rad", 0.02, 0.018, 0.022), "turned about its x axis by 1.15° (1.03 to 1.26)"),
            (told("amplitude_rad", 0.01, 0.008, 0.012), "moves by up to 0.57° (0.46 to 0.69)"),
            (told("width_rad", 0.01, 0.0, 0.02), "from side to side 0.6° (0.0 to 1.1)"),
            (told("length_m", -4e-3, -5e-3, -3e-3), "shorter by 4.0 mm (3.0 to 5.0)"),
            (told("length_m", 4e-3, 3e-3, 5e-3), "longer by 4.0 mm (3.0 to 5.0)"),
            (told("r_elbow_y_offset_rad", 0.02, 0.018, 0.022), "right elbow y off by 1.15° (1.03 to 1.26)"),
            (told("scale_u", 0.02, 0.01, 0.03), "wider by 2.0 % (1.0 to 3.0)"),
        ];
        for (told, words) in said {
            assert_eq!(told.as_deref(), Some(words));
        }
        // A number without a unit of its own is on the page, not in the sentence.
        assert_eq!(told("order", 2.0, 2.0, 2.0), None);
    }

    #[test]
    fn what_may_be_a_part_of_an_effect_is_told_after_it() {
        let member = |title: &str| ClassMember {
            id: String::new(),
            site: String::new(),
            title: title.to_owned(),
            probability: 0.1,
        };
        assert_eq!(beside(&[]), "");
        let told = beside(&[member("right eye turned sideways"), member("right eye rolled")]);
        assert!(told.ends_with(": right eye turned sideways; right eye rolled."), "{told}");
    }

    #[test]
    fn values_that_are_not_told_one_by_one_are_one_phrase() {
        let said = [
            ((true, 0, 0), None),
            ((false, 0, 1), Some("its size is not told from zero")),
            ((false, 0, 3), Some("none of its 3 values is told from zero")),
            ((true, 1, 0), Some("1 more value")),
            ((true, 0, 1), Some("1 more value is not told from zero")),
            ((true, 0, 2), Some("2 more values are not told from zero")),
            ((true, 1, 1), Some("2 more values, 1 of which is not told from zero")),
            ((true, 2, 3), Some("5 more values, 3 of which are not told from zero")),
        ];
        for ((any_told, more, zero), words) in said {
            assert_eq!(rest(any_told, more, zero).as_deref(), words, "{any_told} {more} {zero}");
        }
    }
}
