//! How far the true correction at a new touch may lie from a model's answer.

use nalgebra::Vector2;
use plumbline_model::Pixel;
use plumbline_model::session::Screen;
use serde::{Deserialize, Serialize};

use super::Border;
use super::growth::{Evidence, PARTS, Z_95, deviance, dot, parts, student_factor};
use super::hull::{convex_hull, distance_outside};
use super::region::MARGIN;

/// Reach of the weights of the local part, in spacings.
const LOCAL_REACH: f64 = 1.5;
/// The residuals of all touches count like this many near ones.
const GLOBAL_WEIGHT: f64 = 20.0;
/// From fewer residuals (of all axes) an interval is not calibrated: its ends would rest on the
/// largest five or less.
const FEWEST_SCORES: usize = 100;
/// From fewer blocks growth outside is not learned alone.
const FEWEST_BLOCKS: usize = 3;
/// One more part has to lower the deviance by this much (Akaike's criterion).
const SIGNIFICANT: f64 = 2.0;
/// Between touches a model interpolates: errors grow less there than outside.
const GAP_SHARE: f64 = 0.5;

/// Standard deviation per axis of (true correction at a new touch − model's answer).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    border: Border,
    /// Touches that residuals are known of.
    anchors: Vec<Anchor>,
    /// Corners of the convex hull of the touches.
    hull_px: Vec<[f64; 2]>,
    /// Per axis: variance (m²) of the parts local, gap, near and far, at a spacing's distance.
    parts_m2: [[f64; PARTS]; 3],
    /// Distance outside of the hull, in spacings, that left-out blocks tell of.
    reach: f64,
}

/// A touch, how much it tells of the local part, and its squared residuals over the variance
/// that all touches together make expected there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Anchor {
    pixel: [f64; 2],
    weight: f64,
    relative: [f64; 3],
}

/// Why nothing can be said about the spread of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpreadError {
    /// Not the same number of everything.
    #[error(
        "{pixels} touches have {residuals} residuals and {blocks} blocks: cross-validate the model on all touches"
    )]
    Lengths {
        /// Number of touches.
        pixels: usize,
        /// Number of residuals.
        residuals: usize,
        /// Number of labels of blocks.
        blocks: usize,
    },
    /// Too few for a standard deviation.
    #[error("{found} cross-validated residuals tell no spread: touch at least 3 places")]
    TooFew {
        /// Number of residuals.
        found: usize,
    },
    /// A residual that is no number.
    #[error("the residual of touch {index} (counted from 0) is no number: train the model again without it")]
    NotFinite {
        /// Which one.
        index: usize,
    },
}

impl Spread {
    /// Growth of the standard deviation outside of the touches, beyond the distance that left-out
    /// blocks tell of: 5 mm per 100 px. That is a fifth of the distance on a screen of 0.25 mm per
    /// pixel, as if nothing were known about how the correction goes on but that its slope is 0.2
    /// at most.
    pub const FALLBACK_RATE_M_PER_PX: f64 = 5e-5;

    /// Factor on the local standard deviation outside of the border. A touch lies outside of all
    /// others partly because it went astray itself, so that errors there are larger than their
    /// distance explains: on 245 touches of the real robot, each set judged by the others,
    /// intervals without the factor held 80 to 85 % of what lay outside.
    pub const OUTSIDE_FACTOR: f64 = 2.0;

    /// From residuals (true − answered, m) of touches whose model had been trained without them,
    /// but with others close by: the growth with distance is the fallback's.
    ///
    /// # Errors
    /// For fewer than three residuals, or one that is no number.
    pub fn fit(
        pixels: &[Pixel<Screen>],
        residuals_m: &[[f64; 3]],
        border: &Border,
    ) -> Result<Self, SpreadError> {
        Self::check(pixels, residuals_m, pixels.len())?;
        let near_others = vec![Distance { gap: 0.0, hull: 0.0 }; pixels.len()];
        Ok(Self::learned(pixels, residuals_m, &near_others, Telling::default(), border))
    }

