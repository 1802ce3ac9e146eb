//! Tying the arms to the eyes: the eyes look at the robot's body, the screen, the table and the hands held over
//! it, and both arms are sized by that. What comes of it is a proposal; accepted, it is the model in use.
//!
//! A look is work on a thread of its own. Its body leads the arm order by order, as that of a grasp does.

mod around;
pub mod command;
mod gates;
mod kept;
mod look;
mod progress;
mod refusal;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use around::HandEyeAround;
pub use kept::{FILE, Kept, KeptError};
pub use workflow::{HandEyeWorkflow, is_of_other_eyes};
