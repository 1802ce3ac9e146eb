//! Grasping: what and how, the attempt as it goes on, its result, and earlier ones.

mod aligned;
mod attempts;
mod choice;
mod experiment;
mod eyes;
mod inspector;
mod lamps;
pub mod parts;
mod result;
mod run;
pub mod state;
pub mod things;

pub use attempts::show as show_attempts;
pub use experiment::show as show_experiment;
pub use eyes::{click, hover, overlay, wants_detections};
pub use inspector::show as show_inspector;
pub use run::show as show_run;
pub use things::focused;