    /// From residuals (true − answered, m) of touches whose model had been trained without their
    /// whole block: `blocks` labels the block of each touch. The growth with distance is learned
    /// from how far the blocks lie from the touches that had remained.
    ///
    /// # Errors
    /// For fewer than three residuals, or one that is no number.
    pub fn fit_blocked(
        pixels: &[Pixel<Screen>],
        residuals_m: &[[f64; 3]],
        blocks: &[usize],
        border: &Border,
    ) -> Result<Self, SpreadError> {
        Self::check(pixels, residuals_m, blocks.len())?;
        let spacing = border.spacing_px();
        let mut distances = vec![Distance { gap: 0.0, hull: 0.0 }; pixels.len()];
        let mut labels = blocks.to_vec();
        labels.sort_unstable();
        labels.dedup();
        let mut telling = Telling::default();
        for label in labels {
            let remaining: Vec<_> =
                pixels.iter().zip(blocks).filter(|&(_, &b)| b != label).map(|(p, _)| p.vector()).collect();
            if remaining.is_empty() {
                continue; // One block only: no model can have been trained without it.
            }
            let hull = convex_hull(&remaining);
            let mut farthest = Distance { gap: 0.0, hull: 0.0 };
            for (i, pixel) in pixels.iter().enumerate().filter(|&(i, _)| blocks[i] == label) {
                distances[i] = Distance::new(pixel.vector(), &remaining, &hull, spacing);
                farthest.gap = farthest.gap.max(distances[i].gap);
                farthest.hull = farthest.hull.max(distances[i].hull);
            }
            telling.gap += usize::from(farthest.gap > MARGIN);
            telling.outside += usize::from(farthest.hull > MARGIN);
        }
        Ok(Self::learned(pixels, residuals_m, &distances, telling, border))
    }

    fn check(pixels: &[Pixel<Screen>], residuals_m: &[[f64; 3]], blocks: usize) -> Result<(), SpreadError> {
        if pixels.len() != residuals_m.len() || pixels.len() != blocks {
            let (pixels, residuals) = (pixels.len(), residuals_m.len());
            return Err(SpreadError::Lengths { pixels, residuals, blocks });
        }
        if pixels.len() < 3 {
            return Err(SpreadError::TooFew { found: pixels.len() });
        }
        let is_finite =
            |i: usize| residuals_m[i].iter().chain(pixels[i].vector().iter()).all(|value| value.is_finite());
        match (0..pixels.len()).find(|&i| !is_finite(i)) {
            Some(index) => Err(SpreadError::NotFinite { index }),
            None => Ok(()),
        }
    }

    fn learned(
        pixels: &[Pixel<Screen>],
        residuals_m: &[[f64; 3]],
        distances: &[Distance],
        blocks: Telling,
        border: &Border,
    ) -> Self {
        let points: Vec<_> = pixels.iter().map(Pixel::vector).collect();
        let fitted: [[f64; PARTS]; 3] =
            std::array::from_fn(|axis| fitted_parts(residuals_m, axis, distances));
        let anchors = (0..points.len()).map(|i| {
            let growth = distances[i].growth();
            let expected = |axis: usize| dot(&fitted[axis], &growth).max(f64::MIN_POSITIVE);
            let local = (0..3).map(|axis| fitted[axis][0] / expected(axis)).sum::<f64>() / 3.0;
            Anchor {
                pixel: [points[i].x, points[i].y],
                // A residual far from what remained tells of growth, not of this place.
                weight: local,
                relative: std::array::from_fn(|axis| residuals_m[i][axis].powi(2) / expected(axis)),
            }
        });
        let mut spread = Self {
            border: border.clone(),
            anchors: anchors.collect(),
            hull_px: convex_hull(&points).iter().map(|p| [p.x, p.y]).collect(),
            reach: reach(distances, blocks),
            parts_m2: fitted,
        };
        let local = spread.calibration().unwrap_or(student_factor(points.len() as f64 - 1.0)).powi(2);
        for parts in &mut spread.parts_m2 {
            *parts = widened(*parts, local, blocks, border.spacing_px());
        }
        spread
    }

