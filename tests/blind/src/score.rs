//! Who found what: verdicts against answers.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::answer::{Answer, Hidden};
use crate::recipe::Family;
use crate::verdict::{Found, Rightness, Verdict, plain, rightness};

/// A name that is stated with more than this is confident.
const CONFIDENT: f64 = 0.8;
/// Bins of stated probabilities.
const BINS: usize = 10;

/// So many of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// So many.
    pub hits: usize,
    /// Of so many.
    pub of: usize,
}

impl Share {
    fn count(&mut self, hit: bool) {
        self.hits += usize::from(hit);
        self.of += 1;
    }

    /// 0–1; `None` of nothing.
    pub fn value(&self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }

    /// 95 % interval (Wilson 1927); the whole range of nothing.
    pub fn interval(&self) -> [f64; 2] {
        if self.of == 0 {
            return [0.0, 1.0];
        }
        let (n, p, z) = (self.of as f64, self.hits as f64 / self.of as f64, 1.959_964);
        let middle = p + z * z / (2.0 * n);
        let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + z * z / n;
        [((middle - half) / scale).max(0.0), ((middle + half) / scale).min(1.0)]
    }
}

/// How often a family's effects were found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Naming {
    /// The class holds the truth.
    pub class: Share,
    /// The name is the truth.
    pub exact: Share,
}

/// The score of a test.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Nothing hidden, and a name given; without and with dirt.
    pub null_named: [Share; 2],
    /// Nothing hidden, and a gap without a name claimed.
    pub null_gap: Share,
    /// Singles by plan and size (sigmas, of [`crate::mix::SIZES`]).
    pub singles: BTreeMap<(String, String), Naming>,
    /// Singles of 1 sigma and more, by plan.
    pub singles_visible: BTreeMap<String, Naming>,
    /// The same by kind of effect.
    pub singles_by_kind: BTreeMap<String, Naming>,
    /// Pairs and triples, by plan: all classes found.
    pub several: BTreeMap<(String, String), Naming>,
    /// Those of them in which each effect has 1 sigma and more.
    pub several_visible: BTreeMap<(String, String), Naming>,
    /// Nameless effects that were said to be so, by plan.
    pub nameless: BTreeMap<String, Share>,
    /// The same by kind.
    pub nameless_by_kind: BTreeMap<String, Share>,
    /// Nameless effects to which a confident name was given.
    pub nameless_named: Share,
    /// Robots that are a little off everywhere: that this is so, or that something has no name, was said …
    pub crowd_said: Share,
    /// … a few sure names were said to be all …
    pub crowd_named: Share,
    /// … and a confident name was given to what is not there.
    pub crowd_wrong: Share,
    /// Named effects in all cases that are neither hidden nor dirt.
    pub wrong_names: Share,
    /// The same, of those stated with more than 0.8.
    pub wrong_confident: Share,
    /// Relative errors of parameters of rightly named singles of 2 sigma.
    pub parameter_errors: Vec<f64>,
    /// 95 % intervals of rightly named effects of 1 sigma and more that hold the truth.
    pub coverage: Share,
    /// Closures of cases with named effects of 1 sigma and more.
    pub closures: Vec<f64>,
    /// Per bin of stated probability: sum of the stated, names, right names.
    pub stated: [(f64, usize, usize); BINS],
    /// Per bin, sum of p (1 − p): the variance of the number of right names, were the stated ones right.
    pub stated_variance: [f64; BINS],
    /// Seconds per case.
    pub seconds: Vec<f64>,
    /// Cases.
    pub cases: usize,
    /// Cases without a verdict, and why.
    pub failed: Vec<(usize, String)>,
}

