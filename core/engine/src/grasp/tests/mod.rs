//! Grasps on the live twin: the whole engine, its threads, the bus through the pseudo-terminal, the eyes
//! as they are rendered.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

mod bad;
mod bench;
mod bus;
mod lab;
mod refusals;
mod steps;
mod stepwise;
mod twin;
