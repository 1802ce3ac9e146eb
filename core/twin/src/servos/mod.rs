//! The twin's servos: a pseudo-terminal behind which servos answer as on the real bus, byte for
//! byte, with their registers, their errors, the time that bytes need, and faults that can be
//! switched on.

mod answer;
mod bank;
mod fault;
mod memory;
mod terminal;
#[cfg(test)]
mod tests;

pub(crate) use bank::Bank;
pub use fault::Fault;
pub(crate) use terminal::ServoTerminal;
