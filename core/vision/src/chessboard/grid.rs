//! Grows a chessboard grid from saddle points, one neighbor at a time.
//!
//! Each step predicts the next corner from the two before it and takes the nearest saddle with
//! the opposite polarity. The prediction is local, so a fisheye's bent lines do no harm.

use std::collections::HashMap;
use std::f32::consts::{FRAC_PI_2, PI};

use nalgebra::Vector2;

use super::saddle::Saddle;

/// Saddles at integer grid positions.
pub(super) struct Grid {
    cells: HashMap<(i32, i32), usize>,
}

/// A filled rectangle of corners: positions row by row.
pub(super) struct FilledGrid {
    pub columns: usize,
    pub rows: usize,
    pub corners: Vec<Vector2<f64>>,
}

/// A corner may lie this far from its prediction, in steps.
const TOLERANCE_STEPS: f64 = 0.3;
/// Neighbors' axes differ by a quarter turn, give or take this much (rad): foreshortening.
const POLARITY_TOLERANCE_RAD: f32 = 0.6;
/// Seeds tried before giving up; bounds the time on textured scenes.
const MOST_SEEDS: usize = 300;
/// Steps of a row change by no more than this factor from one to the next.
const MOST_STEP_RATIO: f64 = 1.5;
/// Grids at least this big are not started again from another of their saddles.
const WORTH_REMEMBERING: usize = 9;
/// Length of a side of the buckets for neighbor search, pixels.
const BUCKET_PX: f64 = 24.0;

/// Saddles by place, in square buckets.
struct Index<'a> {
    saddles: &'a [Saddle],
    columns: usize,
    rows: usize,
    buckets: Vec<Vec<u32>>,
}

impl<'a> Index<'a> {
    fn new(saddles: &'a [Saddle]) -> Self {
        let far = saddles.iter().fold(Vector2::zeros(), |far: Vector2<f64>, s| far.sup(&s.at));
        let (columns, rows) = ((far.x / BUCKET_PX) as usize + 1, (far.y / BUCKET_PX) as usize + 1);
        let mut buckets = vec![Vec::new(); columns * rows];
        for (i, saddle) in saddles.iter().enumerate() {
            let (x, y) = ((saddle.at.x / BUCKET_PX) as usize, (saddle.at.y / BUCKET_PX) as usize);
            buckets[y * columns + x].push(i as u32);
        }
        Self { saddles, columns, rows, buckets }
    }

