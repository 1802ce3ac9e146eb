//! Closed polygons around an area that is known point by point, by marching squares.

use std::collections::BTreeMap;

use nalgebra::Vector2;

/// Nodes at which the area is asked for.
pub(super) struct Lattice {
    pub origin: Vector2<f64>,
    pub cell: f64,
    /// Nodes along x and y.
    pub size: (usize, usize),
}

/// Edge of a cell: the node it starts at, and whether it goes along y.
type Edge = (usize, usize, bool);

/// Bisections of a crossing: to a thousandth of a cell.
const BISECTIONS: usize = 10;

impl Lattice {
    fn node(&self, i: usize, j: usize) -> Vector2<f64> {
        self.origin + self.cell * Vector2::new(i as f64, j as f64)
    }

    /// Polygons with the area on the left where y points up. The rim of the lattice must lie
    /// outside of it.
    pub fn rings(&self, is_inside: impl Fn(Vector2<f64>) -> bool) -> Vec<Vec<Vector2<f64>>> {
        let (width, height) = self.size;
        let is_in: Vec<bool> =
            (0..width * height).map(|k| is_inside(self.node(k % width, k / width))).collect();
        let mut next = BTreeMap::new();
        for j in 0..height - 1 {
            for i in 0..width - 1 {
                let corners =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| is_in[j * width + i]);
                if corners.contains(&true) && corners.contains(&false) {
                    let middle = self.node(i, j) + Vector2::repeat(self.cell / 2.0);
                    link(i, j, corners, || is_inside(middle), &mut next);
                }
            }
        }
        let mut rings = Vec::new();
        while let Some((&start, _)) = next.iter().next() {
            let mut ring = Vec::new();
            let mut edge = start;
            while let Some(following) = next.remove(&edge) {
                ring.push(self.crossing(edge, &is_inside));
                edge = following;
            }
            rings.push(ring);
        }
        rings
    }

    /// Where the area ends on an edge, from inside.
    fn crossing(&self, (i, j, along_y): Edge, is_inside: impl Fn(Vector2<f64>) -> bool) -> Vector2<f64> {
        let start = self.node(i, j);
        let end = if along_y { self.node(i, j + 1) } else { self.node(i + 1, j) };
        let (mut inside, mut outside) = if is_inside(start) { (start, end) } else { (end, start) };
        for _ in 0..BISECTIONS {
            let middle = (inside + outside) / 2.0;
            if is_inside(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    }
}

/// Adds the segments of one cell: from the edge where the tour around the cell leaves the area to
/// the one where it had entered it; in a saddle whose middle is inside, to the one where it enters
/// again.
fn link(
    i: usize,
    j: usize,
    corners: [bool; 4],
    middle_is_in: impl Fn() -> bool,
    next: &mut BTreeMap<Edge, Edge>,
) {
    let edges = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
    let changes = |k: usize| corners[k] != corners[(k + 1) % 4];
    let is_saddle = (0..4).all(changes);
    for leave in (0..4).filter(|&k| corners[k] && changes(k)) {
        let backward = !(is_saddle && middle_is_in());
        let enter = (1..4).map(|step| if backward { leave + 4 - step } else { leave + step } % 4);
        if let Some(enter) = enter.into_iter().find(|&k| !corners[k] && changes(k)) {
            next.insert(edges[leave], edges[enter]);
        }
    }
}
