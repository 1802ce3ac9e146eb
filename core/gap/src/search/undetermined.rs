//! What of the effects that were found the rows do not tell.
//!
//! In units of what is expected beforehand, a direction in the space of all values that keeps most of its
//! variance is not told: either one value that the poses do not show, or several that act alike.

use nalgebra::DMatrix;
use plumbline_effects::measurements::{Measurements, What};
use plumbline_effects::{Effect, Present};
use plumbline_model::{decompose, parameter_words};

use crate::finding::Undetermined;

/// A value by itself is not shown when so much of its variance is left.
const NOT_SHOWN: f64 = 0.9;
/// A direction is not told when so much of its variance is left.
const NOT_TOLD: f64 = 0.5;
/// Values that have this part in a direction belong to it.
const PART: f64 = 0.4;
/// At most so many groups are told.
const MOST_GROUPS: usize = 4;

/// `covariance`: of the values of all effects in turn first, in usual sizes; `sds`: of each beforehand.
pub(super) fn undetermined(
    measurements: &Measurements,
    effects: &[Present],
    covariance: &DMatrix<f64>,
    sds: &[f64],
) -> Vec<Undetermined> {
    let names: Vec<(String, String)> =
        effects.iter().flat_map(|present| names(measurements, &present.effect)).collect();
    if names.len() != sds.len() || covariance.nrows() < sds.len() {
        return vec![];
    }
    let left = |r: usize, c: usize| covariance[(r, c)] / (sds[r] * sds[c]);
    let (hidden, shown): (Vec<usize>, Vec<usize>) = (0..sds.len()).partition(|&k| left(k, k) > NOT_SHOWN);
    let mut found = vec![];
    if !hidden.is_empty() {
        let titles: Vec<&str> = hidden.iter().map(|&k| names[k].1.as_str()).collect();
        found.push(Undetermined {
            parameters: hidden.iter().map(|&k| names[k].0.clone()).collect(),
            words: format!("These poses do not show {}.", titles.join(", ")),
        });
    }
    let matrix = DMatrix::from_fn(shown.len(), shown.len(), |r, c| left(shown[r], shown[c]));
    let Some(eigen) = (!shown.is_empty()).then(|| decompose::symmetric_eigen(matrix)).flatten() else {
        return found;
    };
    let mut order: Vec<usize> = (0..shown.len()).filter(|&k| eigen.eigenvalues[k] > NOT_TOLD).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let oriented = measurements.rows.iter().any(|row| row.what == What::OrientedPose);
    for direction in order.into_iter().take(MOST_GROUPS) {
        let axis = eigen.eigenvectors.column(direction);
        let group: Vec<usize> =
            (0..shown.len()).filter(|&k| axis[k].abs() > PART).map(|k| shown[k]).collect();
        if group.is_empty() {
            continue;
        }
        let titles: Vec<&str> = group.iter().map(|&k| names[k].1.as_str()).collect();
        let what = match titles.len() {
            1 => format!("These poses hardly tell {}", titles[0]),
            _ => format!("In these poses {} act alike", titles.join(" and ")),
        };
        let tells = if oriented {
            "other poses would tell"
        } else {
            "orientations, or a tip off the axis, would tell"
        };
        found.push(Undetermined {
            parameters: group.iter().map(|&k| names[k].0.clone()).collect(),
            words: format!("{what}: {tells}."),
        });
    }
    found
}

/// What people call a joint or a link inside of a sentence.
fn place(measurements: &Measurements, site: &str) -> String {
    let arms = measurements.apparatuses.iter().filter_map(|apparatus| apparatus.arm.as_ref());
    let title = arms.flat_map(|arm| &arm.parts).find(|part| part.joint == site).map(|part| &part.title);
    match title {
        Some(title) => {
            let mut letters = title.chars();
            letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
        }
        None => parameter_words::place(site),
    }
}

/// Of each value of an effect: `id@site.parameter`, and words.
fn names(measurements: &Measurements, effect: &Effect) -> Vec<(String, String)> {
    let count = effect.parameters().len();
    let none = DMatrix::zeros(count, count);
    let reported: Vec<String> = effect
        .report(&vec![0.0; count], &none)
        .into_iter()
        .filter(|one| one.text.is_none())
        .map(|one| one.name)
        .collect();
    let own = |k: usize| match reported.get(k) {
        Some(name) if reported.len() == count => name.clone(),
        _ => effect.parameters()[k].name.to_owned(),
    };
    let site = if effect.site.is_empty() {
        String::new()
    } else {
        format!("{} ", place(measurements, &effect.site))
    };
    (0..count)
        .map(|k| {
            let name = own(k);
            let words = format!("{site}{}", parameter_words::called(&name));
            (format!("{}.{name}", effect.name()), words)
        })
        .collect()
}
