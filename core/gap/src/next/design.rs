//! What an experiment would tell.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use plumbline_effects::measurements::{Measurements, Observation};
use plumbline_effects::{Assumed, Tangents};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::menu::Trial;
use super::rival::{FRAME_SD, Rival, right};
use crate::floor::Floor;
use crate::search::Found;

/// Simulated outcomes.
const OUTCOMES: usize = 200;
/// Names that are less probable than this may be left out of a set that is as probable without.
const IN_QUESTION: f64 = 0.2;

/// What an experiment would tell.
#[derive(Clone, Debug)]
pub(super) struct Score {
    /// How far rivals' predictions lie apart: Σ Pᵢ Pⱼ ½ (fᵢ−fⱼ)ᵀ[(S+Vᵢ)⁻¹+(S+Vⱼ)⁻¹](fᵢ−fⱼ).
    pub separation: f64,
    /// The pair that adds most to it.
    pub pair: Option<(usize, usize)>,
    /// Expected probability of the right names after it.
    pub expected: f64,
    /// How likely the most probable names are the right ones after it ([`in_question`]). More than `expected` where it
    /// stays open: of two sets that are left with 0.8 and 0.2 the right one has 0.68 in the mean, and is the first in 0.8.
    pub promised: f64,
    /// What it tells of the sizes of the most probable set: ½ log det, nat.
    pub information: f64,
    /// Standard deviations of those sizes after it over those before, geometric mean.
    pub doubt_left: f64,
}

/// Predictions of one rival for the rows to come, in standard deviations of the noise.
struct Predicted {
    mean: DVector<f64>,
    /// Root of the covariance of an outcome.
    root: Cholesky<f64, Dyn>,
    log_det: f64,
}

/// Scores an experiment; `None` when it cannot be predicted.
pub(super) fn score(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    rivals: &[Rival],
    trial: &Trial,
    seed: u64,
) -> Option<Score> {
    let (scene, rows) = scene(measurements, trial);
    let tangents: Vec<Vec<Option<Tangents>>> = rivals
        .iter()
        .map(|rival| {
            let (assumed, effects) = (in_scene(&rival.assumed, trial), rival.effects());
            rows.iter().map(|row| scene.tangents(row, &assumed, &effects)).collect()
        })
        .collect();
    // Rows that every rival predicts, with the noise of each of their coordinates.
    let used: Vec<usize> = (0..rows.len()).filter(|&i| tangents.iter().all(|all| all[i].is_some())).collect();
    let used: Vec<(usize, &[f64])> =
        used.into_iter().filter_map(|i| Some((i, floor.of(rows[i].what)?.sd.as_slice()))).collect();
    let lines: usize = used.iter().map(|(i, _)| rows[*i].measured.len()).sum();
    if lines == 0 || rivals.is_empty() {
        return None;
    }
    let noise = found.doubt.noise_scale;
    let spread = 1.0 + found.doubt.dirt_sigmas.powi(2);
    // The frame of the new session is not known; its columns are nearly the same for all rivals.
    let frame = stacked(&tangents[0], &used, lines, noise, |tangents| &tangents.gauge);
    let mut own = DMatrix::identity(lines, lines) * spread + &frame * frame.transpose() * FRAME_SD.powi(2);
    add_offsets(&mut own, rows, &used, noise);
    let predicted: Vec<Predicted> = rivals
        .iter()
        .zip(&tangents)
        .map(|(rival, tangents)| {
            let columns = stacked(tangents, &used, lines, noise, |tangents| &tangents.effects);
            let covariance = &own + &columns * &rival.covariance * columns.transpose();
            let root = Cholesky::new(covariance)?;
            let log_det = 2.0 * root.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
            let mean = means(tangents, &used, lines, noise);
            Some(Predicted { mean, root, log_det })
        })
        .collect::<Option<_>>()?;
    let (separation, pair) = separation(rivals, &predicted);
    let (expected, promised) = after(rivals, &predicted, seed);
    let columns = stacked(&tangents[0], &used, lines, noise, |tangents| &tangents.effects);
    let (information, doubt_left) = information(&rivals[0], &columns, &own)?;
    Some(Score { separation, pair, expected, promised, information, doubt_left })
}

/// What is constant of each new stand is not known: in standard deviations of the noise.
fn add_offsets(own: &mut DMatrix<f64>, rows: &[Observation], used: &[(usize, &[f64])], noise: f64) {
    let lines: Vec<(Option<usize>, usize, f64)> = used
        .iter()
        .flat_map(|(i, sd)| sd.iter().enumerate().map(|(c, sd)| (rows[*i].stand, c, FRAME_SD / (sd * noise))))
        .collect();
    for (r, (stand, c, of_row)) in lines.iter().enumerate().filter(|(_, line)| line.0.is_some()) {
        for (k, other) in lines.iter().enumerate() {
            if other.0 == *stand && other.1 == *c {
                own[(r, k)] += of_row * other.2;
            }
        }
    }
}

