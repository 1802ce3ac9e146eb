//! The way of a robot that was just switched on to its first good grasp: eight steps, which of them are
//! done and with what figure, and what they took in minutes, touches and views of the board.
//!
//! [`CommissionWorkflow`] reads what its neighbors know and says which step comes next; it moves nothing
//! and accepts nothing.

mod around;
pub mod command;
mod kept;
mod steps;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use around::{CommissionAround, Found, InUse, Made};
pub use workflow::CommissionWorkflow;
