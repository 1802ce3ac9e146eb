//! Effects in words: what they are called, how large and how sure they are.

use plumbline_engine::view::{AddedEffect, GapModelView};
use plumbline_model::parameter_words;
use plumbline_widgets::format;

use crate::operator::snapshot::gap::{Candidate, NamedEffect, titles};

/// Parameters whose intervals hold zero, counted beside those that are told.
pub fn not_told(told: usize, not_told: usize) -> Option<String> {
    match (told, not_told) {
        (_, 0) => None,
        (0, 1) => Some("Its size is not told from zero.".to_owned()),
        (0, count) => Some(format!("None of its {count} values is told from zero.")),
        (_, 1) => Some("One more value is not told from zero.".to_owned()),
        (_, count) => Some(format!("{count} more values are not told from zero.")),
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
        Some((whose, _)) => format!("{kind} of {}", parameter_words::the(&titles::inside(whose))),
        None if matches!(site, "" | "screen" | "tip" | "base" | "eyes") => kind,
        None if site == "right" => format!("{kind} of the right eye"),
        None => format!("{kind} of {}", parameter_words::the(&parameter_words::place(site))),
    }
}

/// The same of an `id@site`, by the titles of those that were tried.
pub fn of_name(name: &str, candidates: &[Candidate]) -> String {
    let (id, site) = name.split_once('@').unwrap_or((name, ""));
    let known = candidates.iter().find(|candidate| candidate.id == id && candidate.site == site);
    named(id, site, known.map_or("", |candidate| &candidate.title))
}

/// What people call an effect of a finding, of its `id@site`.
pub fn of_effect(name: &str, effects: &[NamedEffect]) -> String {
    let (id, site) = name.split_once('@').unwrap_or((name, ""));
    let known = effects.iter().find(|effect| effect.id == id && effect.site == site);
    known.map_or_else(|| named(id, site, ""), short)
}

/// What an effect of the model is worth on the table: "small, moves the fingertip by 0.12 mm"; `None`: not known.
pub fn moved(effect: &AddedEffect) -> Option<String> {
    let moved_m = format::mm(effect.moved_m?);
    let what = if effect.is_of_eyes { "moves what the eyes see by" } else { "moves the fingertip by" };
    let small = if effect.is_small() { "small, " } else { "" };
    Some(format!("{small}{what} {moved_m}"))
}

/// What the model in use has, in a sentence.
pub fn in_use(model: &GapModelView) -> String {
    let (named, shares): (Vec<_>, Vec<_>) = model.effects.iter().partition(|effect| effect.is_named);
    let named = named.into_iter().filter(|effect| !effect.is_left_out);
    let mut told: Vec<String> = named.map(|effect| effect.title.clone()).collect();
    if !shares.is_empty() {
        told.push(format!("small shares of {}", plumbline_model::counted(shares.len(), "effect")));
    }
    format!("In use: {}.", told.join("; "))
}

/// What a parameter chooses, in words: a joint, as those that were tried call it, or one of two things.
pub fn choice(text: &str, candidates: &[Candidate]) -> String {
    titles::whose(text, candidates)
}

/// What is said before the value of a parameter; the joint that it belongs to, where one effect stands for every joint,
/// as those that were tried call it: "right elbow bend off by".
pub fn before_value(parameter: &str, candidates: &[Candidate]) -> String {
    titles::by_title(parameter, parameter_words::said(parameter), candidates)
}

/// How much less probable the runner-up is: "200 times less probable".
pub fn odds(margin_log10: f64) -> String {
    let odds = 10f64.powf(margin_log10);
    if !odds.is_finite() || odds > 1e4 {
        return "more than 10 000 times less probable".to_owned();
    }
    if odds < 1.5 {
        return "about as probable".to_owned();
    }
    format!("{} times less probable", format::significant(odds, 2))
}

/// "Runner-up: link length of the right forearm, 200 times less probable."; `None`: there is none.
pub fn runner_up(effect: &NamedEffect, candidates: &[Candidate]) -> Option<String> {
    let (name, margin_log10) = effect.runner_up.as_ref()?;
    Some(format!("Runner-up: {}, {}.", of_name(name, candidates), odds(*margin_log10)))
}

