//! Commissioning: its steps, and what it took.

mod inspector;
mod steps;

pub use inspector::show as show_inspector;
pub use steps::show as show_steps;
