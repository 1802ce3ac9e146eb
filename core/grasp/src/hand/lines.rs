//! Along a short line across the rim: where the hand really ends.
//!
//! Far from the rim the pixels' evidence is added up to either side of every possible place of it
//! (Stoiber, Pfaff, Strobl, Triebel 2020). Close to it the colors themselves are fitted, hand to one
//! side, what was there before to the other, which gives fractions of a pixel.

use image::RgbImage;
use nalgebra::Vector2;

use super::evidence::color;
use super::view::{Region, RimPoint};

/// Where the hand ends on a line, from the rim that was predicted, outward positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    pub shift_px: f64,
    /// One over its variance, 1/px².
    pub information: f64,
}

impl Crossing {
    /// The same with one more error of this standard deviation.
    pub fn doubted(self, sigma_px: f64) -> Self {
        Self { information: 1.0 / (1.0 / self.information + sigma_px * sigma_px), ..self }
    }
}

/// Pixels beside each other are not independent: each counts for this much of one.
const INDEPENDENT: f64 = 0.5;
/// Steps of possible places, px.
const STEP_PX: f64 = 0.5;
/// Below this share of what is assumed anyway a line says nothing.
const LEAST_SHARE: f64 = 0.3;

/// From the evidence of pixels up to `half_px` to both sides.
pub(super) fn from_evidence(
    ratios: &[f32],
    region: &Region,
    point: &RimPoint,
    half_px: usize,
) -> Option<Crossing> {
    let reach = half_px as f64;
    let places = (4 * half_px - 3) as i32;
    let first = -(reach - 1.0);
    let samples: Vec<(f64, f64)> = (0..=2 * half_px)
        .filter_map(|i| {
            let r = i as f64 - reach;
            bilinear(ratios, region, &(point.pixel + point.normal * r)).map(|value| (r, value))
        })
        .collect();
    if samples.len() < half_px + 1 {
        return None;
    }
    // All that lies inside of the rim belongs to the hand.
    let log = |d: f64| -> f64 {
        let inside = samples.iter().map(|(r, value)| value * (d - r + 0.5).clamp(0.0, 1.0));
        INDEPENDENT * inside.sum::<f64>() - 0.5 * (2.0 * d / reach).powi(2)
    };
    let at = |i: i32| first + STEP_PX * f64::from(i);
    let logs: Vec<f64> = (0..places).map(|i| log(at(i))).collect();
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
    for (i, log) in logs.iter().enumerate() {
        let (weight, d) = ((log - most).exp(), at(i as i32));
        total += weight;
        mean += weight * d;
        square += weight * d * d;
    }
    mean /= total;
    let variance = (square / total - mean * mean).max(0.05);
    // What was assumed beforehand is taken out again.
    let assumed = (2.0 / reach).powi(2);
    let information = 1.0 / variance - assumed;
    (information > LEAST_SHARE * assumed)
        .then(|| Crossing { shift_px: mean / variance / information, information })
}

/// Half of the edge's width, px: lens blur, pixel and interpolation together.
const EDGE_PX: f64 = 1.1;
/// Colors are taken from this far inside and outside of the predicted rim, px.
const OWN_PX: [f64; 2] = [1.5, 3.5];
const BEHIND_PX: [f64; 2] = [1.5, 4.5];
/// The rim is looked for up to this far, px.
const FIT_PX: f64 = 1.75;
/// Samples of a line, px.
const FIT_STEP_PX: f64 = 0.5;
const FIT_REACH: i32 = 6;
/// Standard deviation of a channel, 0–255.
const NOISE: f64 = 4.0;
/// The brightness of what lies behind may have changed by these factors.
const GAIN: [f64; 2] = [0.35, 1.3];