    /// Saddles within `radius_px`, unsorted.
    fn within(&self, at: Vector2<f64>, radius_px: f64) -> impl Iterator<Item = usize> + '_ {
        let low = |v: f64| ((v - radius_px) / BUCKET_PX).max(0.0) as usize;
        let high = |v: f64, count: usize| (((v + radius_px) / BUCKET_PX).max(0.0) as usize + 1).min(count);
        let (xs, ys) = (low(at.x)..high(at.x, self.columns), low(at.y)..high(at.y, self.rows));
        ys.flat_map(move |y| xs.clone().map(move |x| (x, y)))
            .flat_map(|(x, y)| &self.buckets[y * self.columns + x])
            .map(|&i| i as usize)
            .filter(move |&i| (self.saddles[i].at - at).norm_squared() <= radius_px * radius_px)
    }

    fn nearest(&self, at: Vector2<f64>, radius_px: f64, accept: impl Fn(usize) -> bool) -> Option<usize> {
        let distance = |&i: &usize| (self.saddles[i].at - at).norm_squared();
        self.within(at, radius_px).filter(|&i| accept(i)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Whether two saddles can be neighbors on a board: opposite polarity, similar contrast.
    fn can_be_neighbors(&self, a: usize, b: usize) -> bool {
        const MOST_STRENGTH_RATIO: f32 = 2.5;
        let (a, b) = (&self.saddles[a], &self.saddles[b]);
        let turn = (a.axis_rad - b.axis_rad).rem_euclid(PI);
        (turn - FRAC_PI_2).abs() < POLARITY_TOLERANCE_RAD
            && a.strength < MOST_STRENGTH_RATIO * b.strength
            && b.strength < MOST_STRENGTH_RATIO * a.strength
    }
}

/// Grows grids from the strongest saddles until `choose` likes one.
pub(super) fn first_grid<T>(saddles: &[Saddle], choose: impl Fn(&Grid) -> Option<T>) -> Option<T> {
    let index = Index::new(saddles);
    let mut used = vec![false; saddles.len()];
    for seed in 0..saddles.len().min(MOST_SEEDS) {
        if used[seed] {
            continue;
        }
        let Some(grid) = start(&index, seed).map(|grid| grow(&index, grid)) else { continue };
        if let Some(chosen) = choose(&grid) {
            return Some(chosen);
        }
        // What grew into a grid will grow into the same grid again.
        if grid.cells.len() >= WORTH_REMEMBERING {
            for &i in grid.cells.values() {
                used[i] = true;
            }
        }
    }
    None
}

/// A first square: the seed, two neighbors and the corner opposite to it.
fn start(index: &Index<'_>, seed: usize) -> Option<Grid> {
    let at = index.saddles[seed].at;
    let mut near: Vec<usize> =
        index.within(at, 120.0).filter(|&i| i != seed && index.can_be_neighbors(seed, i)).collect();
    near.sort_by(|&a, &b| (index.saddles[a].at - at).norm().total_cmp(&(index.saddles[b].at - at).norm()));
    near.truncate(6);
    for (rank, &a) in near.iter().enumerate() {
        for &b in &near[rank + 1..] {
            let (ea, eb) = (index.saddles[a].at - at, index.saddles[b].at - at);
            let sine = (ea.x * eb.y - ea.y * eb.x) / (ea.norm() * eb.norm());
            if sine.abs() < 0.4 || eb.norm() > 3.0 * ea.norm() {
                continue;
            }
            let reach = TOLERANCE_STEPS * ea.norm().min(eb.norm());
            let opposite = index.nearest(at + ea + eb, reach, |i| {
                index.can_be_neighbors(a, i) && index.can_be_neighbors(b, i)
            });
            if let Some(opposite) = opposite {
                // Keep the handedness of the image: x to the right, y down.
                let (x, y) = if sine > 0.0 { (a, b) } else { (b, a) };
                let cells = [((0, 0), seed), ((1, 0), x), ((0, 1), y), ((1, 1), opposite)];
                return Some(Grid { cells: cells.into_iter().collect() });
            }
        }
    }
    None
}

fn grow(index: &Index<'_>, mut grid: Grid) -> Grid {
    let mut used: std::collections::HashSet<usize> = grid.cells.values().copied().collect();
    let mut frontier: Vec<(i32, i32)> = grid.cells.keys().copied().collect();
    frontier.sort_unstable();
    while !frontier.is_empty() {
        let mut next = Vec::new();
        for cell in frontier {
            for direction in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
                let target = (cell.0 + direction.0, cell.1 + direction.1);
                if grid.cells.contains_key(&target) {
                    continue;
                }
                let Some((predicted, step)) = predict(index, &grid, cell, direction) else { continue };
                let from = grid.cells[&cell];
                let here = index.saddles[from].at;
                let found = index.nearest(predicted, TOLERANCE_STEPS * step, |i| {
                    let ratio = (index.saddles[i].at - here).norm() / step;
                    !used.contains(&i)
                        && index.can_be_neighbors(from, i)
                        && (1.0 / MOST_STEP_RATIO..MOST_STEP_RATIO).contains(&ratio)
                });
                if let Some(i) = found {
                    used.insert(i);
                    grid.cells.insert(target, i);
                    next.push(target);
                }
            }
        }
        frontier = next;
    }
    grid
}

/// Where the neighbor of `cell` should be, and the length of the step to it.
fn predict(index: &Index<'_>, grid: &Grid, cell: (i32, i32), d: (i32, i32)) -> Option<(Vector2<f64>, f64)> {
    let at = |c: (i32, i32)| grid.cells.get(&c).map(|&i| index.saddles[i].at);
    let here = at(cell)?;
    if let Some(behind) = at((cell.0 - d.0, cell.1 - d.1)) {
        let last = here - behind;
        // Follow perspective: steps shrink or grow steadily along a row.
        let change = at((cell.0 - 2 * d.0, cell.1 - 2 * d.1)).map(|before| last - (behind - before));
        let step = last + change.unwrap_or_default() * 0.7;
        return Some((here + step, last.norm().min(step.norm())));
    }
    let side = (d.1, d.0);
    for sign in [1, -1] {
        let beside = (cell.0 + sign * side.0, cell.1 + sign * side.1);
        if let (Some(a), Some(b)) = (at(beside), at((beside.0 + d.0, beside.1 + d.1))) {
            let step = b - a;
            return Some((here + step, step.norm()));
        }
    }
    None
}

impl Grid {
    /// The `columns` × `rows` board (or the same lying on its side) within the grid.
    ///
    /// A grid may have grown beyond the board, onto the edge of the paper; then the board is the
    /// full rectangle with the strongest corners, and what is left over beside it must be clearly
    /// weaker. `None` if there is no such rectangle.
    pub fn board(&self, saddles: &[Saddle], columns: usize, rows: usize) -> Option<FilledGrid> {
        let mut best: Option<(f32, FilledGrid)> = None;
        let (x, y) = (span(self.cells.keys().map(|c| c.0))?, span(self.cells.keys().map(|c| c.1))?);
        let shapes =
            if columns == rows { vec![(columns, rows)] } else { vec![(columns, rows), (rows, columns)] };
        for (width, height) in shapes {
            for top in y.0..=(y.1 - height as i32 + 1) {
                for left in x.0..=(x.1 - width as i32 + 1) {
                    let Some(cells) = self.rectangle((left, top), (width, height)) else { continue };
                    let weakest = cells.iter().map(|&i| saddles[i].strength).fold(f32::INFINITY, f32::min);
                    if best.as_ref().is_none_or(|(strength, _)| weakest > *strength)
                        && self.stands_out(saddles, &cells, (left, top), (width, height))
                    {
                        let corners = cells.iter().map(|&i| saddles[i].at).collect();
                        let filled = FilledGrid { columns: width, rows: height, corners };
                        if filled.is_smooth() {
                            best = Some((weakest, filled));
                        }
                    }
                }
            }
        }
        best.map(|(_, filled)| filled)
    }