impl Score {
    /// Counts a case.
    pub fn count(&mut self, answer: &Answer, verdict: &Verdict) {
        self.cases += 1;
        self.seconds.extend(verdict.seconds);
        // A crowd has rows of its own: what is asked of it is not which name is right.
        if answer.family != Family::Crowd {
            self.count_names(answer, verdict);
        }
        let plan = crate::words::word(answer.design);
        match answer.family {
            Family::Null => {
                let also = |found: &Found| answer.also.iter().any(|name| plain(name) == found.name());
                let false_names = verdict.names() && !verdict.effects.iter().all(also);
                self.null_named[usize::from(!answer.dirt.is_empty())].count(false_names);
                self.null_gap.count(verdict.verdict == "not-in-library");
            }
            Family::Single => self.count_single(answer, verdict, &plan),
            Family::Pair | Family::Triple => {
                let key = (crate::words::word(answer.family), plan);
                if answer.hidden.iter().all(|hidden| hidden.size_sigmas >= VISIBLE) {
                    self.several_visible.entry(key.clone()).or_default().count(&answer.hidden, verdict);
                }
                self.several.entry(key).or_default().count(&answer.hidden, verdict);
                self.closures.extend(verdict.closure());
            }
            Family::Crowd => {
                let is_not_all = verdict.many.is_some() || verdict.verdict == "not-in-library";
                self.crowd_said.count(is_not_all);
                self.crowd_named.count(verdict.verdict == "named");
                let right = rightness(answer, verdict);
                let mut names = verdict.effects.iter().zip(right);
                self.crowd_wrong
                    .count(names.any(|(found, right)| found.probability > CONFIDENT && !right.is_among));
            }
            Family::OffLibrary => {
                let said = verdict.verdict == "not-in-library";
                self.nameless.entry(plan).or_default().count(said);
                for hidden in &answer.hidden {
                    self.nameless_by_kind.entry(hidden.id.clone()).or_default().count(said);
                }
                let wrong = verdict.effects.iter().any(|found| {
                    found.probability > CONFIDENT
                        && !answer.dirt.iter().chain(&answer.also).any(|there| found.may_be(&plain(there)))
                });
                self.nameless_named.count(wrong);
            }
        }
        let sized = answer.hidden.iter().filter(|_| answer.family != Family::Crowd);
        for hidden in sized.filter(|hidden| hidden.size_sigmas >= VISIBLE) {
            self.count_parameters(answer.family, hidden, verdict);
        }
    }

    /// A case that got no verdict counts as not found.
    pub fn count_failure(&mut self, answer: &Answer, why: &str) {
        let none = Verdict {
            verdict: "failed".to_owned(),
            effects: vec![],
            many: None,
            held_out: BTreeMap::new(),
            seconds: None,
        };
        self.count(answer, &none);
        self.failed.push((answer.case, why.to_owned()));
    }

    fn count_single(&mut self, answer: &Answer, verdict: &Verdict, plan: &str) {
        let Some(size) = answer.hidden.first().map(|hidden| hidden.size_sigmas) else { return };
        let key = (plan.to_owned(), crate::words::nearest_size(size));
        self.singles.entry(key).or_default().count(&answer.hidden, verdict);
        if size >= VISIBLE {
            self.singles_visible.entry(plan.to_owned()).or_default().count(&answer.hidden, verdict);
            let kind = answer.hidden[0].id.clone();
            self.singles_by_kind.entry(kind).or_default().count(&answer.hidden, verdict);
            self.closures.extend(verdict.closure());
        }
    }

    fn count_names(&mut self, answer: &Answer, verdict: &Verdict) {
        if !verdict.names() {
            return;
        }
        for (found, Rightness { is_exact, is_among }) in
            verdict.effects.iter().zip(rightness(answer, verdict))
        {
            self.wrong_names.count(!is_among);
            if found.probability > CONFIDENT {
                self.wrong_confident.count(!is_among);
            }
            let bin = ((found.probability * BINS as f64) as usize).min(BINS - 1);
            let (sum, names, right) = &mut self.stated[bin];
            *sum += found.probability;
            *names += 1;
            *right += usize::from(is_exact);
            self.stated_variance[bin] += found.probability * (1.0 - found.probability);
        }
    }

