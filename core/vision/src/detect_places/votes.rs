//! Which pixels of a box were matched and agreed, as a small picture without memory of its own.

use plumbline_model::PixelBox;

/// Most cells along a side.
pub const MOST_CELLS: usize = 32;

/// A grid over the left box; a set cell voted for the object's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Votes {
    /// What the grid covers, in the raw left image.
    pub area: PixelBox,
    columns: u8,
    rows: u8,
    bits: [u32; MOST_CELLS],
}

impl Votes {
    /// Nobody has voted; cells of a raw pixel or more.
    pub fn none(area: PixelBox) -> Self {
        // Sizes are limited on both sides before they are cut to whole numbers.
        let cells = |size_px: f32| size_px.round().clamp(1.0, MOST_CELLS as f32) as u8;
        Self { area, columns: cells(area.width_px()), rows: cells(area.height_px()), bits: [0; MOST_CELLS] }
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> (usize, usize) {
        (usize::from(self.columns), usize::from(self.rows))
    }

    /// Whether a cell voted; `false` outside.
    pub fn voted(&self, column: usize, row: usize) -> bool {
        column < usize::from(self.columns)
            && row < usize::from(self.rows)
            && self.bits[row] >> column & 1 == 1
    }

    /// How many cells voted.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|row| row.count_ones() as usize).sum()
    }

    /// Their share of the box, 0–1.
    pub fn share(&self) -> f64 {
        self.count() as f64 / (f64::from(self.columns) * f64::from(self.rows))
    }

    /// The cells that voted, as rectangles of the raw left image.
    pub fn cells(&self) -> impl Iterator<Item = PixelBox> + '_ {
        let width = self.area.width_px() / f32::from(self.columns);
        let height = self.area.height_px() / f32::from(self.rows);
        let (columns, rows) = self.size();
        (0..rows).flat_map(move |row| {
            (0..columns).filter(move |column| self.voted(*column, row)).map(move |column| {
                let x0 = self.area.x0_px + width * column as f32;
                let y0 = self.area.y0_px + height * row as f32;
                PixelBox::new(x0, y0, x0 + width, y0 + height)
            })
        })
    }

    /// Lets the cell at a place of the raw image vote (edges as in [`PixelBox`]).
    pub(super) fn vote(&mut self, x_px: f32, y_px: f32) {
        let column = (x_px - self.area.x0_px) / self.area.width_px() * f32::from(self.columns);
        let row = (y_px - self.area.y0_px) / self.area.height_px() * f32::from(self.rows);
        if column >= 0.0 && column < f32::from(self.columns) && row >= 0.0 && row < f32::from(self.rows) {
            self.bits[row as usize] |= 1 << column as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vote_is_where_it_was_cast() {
        let mut votes = Votes::none(PixelBox::new(10.0, 20.0, 26.0, 30.0));
        assert_eq!(votes.size(), (16, 10));
        votes.vote(12.5, 29.5);
        votes.vote(9.0, 25.0);
        votes.vote(f32::NAN, 25.0);
        assert_eq!(votes.count(), 1);
        assert!(votes.voted(2, 9) && !votes.voted(2, 10) && !votes.voted(99, 0));
        let cell = votes.cells().next().expect("one cell");
        assert_eq!(cell, PixelBox::new(12.0, 29.0, 13.0, 30.0));
    }

    #[test]
    fn a_large_box_has_coarser_cells() {
        let votes = Votes::none(PixelBox::new(0.0, 0.0, 320.0, 0.2));
        assert_eq!(votes.size(), (32, 1));
    }
}