    /// Saddles of a rectangle of cells, row by row; `None` if one is missing.
    fn rectangle(&self, (left, top): (i32, i32), (width, height): (usize, usize)) -> Option<Vec<usize>> {
        (top..top + height as i32)
            .flat_map(|j| (left..left + width as i32).map(move |i| (i, j)))
            .map(|cell| self.cells.get(&cell).copied())
            .collect()
    }

    /// Whether each line of cells just outside the rectangle is mostly empty or clearly weaker than
    /// the rectangle: otherwise it is a part of a bigger board.
    fn stands_out(
        &self,
        saddles: &[Saddle],
        inside: &[usize],
        (left, top): (i32, i32),
        (width, height): (usize, usize),
    ) -> bool {
        const CLEARLY_WEAKER: f32 = 0.6;
        let median = |mut strengths: Vec<f32>| {
            let middle = strengths.len() / 2;
            (!strengths.is_empty()).then(|| *strengths.select_nth_unstable_by(middle, f32::total_cmp).1)
        };
        let Some(typical) = median(inside.iter().map(|&i| saddles[i].strength).collect()) else {
            return false;
        };
        let (right, bottom) = (left + width as i32, top + height as i32);
        let row = |j: i32| (left..right).map(move |i| (i, j)).collect::<Vec<_>>();
        let column = |i: i32| (top..bottom).map(move |j| (i, j)).collect::<Vec<_>>();
        [row(top - 1), row(bottom), column(left - 1), column(right)].iter().all(|line| {
            let strengths: Vec<f32> =
                line.iter().filter_map(|cell| self.cells.get(cell)).map(|&i| saddles[i].strength).collect();
            2 * strengths.len() <= line.len()
                || median(strengths).is_none_or(|m| m < CLEARLY_WEAKER * typical)
        })
    }

    /// The densest full rectangle: rows and columns that are less than half filled at the rim are
    /// peeled off; `None` if what remains has holes.
    pub fn filled(&self, saddles: &[Saddle]) -> Option<FilledGrid> {
        let mut x = span(self.cells.keys().map(|c| c.0))?;
        let mut y = span(self.cells.keys().map(|c| c.1))?;
        loop {
            let full = |cells: usize, length: i32| 2 * cells > length as usize;
            let row = |j: i32| (x.0..=x.1).filter(|&i| self.cells.contains_key(&(i, j))).count();
            let column = |i: i32| (y.0..=y.1).filter(|&j| self.cells.contains_key(&(i, j))).count();
            let (width, height) = (x.1 - x.0 + 1, y.1 - y.0 + 1);
            if width < 2 || height < 2 {
                return None;
            }
            if !full(row(y.0), width) {
                y.0 += 1;
            } else if !full(row(y.1), width) {
                y.1 -= 1;
            } else if !full(column(x.0), height) {
                x.0 += 1;
            } else if !full(column(x.1), height) {
                x.1 -= 1;
            } else {
                break;
            }
        }
        let mut corners = Vec::new();
        for j in y.0..=y.1 {
            for i in x.0..=x.1 {
                corners.push(saddles[*self.cells.get(&(i, j))?].at);
            }
        }
        let filled =
            FilledGrid { columns: (x.1 - x.0 + 1) as usize, rows: (y.1 - y.0 + 1) as usize, corners };
        filled.is_smooth().then_some(filled)
    }
}

impl FilledGrid {
    /// Whether rows and columns run smoothly, as on a flat board seen through any lens; random
    /// texture that happened to form a grid does not.
    fn is_smooth(&self) -> bool {
        /// Most that a corner may be off the middle between its neighbors, in steps.
        const MOST_BEND: f64 = 0.12;
        let at = |i: usize, j: usize| self.corners[j * self.columns + i];
        let bent = |a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>| {
            ((a + c) * 0.5 - b).norm() > MOST_BEND * (c - a).norm() * 0.5 + 0.5
        };
        let rows_bent =
            (0..self.rows).any(|j| (2..self.columns).any(|i| bent(at(i - 2, j), at(i - 1, j), at(i, j))));
        let columns_bent =
            (0..self.columns).any(|i| (2..self.rows).any(|j| bent(at(i, j - 2), at(i, j - 1), at(i, j))));
        !rows_bent && !columns_bent
    }
}

fn span(values: impl Iterator<Item = i32>) -> Option<(i32, i32)> {
    values.fold(None, |range: Option<(i32, i32)>, v| {
        Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    })
}