/// From the colors themselves, for a rim that is right to about a pixel.
pub(super) fn from_colors(now: &RgbImage, before: Option<&RgbImage>, point: &RimPoint) -> Option<Crossing> {
    let place = |r: f64| point.pixel + point.normal * r;
    let own = mean_color(now, place, [-OWN_PX[1], -OWN_PX[0]]);
    let behind: Box<dyn Fn(f64) -> [f64; 3]> = match before {
        Some(before) => {
            let gain = gain(now, before, place);
            Box::new(move |r| sample(before, &place(r)).map(|value| value * gain))
        }
        None => {
            let mean = mean_color(now, place, BEHIND_PX);
            Box::new(move |_| mean)
        }
    };
    let samples: Vec<(f64, [f64; 3], [f64; 3])> = (-FIT_REACH..=FIT_REACH)
        .map(|i| f64::from(i) * FIT_STEP_PX)
        .map(|r| (r, sample(now, &place(r)), behind(r)))
        .collect();
    let cost = |d: f64| -> f64 {
        let one = |(r, seen, back): &(f64, [f64; 3], [f64; 3])| {
            let covered = edge(d - r);
            (0..3).map(|c| (seen[c] - covered * own[c] - (1.0 - covered) * back[c]).powi(2)).sum::<f64>()
        };
        samples.iter().map(one).sum()
    };
    let steps = (FIT_PX / 0.25).round() as i32;
    let costs: Vec<f64> = (-steps..=steps).map(|i| cost(0.25 * f64::from(i))).collect();
    let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]))?;
    if best == 0 || best + 1 == costs.len() {
        return None;
    }
    let [left, middle, right] = [costs[best - 1], costs[best], costs[best + 1]];
    let bend = left - 2.0 * middle + right;
    if !(bend > 0.0) {
        return None;
    }
    let shift_px = 0.25 * (best as f64 - f64::from(steps) + 0.5 * (left - right) / bend);
    // Samples are closer than pixels, and channels go together.
    let count = samples.len() as f64;
    let variance = NOISE * NOISE + middle / (3.0 * count);
    let information = 0.5 * (bend / (0.25 * 0.25)) * (FIT_STEP_PX / 3.0) / variance;
    Some(Crossing { shift_px, information })
}

/// Coverage at a distance inside of a rim.
fn edge(inside_px: f64) -> f64 {
    let t = (0.5 + 0.5 * inside_px / EDGE_PX).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// By which factor what lies outside of the rim is brighter now.
fn gain(now: &RgbImage, before: &RgbImage, place: impl Fn(f64) -> Vector2<f64>) -> f64 {
    let (mut both, mut own) = (0.0, 1.0);
    for r in steps(BEHIND_PX) {
        let (is, was) = (sample(now, &place(r)), sample(before, &place(r)));
        both += (0..3).map(|c| is[c] * was[c]).sum::<f64>();
        own += was.iter().map(|value| value * value).sum::<f64>();
    }
    (both / own).clamp(GAIN[0], GAIN[1])
}

fn mean_color(image: &RgbImage, place: impl Fn(f64) -> Vector2<f64>, range: [f64; 2]) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for r in steps(range) {
        let value = sample(image, &place(r));
        (0..3).for_each(|c| sum[c] += value[c]);
        count += 1.0;
    }
    sum.map(|value| value / count)
}

fn steps(range: [f64; 2]) -> impl Iterator<Item = f64> {
    let count = ((range[1] - range[0]) / FIT_STEP_PX).round() as i32;
    (0..=count).map(move |i| range[0] + f64::from(i) * FIT_STEP_PX)
}

fn sample(image: &RgbImage, at: &Vector2<f64>) -> [f64; 3] {
    let (u, v) = (at.x.floor(), at.y.floor());
    let (p, q) = (at.x - u, at.y - v);
    let (u, v) = (u as i32, v as i32);
    let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(du, dv)| color(image, u + du, v + dv));
    let weights = [(1.0 - p) * (1.0 - q), p * (1.0 - q), (1.0 - p) * q, p * q];
    std::array::from_fn(|c| (0..4).map(|k| weights[k] * f64::from(corners[k][c])).sum())
}

fn bilinear(values: &[f32], region: &Region, at: &Vector2<f64>) -> Option<f64> {
    let (u, v) = (at.x - f64::from(region.u0), at.y - f64::from(region.v0));
    let last = (region.width as f64 - 1.0, region.height as f64 - 1.0);
    if !(u >= 0.0 && v >= 0.0 && u < last.0 && v < last.1) {
        return None;
    }
    let (column, row) = (u as usize, v as usize);
    let (p, q) = (u - column as f64, v - row as f64);
    let value = |du: usize, dv: usize| f64::from(values[(row + dv) * region.width + column + du]);
    let upper = (1.0 - p) * value(0, 0) + p * value(1, 0);
    let lower = (1.0 - p) * value(0, 1) + p * value(1, 1);
    Some((1.0 - q) * upper + q * lower)
}
