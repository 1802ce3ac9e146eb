//! Synthetic truth: planted mounts, pixel noise, encoder ticks; then everything that can go wrong.

mod derivative;
mod failures;
mod files;
mod honesty;
mod rendered;
mod targets;
mod world;
