//! Sources on files made for the purpose: what pairs, what is refused and with which words,
//! and what happens when a source disappears and comes back.

mod disappearing;
mod dropped_paths;
mod folders;
mod measured_data;
mod recordings;
mod replaying;
mod videos;
mod world;