/// The sessions and one more, and the rows to come.
fn scene<'a>(measurements: &Measurements, trial: &'a Trial) -> (Measurements, &'a [Observation]) {
    let mut scene = measurements.only([]);
    scene.apparatuses.push(measurements.apparatuses[trial.like].clone());
    (scene, &trial.rows)
}

fn in_scene(assumed: &Assumed, trial: &Trial) -> Assumed {
    let mut assumed = assumed.clone();
    assumed.placements.push(assumed.placements[trial.like]);
    assumed.set_mount(assumed.placements.len() - 1, assumed.mount(trial.like));
    assumed
}

/// Columns of all rows below each other, in standard deviations of the noise.
fn stacked(
    tangents: &[Option<Tangents>],
    used: &[(usize, &[f64])],
    lines: usize,
    noise: f64,
    columns: impl Fn(&Tangents) -> &DMatrix<f64>,
) -> DMatrix<f64> {
    let own = used.iter().filter_map(|(i, sd)| Some((columns(tangents[*i].as_ref()?), *sd)));
    let width = own.clone().map(|(columns, _)| columns.ncols()).next().unwrap_or(0);
    let mut all = DMatrix::zeros(lines, width);
    let mut at = 0;
    for (columns, sd) in own {
        for (line, sd) in columns.row_iter().zip(sd) {
            all.set_row(at, &(line / (sd * noise)));
            at += 1;
        }
    }
    all
}

fn means(tangents: &[Option<Tangents>], used: &[(usize, &[f64])], lines: usize, noise: f64) -> DVector<f64> {
    let values =
        used.iter().filter_map(|(i, sd)| Some((tangents[*i].as_ref()?, *sd))).flat_map(|(tangents, sd)| {
            tangents.predicted.iter().zip(sd).map(move |(value, sd)| value / (sd * noise))
        });
    let mut mean = DVector::zeros(lines);
    mean.iter_mut().zip(values).for_each(|(mean, value)| *mean = value);
    mean
}

fn separation(rivals: &[Rival], predicted: &[Predicted]) -> (f64, Option<(usize, usize)>) {
    let (mut sum, mut best) = (0.0, (0.0, None));
    for i in 0..rivals.len() {
        for j in i + 1..rivals.len() {
            let apart = &predicted[i].mean - &predicted[j].mean;
            let square = |one: &Predicted| apart.dot(&one.root.solve(&apart));
            let part = rivals[i].probability
                * rivals[j].probability
                * 0.5
                * (square(&predicted[i]) + square(&predicted[j]));
            sum += part;
            if part > best.0 {
                best = (part, Some((i, j)));
            }
        }
    }
    (sum, best.1)
}

/// Means over simulated outcomes, the truth drawn from the rivals: the probability of the right names, and that of
/// the most probable ones that are in question, which is how often those are right.
fn after(rivals: &[Rival], predicted: &[Predicted], seed: u64) -> (f64, f64) {
    if rivals.len() < 2 {
        let only = rivals.first().map_or(0.0, |_| 1.0);
        return (only, only);
    }
    let in_question = in_question(rivals);
    let mut random = StdRng::seed_from_u64(seed);
    let (mut of_right, mut of_first) = (0.0, 0.0);
    for outcome in 0..OUTCOMES {
        let truth = drawn(rivals, (outcome as f64 + random.random::<f64>()) / OUTCOMES as f64);
        let one = &predicted[truth];
        let noise = DVector::from_fn(one.mean.len(), |_, _| normal(&mut random));
        let measured = &one.mean + one.root.l() * noise;
        let logs: Vec<f64> = rivals
            .iter()
            .zip(predicted)
            .map(|(rival, one)| {
                let off = &measured - &one.mean;
                rival.probability.max(1e-12).ln() - 0.5 * (one.log_det + off.dot(&one.root.solve(&off)))
            })
            .collect();
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = logs.iter().map(|log| (log - largest).exp()).collect();
        let whole: f64 = weights.iter().sum();
        let after: Vec<f64> = weights.iter().map(|weight| weight / whole).collect();
        of_right += right(rivals, truth, &after);
        let mut of_names = vec![0.0; rivals.len()];
        in_question.iter().zip(&after).for_each(|(names, share)| of_names[*names] += share);
        of_first += of_names.iter().copied().fold(0.0, f64::max);
    }
    (of_right / OUTCOMES as f64, of_first / OUTCOMES as f64)
}

