//! A made-up lab on disk, to try the program without a camera.

use std::path::PathBuf;

use plumbline_model::JobContext;
use plumbline_vision::synthetic::sample::{self, SampleError};
use serde::Serialize;

/// What to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleArgs {
    /// Folder that receives `board` and `table`, each with `left` and `right`.
    pub out: PathBuf,
    /// Chessboard pairs.
    pub pairs: usize,
    /// The same seed gives the same images.
    pub seed: u64,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleReport {
    /// Folder of chessboard pairs.
    pub board: PathBuf,
    /// Folder of pairs of the table.
    pub table: PathBuf,
    /// Chessboard pairs written.
    pub pairs: usize,
    /// The board's inner corners and the side of a square.
    pub board_inner_columns: u32,
    /// Inner corners along a column.
    pub board_inner_rows: u32,
    /// Side of a square.
    pub square_mm: f64,
}

/// Renders and writes the pairs.
pub fn write_sample(args: &SampleArgs, context: &dyn JobContext) -> Result<SampleReport, SampleError> {
    sample::write(&args.out, args.pairs, args.seed, context)?;
    let board = sample::board();
    Ok(SampleReport {
        board: args.out.join("board"),
        table: args.out.join("table"),
        pairs: args.pairs,
        board_inner_columns: board.inner_columns,
        board_inner_rows: board.inner_rows,
        square_mm: board.square_m * 1000.0,
    })
}
