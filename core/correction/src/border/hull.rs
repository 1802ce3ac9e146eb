//! Convex hull of points, and the distance from it.

use nalgebra::Vector2;

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
pub(super) fn convex_hull(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull = half_hull(sorted.iter());
    hull.pop();
    let mut upper = half_hull(sorted.iter().rev());
    upper.pop();
    hull.extend(upper);
    hull
}

fn half_hull<'a>(points: impl Iterator<Item = &'a Vector2<f64>>) -> Vec<Vector2<f64>> {
    let mut half: Vec<Vector2<f64>> = Vec::new();
    for &point in points {
        while let [.., a, b] = half[..] {
            if (b - a).perp(&(point - b)) > 0.0 {
                break;
            }
            half.pop();
        }
        half.push(point);
    }
    half
}

/// Distance from a convex polygon, or from the segment or point that is left of it; 0 inside.
pub(super) fn distance_outside(point: Vector2<f64>, hull: &[Vector2<f64>]) -> f64 {
    let sides = (0..hull.len()).map(|i| (hull[i], hull[(i + 1) % hull.len()]));
    if hull.len() > 2 && sides.clone().all(|(a, b)| (b - a).perp(&(point - a)) >= 0.0) {
        return 0.0;
    }
    let from_side = |(a, b): (Vector2<f64>, Vector2<f64>)| {
        let along = b - a;
        let share = (point - a).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (a + share.clamp(0.0, 1.0) * along - point).norm()
    };
    sides.map(from_side).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(rows: &[[f64; 2]]) -> Vec<Vector2<f64>> {
        rows.iter().map(|&row| Vector2::from(row)).collect()
    }

    #[test]
    fn the_hull_of_a_square_are_its_corners() {
        let inner = [[1.0, 1.0], [0.5, 1.5], [1.0, 0.0]];
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let hull = convex_hull(&points(&[&inner[..], &corners[..]].concat()));
        assert_eq!(hull, points(&corners));
        for (point, distance) in [([1.0, 1.9], 0.0), ([3.0, 1.0], 1.0), ([5.0, 6.0], 5.0), ([2.0, 2.0], 0.0)]
        {
            assert!((distance_outside(Vector2::from(point), &hull) - distance).abs() < 1e-12, "{point:?}");
        }
    }

    #[test]
    fn without_an_area_the_distance_is_that_of_the_line_or_point() {
        let line = convex_hull(&points(&[[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]]));
        assert_eq!(distance_outside(Vector2::new(2.0, 0.5), &line), 0.5);
        let point = convex_hull(&points(&[[1.0, 1.0], [1.0, 1.0]]));
        assert_eq!(distance_outside(Vector2::new(1.0, 3.0), &point), 2.0);
    }
}
