//! Touching the screen: planning, the map of touches, the run, the place of the screen.

mod draft;
mod inspector;
mod map;
mod options;
pub mod parts;
mod place;
mod plan;
mod run;
mod score;
pub mod state;
mod words;

pub use inspector::show as show_inspector;
pub use map::show as show_map;
pub use place::show as show_place;
pub use plan::show as show_plan;
pub use run::show as show_run;
