//! The simulated NICO: physics, eyes, and servos that speak the true protocol.
//!
//! A [`Twin`] runs until it is dropped. Its servos are reached through a pseudo-terminal
//! ([`Twin::port`]) as those of the real robot are through a serial port; its eyes are drawn from
//! [`Twin::scene`]; fingers on the glass come from [`Twin::touchscreen`]. What a [`Scenario`]
//! hides stays hidden, but for judges and tests: [`truth`].

mod board_presets;
mod course;
mod error;
pub mod eyes;
mod hand_look;
pub mod judging;
mod lockstep;
pub mod physics;
pub mod scenario;
pub mod scene;
pub mod scenery;
mod servos;
mod toys;
pub mod training_set;
pub mod truth;
mod twin;
mod warm_up;

pub use board_presets::{board_presets, default_board, few_board_presets};
pub use course::CoursePoint;
pub use error::TwinError;
pub use lockstep::{Lockstep, ServoState, Touched};
pub use physics::places_of_bodies;
pub use scenario::Scenario;
pub use servos::Fault;
pub use toys::Toy;
pub use twin::{SceneSource, Twin, TwinCommand, TwinSettings, TwinState, TwinTouchscreen};

/// Version of the physics that the twin is made of.
pub fn physics_version() -> &'static str {
    mujoco_rs::mujoco_version()
}
