//! Calibrating the eyes.

pub mod assess;
pub mod auto_capture;
pub mod collection;
pub mod coverage;
pub mod geometry;
pub mod ghost;
pub mod place;
pub mod sharpness;

use plumbline_model::Chessboard;

/// The board that the laboratory of NICO uses: 9×6 squares of 30 mm.
pub fn default_board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}
