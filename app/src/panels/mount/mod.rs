//! Calibrating how the eyes sit in the head: views from several head poses, and what was solved.

mod result;
mod views;

pub use result::show as show_result;
pub use views::show as show_views;