#[cfg(test)]
mod tests {
    use crate::operator::snapshot::gap::{Knowledge, sample};

    use super::*;

    #[test]
    fn effects_are_called_by_kind_and_place() {
        let title = "Right elbow: zero position off";
        assert_eq!(named("joint-zero", "r_elbow_y", title), "joint zero of the right elbow");
        assert_eq!(named("axis-skew", "", "Every joint: axis not square"), "axis skew of every joint");
        assert_eq!(named("axis-skew", "every_joint", ""), "axis skew of every joint", "also without a title");
        assert_eq!(named("screen-tilt", "screen", "screen tilted or shifted"), "screen tilt");
        let title = "right upper arm: wrong length";
        assert_eq!(named("link-length", "right_upper_arm", title), "link length of the right upper arm");
        // Without a title the site is read.
        assert_eq!(named("link-length", "forearm_r", "wrong length"), "link length of the right forearm");
    }

    #[test]
    fn a_joint_among_all_is_called_as_everywhere() {
        let mut of_joint = sample::named().candidates[0].clone();
        (of_joint.site, of_joint.title) =
            ("r_elbow_y".to_owned(), "Right elbow bend: zero position off".to_owned());
        let candidates = [of_joint];
        assert_eq!(before_value("r_elbow_y_offset_rad", &candidates), "right elbow bend off by");
        assert_eq!(
            before_value("r_elbow_y_offset_rad", &[]),
            "right elbow y off by",
            "nobody gave it a title"
        );
        assert_eq!(before_value("offset_rad", &candidates), "off by");
    }

    #[test]
    fn odds_and_the_runner_up_are_said_in_words() {
        assert_eq!(odds(0.05), "about as probable");
        assert_eq!(odds(2.0), "100 times less probable");
        assert!(odds(f64::INFINITY).starts_with("more than"));
        let mut effect = sample::named().effects[0].clone();
        effect.runner_up = Some(("link-length@forearm_r".to_owned(), 2.0));
        assert_eq!(
            runner_up(&effect, &[]).as_deref(),
            Some("Runner-up: link length of the right forearm, 100 times less probable.")
        );
        effect.runner_up = None;
        assert_eq!(runner_up(&effect, &[]), None);
    }

    #[test]
    fn a_choice_is_no_raw_joint() {
        assert_eq!(choice("r_shoulder_y", &[]), "right shoulder y");
        assert_eq!(choice("distance of the eyes", &[]), "distance of the eyes");
        let known = Candidate {
            id: "joint-zero".to_owned(),
            site: "r_shoulder_y".to_owned(),
            title: "Right shoulder turn: zero position off".to_owned(),
            probability: 0.5,
            score_sigmas: 3.0,
            knowledge: Knowledge::Known,
        };
        assert_eq!(choice("r_shoulder_y", &[known]), "right shoulder turn");
    }

    #[test]
    fn values_that_may_be_zero_are_counted() {
        assert_eq!(not_told(3, 0), None);
        assert_eq!(not_told(0, 1).as_deref(), Some("Its size is not told from zero."));
        assert_eq!(not_told(2, 4).as_deref(), Some("4 more values are not told from zero."));
    }

    #[test]
    fn what_an_effect_is_worth_is_said_in_millimeters() {
        let mut effect = AddedEffect {
            name: "finger-roll@tip".to_owned(),
            is_named: true,
            title: "Fingertip: it rolls".to_owned(),
            parameters: vec![],
            is_of_eyes: false,
            is_left_out: false,
            moved_m: Some(1.2e-4),
        };
        assert_eq!(moved(&effect).as_deref(), Some("small, moves the fingertip by 0.12 mm"));
        effect.moved_m = Some(2.5e-3);
        assert_eq!(moved(&effect).as_deref(), Some("moves the fingertip by 2.50 mm"));
        effect.is_of_eyes = true;
        assert_eq!(moved(&effect).as_deref(), Some("moves what the eyes see by 2.50 mm"));
        effect.moved_m = None;
        assert_eq!(moved(&effect), None);
    }
}
