//! The arm on a chain of servos behind a pseudo-terminal: byte for byte what real servos would
//! see, with everything that can go wrong between them.

mod chain;
mod faults;
mod gripping;
mod killed;
mod limits;
mod moving;
mod power;
mod scanning;
mod seam;
mod stopping;
mod world;
