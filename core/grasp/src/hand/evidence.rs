//! How much each pixel speaks for the hand and against what was there before: the logarithm of the
//! ratio of two likelihoods.
//!
//! What the hand looks like is learned from the image itself, as a histogram of colors. What lies
//! behind it is known from the image taken before, up to noise, small sways of the head and shadows;
//! without one, it too is a histogram, of the colors around the hand.

use image::RgbImage;

use super::shape::Part;
use super::view::Region;

/// No pixel counts more than this, either way: colors are no proof.
const MOST: f32 = 3.0;
/// Standard deviation of a channel between two images of the same thing, 0–255.
const NOISE: f32 = 3.5;
/// The head sways by about this much between two images, px.
const SWAY_PX: f32 = 0.25;
/// Share of pixels of the background that lie in a new shadow, and that changed for other reasons.
const SHADOWED: f32 = 0.12;
const CHANGED: f32 = 0.03;
/// A shadow leaves at least this part of the brightness (as coded in the image).
const DARKEST_SHADOW: f32 = 0.4;
/// Density of colors of which nothing is known.
const ANY_COLOR: f32 = 1.0 / (256.0 * 256.0 * 256.0);
/// Share of pixels of the hand that have any color.
const ODD: f32 = 0.15;
/// A pixel has changed when its difference is this many times the noise.
const CHANGE_SIGMAS: f32 = 4.0;

/// Bins of a channel: finer where it is dark, as noise is.
const BINS: usize = 16;

fn bin(value: f32) -> usize {
    (((value.clamp(0.0, 255.0) / 256.0).sqrt() * BINS as f32) as usize).min(BINS - 1)
}

/// Width of a bin in levels.
fn width(bin: usize) -> f32 {
    let edge = |i: usize| (i as f32 / BINS as f32).powi(2) * 256.0;
    edge(bin + 1) - edge(bin)
}

/// The bin of a color in the cube of all.
fn cell(color: [f32; 3]) -> u16 {
    let [r, g, b] = color.map(bin);
    ((r * BINS + g) * BINS + b) as u16
}

/// Density of colors, as logarithms.
pub(super) struct Colors {
    log_density: Vec<f32>,
}

impl Colors {
    /// From samples; each counts a little in the bins beside its own.
    fn of(samples: impl Iterator<Item = u16>) -> Option<Self> {
        let mut mass = vec![0.0f32; BINS * BINS * BINS];
        let mut count = 0u32;
        for cell in samples {
            mass[usize::from(cell)] += 1.0;
            count += 1;
        }
        if count < 30 {
            return None;
        }
        for stride in [1, BINS, BINS * BINS] {
            mass = blurred(&mass, stride);
        }
        let total: f32 = mass.iter().sum();
        for (i, cell) in mass.iter_mut().enumerate() {
            let volume = width(i / BINS / BINS) * width(i / BINS % BINS) * width(i % BINS);
            *cell = ((1.0 - ODD) * *cell / (total * volume) + ODD * ANY_COLOR).ln();
        }
        Some(Self { log_density: mass })
    }

    fn log(&self, cell: u16) -> f32 {
        self.log_density[usize::from(cell)]
    }
}

/// One axis of the cube of bins, blurred with (1, 2, 1).
fn blurred(mass: &[f32], stride: usize) -> Vec<f32> {
    (0..mass.len())
        .map(|i| {
            let place = i / stride % BINS;
            let before = if place > 0 { mass[i - stride] } else { mass[i] };
            let after = if place + 1 < BINS { mass[i + stride] } else { mass[i] };
            0.25 * before + 0.5 * mass[i] + 0.25 * after
        })
        .collect()
}

/// A pixel's color as numbers; the nearest pixel of the image beyond its edge.
pub(super) fn color(image: &RgbImage, u: i32, v: i32) -> [f32; 3] {
    let clamp = |at: i32, size: u32| at.clamp(0, size as i32 - 1) as u32;
    image.get_pixel(clamp(u, image.width()), clamp(v, image.height())).0.map(f32::from)
}