/// Which rivals are the same to somebody who reads their names: each one's first that has the same names, but for those that
/// are hardly probable and that the set is about as probable without. Hundreds of sets have one more effect that hardly does
/// anything.
fn in_question(rivals: &[Rival]) -> Vec<usize> {
    let probable = |name: &String| -> f64 {
        rivals.iter().filter(|rival| rival.names.contains(name)).map(|rival| rival.probability).sum()
    };
    let sorted = |rival: &Rival| {
        let mut names = rival.names.clone();
        names.sort_unstable();
        names
    };
    let mut sets: Vec<(Vec<String>, f64)> = vec![];
    for rival in rivals {
        let names = sorted(rival);
        match sets.iter_mut().find(|(known, _)| *known == names) {
            Some((_, known)) => *known = known.max(rival.probability),
            None => sets.push((names, rival.probability)),
        }
    }
    let less = |names: &Vec<String>, own: f64| -> Option<(Vec<String>, f64)> {
        (0..names.len()).filter(|&k| probable(&names[k]) < IN_QUESTION).find_map(|k| {
            let mut without = names.clone();
            without.remove(k);
            sets.iter().find(|(known, other)| *known == without && 2.0 * other >= own).cloned()
        })
    };
    let names: Vec<Vec<String>> = rivals
        .iter()
        .map(|rival| {
            let (mut names, mut own) = (sorted(rival), rival.probability);
            while let Some(smaller) = less(&names, own) {
                (names, own) = smaller;
            }
            names
        })
        .collect();
    let first = |own: &Vec<String>| names.iter().position(|other| other == own).unwrap_or(0);
    names.iter().map(first).collect()
}

/// The rival in whose part of 0–1 a number lies.
fn drawn(rivals: &[Rival], at: f64) -> usize {
    let mut below = 0.0;
    for (i, rival) in rivals.iter().enumerate() {
        below += rival.probability;
        if at < below {
            return i;
        }
    }
    rivals.len() - 1
}

/// By Box and Muller.
fn normal(random: &mut StdRng) -> f64 {
    let (a, b): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// ½ log det(I + C Jᵀ S⁻¹ J), and what of the standard deviations is left.
fn information(rival: &Rival, columns: &DMatrix<f64>, own: &DMatrix<f64>) -> Option<(f64, f64)> {
    let count = columns.ncols();
    if count == 0 {
        return Some((0.0, 1.0));
    }
    let tells = columns.transpose() * Cholesky::new(own.clone())?.solve(columns);
    let det = (DMatrix::identity(count, count) + &rival.covariance * tells).determinant();
    let information = 0.5 * det.max(1.0).ln();
    Some((information, (-information / count as f64).exp()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rival(name: &str, probability: f64) -> Rival {
        Rival {
            names: vec![name.to_owned()],
            probability,
            assumed: Assumed::default(),
            covariance: DMatrix::zeros(0, 0),
        }
    }

    fn at(mean: f64) -> Predicted {
        let root = Cholesky::new(DMatrix::identity(1, 1)).expect("positive");
        Predicted { mean: DVector::from_element(1, mean), root, log_det: 0.0 }
    }

    #[test]
    fn what_is_promised_is_how_often_the_first_name_is_right() {
        let rivals = [rival("play", 0.5), rival("sag", 0.5)];
        // One number tells them apart by two standard deviations: it falls on the right side of the middle in Φ(1).
        let (expected, promised) = after(&rivals, &[at(0.0), at(2.0)], 7);
        assert!((promised - 0.841).abs() < 0.02, "{promised}");
        assert!(expected < promised - 0.03, "{expected} {promised}");
        let (expected, promised) = after(&rivals, &[at(0.0), at(0.0)], 7);
        assert!((expected - 0.5).abs() < 1e-9 && (promised - 0.5).abs() < 1e-9, "{expected} {promised}");
        let (expected, promised) = after(&rivals, &[at(0.0), at(20.0)], 7);
        assert!(expected > 0.99 && promised > 0.99, "{expected} {promised}");
    }

    #[test]
    fn what_hardly_does_anything_beside_it_makes_a_name_no_less_likely() {
        let mut rivals: Vec<Rival> = (0..10).map(|_| rival("play", 0.09)).collect();
        for (k, with) in rivals.iter_mut().enumerate().skip(1) {
            with.names.push(format!("trace {k}"));
        }
        rivals.push(rival("sag", 0.1));
        assert_eq!(in_question(&rivals)[9..], [0, 10]);
        let one_of_six: Vec<Rival> = (0..6).map(|k| rival(&format!("joint {k}"), 1.0 / 6.0)).collect();
        assert_eq!(in_question(&one_of_six), [0, 1, 2, 3, 4, 5]);
        let mut beside_sure = one_of_six;
        beside_sure.iter_mut().for_each(|one| one.names.push("sag".to_owned()));
        assert_eq!(
            in_question(&beside_sure),
            [0, 1, 2, 3, 4, 5],
            "which joint it is stays open beside what is sure"
        );
        let alike: Vec<Predicted> = (0..11).map(|k| at(if k < 10 { 0.0 } else { 20.0 })).collect();
        let (_, promised) = after(&rivals, &alike, 7);
        assert!(promised > 0.99, "{promised}");
    }
}
