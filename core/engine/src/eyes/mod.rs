//! Calibrating the eyes: choose a board, collect pairs, solve, judge, compare, accept.
//!
//! [`EyesWorkflow`] is driven by commands, by what the live overlay sees and by the results of
//! work; it owns no thread and reads no clock, so that tests drive it with synthetic pairs.

mod apply;
pub mod assess;
pub mod auto_capture;
mod clock;
#[cfg(test)]
mod clock_tests;
pub mod collection;
pub mod command;
mod corners;
pub mod coverage;
mod events;
pub mod geometry;
pub mod ghost;
mod health;
mod health_by_itself;
mod health_judged;
mod health_shown;
#[cfg(test)]
mod health_tests;
mod health_view;
mod look;
pub mod map;
pub mod place;
pub mod sharpness;
mod shown;
pub mod store;
mod times;
pub mod view;
pub mod work;
mod workflow;

pub use corners::{CornersInput, CornersStage};
pub use health_judged::ToldHealth;
pub use look::Look;
pub use workflow::{EyesAround, EyesWorkflow};
