//! Which rows are held out together.

use std::collections::BTreeMap;

use plumbline_effects::Measurements;
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;

/// Folds where rows are many.
const FOLDS: usize = 5;
/// With fewer rows each is held out by itself.
const FEW_ROWS: usize = 60;
/// A fold with more of the rows than this leaves too little to learn from.
const LARGEST_SHARE: f64 = 0.6;

/// Rows in folds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Folds {
    /// Fold of each chosen row, in their order.
    pub of_row: Vec<usize>,
    /// Block of each chosen row: what is drawn as a whole when the interval is worked out.
    pub block: Vec<usize>,
    /// Number of folds.
    pub count: usize,
    /// How, in words.
    pub words: String,
}

/// Folds of the chosen rows; `one_by_one` allows a fold per row where rows are few.
pub(super) fn folds(measurements: &Measurements, chosen: &[usize], seed: u64, one_by_one: bool) -> Folds {
    let cell = |i: usize| measurements.rows[i].pose.unwrap_or(measurements.rows[i].cell);
    if chosen.len() < FEW_ROWS && one_by_one {
        let of_row = numbered(chosen.iter().map(|&i| cell(i)));
        let count = of_row.iter().max().map_or(0, |last| last + 1);
        return Folds {
            block: of_row.clone(),
            of_row,
            count,
            words: if chosen.iter().all(|&i| measurements.rows[i].stand.is_some()) {
                format!("{count} folds, every {count}th look")
            } else {
                format!("{count} folds, one place at a time")
            },
        };
    }
    if let Some(folds) = by_set(measurements, chosen) {
        return folds;
    }
    let block = numbered(chosen.iter().map(|&i| cell(i)));
    let blocks = block.iter().max().map_or(0, |last| last + 1);
    let count = FOLDS.min(blocks.max(1));
    // Drawn, since neighbors in the list are neighbors on the table.
    let mut order: Vec<usize> = (0..blocks).collect();
    order.shuffle(&mut StdRng::seed_from_u64(seed));
    let mut of_block = vec![0; blocks];
    order.iter().enumerate().for_each(|(place, &block)| of_block[block] = place % count);
    let of_row = block.iter().map(|&block| of_block[block]).collect();
    Folds { of_row, block, count, words: format!("{count} folds, whole places") }
}

fn by_set(measurements: &Measurements, chosen: &[usize]) -> Option<Folds> {
    let key = |i: usize| {
        let row = &measurements.rows[i];
        Some((row.session, row.set.clone()?))
    };
    let keys: Vec<(usize, String)> = chosen.iter().map(|&i| key(i)).collect::<Option<_>>()?;
    let mut sizes = BTreeMap::<&(usize, String), usize>::new();
    keys.iter().for_each(|key| *sizes.entry(key).or_default() += 1);
    let names: std::collections::BTreeSet<&String> = keys.iter().map(|(_, set)| set).collect();
    if names.len() < 3 {
        return None;
    }
    // The same label in two sessions is one set: a line that was measured twice.
    let mut by_name = BTreeMap::<&String, usize>::new();
    keys.iter().for_each(|(_, set)| *by_name.entry(set).or_default() += 1);
    let mut ordered: Vec<(&String, usize)> = by_name.into_iter().collect();
    ordered.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
    let count = FOLDS.min(ordered.len());
    let mut filled = vec![0usize; count];
    let mut fold = BTreeMap::<&String, usize>::new();
    for (name, size) in ordered {
        let smallest = (0..count).min_by_key(|&k| filled[k])?;
        filled[smallest] += size;
        fold.insert(name, smallest);
    }
    if filled.iter().any(|&size| size as f64 > LARGEST_SHARE * chosen.len() as f64) {
        return None;
    }
    let of_row: Vec<usize> = keys.iter().map(|(_, set)| fold[set]).collect();
    // The frame of a session that is held out as a whole would be unknown.
    for session in keys.iter().map(|(session, _)| *session).collect::<std::collections::BTreeSet<_>>() {
        let mut own = keys.iter().zip(&of_row).filter(|((of, _), _)| *of == session).map(|(_, fold)| fold);
        let first = own.next();
        if own.all(|fold| Some(fold) == first) {
            return None;
        }
    }
    let block = numbered(keys.iter().map(|(_, set)| set));
    Some(Folds { of_row, block, count, words: format!("{count} folds, whole sets") })
}

/// Labels numbered in the order in which they come.
fn numbered<T: Ord>(labels: impl Iterator<Item = T>) -> Vec<usize> {
    let mut known = BTreeMap::<T, usize>::new();
    labels
        .map(|label| {
            let next = known.len();
            *known.entry(label).or_insert(next)
        })
        .collect()
}
