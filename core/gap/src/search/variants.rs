//! How noise and sizes may be: what is integrated over.

use super::field::Variant;
use crate::finding::FloorSource;

/// How large an effect of these sessions is, in floors; each as probable as the others.
const SIZES: [f64; 3] = [1.0, 3.0, 10.0];
/// From this on what every cell is off by, by itself, is no small dirt but something unknown.
pub(super) const UNKNOWN_CELL: f64 = 0.7;

/// With repeats: own amount of every cell and dirt (in floors), and how probable.
const REPEATED: [(f64, f64, f64); 7] = [
    (0.05, 0.15, 0.30),
    (0.2, 0.15, 0.20),
    (0.2, 0.4, 0.20),
    (0.4, 0.4, 0.20),
    (0.8, 0.4, 0.05),
    (1.6, 0.4, 0.03),
    (3.2, 0.4, 0.02),
];
/// Without: what the floor is off by, and how probable.
const APPROXIMATE: [(f64, f64); 7] =
    [(0.5, 0.1), (0.7, 0.2), (1.0, 0.25), (1.4, 0.2), (2.0, 0.15), (2.8, 0.07), (4.0, 0.03)];

/// Where nothing tells it, it may be anything below what frames leave.
const UNKNOWN: [(f64, f64); 8] =
    [(0.02, 0.1), (0.05, 0.1), (0.1, 0.1), (0.2, 0.15), (0.4, 0.15), (0.7, 0.15), (1.0, 0.15), (1.4, 0.1)];

/// All variants.
pub(super) fn variants(source: FloorSource) -> Vec<Variant> {
    let scaled = |grid: &[(f64, f64)]| -> Vec<(f64, f64, f64, f64)> {
        grid.iter().map(|&(noise, share)| (noise, 0.05, 0.3 * noise, share)).collect()
    };
    let base = match source {
        FloorSource::Repeats => {
            REPEATED.iter().map(|&(cell, dirt, share)| (1.0, cell, dirt, share)).collect()
        }
        FloorSource::Neighbors | FloorSource::Instrument => scaled(&APPROXIMATE),
        FloorSource::Fitted => scaled(&UNKNOWN),
    };
    let shares = SIZES.len() as f64;
    base.into_iter()
        .flat_map(|(noise, cell, dirt, share)| {
            SIZES.map(|size| Variant { noise, cell, dirt, size, log_prior: (share / shares).ln() })
        })
        .collect()
}
