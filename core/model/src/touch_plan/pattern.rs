//! From patterns to targets.

use super::random::Random;
use super::{Pattern, PlanOptions, TouchArea};
use crate::pixel::Pixel;
use crate::session::{Screen, Touchscreen};

/// Places nearer than this are the same target, px.
const SAME_PX: f64 = 0.01;

/// A place to be touched.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub pixel: Pixel<Screen>,
    pub set: String,
    /// How many patterns ask for it.
    pub times: usize,
}

/// All targets, in the order of the patterns. A place that was there before gets one time more:
/// it must stay in one set, or cross-validation would be judged by what it was trained on.
pub(super) fn targets(options: &PlanOptions) -> Vec<Target> {
    let mut random = Random::new(options.seed);
    let mut targets: Vec<Target> = vec![];
    for (pixel, set) in options.patterns.iter().flat_map(|p| places(p, &options.area, &mut random)) {
        match targets.iter_mut().find(|target| target.pixel.distance_px(&pixel) < SAME_PX) {
            Some(target) => target.times += 1,
            None => targets.push(Target { pixel, set, times: 1 }),
        }
    }
    for pattern in &options.patterns {
        if let Pattern::Again { targets: count, times } = *pattern {
            for i in far_apart(&targets, count) {
                targets[i].times += times;
            }
        }
    }
    targets
}

fn places(pattern: &Pattern, area: &TouchArea, random: &mut Random) -> Vec<(Pixel<Screen>, String)> {
    match *pattern {
        Pattern::Grid { columns, rows } => (0..rows)
            .flat_map(|row| {
                (0..columns).map(move |column| {
                    (area.at(even(column, columns), even(row, rows)), format!("grid row {}", row + 1))
                })
            })
            .collect(),
        Pattern::Lines { horizontal, vertical, diagonal, points } => {
            let mut places = vec![];
            let mut line = |count: usize, name: &str, at: &dyn Fn(usize, f64) -> Pixel<Screen>| {
                for i in 0..count {
                    let set = format!("{name} {}", i + 1);
                    places.extend((0..points).map(|k| (at(i, even(k, points)), set.clone())));
                }
            };
            line(horizontal, "horizontal", &|i, along| area.at(along, inner(i, horizontal)));
            line(vertical, "vertical", &|i, along| area.at(inner(i, vertical), along));
            line(diagonal, "diagonal", &|i, along| area.at(if i == 0 { along } else { 1.0 - along }, along));
            places
        }
        Pattern::Random { count } => (0..count)
            .map(|_| {
                let (across, down) = (random.unit(), random.unit());
                (area.at(across, down), format!("random {}", quarter(across, down)))
            })
            .collect(),
        Pattern::Corners => area.corners().map(|corner| (corner, "corners".to_owned())).into(),
        Pattern::Again { .. } | Pattern::Telling { .. } => vec![],
    }
}

/// Position 0–1 of the i-th of `count` evenly spaced places, ends included.
fn even(i: usize, count: usize) -> f64 {
    if count == 1 { 0.5 } else { i as f64 / (count - 1) as f64 }
}

/// Position 0–1 of the i-th of `count` lines, ends left free: the border belongs to the grid.
fn inner(i: usize, count: usize) -> f64 {
    (i as f64 + 1.0) / (count as f64 + 1.0)
}

fn quarter(across: f64, down: f64) -> &'static str {
    match (across < 0.5, down < 0.5) {
        (true, true) => "far left",
        (false, true) => "far right",
        (true, false) => "near left",
        (false, false) => "near right",
    }
}

/// Targets far from each other: the first next to the middle, each further one farthest from all
/// before (Gonzalez 1985).
fn far_apart(targets: &[Target], count: usize) -> Vec<usize> {
    let middle = targets.iter().map(|t| t.pixel.vector()).sum::<nalgebra::Vector2<f64>>()
        / targets.len().max(1) as f64;
    let nearest = |a: &f64, b: &f64| a.total_cmp(b);
    let first = (0..targets.len()).min_by(|&a, &b| {
        nearest(&(targets[a].pixel.vector() - middle).norm(), &(targets[b].pixel.vector() - middle).norm())
    });
    let mut chosen: Vec<usize> = first.into_iter().collect();
    while chosen.len() < count.min(targets.len()) {
        let distance = |i: usize| {
            chosen
                .iter()
                .map(|&c| targets[i].pixel.distance_px(&targets[c].pixel))
                .fold(f64::INFINITY, f64::min)
        };
        let Some(next) = (0..targets.len()).max_by(|&a, &b| nearest(&distance(a), &distance(b))) else {
            break;
        };
        chosen.push(next);
    }
    chosen
}

/// Whether targets spread by 2 cm and more across the line through them.
pub(super) fn span_a_plane(targets: &[Target], screen: &Touchscreen) -> bool {
    let [u_m, v_m] = screen.pitch_m();
    let places: Vec<nalgebra::Vector2<f64>> = targets
        .iter()
        .map(|target| nalgebra::Vector2::new(target.pixel.u_px * u_m, target.pixel.v_px * v_m))
        .collect();
    let count = places.len() as f64;
    let mean = places.iter().sum::<nalgebra::Vector2<f64>>() / count;
    let scatter: nalgebra::Matrix2<f64> = places.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
    let across = crate::decompose::symmetric_eigenvalues(scatter / count).map(|found| found.min());
    targets.len() >= 3 && across.is_some_and(|variance_m2| variance_m2 > 0.02f64.powi(2))
}
