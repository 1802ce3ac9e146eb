//! Throws changed inputs at everything that reads what comes from outside: files, folders, bytes on a
//! line, words on the command line, and whole verbs on small folders.
//!
//! A case is a reader, a seed and a number: the same three give the same changed files. Worker processes
//! run cases one after the other under a limit of memory; whoever watches them ends one that hangs, and
//! says which case it was. What counts as a finding is a [`run::Verdict`] other than accepted or refused:
//! a panic, an abort, a hang, memory beyond the limit, and an answer that must not be given (a number that
//! is none, a message in a library's own words).
//!
//! `cargo run --release -p plumbline-fuzz -- --cases 100000` is the long run, `--replay FOLDER` runs a
//! finding again.

pub mod check;
pub mod dice;
pub mod mutate;
pub mod readers;
pub mod run;
pub mod seeds;
