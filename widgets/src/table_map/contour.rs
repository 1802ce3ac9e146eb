//! Lines of equal value (marching squares), joined from cell to cell.

use std::collections::BTreeMap;

use super::ScalarField;

/// A grid edge between two neighboring nodes (row, column); a line crosses it at most once.
type Edge = ((usize, usize), (usize, usize));

/// Where a line crosses an edge, and the crossings that it is joined with: one in each of the
/// two cells that share the edge.
#[derive(Default)]
struct Crossing {
    at_m: [f64; 2],
    joined: Vec<Edge>,
}

/// The lines where the field crosses a level, each as table positions in meters; closed ones end
/// where they begin. Cells with a missing node have none.
pub(super) fn lines(field: &ScalarField, level: f64) -> Vec<Vec<[f64; 2]>> {
    let [rows, columns] = field.nodes();
    let mut crossings = BTreeMap::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            cell(field, level, [row, column], &mut crossings);
        }
    }
    // Open lines are followed from their ends first; what is left then is closed.
    let ends: Vec<Edge> =
        crossings.iter().filter(|(_, crossing)| crossing.joined.len() == 1).map(|(edge, _)| *edge).collect();
    let all: Vec<Edge> = crossings.keys().copied().collect();
    ends.into_iter().chain(all).filter_map(|edge| follow(edge, &mut crossings)).collect()
}

/// Takes one line out of the crossings; `None` if it was taken before.
fn follow(start: Edge, crossings: &mut BTreeMap<Edge, Crossing>) -> Option<Vec<[f64; 2]>> {
    let mut line = Vec::new();
    let mut next = Some(start);
    while let Some(edge) = next {
        let Some(crossing) = crossings.remove(&edge) else { break };
        line.push(crossing.at_m);
        let open = crossing.joined.iter().copied().find(|other| crossings.contains_key(other));
        if open.is_none() && line.len() > 2 && crossing.joined.contains(&start) {
            line.push(line[0]);
        }
        next = open;
    }
    (line.len() > 1).then_some(line)
}

fn cell(
    field: &ScalarField,
    level: f64,
    [row, column]: [usize; 2],
    crossings: &mut BTreeMap<Edge, Crossing>,
) {
    let corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)];
    let mut above = [0.0; 4];
    for (value, (r, c)) in above.iter_mut().zip(corners) {
        match field.node(r, c) {
            Some(found) => *value = found - level,
            None => return,
        }
    }
    let mut crossed = Vec::with_capacity(4);
    for i in 0..4 {
        let j = (i + 1) % 4;
        if (above[i] >= 0.0) != (above[j] >= 0.0) {
            let part = above[i] / (above[i] - above[j]);
            let along = |a: usize, b: usize| a as f64 + (b as f64 - a as f64) * part;
            let (a, b) = (corners[i], corners[j]);
            let edge = (a.min(b), a.max(b));
            let at_m = field.node_m(along(a.0, b.0), along(a.1, b.1));
            crossings.entry(edge).or_default().at_m = at_m;
            crossed.push(edge);
        }
    }
    let mut join = |a: Edge, b: Edge| {
        crossings.entry(a).or_default().joined.push(b);
        crossings.entry(b).or_default().joined.push(a);
    };
    match crossed[..] {
        [a, b] => join(a, b),
        // A saddle: the middle decides which corners belong together.
        [a, b, c, d] if (above.iter().sum::<f64>() >= 0.0) == (above[0] >= 0.0) => {
            join(a, b);
            join(c, d);
        }
        [a, b, c, d] => {
            join(d, a);
            join(b, c);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Quantity;

    const SQUARE: [[f64; 2]; 2] = [[-1.0, 1.0]; 2];

    fn sample(value: impl FnMut([f64; 2]) -> Option<f64>) -> ScalarField {
        ScalarField::sample("test", Quantity::Length, SQUARE[0], SQUARE[1], [81, 81], value)
    }

    fn length_m(line: &[[f64; 2]]) -> f64 {
        line.windows(2).map(|p| (p[0][0] - p[1][0]).hypot(p[0][1] - p[1][1])).sum()
    }

    #[test]
    fn the_level_of_a_cone_is_one_closed_circle() {
        let found = lines(&sample(|[x, y]| Some(x.hypot(y))), 0.6);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].first(), found[0].last());
        assert!((length_m(&found[0]) - 0.6 * std::f64::consts::TAU).abs() < 0.01);
        assert!(found[0].iter().all(|[x, y]| (x.hypot(*y) - 0.6).abs() < 1e-3));
    }

    #[test]
    fn a_slope_has_one_line_across() {
        let found = lines(&sample(|[x, y]| Some(x + 0.3 * y)), 0.05);
        assert_eq!(found.len(), 1);
        assert!((length_m(&found[0]) - 2.0 * (1.0f64 + 0.09).sqrt()).abs() < 1e-6);
    }

    #[test]
    fn a_saddle_has_two_lines() {
        let found = lines(&sample(|[x, y]| Some(x * y)), 0.1);
        assert_eq!(found.len(), 2);
        assert!(found.iter().flatten().all(|[x, y]| (x * y - 0.1).abs() < 1e-3));
    }

    #[test]
    fn no_lines_where_the_field_is_unknown_or_flat() {
        let found = lines(&sample(|[x, y]| (x > 0.0).then_some(y)), 0.05);
        assert!(!found.is_empty() && found.iter().flatten().all(|at| at[0] > 0.0));
        assert!(lines(&sample(|_| Some(2.0)), 1.0).is_empty());
    }
}
