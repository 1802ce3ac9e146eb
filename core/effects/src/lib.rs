//! Physical effects that make measurement disagree with the model, and what a plan of touches
//! can tell of them.
//!
//! - [`library`]: the effects: their names, where they may sit, their usual size, and how each
//!   deviates the arm, the tip or the screen.
//! - [`arm`]: the arm with such deviations, and the touch that it predicts.
//! - [`eyes`]: the eyes with such deviations, and what they see and estimate.
//! - [`measurements`]: rows of sessions as predictions need them.
//! - [`forward`]: predicts a row with effects, and how it changes with each of them.
//! - [`rig_model`]: a rig's model with the effects that were accepted: file, history, predictions.
//! - [`robot_model`]: the robot as it is known now, for whatever looks, moves or grasps.
//! - [`observability`]: scores a plan of touches by the effects it will be able to tell apart.

pub mod arm;
mod candidates;
pub mod eyes;
pub mod forward;
#[cfg(test)]
mod laws;
#[cfg(test)]
mod laws_candidates;
#[cfg(test)]
mod laws_other_robots;
pub mod library;
mod looking;
pub mod measurements;
mod nuisance;
pub mod observability;
mod observation;
pub mod rig_model;
pub mod robot_model;
mod slopes;

pub use arm::Part;
pub use eyes::EyesDeviation;
pub use forward::{Assumed, Tangents};
pub use library::{Effect, Growth, Kind, Parameter, Present, Reported, Situation, Surface};
pub use measurements::{Measurements, MeasurementsError};
pub use nuisance::Nuisance;
pub use observability::{
    Addition, Advice, EffectVisibility, Noise, PlanScore, PlannedContact, ScoreError, score,
};
pub use observation::{Observation, What};
pub use rig_model::{RigModel, RigModelError};
pub use robot_model::{ModelArm, PlaceInRobot, RobotModel, SeenUnder};
