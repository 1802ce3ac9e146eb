//! The gap in words: verdicts, units, names of effects.

use plumbline_engine::View;
use plumbline_widgets::format::{self, Quantity};

use super::effect::{of_name, short};
use crate::operator::snapshot::gap::{
    Candidate, CoordinateComparison, Experiment, Finding, Knowledge, Shown, ShownUnit, Unit, Verdict, What,
};

/// Less of a gap than this is said to be none.
const LEAST_SHARE: f64 = 0.01;

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

/// The answer of a finding as a heading: where nothing tells the noise, what has no name is no agreement.
pub fn heading(finding: &Finding) -> &'static str {
    match finding.verdict {
        Verdict::NoGap if !finding.is_all_clear() => "Not told from noise",
        Verdict::Class if finding.many.is_some() => "Much is a little off at once",
        of => verdict(of),
    }
}

/// Whether something outside of the names that were found may be at work: they are less sure than the names of the
/// library are among themselves.
pub fn is_unsure(finding: &Finding) -> bool {
    finding.verdict == Verdict::NotInLibrary || finding.many.is_some()
}

/// Whether there is a gap, in a sentence.
pub fn is_there_a_gap(finding: &Finding) -> &'static str {
    let comparison = &finding.comparison;
    match (comparison.is_noise_known(), comparison.is_gap) {
        (false, _) if finding.verdict == Verdict::NoGap => {
            "That cannot be told: the noise is not known, and nothing in the library explains what is left. A few repeats of one pose would tell."
        }
        (false, _) => {
            "The noise is not known: what the best model leaves was taken for it. A few repeats of one pose would tell how large it is."
        }
        (true, true) => "Yes: model and measurement differ by more than the noise.",
        (true, false) => "No: model and measurement agree within the noise.",
    }
}

/// What stays beside the names: whether it is what noise leaves, and a sentence.
pub fn rest(finding: &Finding) -> (bool, String) {
    let (left, shown) = (&finding.unexplained, &finding.shown);
    if !finding.comparison.is_noise_known() {
        let said = "Whether the rest is noise cannot be told: too little was measured twice.";
        return (false, said.to_owned());
    }
    if !finding.effects.is_empty() && !shown.is_near_noise() {
        let [after, noise] = [shown.after, shown.floor].map(|value| error(shown, value));
        let said = format!("Rows that were not used stay off by {after}; noise alone would leave {noise}.");
        return (false, said);
    }
    if left.p_value > 0.05 && finding.verdict != Verdict::NotInLibrary {
        return (true, "The rest is what noise alone would leave.".to_owned());
    }
    if left.share < LEAST_SHARE {
        let said = "What stays is no larger than the noise, but it is not spread like noise.";
        return (false, said.to_owned());
    }
    let share = format::percent(left.share);
    (false, format!("{share} of the gap stays, and noise alone does not explain it."))
}

/// What the data say about one of the candidates: a word, and what it means.
pub fn knowledge(knowledge: &Knowledge, candidates: &[Candidate]) -> (&'static str, String) {
    match knowledge {
        Knowledge::Dead => ("dead", "It would do nothing to these rows.".to_owned()),
        Knowledge::Flat => ("flat", "It would do less than the noise.".to_owned()),
        Knowledge::TradeOff(with) => {
            let with: Vec<String> = with.iter().map(|name| of_name(name, candidates)).collect();
            let with = with.join(", ");
            ("trade-off", format!("Seen only together with {with}: they can trade against each other."))
        }
        Knowledge::NotPinned => {
            ("not pinned", "Its size is hardly better known after than before.".to_owned())
        }
        Knowledge::AtBound => ("at bound", "Its fit sits at the end of what is plausible.".to_owned()),
        Knowledge::Known => ("known", "Its size is known.".to_owned()),
    }
}

/// "On held-out rows 92 % of the gap is closed.", or from what to what the error falls, where nothing tells the noise.
pub fn on_held_out(finding: &Finding, on: &str) -> Option<String> {
    let shown = &finding.shown;
    shown.closure?;
    Some(match finding.told_closure() {
        Some(closure) => format!("{on} {} of the gap is closed.", format::percent(closure)),
        None => format!(
            "{on} the error falls from {} to {}.",
            error(shown, shown.before),
            error(shown, shown.after)
        ),
    })
}

/// What stands for the noise in a picture of a finding.
pub fn floor_name(finding: &Finding) -> &'static str {
    if finding.comparison.is_noise_known() { "noise alone" } else { "the best model leaves" }
}

/// "92 % of the gap is closed (95 % interval: 85 to 97 %)."
pub fn closure(finding: &Finding) -> Option<String> {
    let shown = &finding.shown;
    let Some(closure) = finding.told_closure() else {
        return on_held_out(finding, "On rows that were not used");
    };
    let range = shown.closure_range.map_or_else(String::new, |[low, high]| {
        let low = format::percent(low);
        format!(" (95 % interval: {} to {})", low.trim_end_matches(" %"), format::percent(high))
    });
    Some(format!("{} of the gap is closed{range}.", format::percent(closure)))
}

