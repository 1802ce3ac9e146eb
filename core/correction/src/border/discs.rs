//! The union of equal discs, and the exact distance to its edge.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

/// Discs of one radius about places.
pub(super) struct Discs {
    places: Vec<Vector2<f64>>,
    radius: f64,
    edge: Vec<Arc>,
}

/// A piece of a circle that no other disc covers, counter-clockwise.
struct Arc {
    center: Vector2<f64>,
    from_rad: f64,
    sweep_rad: f64,
}

impl Discs {
    pub fn new(places: Vec<Vector2<f64>>, radius: f64) -> Self {
        let edge = (0..places.len()).flat_map(|i| uncovered(&places, i, radius)).collect();
        Self { places, radius, edge }
    }

    /// Distance to the edge of the union; negative outside.
    fn depth(&self, point: Vector2<f64>) -> f64 {
        let mut distance = f64::INFINITY;
        for arc in &self.edge {
            // The circle is at least as near as its arc, and quicker to measure.
            if ((point - arc.center).norm() - self.radius).abs() < distance {
                distance = distance.min(arc.distance(point, self.radius));
            }
        }
        if self.nearest_squared(point) <= self.radius.powi(2) { distance } else { -distance }
    }

    /// Whether the edge is at least `depth` away, from inside.
    pub fn is_deep(&self, point: Vector2<f64>, depth: f64) -> bool {
        let nearest = self.nearest_squared(point);
        // From the place itself the edge is a radius away.
        nearest <= (self.radius - depth).powi(2)
            || (nearest <= self.radius.powi(2) && self.depth(point) >= depth)
    }

    fn nearest_squared(&self, point: Vector2<f64>) -> f64 {
        self.places.iter().map(|place| (place - point).norm_squared()).fold(f64::INFINITY, f64::min)
    }
}

impl Arc {
    fn distance(&self, point: Vector2<f64>, radius: f64) -> f64 {
        let offset = point - self.center;
        let angle = offset.y.atan2(offset.x);
        if (angle - self.from_rad).rem_euclid(TAU) <= self.sweep_rad {
            return (offset.norm() - radius).abs();
        }
        let end = |angle: f64| (offset - radius * Vector2::new(angle.cos(), angle.sin())).norm();
        end(self.from_rad).min(end(self.from_rad + self.sweep_rad))
    }
}

/// The pieces of the circle about one place that lie in no other disc.
fn uncovered(places: &[Vector2<f64>], i: usize, radius: f64) -> Vec<Arc> {
    let center = places[i];
    let mut covered: Vec<(f64, f64)> = Vec::new();
    for (j, other) in places.iter().enumerate() {
        let step = other - center;
        let distance = step.norm();
        if i != j && distance < 2.0 * radius {
            let half = (distance / (2.0 * radius)).acos();
            let from = (step.y.atan2(step.x) - half).rem_euclid(TAU);
            covered.push((from, from + 2.0 * half));
        }
    }
    if covered.is_empty() {
        return vec![Arc { center, from_rad: -PI, sweep_rad: TAU }];
    }
    covered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let first = covered[0].0;
    // An interval that goes on past the start of the circle covers its beginning.
    let around = covered.iter().map(|interval| interval.1 - TAU).fold(f64::NEG_INFINITY, f64::max);
    let mut reached = covered[0].1.max(around);
    let mut arcs = Vec::new();
    for &(from, to) in covered[1..].iter().chain(&[(first + TAU, first + TAU)]) {
        if from > reached {
            arcs.push(Arc { center, from_rad: reached, sweep_rad: from - reached });
        }
        reached = reached.max(to);
    }
    arcs
}
