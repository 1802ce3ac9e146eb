//! Counts of corners in cells of an image.

/// Cells per side; about as many as a board has corners.
const CELLS: [usize; 2] = [12, 9];

const REGIONS: [[&str; 3]; 3] = [
    ["top left", "top", "top right"],
    ["left", "middle", "right"],
    ["bottom left", "bottom", "bottom right"],
];

/// How many corners fell into each cell of one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoverageGrid {
    size_px: [u32; 2],
    counts: Vec<u32>,
    reachable: Vec<bool>,
}

impl CoverageGrid {
    /// An empty grid over an image of this size.
    pub fn new(size_px: [u32; 2]) -> Self {
        let cells = CELLS[0] * CELLS[1];
        Self { size_px, counts: vec![0; cells], reachable: vec![true; cells] }
    }

    /// Takes cells out of the count whose center is outside of what the lens shows.
    pub fn with_reachable(mut self, is_reachable: impl Fn([f64; 2]) -> bool) -> Self {
        for row in 0..CELLS[1] {
            for column in 0..CELLS[0] {
                let center_px = [0, 1].map(|i| {
                    let cell = [column, row][i] as f64 + 0.5;
                    cell * f64::from(self.size_px[i]) / CELLS[i] as f64 - 0.5
                });
                self.reachable[row * CELLS[0] + column] = is_reachable(center_px);
            }
        }
        self
    }

    /// Counts a corner; one outside the image counts nothing.
    pub fn add(&mut self, at_px: [f64; 2]) {
        let cell = [0, 1].map(|i| (at_px[i] + 0.5) / f64::from(self.size_px[i]) * CELLS[i] as f64);
        let inside = |i: usize| cell[i] >= 0.0 && cell[i] < CELLS[i] as f64;
        if inside(0) && inside(1) {
            self.counts[cell[1] as usize * CELLS[0] + cell[0] as usize] += 1;
        }
    }

    /// Forgets all corners.
    pub fn clear(&mut self) {
        self.counts.fill(0);
    }

    /// Image size in pixels.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Columns and rows.
    pub fn cells(&self) -> [usize; 2] {
        CELLS
    }

    /// Corners in a cell.
    pub fn count(&self, column: usize, row: usize) -> u32 {
        self.counts[row * CELLS[0] + column]
    }

    /// Whether corners can appear in a cell.
    pub fn is_reachable(&self, column: usize, row: usize) -> bool {
        self.reachable[row * CELLS[0] + column]
    }

    /// Part of the reachable cells that hold a corner, 0..=1; 1 if none can be reached.
    pub fn fraction(&self) -> f64 {
        self.fraction_where(|_, _| true).unwrap_or(1.0)
    }

    fn fraction_where(&self, wanted: impl Fn(usize, usize) -> bool) -> Option<f64> {
        let cells = (0..CELLS[1]).flat_map(|row| (0..CELLS[0]).map(move |column| (column, row)));
        let (mut all, mut full) = (0, 0);
        for (column, row) in cells.filter(|(c, r)| wanted(*c, *r) && self.is_reachable(*c, *r)) {
            all += 1;
            full += usize::from(self.count(column, row) > 0);
        }
        (all > 0).then(|| full as f64 / all as f64)
    }

    /// Ninths of the image that are less than half covered, emptiest first, at most three.
    pub fn missing_regions(&self) -> Vec<&'static str> {
        let mut missing = Vec::new();
        for (v, names) in REGIONS.iter().enumerate() {
            for (u, name) in names.iter().enumerate() {
                let here = |column: usize, row: usize| (column * 3 / CELLS[0], row * 3 / CELLS[1]) == (u, v);
                if let Some(covered) = self.fraction_where(here).filter(|covered| *covered < 0.5) {
                    missing.push((covered, *name));
                }
            }
        }
        missing.sort_by(|a, b| a.0.total_cmp(&b.0));
        missing.into_iter().take(3).map(|(_, name)| name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_fall_into_their_cells() {
        let mut grid = CoverageGrid::new([640, 480]);
        grid.add([-0.5, -0.5]);
        grid.add([639.4, 479.4]);
        grid.add([640.0, 0.0]);
        grid.add([f64::NAN, 0.0]);
        assert_eq!((grid.count(0, 0), grid.count(11, 8)), (1, 1));
        assert!((grid.fraction() - 2.0 / 108.0).abs() < 1e-12);
        grid.clear();
        assert_eq!(grid.fraction(), 0.0);
    }

    #[test]
    fn the_empty_corner_is_named() {
        let mut grid = CoverageGrid::new([640, 480]);
        for y in 0..48 {
            for x in 0..64 {
                if !(x > 42 && y > 31) {
                    grid.add([f64::from(x) * 10.0, f64::from(y) * 10.0]);
                }
            }
        }
        assert_eq!(grid.missing_regions(), ["bottom right"]);
    }

    #[test]
    fn what_the_lens_does_not_show_is_not_missing() {
        let inside = |at: [f64; 2]| (at[0] - 320.0).hypot(at[1] - 240.0) < 200.0;
        let mut grid = CoverageGrid::new([640, 480]).with_reachable(inside);
        assert!(!grid.is_reachable(0, 0) && grid.is_reachable(6, 4));
        for y in 0..48 {
            for x in 0..64 {
                let at = [f64::from(x) * 10.0, f64::from(y) * 10.0];
                if inside(at) {
                    grid.add(at);
                }
            }
        }
        assert!(grid.fraction() > 0.95, "{}", grid.fraction());
        assert!(grid.missing_regions().is_empty());
    }
}