    /// Factor on the local standard deviation with which 1.96 of it hold 95 % of the residuals
    /// that tell of it, each judged by the others; `None` if they are too few to say.
    fn calibration(&self) -> Option<f64> {
        let mut scores: Vec<f64> = Vec::new();
        for (i, anchor) in self.anchors.iter().enumerate().filter(|(_, anchor)| anchor.weight > 0.5) {
            let local = self.local(Vector2::from(anchor.pixel), Some(i));
            scores.extend((0..3).map(|axis| (anchor.relative[axis] / local[axis]).sqrt()));
        }
        scores.sort_by(f64::total_cmp);
        // The rank of split conformal prediction.
        let rank = (0.95 * (scores.len() as f64 + 1.0)).ceil() as usize;
        (scores.len() >= FEWEST_SCORES).then(|| scores[rank - 1] / Z_95)
    }

    /// Standard deviation per axis (m) at a pixel: the true correction at a new touch lies within
    /// 1.96 of it about the model's answer in 95 of 100 cases, and outside of the border at least.
    pub fn sd_m(&self, pixel: Pixel<Screen>) -> [f64; 3] {
        self.sd_m_with(pixel, [0.0; 3])
    }

    /// The same when an ensemble of models disagrees with this standard deviation (m) at the
    /// pixel: where that is more than the growth learned from distances it takes its place. The
    /// residuals behind the local part hold the disagreement near the touches already.
    pub fn sd_m_with(&self, pixel: Pixel<Screen>, model_sd_m: [f64; 3]) -> [f64; 3] {
        let distance = self.distance(pixel);
        let growth = distance.growth();
        let untold = fallback_m2((distance.hull - self.reach).max(0.0), self.border.spacing_px());
        let place = self.border.nearest_inside(pixel);
        let outside = (place.distance_px(&pixel) / self.border.spacing_px()).min(1.0);
        // Outside as at the nearest place inside, or as everywhere where that is larger.
        let local = self.local(place.vector(), None).map(|here| here + outside * (1.0 - here).max(0.0));
        let doubt = if outside > 0.0 { Self::OUTSIDE_FACTOR.powi(2) } else { 1.0 };
        std::array::from_fn(|axis| {
            let parts = self.parts_m2[axis];
            let grown = dot(&[0.0, parts[1], parts[2], parts[3]], &growth) + untold;
            (doubt * parts[0] * local[axis] + grown.max(model_sd_m[axis].powi(2))).sqrt()
        })
    }

    fn distance(&self, pixel: Pixel<Screen>) -> Distance {
        let touches: Vec<_> = self.anchors.iter().map(|anchor| Vector2::from(anchor.pixel)).collect();
        let hull: Vec<_> = self.hull_px.iter().map(|&corner| Vector2::from(corner)).collect();
        let spacing = self.border.spacing_px();
        let of = |pixel: Pixel<Screen>| Distance::new(pixel.vector(), &touches, &hull, spacing);
        let outside_px = self.border.distance_outside_px(pixel);
        if outside_px == 0.0 {
            return of(pixel);
        }
        // Counted from the border: near an outlier, too, less is known than there.
        let at_border = of(self.border.nearest_inside(pixel));
        Distance { gap: at_border.gap + outside_px / spacing, hull: at_border.hull.max(of(pixel).hull) }
    }

