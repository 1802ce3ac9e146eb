//! The calibration target: a printed chessboard.

use std::fmt;
use std::str::FromStr;

use crate::frame::{Board, Point};
use crate::plausible;

/// A chessboard of `inner_columns` × `inner_rows` inner corners.
///
/// People count squares; detectors want inner corners (one less each way). Both are offered
/// so that neither has to be guessed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Chessboard {
    /// Inner corners along a row (squares minus one).
    pub inner_columns: u32,
    /// Inner corners along a column (squares minus one).
    pub inner_rows: u32,
    /// Side of one square, meters.
    pub square_m: f64,
}

/// The board that the laboratory of NICO uses: 9×6 squares of 30 mm.
pub fn default_board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}

/// A board that cannot be used for calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoardError {
    /// Fewer than 3×2 inner corners, or absurdly many.
    #[error(
        "a board of {columns}x{rows} inner corners cannot be used: give between 3x2 and 40x40, for example 8x5 (that is 9x6 squares)"
    )]
    Size {
        /// Inner columns asked for.
        columns: u32,
        /// Inner rows asked for.
        rows: u32,
    },
    /// Not the length of a square that is held in front of eyes.
    #[error(
        "a square of {0} m cannot be used: measure the side of one square and give it in millimeters, for example 30"
    )]
    Square(f64),
    /// Text that is not COLUMNSxROWS.
    #[error(
        "\"{0}\" is not a board size: write inner corners as COLUMNSxROWS, for example 8x5 (that is 9x6 squares)"
    )]
    Text(String),
}

impl Chessboard {
    /// From inner corners and the side of a square in meters.
    pub fn new(inner_columns: u32, inner_rows: u32, square_m: f64) -> Result<Self, BoardError> {
        let usable = |n: u32, least: u32| (least..=40).contains(&n);
        if !(usable(inner_columns.max(inner_rows), 3) && usable(inner_columns.min(inner_rows), 2)) {
            return Err(BoardError::Size { columns: inner_columns, rows: inner_rows });
        }
        if !plausible::SQUARE_M.contains(square_m) {
            return Err(BoardError::Square(square_m));
        }
        Ok(Self { inner_columns, inner_rows, square_m })
    }

    /// From the number of squares, as a person counts them.
    pub fn from_squares(columns: u32, rows: u32, square_m: f64) -> Result<Self, BoardError> {
        Self::new(columns.saturating_sub(1), rows.saturating_sub(1), square_m)
    }

    /// Squares (columns, rows).
    pub fn squares(&self) -> (u32, u32) {
        (self.inner_columns + 1, self.inner_rows + 1)
    }

    /// Number of inner corners.
    pub fn corner_count(&self) -> usize {
        self.inner_columns as usize * self.inner_rows as usize
    }

    /// Place of corner `index` on the board; row by row, like OpenCV.
    pub fn corner(&self, index: usize) -> Point<Board> {
        let columns = self.inner_columns as usize;
        Point::new((index % columns) as f64 * self.square_m, (index / columns) as f64 * self.square_m, 0.0)
    }

    /// All inner corners in order.
    pub fn corners(&self) -> Vec<Point<Board>> {
        (0..self.corner_count()).map(|i| self.corner(i)).collect()
    }

    /// The four outer inner-corners in drawing order, as indices.
    pub fn outline(&self) -> [usize; 4] {
        let (c, n) = (self.inner_columns as usize, self.corner_count());
        [0, c - 1, n - 1, n - c]
    }
}

impl fmt::Display for Chessboard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (columns, rows) = self.squares();
        write!(
            f,
            "{columns}×{rows} squares ({}×{} inner corners) of {} mm",
            self.inner_columns,
            self.inner_rows,
            self.square_m * 1000.0
        )
    }
}

/// Inner corners written as `8x5`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InnerCorners {
    /// Along a row.
    pub columns: u32,
    /// Along a column.
    pub rows: u32,
}

impl FromStr for InnerCorners {
    type Err = BoardError;
    fn from_str(text: &str) -> Result<Self, BoardError> {
        let bad = || BoardError::Text(text.to_owned());
        let (columns, rows) = text.split_once(['x', 'X', '×']).ok_or_else(bad)?;
        let number = |t: &str| t.trim().parse::<u32>().map_err(|_| bad());
        Ok(Self { columns: number(columns)?, rows: number(rows)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_run_row_by_row() {
        let board = Chessboard::from_squares(9, 6, 0.03).expect("usable");
        assert_eq!((board.inner_columns, board.inner_rows, board.corner_count()), (8, 5, 40));
        assert_eq!(board.corner(8), Point::new(0.0, 0.03, 0.0));
        assert_eq!(board.outline(), [0, 7, 39, 32]);
    }

    #[test]
    fn unusable_boards_say_what_to_give() {
        assert!(Chessboard::new(8, 1, 0.03).is_err());
        for wild in [f64::NAN, 0.0, -0.03, 30.0, 1e-9] {
            assert!(Chessboard::new(8, 5, wild).is_err(), "{wild}");
        }
        assert!(Chessboard::from_squares(0, 6, 0.03).is_err());
        let message = "8by5".parse::<InnerCorners>().expect_err("not a size").to_string();
        assert!(message.contains("8x5"), "{message}");
    }
}
