//! Synthetic truth: planted mounts, pixel noise, encoder ticks; then everything that can go wrong.

mod failures;
mod files;
mod honesty;
mod targets;
mod world;
