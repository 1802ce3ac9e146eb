//! Physical effects that make measurement disagree with the model, and what a plan of touches
//! can tell of them.
//!
//! - [`library`]: the effects: their names, where they may sit, their usual size, and how each
//!   deviates the arm, the tip or the screen.
//! - [`arm`]: the arm with such deviations, and the touch that it predicts.
//! - [`observability`]: scores a plan of touches by the effects it will be able to tell apart.

pub mod arm;
#[cfg(test)]
mod laws;
pub mod library;
pub mod observability;

pub use library::{Effect, Kind, Parameter, Surface};
pub use observability::{
    Addition, Advice, EffectVisibility, Noise, PlanScore, PlannedContact, ScoreError, score,
};
