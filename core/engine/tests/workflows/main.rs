//! The engine as its users meet it: whole workflows, with and without its threads, on synthetic
//! images.
#![allow(missing_docs)]

mod common;
mod eyes;
mod journal;
mod measured;
mod offline;
mod threads;