    fn count_parameters(&mut self, family: Family, hidden: &Hidden, verdict: &Verdict) {
        let name = plain(&hidden.named());
        let Some(found) = verdict.effects.iter().find(|found| found.name() == name) else { return };
        if !verdict.names() {
            return;
        }
        let (mut error, mut whole) = (0.0, 0.0);
        for (key, truth) in &hidden.parameters {
            let Some(stated) = found.parameters.get(key) else { continue };
            let number = |name: &str| stated.get(name).and_then(Value::as_f64);
            let (Some(value), Some(low), Some(high)) = (number("value"), number("low"), number("high"))
            else {
                continue;
            };
            // Which way play is counted is a matter of taste; how wide it is, is not.
            let width = matches!(key.as_str(), "width_rad" | "width_m");
            let [mut value, mut low, mut high, mut truth] = [value, low, high, *truth];
            if width {
                if value < 0.0 {
                    [value, low, high] = [-value, -high, -low];
                }
                truth = truth.abs();
            }
            if key == "phase_rad" {
                // The turn of the wave, not the number of whole turns.
                let turns = ((value - truth) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
                [value, low, high] = [value - turns, low - turns, high - turns];
            }
            self.coverage.count(low <= truth && truth <= high);
            if key != "phase_rad" {
                error += (value - truth).powi(2);
                whole += truth * truth;
            }
        }
        let of_two_sigma = (1.5..3.0).contains(&hidden.size_sigmas);
        if family == Family::Single && of_two_sigma && whole > 0.0 {
            self.parameter_errors.push((error / whole).sqrt());
        }
    }

    /// How far stated probabilities are off, names weighed alike (expected calibration error);
    /// `None` without names.
    pub fn calibration_error(&self) -> Option<f64> {
        let names: usize = self.stated.iter().map(|(_, names, _)| names).sum();
        let off: f64 = self.stated.iter().map(|(sum, _, right)| (sum - *right as f64).abs()).sum();
        (names > 0).then(|| off / names as f64)
    }

    /// What [`Self::calibration_error`] would be on average, were every stated probability right: few names in
    /// a bin are off by chance (each bin's count taken as normal).
    pub fn calibration_error_by_chance(&self) -> Option<f64> {
        let names: usize = self.stated.iter().map(|(_, names, _)| names).sum();
        let usual = self.stated_variance.iter().map(|variance| variance.sqrt()).sum::<f64>();
        (names > 0).then(|| (2.0 / std::f64::consts::PI).sqrt() * usual / names as f64)
    }
}

/// From this size on an effect is expected to be found, sigmas. Sizes are made to a tenth.
pub(crate) const VISIBLE: f64 = 0.89;

impl Naming {
    fn count(&mut self, hidden: &[Hidden], verdict: &Verdict) {
        let names: Vec<String> = hidden.iter().map(|hidden| plain(&hidden.named())).collect();
        let found = |right: &dyn Fn(&Found, &str) -> bool| {
            verdict.names() && names.iter().all(|name| verdict.effects.iter().any(|found| right(found, name)))
        };
        // What is only told to be, perhaps, beside a name (`beside`) is not found.
        self.class.count(found(&|found, name| found.may_be(name)));
        self.exact.count(found(&|found, name| found.name() == name));
    }
}

/// The middle one; `None` of nothing.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    (n > 0).then(|| 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::{Plan, Source};
    use serde_json::json;

    fn answer(family: Family, hidden: &[(&str, &str, f64)], dirt: &[&str]) -> Answer {
        let hidden = hidden.iter().map(|(id, site, size_sigmas)| Hidden {
            id: (*id).to_owned(),
            site: (*site).to_owned(),
            parameters: BTreeMap::from([("offset_rad".to_owned(), 0.02)]),
            size_sigmas: *size_sigmas,
        });
        Answer {
            case: 0,
            seed: 0,
            family,
            generator: Source::Lean,
            design: Plan::Rich,
            hidden: hidden.collect(),
            also: vec![],
            dirt: dirt.iter().map(|name| (*name).to_owned()).collect(),
            sigma: vec![1e-3; 3],
            rows: 300,
            cells: 100,
        }
    }

    fn verdict(word: &str, effects: &[(&str, &str, f64, &[&str])]) -> Verdict {
        let effects: Vec<Value> = effects
            .iter()
            .map(|(id, site, probability, class)| {
                json!({
                    "id": id, "site": site, "probability": probability, "class": class, "split_by": null,
                    "parameters": {"offset_rad": {"value": 0.022, "low": 0.018, "high": 0.025}},
                })
            })
            .collect();
        let text = json!({"verdict": word, "effects": effects, "held_out": {"closure": 0.9}, "seconds": 1.5});
        serde_json::from_value(text).expect("the contract")
    }

    #[test]
    fn the_right_name_is_right_and_its_numbers_are_compared() {
        let mut score = Score::default();
        let truth = answer(Family::Single, &[("joint-zero", "r_elbow_y", 2.0)], &[]);
        score.count(
            &truth,
            &verdict("named", &[("joint-zero", "r_elbow_y", 0.95, &["joint-zero@r_elbow_y"])]),
        );
        let naming = score.singles_visible["rich"];
        assert_eq!((naming.class.hits, naming.exact.hits), (1, 1));
        assert!((score.parameter_errors[0] - 0.1).abs() < 1e-9);
        assert_eq!((score.coverage.hits, score.wrong_names.hits), (1, 0));
        assert_eq!(score.closures, [0.9]);
    }

