//! How noise and sizes may be: what is integrated over.

use super::field::Variant;
use crate::finding::FloorSource;

/// How large an effect of these sessions is, in floors; each as probable as the others.
const SIZES: [f64; 3] = [1.0, 3.0, LARGEST];
const LARGEST: f64 = 10.0;
/// Where effects are so large, they may have so many usual sizes; but a noise that nothing but neighbors tell is no
/// ground to believe more than what is usual.
const LARGER_THAN_USUAL: f64 = 2.0;
/// The formula of an effect is right to this share of what it does: of a large one more is left.
const FORMULA_SHARE: f64 = 0.08;
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
/// The larger one of both amounts of dirt; it grows with the gap.
const LARGER_DIRT: f64 = 0.4;
/// Without: what the floor is off by, and how probable.
const APPROXIMATE: [(f64, f64); 7] =
    [(0.5, 0.1), (0.7, 0.2), (1.0, 0.25), (1.4, 0.2), (2.0, 0.15), (2.8, 0.07), (4.0, 0.03)];

/// Where nothing tells it, it may be anything below what frames leave.
const UNKNOWN: [(f64, f64); 8] =
    [(0.02, 0.1), (0.05, 0.1), (0.1, 0.1), (0.2, 0.15), (0.4, 0.15), (0.7, 0.15), (1.0, 0.15), (1.4, 0.1)];

/// All variants, for a gap of so many floors.
pub(super) fn variants(source: FloorSource, gap: f64) -> Vec<Variant> {
    let scaled = |grid: &[(f64, f64)]| -> Vec<(f64, f64, f64, f64)> {
        grid.iter().map(|&(noise, share)| (noise, 0.05, 0.3 * noise, share)).collect()
    };
    let base = match source {
        FloorSource::Repeats => {
            let grown = |dirt: f64| if dirt < LARGER_DIRT { dirt } else { dirt.max(FORMULA_SHARE * gap) };
            REPEATED.iter().map(|&(cell, dirt, share)| (1.0, cell, grown(dirt), share)).collect()
        }
        FloorSource::Neighbors | FloorSource::Instrument => scaled(&APPROXIMATE),
        FloorSource::Fitted => scaled(&UNKNOWN),
    };
    let shares = SIZES.len() as f64;
    let is_unusual = |size: f64| size >= LARGEST && source == FloorSource::Repeats;
    let sizes = SIZES.map(|size| (size, if is_unusual(size) { LARGER_THAN_USUAL } else { 1.0 }));
    base.into_iter()
        .flat_map(|(noise, cell, dirt, share)| {
            sizes.map(|(size, most)| Variant {
                noise,
                cell,
                dirt,
                size,
                most,
                log_prior: (share / shares).ln(),
            })
        })
        .collect()
}
