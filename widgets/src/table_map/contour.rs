//! Lines of equal value (marching squares).

use super::ScalarField;

/// The segments where the field crosses a level, as pairs of table positions in meters. Cells
/// with a missing node have none.
pub(super) fn segments(field: &ScalarField, level: f64) -> Vec<[[f64; 2]; 2]> {
    let [rows, columns] = field.nodes();
    let mut segments = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            cell(field, level, row, column, &mut segments);
        }
    }
    segments
}

fn cell(field: &ScalarField, level: f64, row: usize, column: usize, segments: &mut Vec<[[f64; 2]; 2]>) {
    let corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)];
    let mut above = [0.0; 4];
    for (value, (r, c)) in above.iter_mut().zip(corners) {
        match field.node(r, c) {
            Some(found) => *value = found - level,
            None => return,
        }
    }
    let mut crossings = Vec::with_capacity(4);
    for i in 0..4 {
        let j = (i + 1) % 4;
        if (above[i] >= 0.0) != (above[j] >= 0.0) {
            let part = above[i] / (above[i] - above[j]);
            let at = |k: fn((usize, usize)) -> usize| {
                let (a, b) = (k(corners[i]) as f64, k(corners[j]) as f64);
                a + (b - a) * part
            };
            crossings.push(field.node_m(at(|c| c.0), at(|c| c.1)));
        }
    }
    match crossings[..] {
        [a, b] => segments.push([a, b]),
        // A saddle: the middle decides which corners belong together.
        [a, b, c, d] => {
            let middle_above = above.iter().sum::<f64>() >= 0.0;
            if middle_above == (above[0] >= 0.0) {
                segments.extend([[a, b], [c, d]]);
            } else {
                segments.extend([[d, a], [b, c]]);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Quantity;

    #[test]
    fn the_level_of_a_cone_is_a_circle() {
        let cone =
            ScalarField::sample("r", Quantity::Length, [-1.0, 1.0], [-1.0, 1.0], [81, 81], |[x, y]| {
                Some(x.hypot(y))
            });
        let found = segments(&cone, 0.6);
        let length: f64 = found.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length - 0.6 * std::f64::consts::TAU).abs() < 0.01, "{length}");
        assert!(found.iter().flatten().all(|[x, y]| (x.hypot(*y) - 0.6).abs() < 1e-3));
    }

    #[test]
    fn no_lines_where_the_field_is_unknown_or_flat() {
        let half = |[x, y]: [f64; 2]| (x > 0.0).then_some(y);
        let field = ScalarField::sample("y", Quantity::Length, [-1.0, 1.0], [-1.0, 1.0], [21, 21], half);
        let found = segments(&field, 0.05);
        assert!(!found.is_empty() && found.iter().flatten().all(|at| at[0] > 0.0));
        let flat = ScalarField::sample("c", Quantity::Length, [0.0, 1.0], [0.0, 1.0], [5, 5], |_| Some(2.0));
        assert!(segments(&flat, 1.0).is_empty());
    }
}
