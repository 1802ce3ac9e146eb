//! How right an answer is.

use std::fmt;

use plumbline_effects::Effect;

use crate::finding::Verdict;
use crate::search::Found;

/// One case judged.
#[derive(Clone, Debug)]
pub struct Score {
    truths: usize,
    /// Truths that are in some class.
    in_class: usize,
    /// Truths that are named.
    exact: usize,
    named: usize,
    /// Named effects none of whose class is true.
    wrong: usize,
    confident_wrong: usize,
    not_in_library: bool,
    /// Stated probability and whether it was right: names, then classes.
    stated: Vec<(f64, bool)>,
    stated_class: Vec<(f64, bool)>,
    class_sizes: Vec<usize>,
    seconds: f64,
}

impl Score {
    pub fn of(answer: &[Effect], found: &Found, seconds: f64) -> Self {
        let names: Vec<String> = answer.iter().map(Effect::name).collect();
        let name =
            |id: &str, site: &str| if site.is_empty() { id.to_owned() } else { format!("{id}@{site}") };
        let classes: Vec<Vec<String>> = found
            .effects
            .iter()
            .map(|effect| effect.class.iter().map(|member| name(&member.id, &member.site)).collect())
            .collect();
        let named: Vec<String> = found.effects.iter().map(|effect| name(&effect.id, &effect.site)).collect();
        let right = |class: &Vec<String>| class.iter().any(|name| names.contains(name));
        let out = found.verdict == Verdict::NotInLibrary;
        Self {
            truths: names.len(),
            in_class: names.iter().filter(|name| classes.iter().any(|class| class.contains(name))).count(),
            exact: names.iter().filter(|name| named.contains(name)).count(),
            named: named.len(),
            wrong: classes.iter().filter(|class| !right(class)).count(),
            confident_wrong: found
                .effects
                .iter()
                .zip(&named)
                .filter(|(effect, name)| !out && effect.probability > 0.8 && !names.contains(name))
                .count(),
            not_in_library: out,
            stated: found
                .effects
                .iter()
                .zip(&named)
                .filter(|_| !out)
                .map(|(effect, name)| (effect.probability, names.contains(name)))
                .collect(),
            stated_class: found
                .effects
                .iter()
                .zip(&classes)
                .filter(|_| !out)
                .map(|(effect, class)| (effect.class_probability, right(class)))
                .collect(),
            class_sizes: classes.iter().map(Vec::len).collect(),
            seconds,
        }
    }

    pub fn line(&self, answer: &[Effect], found: &Found) -> String {
        let truths: Vec<String> = answer.iter().map(Effect::name).collect();
        let named: Vec<String> = found
            .effects
            .iter()
            .map(|effect| {
                format!(
                    "{}@{} p{:.2}/{:.2} {:.1}s c{}",
                    effect.id,
                    effect.site,
                    effect.probability,
                    effect.class_probability,
                    effect.size_sigmas,
                    effect.class.len()
                )
            })
            .collect();
        format!(
            "{truths:?} -> {:?} {named:?} unknown {:.2} p {:.1e} {:.2}s",
            found.verdict, found.unexplained.probability, found.unexplained.p_value, self.seconds
        )
    }
}

/// Many cases.
#[derive(Default)]
pub struct Tally {
    scores: Vec<Score>,
}

impl Tally {
    pub fn add(&mut self, score: &Score) {
        self.scores.push(score.clone());
    }

    pub fn merge(&mut self, scores: &[Score]) {
        self.scores.extend_from_slice(scores);
    }

    fn share(&self, what: impl Fn(&Score) -> bool) -> f64 {
        100.0 * self.scores.iter().filter(|score| what(score)).count() as f64
            / self.scores.len().max(1) as f64
    }

    /// Expected calibration error and a table, of names and of classes.
    pub fn calibration(&self) -> String {
        let names: Vec<(f64, bool)> = self.scores.iter().flat_map(|score| score.stated.clone()).collect();
        let classes: Vec<(f64, bool)> =
            self.scores.iter().flat_map(|score| score.stated_class.clone()).collect();
        format!("names: {}\nclasses: {}", reliability(&names), reliability(&classes))
    }
}

fn reliability(stated: &[(f64, bool)]) -> String {
    let mut text = String::new();
    let mut error = 0.0;
    for bin in 0..10 {
        let inside: Vec<&(f64, bool)> =
            stated.iter().filter(|(p, _)| ((p * 10.0) as usize).min(9) == bin).collect();
        if inside.is_empty() {
            continue;
        }
        let count = inside.len() as f64;
        let said = inside.iter().map(|(p, _)| p).sum::<f64>() / count;
        let was = inside.iter().filter(|(_, right)| *right).count() as f64 / count;
        error += (said - was).abs() * count / stated.len() as f64;
        text += &format!(" {said:.2}:{was:.2}({count})");
    }
    format!("ECE {error:.3}{text}")
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.scores.len();
        let sizes: Vec<usize> = self.scores.iter().flat_map(|score| score.class_sizes.clone()).collect();
        write!(
            f,
            "n {count:3} class {:3.0} exact {:3.0} nothing {:3.0} any {:3.0} wrong {:3.0} confident-wrong {:3.0} unknown {:3.0} class-size {:.1} {:.2}s",
            self.share(|score| score.in_class == score.truths),
            self.share(|score| score.exact == score.truths),
            self.share(|score| score.named == 0 && !score.not_in_library),
            self.share(|score| score.named > 0 && !score.not_in_library),
            self.share(|score| score.wrong > 0 && !score.not_in_library),
            self.share(|score| score.confident_wrong > 0),
            self.share(|score| score.not_in_library),
            sizes.iter().sum::<usize>() as f64 / sizes.len().max(1) as f64,
            self.scores.iter().map(|score| score.seconds).sum::<f64>() / count.max(1) as f64,
        )
    }
}