/// Whether the answer can be trusted, a sentence per reason.
pub fn trust(finding: &Finding) -> Vec<String> {
    let comparison = &finding.comparison;
    let mut said = vec![];
    // Against a noise that was fitted to the same rows no probability says anything.
    if comparison.is_noise_known() {
        let p = if comparison.p_value < 1e-4 {
            "less than 0.0001".to_owned()
        } else {
            format::significant(comparison.p_value, 2)
        };
        said.push(format!(
            "What the model leaves is {} noise deviations beyond the noise; by noise alone so much comes with a probability of {p}.",
            format::significant(comparison.size_sigmas, 2),
        ));
    }
    said.push(comparison.floor_from().sentence().to_owned());
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
    use crate::operator::snapshot::gap::sample;

    use super::*;

    #[test]
    fn what_trades_against_a_candidate_is_called_by_its_title() {
        let candidate = Candidate {
            id: "joint-zero".to_owned(),
            site: "r_elbow_y".to_owned(),
            title: "Right elbow: zero position off".to_owned(),
            probability: 0.5,
            score_sigmas: 3.0,
            knowledge: Knowledge::Known,
        };
        let with =
            ["joint-zero@r_elbow_y", "axis-skew@l_wrist_x", "tip-offset@tip"].map(str::to_owned).to_vec();
        let (_, said) = knowledge(&Knowledge::TradeOff(with), &[candidate]);
        assert!(
            said.contains("joint zero of the right elbow, axis skew of the left wrist x, tip offset:"),
            "{said}"
        );
        assert!(!said.contains('@') && !said.contains('_'), "{said}");
    }

    /// A finding without a name, whose noise nothing told.
    fn without_noise() -> Finding {
        let mut finding = sample::no_gap();
        finding.comparison.floor_from_repeats = false;
        finding.comparison.floor_source = serde_json::from_str("\"fitted\"").expect("a source");
        finding.comparison.is_gap = true;
        finding
    }

    #[test]
    fn without_a_known_noise_nothing_is_said_to_agree_or_to_be_a_gap() {
        let finding = without_noise();
        assert!(!finding.is_all_clear() && sample::no_gap().is_all_clear());
        assert_ne!(heading(&finding), heading(&sample::no_gap()));
        let said = [is_there_a_gap(&finding).to_owned(), trust(&finding).join(" ")].join(" ");
        assert!(said.contains("noise is not known") && said.contains("A few repeats of one pose"), "{said}");
        for wrong in ["Yes", "No:", "agree", "neighbors", "probability"] {
            assert!(!said.contains(wrong), "{wrong}: {said}");
        }
    }

    #[test]
    fn what_tells_the_noise_is_called_by_its_name() {
        let mut finding = without_noise();
        for (source, words) in
            [("instrument", "the instrument's own figure"), ("neighbors", "near neighbors")]
        {
            finding.comparison.floor_source = serde_json::from_str(&format!("{source:?}")).expect("a source");
            let said = trust(&finding).join(" ");
            assert!(said.contains(words), "{said}");
            assert_eq!(said.contains("neighbors"), source == "neighbors", "{said}");
        }
        assert!(trust(&sample::named()).join(" ").contains("spread of repeats"));
    }

    #[test]
    fn the_rest_is_noise_only_where_held_out_rows_say_so_too() {
        let mut finding = sample::named();
        assert_eq!(rest(&finding), (true, "The rest is what noise alone would leave.".to_owned()));
        finding.shown.after = 2.6 * finding.shown.floor;
        let (is_noise, said) = rest(&finding);
        assert!(!is_noise && said.contains("7.75 mm") && said.contains("2.98 mm"), "{said}");
    }

    #[test]
    fn where_nothing_tells_the_noise_no_share_of_the_gap_is_said_to_close() {
        let known = sample::named();
        let mut unknown = known.clone();
        unknown.comparison.floor_from_repeats = false;
        unknown.comparison.floor_source = without_noise().comparison.floor_source;
        for (finding, is_known) in [(known, true), (unknown, false)] {
            let said = [closure(&finding), on_held_out(&finding, "On held-out rows")]
                .map(|said| said.expect("judged"));
            for said in said {
                assert_eq!(said.contains('%') && said.contains("of the gap"), is_known, "{said}");
                assert_eq!(said.contains("falls from"), !is_known, "{said}");
            }
            assert_eq!(floor_name(&finding) == "noise alone", is_known);
        }
    }

    #[test]
    fn no_share_of_nothing_is_left_unexplained() {
        let mut finding = sample::named();
        finding.unexplained.p_value = 1e-6;
        for share in [0.0, 0.004, 0.0099] {
            finding.unexplained.share = share;
            let (is_noise, said) = rest(&finding);
            assert!(!is_noise && !said.contains('%') && said.contains("not spread like noise"), "{said}");
        }
        finding.unexplained.share = 0.16;
        assert!(rest(&finding).1.contains("of the gap stays, and noise alone does not explain it"));
    }
}
