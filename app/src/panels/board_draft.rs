//! The board as it is being typed.

use plumbline_model::Chessboard;

/// The board as it is being typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardDraft {
    /// The board that the engine had when the typing began.
    pub(crate) from: Chessboard,
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) square_mm: f64,
}

impl BoardDraft {
    pub fn of(board: &Chessboard) -> Self {
        let (columns, rows) = board.squares();
        Self { from: *board, columns, rows, square_mm: board.square_m * 1000.0 }
    }

    pub fn board(&self) -> Result<Chessboard, String> {
        Chessboard::from_squares(self.columns, self.rows, self.square_mm / 1000.0)
            .map_err(|error| error.to_string())
    }
}
