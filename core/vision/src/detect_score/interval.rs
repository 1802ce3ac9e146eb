//! How far a score can be trusted: what it would have been on other scenes of the same kind.
//!
//! The scenes are drawn again with replacement (the bootstrap; Efron and Tibshirani, *An
//! Introduction to the Bootstrap*, 1993) and scored again; images of one scene stand or fall
//! together, since they are no independent witnesses.

use std::collections::BTreeMap;

use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};
use serde::Serialize;

use super::accumulate::curve;
use super::summary::{ClassScores, Scores, mean};

/// Fewer scenes with a class than this say nothing about other scenes.
pub const FEWEST_SCENES: usize = 5;

/// How intervals are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalOptions {
    /// How often the scenes are drawn.
    pub draws: usize,
    /// Another seed draws others.
    pub seed: u64,
    /// Part of the draws that the interval holds.
    pub level: f64,
}

impl Default for IntervalOptions {
    fn default() -> Self {
        Self { draws: 400, seed: 1, level: 0.95 }
    }
}

/// Where a score would mostly lie on other scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Intervals of one class, or of the mean over classes. `None`: too few scenes
/// ([`FEWEST_SCENES`]) to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Intervals {
    /// Of mAP50–95.
    pub ap: Option<Interval>,
    /// Of mAP50.
    pub ap50: Option<Interval>,
}

/// How far scores can be trusted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScoreIntervals {
    /// Over all classes.
    pub overall: Intervals,
    /// Of each class.
    pub per_class: Vec<Intervals>,
    /// Of the mean over each group of classes that was asked for.
    pub groups: Vec<Intervals>,
}

/// Scores of one class in one draw.
type Draw = Option<[f64; 2]>;

impl Scores {
    /// Intervals over all classes, per class, and of the mean over groups of classes. `scenes` names
    /// the scene of every image, in the order of the images that were scored.
    pub fn intervals(
        &self,
        scenes: &[&str],
        groups: &[Vec<usize>],
        options: &IntervalOptions,
    ) -> ScoreIntervals {
        let mut members: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (image, scene) in scenes.iter().enumerate() {
            members.entry(scene).or_default().push(image);
        }
        let members: Vec<Vec<usize>> = members.into_values().collect();
        let draws: Vec<Vec<Draw>> = (0..options.draws)
            .into_par_iter()
            .map(|draw| self.draw(&members, scenes.len(), options.seed, draw as u64))
            .collect();
        let of = |classes: &[usize]| {
            let one = |draw: &Vec<Draw>, number: usize| {
                mean(classes.iter().filter_map(|class| Some((*draw.get(*class)?)?[number])))
            };
            let over = |number: usize| draws.iter().filter_map(|draw| one(draw, number)).collect();
            if self.is_seen_enough(classes, &members) {
                self.between(over, options.level)
            } else {
                Intervals::default()
            }
        };
        let all: Vec<usize> = (0..self.per_class.len()).collect();
        ScoreIntervals {
            overall: if members.len() >= FEWEST_SCENES { of(&all) } else { Intervals::default() },
            per_class: all.iter().map(|class| of(&[*class])).collect(),
            groups: groups.iter().map(|group| of(group)).collect(),
        }
    }

    /// Whether enough scenes have something of these classes.
    fn is_seen_enough(&self, classes: &[usize], scenes: &[Vec<usize>]) -> bool {
        let there = |class: &usize, image: &usize| {
            let class = self.per_class.get(*class);
            class.and_then(|class| class.things_per_image.get(*image)).is_some_and(|things| *things > 0)
        };
        let has =
            |images: &&Vec<usize>| images.iter().any(|image| classes.iter().any(|class| there(class, image)));
        scenes.iter().filter(has).count() >= FEWEST_SCENES
    }

    /// Draws scenes once and scores every class on them.
    fn draw(&self, scenes: &[Vec<usize>], images: usize, seed: u64, draw: u64) -> Vec<Draw> {
        let mut random = Random::new(seed, draw);
        let mut weights = vec![0u32; images];
        for _ in 0..scenes.len() {
            for &image in &scenes[random.below(scenes.len())] {
                weights[image] += 1;
            }
        }
        let at_half = self.iou.index_of(0.5);
        let mut scratch = Vec::new();
        let score = |class: &ClassScores| {
            let pairs = class.things_per_image.iter().zip(&weights);
            let things: u32 = pairs.map(|(things, weight)| things * weight).sum();
            if things == 0 {
                return None;
            }
            let weight = |image: u32| f64::from(weights[image as usize]);
            let precision: Vec<f64> = (0..self.iou.values().len())
                .map(|bit| {
                    curve(&class.judged, bit, f64::from(things), weight, &mut scratch).average_precision
                })
                .collect();
            let half = at_half.map_or(f64::NAN, |bit| precision[bit]);
            Some([mean(precision.into_iter())?, half])
        };
        self.per_class.iter().map(score).collect()
    }

    fn between(&self, of: impl Fn(usize) -> Vec<f64>, level: f64) -> Intervals {
        let ap50 = self.iou.index_of(0.5).and_then(|_| middle(of(1), level));
        Intervals { ap: middle(of(0), level), ap50 }
    }
}

/// The middle part of the values.
fn middle(mut values: Vec<f64>, level: f64) -> Option<Interval> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)? as f64;
    let at = |part: f64| {
        let place = part * last;
        let (below, above) = (place.floor() as usize, place.ceil() as usize);
        values[below] + (values[above] - values[below]) * (place - place.floor())
    };
    let tail = 0.5 * (1.0 - level);
    Some(Interval { low: at(tail), high: at(1.0 - tail) })
}

/// SplitMix64 (Steele, Lea and Flood, 2014): the same draws on every machine.
struct Random(u64);

impl Random {
    fn new(seed: u64, draw: u64) -> Self {
        let mut random =
            Self(seed.wrapping_mul(0xd134_2543_de82_ef95) ^ draw.wrapping_mul(0x2545_f491_4f6c_dd1d));
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.next()) * end as u128) >> 64) as usize
    }
}