    #[test]
    fn a_class_that_holds_the_truth_is_right_but_not_exact() {
        let mut score = Score::default();
        let truth = answer(Family::Single, &[("joint-zero", "r_elbow_y", 2.0)], &[]);
        let class: &[&str] = &["tip-offset@tip", "joint-zero@r_elbow_y"];
        score.count(&truth, &verdict("class", &[("tip-offset", "tip", 0.6, class)]));
        let naming = score.singles_visible["rich"];
        assert_eq!((naming.class.hits, naming.exact.hits), (1, 0));
        assert_eq!((score.coverage.of, score.wrong_names.hits), (0, 0));
    }

    #[test]
    fn a_right_name_under_a_verdict_that_takes_it_back_does_not_count() {
        let mut score = Score::default();
        let truth = answer(Family::Single, &[("joint-zero", "r_elbow_y", 2.0)], &[]);
        score.count(&truth, &verdict("not-in-library", &[("joint-zero", "r_elbow_y", 0.5, &[])]));
        score.count(&truth, &verdict("no-gap", &[]));
        score.count_failure(&truth, "too few");
        let naming = score.singles_visible["rich"];
        assert_eq!((naming.class.hits, naming.class.of), (0, 3));
        assert_eq!(score.failed.len(), 1);
    }

    #[test]
    fn a_name_where_nothing_is_hidden_is_a_false_alarm_even_if_it_is_dirt() {
        let mut score = Score::default();
        let truth = answer(Family::Null, &[], &["joint-sag@r_arm_x"]);
        score.count(&truth, &verdict("named", &[("joint-sag", "r_arm_x", 0.9, &[])]));
        score.count(&truth, &verdict("no-gap", &[]));
        assert_eq!(score.null_named[1], Share { hits: 1, of: 2 });
        assert_eq!(score.wrong_names.hits, 0, "it is really there");
    }

    #[test]
    fn all_of_several_must_be_found() {
        let mut score = Score::default();
        let truth =
            answer(Family::Pair, &[("joint-zero", "r_elbow_y", 2.0), ("finger-roll", "tip", 2.0)], &[]);
        score.count(&truth, &verdict("named", &[("joint-zero", "r_elbow_y", 0.9, &[])]));
        let both: &[(&str, &str, f64, &[&str])] =
            &[("joint-zero", "r_elbow_y", 0.9, &[]), ("finger-roll", "tip", 0.9, &[])];
        score.count(&truth, &verdict("named", both));
        assert_eq!(score.several.values().next().expect("pairs").class, Share { hits: 1, of: 2 });
    }

    #[test]
    fn what_is_told_beside_a_name_is_not_found_by_it() {
        let truth = answer(Family::Pair, &[("image-shift", "right", 2.0), ("eye-yaw", "right", 2.0)], &[]);
        let mut verdict = verdict("named", &[("image-shift", "right", 0.9, &[])]);
        verdict.effects[0].beside = vec!["eye-yaw@right".to_owned()];
        let mut score = Score::default();
        score.count(&truth, &verdict);
        assert_eq!(score.several.values().next().expect("pairs").class, Share { hits: 0, of: 1 });
    }

    #[test]
    fn a_confident_name_for_what_has_none_is_counted_under_any_verdict() {
        let mut score = Score::default();
        let truth = answer(Family::OffLibrary, &[("(magnet)", "r_arm_x", 3.0)], &[]);
        score.count(&truth, &verdict("not-in-library", &[("joint-zero", "r_arm_x", 0.4, &[])]));
        score.count(&truth, &verdict("named", &[("joint-zero", "r_arm_x", 0.9, &[])]));
        assert_eq!(score.nameless["rich"], Share { hits: 1, of: 2 });
        assert_eq!(score.nameless_named, Share { hits: 1, of: 2 });
    }

    #[test]
    fn an_effect_of_no_site_is_found_with_or_without_the_sign() {
        let mut score = Score::default();
        let truth = answer(Family::Single, &[("early-log", "", 5.0)], &[]);
        score.count(&truth, &verdict("named", &[("early-log", "", 0.9, &["early-log"])]));
        score.count(&truth, &verdict("class", &[("joint-zero", "x", 0.9, &["joint-zero@x", "early-log@"])]));
        assert_eq!(score.singles_visible["rich"].class.hits, 2);
    }