/// What is known of one eye's pixels in a region.
pub(super) struct Evidence {
    pub region: Region,
    /// Colors now, by their bins.
    now: Vec<u16>,
    /// Logarithm of the density of the color now if nothing is in front of what was there; and
    /// whether it has changed. `None` without an image before.
    still: Option<Vec<(f32, bool)>>,
}

impl Evidence {
    pub fn new(region: Region, now: &RgbImage, before: Option<&RgbImage>) -> Self {
        let colors: Vec<[f32; 3]> =
            (0..region.len()).map(|i| region.pixel(i)).map(|(u, v)| color(now, u, v)).collect();
        let still = before.map(|before| {
            let one = |(i, now): (usize, &[f32; 3])| {
                let (u, v) = region.pixel(i);
                let (density, changed) = density_if_still(*now, before, u, v);
                (density.ln(), changed)
            };
            colors.iter().enumerate().map(one).collect()
        });
        Self { region, now: colors.into_iter().map(cell).collect(), still }
    }

    /// Whether there is an image from before.
    pub fn knows_before(&self) -> bool {
        self.still.is_some()
    }

    /// Whether a pixel differs from before; `None` without an image before.
    pub fn has_changed(&self, index: usize) -> Option<bool> {
        self.still.as_ref().map(|still| still[index].1)
    }

    /// Colors of pixels that a rule chooses.
    pub fn colors(&self, chosen: impl Fn(usize) -> bool) -> Option<Colors> {
        Colors::of((0..self.region.len()).filter(|i| chosen(*i)).map(|i| self.now[i]))
    }

    /// For every pixel how much it speaks for the hand (for the forearm where `labels` say so) and
    /// against the background.
    pub fn ratios(
        &self,
        hand: &Colors,
        forearm: Option<&Colors>,
        around: Option<&Colors>,
        labels: &[Option<Part>],
    ) -> Vec<f32> {
        (0..self.region.len())
            .map(|i| {
                let now = self.now[i];
                let front = match (labels[i], forearm) {
                    (Some(Part::Forearm), Some(forearm)) => forearm.log(now),
                    _ => hand.log(now),
                };
                let behind = match (&self.still, around) {
                    (Some(still), _) => still[i].0,
                    (None, Some(around)) => around.log(now),
                    (None, None) => ANY_COLOR.ln(),
                };
                (front - behind).clamp(-MOST, MOST)
            })
            .collect()
    }
}

/// Density of a color if what was there before still is, perhaps in a shadow; and whether it is
/// clearly another.
fn density_if_still(now: [f32; 3], before: &RgbImage, u: i32, v: i32) -> (f32, bool) {
    let was = color(before, u, v);
    let beside = [(1, 0), (0, 1)].map(|(du, dv)| {
        let (next, last) = (color(before, u + du, v + dv), color(before, u - du, v - dv));
        (0..3).map(|c| (0.5 * (next[c] - last[c])).powi(2)).sum::<f32>() / 3.0
    });
    let variance = NOISE * NOISE + SWAY_PX * SWAY_PX * (beside[0] + beside[1]);
    let sigma = variance.sqrt();
    let normal = |square: f32, dimensions: i32| {
        (-0.5 * square / variance).exp() / (sigma * (2.0 * std::f32::consts::PI).sqrt()).powi(dimensions)
    };
    let square: f32 = (0..3).map(|c| (now[c] - was[c]).powi(2)).sum();
    let (own, length): (f32, f32) =
        ((0..3).map(|c| now[c] * was[c]).sum(), (0..3).map(|c| was[c] * was[c]).sum::<f32>().max(1.0));
    let share = own / length;
    let aside: f32 = (0..3).map(|c| (now[c] - share * was[c]).powi(2)).sum();
    let in_shadow = if (DARKEST_SHADOW..1.0).contains(&share) {
        normal(aside, 2) / ((1.0 - DARKEST_SHADOW) * length.sqrt())
    } else {
        0.0
    };
    let density = (1.0 - SHADOWED - CHANGED) * normal(square, 3) + SHADOWED * in_shadow + CHANGED * ANY_COLOR;
    (density, square > (CHANGE_SIGMAS * sigma).powi(2))
}
