//! Calibrating the eyes: choose a board, collect pairs, solve, judge, compare, accept.
//!
//! [`EyesState`] is driven by commands, by what the live overlay sees and by the results of
//! work; it owns no thread and reads no clock, so that tests drive it with synthetic pairs.

pub mod assess;
pub mod auto_capture;
pub mod collection;
mod commands;
pub mod coverage;
mod events;
pub mod geometry;
pub mod ghost;
pub mod place;
pub mod sharpness;
mod state;
pub mod store;
pub mod work;
mod worlds;

use plumbline_model::Chessboard;

pub use events::Look;
pub use state::EyesState;
pub use worlds::{EyesOfWorlds, World};

/// The board that the laboratory of NICO uses: 9×6 squares of 30 mm.
pub fn default_board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}
