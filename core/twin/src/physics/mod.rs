//! The world in MuJoCo: robot, table, touchscreen, toys, stepped by hand or by a thread.

mod mjcf;
pub(crate) mod motor;
pub(crate) mod parts;
mod place;
mod places;
mod servo;
#[cfg(test)]
mod tests;
mod touch;
mod world;

pub use place::Places;
pub use places::places_of_bodies;
pub use servo::{Drive, Reading};
pub use touch::Contact;
pub use world::World;
