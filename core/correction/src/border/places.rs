//! Places that were touched: repeats merged, their spacing, outliers left out.

use nalgebra::{Matrix2, Vector2};
use plumbline_model::decompose;

use super::BorderError;

/// Repeats lie nearer to each other than this share of the mean spacing.
const REPEAT_SHARE: f64 = 0.2;
/// Touches whose scatter across is less than this share of that along lie on a line.
const LINE_SHARE: f64 = 0.03;
/// An outlier has fewer than [`CORE_NEIGHBORS`] others within this many spacings.
const CORE_RADIUS: f64 = 3.0;
const CORE_NEIGHBORS: usize = 2;

/// Places without outliers, and their spacing.
pub(super) struct Places {
    pub places: Vec<Vector2<f64>>,
    pub spacing: f64,
}

impl Places {
    pub fn of(points: &[Vector2<f64>]) -> Result<Self, BorderError> {
        if let Some(index) = points.iter().position(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return Err(BorderError::NotFinite { index });
        }
        let all = merged(points);
        if all.len() < 3 {
            return Err(BorderError::TooFew { found: all.len() });
        }
        let spacing = spacing(&all);
        let places = core(&all, spacing);
        if is_line(&places) {
            return Err(BorderError::OnALine);
        }
        Ok(Self { places, spacing })
    }
}

fn covariance(points: &[Vector2<f64>]) -> Matrix2<f64> {
    let n = points.len() as f64;
    let mean = points.iter().sum::<Vector2<f64>>() / n;
    points.iter().map(|p| (p - mean) * (p - mean).transpose()).sum::<Matrix2<f64>>() / n
}

fn is_line(points: &[Vector2<f64>]) -> bool {
    // What cannot be taken apart has no area that anything could be told of.
    decompose::symmetric_eigenvalues(covariance(points))
        .is_none_or(|variances| variances.min().max(0.0).sqrt() <= LINE_SHARE * variances.max().sqrt())
}

/// One place for repeats, whatever the order of the points.
fn merged(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.is_empty() {
        return sorted;
    }
    // A rectangle that is filled evenly has 12 times the area of the root of this determinant.
    let area = 12.0 * covariance(&sorted).determinant().max(0.0).sqrt();
    let nearest = REPEAT_SHARE * (area / sorted.len() as f64).sqrt();
    let mut places: Vec<Vector2<f64>> = Vec::new();
    for point in sorted {
        if places.iter().all(|place| (place - point).norm() > nearest) {
            places.push(point);
        }
    }
    places
}

/// Typical distance between neighbors, see the module's description.
fn spacing(places: &[Vector2<f64>]) -> f64 {
    let mut thirds: Vec<f64> = places.iter().filter_map(|&place| third_neighbor(places, place)).collect();
    if thirds.len() < 3 {
        return longest_link(places);
    }
    thirds.sort_by(f64::total_cmp);
    thirds[thirds.len() / 2]
}

/// Third nearest of the nearest neighbors in four directions; `None` where fewer have any.
fn third_neighbor(places: &[Vector2<f64>], place: Vector2<f64>) -> Option<f64> {
    let mut nearest = [f64::INFINITY; 4];
    for other in places {
        let step = other - place;
        let distance = step.norm();
        if distance > 0.0 {
            let sideways = step.x.abs() >= step.y.abs();
            let direction = match (sideways, step.x > 0.0, step.y > 0.0) {
                (true, true, _) => 0,
                (true, false, _) => 1,
                (false, _, true) => 2,
                (false, _, false) => 3,
            };
            nearest[direction] = nearest[direction].min(distance);
        }
    }
    nearest.sort_by(f64::total_cmp);
    Some(nearest[2]).filter(|distance| distance.is_finite())
}

/// Longest edge of the minimum spanning tree (Prim), for data too few for statistics.
fn longest_link(places: &[Vector2<f64>]) -> f64 {
    let mut distance: Vec<f64> = places.iter().map(|place| (place - places[0]).norm()).collect();
    let mut is_open = vec![true; places.len()];
    is_open[0] = false;
    let mut longest: f64 = 0.0;
    for _ in 1..places.len() {
        let Some(next) =
            (0..places.len()).filter(|&i| is_open[i]).min_by(|&a, &b| distance[a].total_cmp(&distance[b]))
        else {
            break;
        };
        longest = longest.max(distance[next]);
        is_open[next] = false;
        for (reach, place) in distance.iter_mut().zip(places) {
            *reach = reach.min((place - places[next]).norm());
        }
    }
    longest
}

fn core(places: &[Vector2<f64>], spacing: f64) -> Vec<Vector2<f64>> {
    let neighbors = |place: &Vector2<f64>| {
        // The place itself is among those near it.
        places.iter().filter(|other| (*other - place).norm() <= CORE_RADIUS * spacing).count() - 1
    };
    let core: Vec<_> = places.iter().filter(|place| neighbors(place) >= CORE_NEIGHBORS).copied().collect();
    if core.len() < 3 { places.to_vec() } else { core }
}
