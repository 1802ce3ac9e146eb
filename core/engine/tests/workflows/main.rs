//! The engine as its users meet it: whole workflows, with and without its threads, on synthetic
//! images.
#![allow(missing_docs, clippy::print_stdout)]

mod common;
mod detect;
mod eyes;
mod journal;
mod measured;
mod model_in_use;
mod threads;
mod timeline;
