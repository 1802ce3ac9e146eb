//! The texture of speckles: random blotches that repeat after 512 texels, with coarser and coarser
//! averages of itself for places far away.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// Texels of a side; the shader says the same.
pub(super) const SIDE: usize = 512;
/// Levels, down to one texel.
pub(super) const LEVELS: usize = 10;

/// Gray levels of every level of detail, finest first; 128 is the mean.
pub(super) fn levels() -> Vec<Vec<u8>> {
    let mut fine = blotches();
    let mut levels = Vec::with_capacity(LEVELS);
    let mut side = SIDE;
    for _ in 0..LEVELS {
        levels.push(fine.iter().map(|v| (127.5 + 127.5 * v).round().clamp(0.0, 255.0) as u8).collect());
        let half = (side / 2).max(1);
        fine = (0..half * half)
            .map(|i| {
                let (x, y) = (2 * (i % half), 2 * (i / half));
                let at = |dx: usize, dy: usize| fine[(y + dy) % side * side + (x + dx) % side];
                0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
            })
            .collect();
        side = half;
    }
    levels
}

/// Dark grains of different size on a light ground, mean 0, from -1 to 1.
fn blotches() -> Vec<f32> {
    let mut random = StdRng::seed_from_u64(20_261_121);
    let mut white = || -> Vec<f32> { (0..SIDE * SIDE).map(|_| random.random_range(-1.0..1.0)).collect() };
    let fine = smooth(&white(), 1);
    let coarse = smooth(&white(), 2);
    let mut sum: Vec<f32> =
        fine.iter().zip(&coarse).map(|(f, c)| (5.0 * (f * 1.3 + c * 1.2 + 0.15)).tanh()).collect();
    let mean = sum.iter().sum::<f32>() / sum.len() as f32;
    for v in &mut sum {
        *v = ((*v - mean) / (1.0 + mean.abs())).clamp(-1.0, 1.0);
    }
    sum
}

/// Averages over a box of 2 `radius` + 1 texels, twice, around the edges; variance kept.
fn smooth(values: &[f32], radius: usize) -> Vec<f32> {
    let mut out = values.to_vec();
    let taps = (2 * radius + 1) as f32;
    for (step, _) in [(1, 0), (SIDE, 0), (1, 1), (SIDE, 1)] {
        let source = out.clone();
        for (i, v) in out.iter_mut().enumerate() {
            let (x, y) = (i % SIDE, i / SIDE);
            *v = (0..=2 * radius)
                .map(|k| {
                    let shift = |c: usize| (c + SIDE + k - radius) % SIDE;
                    if step == 1 { source[y * SIDE + shift(x)] } else { source[shift(y) * SIDE + x] }
                })
                .sum::<f32>()
                / taps;
        }
    }
    let spread = (out.iter().map(|v| v * v).sum::<f32>() / out.len() as f32).sqrt();
    out.iter().map(|v| 0.5 * v / spread.max(1e-9)).collect()
}
