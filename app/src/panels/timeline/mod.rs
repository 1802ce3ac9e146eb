//! Everything that was put in use, taken back, found and checked.

mod compared;
mod in_use;
mod line;
pub mod state;

pub use compared::show as show_compared;
pub use in_use::{show as show_in_use, show_inspector};
pub use line::show as show_line;