    /// Factor on the local variance, per axis, from the touches around a place but one.
    fn local(&self, place: Vector2<f64>, except: Option<usize>) -> [f64; 3] {
        let reach_px = LOCAL_REACH * self.border.spacing_px();
        let mut weights = GLOBAL_WEIGHT;
        let mut sums = [GLOBAL_WEIGHT; 3];
        for (_, anchor) in self.anchors.iter().enumerate().filter(|&(i, _)| Some(i) != except) {
            let distance = (Vector2::from(anchor.pixel) - place).norm() / reach_px;
            let weight = anchor.weight * (-0.5 * distance.powi(2)).exp();
            weights += weight;
            for (sum, relative) in sums.iter_mut().zip(anchor.relative) {
                *sum += weight * relative;
            }
        }
        sums.map(|sum| sum / weights)
    }
}

/// Left-out blocks that tell of growth: so many reached into a gap, or out of the hull, of the
/// touches that remained.
#[derive(Clone, Copy, Default)]
struct Telling {
    gap: usize,
    outside: usize,
}

/// Distances of a pixel from touches, in spacings.
#[derive(Clone, Copy)]
struct Distance {
    /// From the nearest touch, beyond the margin.
    gap: f64,
    /// Outside of the convex hull.
    hull: f64,
}

impl Distance {
    fn new(point: Vector2<f64>, touches: &[Vector2<f64>], hull: &[Vector2<f64>], spacing: f64) -> Self {
        let nearest = touches.iter().map(|touch| (touch - point).norm()).fold(f64::INFINITY, f64::min);
        Self { gap: (nearest / spacing - MARGIN).max(0.0), hull: distance_outside(point, hull) / spacing }
    }

    /// What each part of the variance is multiplied by.
    fn growth(self) -> [f64; PARTS] {
        [1.0, self.gap.powi(2), self.hull.powi(2), self.hull.powi(4)]
    }
}

/// The parts of the variance along one axis, before they are widened for few data.
fn fitted_parts(residuals_m: &[[f64; 3]], axis: usize, distances: &[Distance]) -> [f64; PARTS] {
    let residual = |(residual, distance): (&[f64; 3], &Distance)| Evidence {
        squared: residual[axis].powi(2),
        growth: distance.growth(),
    };
    let evidence: Vec<_> = residuals_m.iter().zip(distances).map(residual).collect();
    let all = parts(&evidence, [true; PARTS]);
    let gapless = parts(&evidence, [true, false, true, true]);
    if deviance(&evidence, &gapless) - deviance(&evidence, &all) > SIGNIFICANT {
        return all;
    }
    // Noise that happens to be larger in gaps must not make it smaller elsewhere.
    [gapless[0], all[1], gapless[2], gapless[3]]
}

/// Parts as they are used: the local variance by a factor; growth outside from few blocks is
/// widened as Student's t demands; the fallback holds where blocks tell nothing of a gap.
fn widened(parts: [f64; PARTS], factor: f64, blocks: Telling, spacing_px: f64) -> [f64; PARTS] {
    let [local, gap, near, far] = parts;
    let gap = if blocks.gap == 0 { fallback_m2(GAP_SHARE, spacing_px) } else { gap };
    let outside = student_factor((blocks.outside as f64 - 1.0).max(2.0)).powi(2);
    [local * factor, gap, outside * near, outside * far]
}

/// Variance after so many spacings at the stated rate.
fn fallback_m2(spacings: f64, spacing_px: f64) -> f64 {
    (spacings * spacing_px * Spread::FALLBACK_RATE_M_PER_PX).powi(2)
}

/// How far outside of the hull left-out blocks tell of: 9 of 10 touches that were out lay nearer;
/// no distance if they are in fewer than three blocks.
fn reach(distances: &[Distance], blocks: Telling) -> f64 {
    let mut out: Vec<f64> =
        distances.iter().map(|distance| distance.hull).filter(|&hull| hull > 0.0).collect();
    out.sort_by(f64::total_cmp);
    if blocks.outside < FEWEST_BLOCKS || out.is_empty() { 0.0 } else { out[(out.len() - 1) * 9 / 10] }
}
