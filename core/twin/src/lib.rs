//! The simulated NICO: physics, eyes, and servos that speak the true protocol.

mod error;
pub mod eyes;
pub mod physics;
pub mod scenario;
pub mod scene;
pub mod scenery;
mod toys;
mod warm_up;

pub use error::TwinError;
pub use scenario::Scenario;
pub use toys::Toy;