    #[test]
    fn probabilities_that_are_kept_are_not_off_and_boasts_are() {
        let truth = answer(Family::Single, &[("joint-zero", "r_elbow_y", 2.0)], &[]);
        let right: &[(&str, &str, f64, &[&str])] = &[("joint-zero", "r_elbow_y", 0.75, &[])];
        let wrong: &[(&str, &str, f64, &[&str])] = &[("joint-zero", "r_arm_x", 0.75, &[])];
        let mut honest = Score::default();
        for effects in [right, right, right, wrong] {
            honest.count(&truth, &verdict("named", effects));
        }
        assert!(honest.calibration_error().expect("names") < 1e-9);
        let mut boast = Score::default();
        boast.count(&truth, &verdict("named", wrong));
        assert!((boast.calibration_error().expect("names") - 0.75).abs() < 1e-9);
        assert!(Score::default().calibration_error().is_none());
        // A thousand names at 0.75, three quarters of them right, and what chance does to as many.
        let mut many = Score::default();
        for k in 0..1000 {
            let effects = if k % 4 == 0 { wrong } else { right };
            many.count(&truth, &verdict("named", effects));
        }
        let by_chance = many.calibration_error_by_chance().expect("names");
        assert!((by_chance - 0.0109).abs() < 1e-4, "{by_chance}");
    }

    #[test]
    fn a_trace_makes_no_name_right_that_stands_for_what_is_hidden() {
        let truth = answer(Family::Single, &[("eye-yaw", "right", 2.0)], &["image-shift@right"]);
        let class: &[&str] = &["image-shift@right", "eye-yaw@right"];
        let right = |effects: &[(&str, &str, f64, &[&str])]| {
            let mut score = Score::default();
            score.count(&truth, &verdict("class", effects));
            score.stated.iter().map(|(_, _, right)| right).sum::<usize>()
        };
        assert_eq!(right(&[("image-shift", "right", 0.6, class)]), 0);
        assert_eq!(right(&[("image-shift", "right", 0.6, &["image-shift@right"])]), 1, "a trace of its own");
        assert_eq!(right(&[("eye-yaw", "right", 0.9, &[]), ("image-shift", "right", 0.6, class)]), 2, "both");
    }

    #[test]
    fn pairs_with_an_effect_that_is_hardly_there_count_and_stand_apart() {
        let mut score = Score::default();
        for size_sigmas in [2.0, 0.5] {
            let hidden = [("joint-zero", "r_elbow_y", 2.0), ("link-length", "right_wrist", size_sigmas)];
            let found: &[(&str, &str, f64, &[&str])] = &[("joint-zero", "r_elbow_y", 0.9, &[])];
            score.count(&answer(Family::Pair, &hidden, &[]), &verdict("named", found));
        }
        let of = |several: &BTreeMap<(String, String), Naming>| {
            several.values().map(|one| one.class.of).sum::<usize>()
        };
        assert_eq!((of(&score.several), of(&score.several_visible)), (2, 1));
        assert!(crate::table::markdown(&score).contains("– of those with ≥ 1 σ each: pair"));
    }

    #[test]
    fn intervals_are_those_of_wilson() {
        let [low, high] = Share { hits: 0, of: 24 }.interval();
        assert!(low == 0.0 && (high - 0.138).abs() < 2e-3, "{high}");
        let [low, high] = Share { hits: 81, of: 263 }.interval();
        assert!((low - 0.2553).abs() < 1e-3 && (high - 0.3662).abs() < 1e-3, "{low} {high}");
        assert_eq!(Share::default().interval(), [0.0, 1.0]);
    }

    #[test]
    fn the_table_names_what_is_wanted() {
        let mut score = Score::default();
        let truth = answer(Family::Single, &[("joint-zero", "r_elbow_y", 2.0)], &[]);
        score.count(&truth, &verdict("named", &[("joint-zero", "r_elbow_y", 0.95, &[])]));
        let text = crate::table::markdown(&score);
        assert!(text.contains("| one effect ≥ 1 σ, rich: exact | ≥ 85 % | 100 % (1 of 1) |"), "{text}");
    }
}
