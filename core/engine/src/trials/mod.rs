//! The experiment with grasps: positions × attempts × methods, on the twin by itself, on the robot with a
//! person who lays the thing down and says whether it was held.
//!
//! Plan, files and summary are those of the command line too. [`TrialsWorkflow`] hands out one attempt at a
//! time to grasping and owns no thread; each attempt is on disk before the next begins.

pub mod command;
mod error;
mod judged;
mod page;
mod plan;
pub mod store;
mod summary;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use error::TrialsError;
pub use judged::{Attempt, Judged};
pub use plan::{Experiment, FORMAT, Trial};
pub use plumbline_report::experiment::{
    Experiment as Page, Method as PageMethod, Position as PagePosition, TABLE as HEADINGS,
};
pub use summary::{MethodSummary, PositionSummary, Spread, Summary};
pub use workflow::{GraspNow, TrialsAround, TrialsWorkflow};
