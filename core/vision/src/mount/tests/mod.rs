//! Synthetic truth: planted mounts, pixel noise, encoder ticks; then everything that can go wrong.
// Numbers of seeded worlds are printed for whoever wants to see them.
#![allow(clippy::print_stdout)]

mod derivative;
mod failures;
mod files;
mod honesty;
mod planning;
mod rendered;
mod targets;
mod uncertainty;
mod world;
